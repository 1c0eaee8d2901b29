//! Another frame rate.

use super::Clip;

/// Why a clip cannot be resampled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ResampleError {
    /// Not a frame rate.
    #[error("the frame rate is {found}, expected a number from 1 to 1000 frames per second")]
    Rate {
        /// What was asked for.
        found: f64,
    },
    /// More frames than the clip's length in frames accounts for.
    #[error(
        "at {fps} frames per second its {seconds:.0} s {memory}: cut the clip, or correct the frame time if it is not that long"
    )]
    TooLong {
        /// Length of the clip, s.
        seconds: f64,
        /// The rate asked for.
        fps: f64,
        /// Why not.
        memory: Memory,
    },
}

/// Memory that frames would take, and what their source allows, bytes.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "take {:.0} MB of memory, at most {:.0} MB are taken (20 times the {frames} frames that are there, and 200 MB)", needed / 1e6, allowed / 1e6
)]
pub struct Memory {
    needed: f64,
    allowed: f64,
    frames: usize,
}

impl Memory {
    /// Refuses to make `wanted` frames out of `frames` where that takes more than 20 times the memory of these as text, and 200 MB.
    ///
    /// Frames that are played are poses of the host's capacity, a clip before and behind, and the text that is written: measured on
    /// `kinesic apply`.
    pub fn check(frames: usize, wanted: f64, joints: usize) -> Result<(), Memory> {
        let joints = joints as f64;
        let needed = wanted * (3000.0 + 100.0 * joints);
        // Three angles of nine characters.
        let allowed = 20.0 * (27.0 * joints * frames as f64) + 2e8;
        if wanted <= frames as f64 || needed <= allowed { Ok(()) } else { Err(Memory { needed, allowed, frames }) }
    }
}

/// Frame times are written with few digits (0.0333333): a ratio this near to a whole number is meant to be it. The 29.97 frames of
/// television are not 30, a thousandth off.
const RATIO_TOLERANCE: f64 = 5e-4;

impl Clip {
    /// The clip at another frame rate, over the same time.
    ///
    /// Where the source rate is a multiple of the new one, frames are picked and nothing is interpolated. Otherwise
    /// rotations are interpolated on the great arc (slerp) and the root linearly. Interpolation does not filter: halving the
    /// rate of a noisy clip aliases its noise.
    pub fn resample(&self, fps: f64) -> Result<Clip, ResampleError> {
        if !(1.0..=1000.0).contains(&fps) {
            return Err(ResampleError::Rate { found: fps });
        }
        let wanted = 1.0 + self.duration() * fps;
        Memory::check(self.frames(), wanted, self.skeleton.len()).map_err(|memory| ResampleError::TooLong {
            seconds: self.duration(),
            fps,
            memory,
        })?;
        let ratio = self.fps() / fps;
        let whole = ratio.round();
        let drift = (ratio - whole).abs() / whole.max(1.0);
        if whole >= 1.0 && drift < RATIO_TOLERANCE {
            return Ok(self.every(whole as usize, 1.0 / fps));
        }
        let count = 1 + (self.duration() * fps + 1e-6).floor() as usize;
        Ok(self.sampled((0..count).map(|frame| frame as f64 * ratio), 1.0 / fps))
    }

    /// The clip at these times, in frames; past its end it stays there. Rotations are interpolated on the great arc, the rest linearly.
    pub fn sampled(&self, times: impl ExactSizeIterator<Item = f64>, frame_time: f64) -> Clip {
        let rotations = Vec::with_capacity(times.len() * self.skeleton.len());
        let last = self.frames().saturating_sub(1);
        let mut out = Clip { root: Vec::with_capacity(times.len()), rotations, ..self.shell(frame_time) };
        for at in times {
            let at = at.clamp(0.0, last as f64);
            let (before, part) = (at.floor() as usize, at.fract());
            let after = (before + 1).min(last);
            if let (Some(a), Some(b)) = (self.root.get(before), self.root.get(after)) {
                out.root.push(a.lerp(b, part));
            }
            let pairs = self.pose(before).iter().zip(self.pose(after));
            // A half turn within a frame has no shortest arc; the nearer frame is as good as any.
            let nearer = |a, b| if part < 0.5 { a } else { b };
            out.rotations.extend(pairs.map(|(a, b)| a.try_slerp(b, part, 1e-12).unwrap_or(*nearer(a, b))));
            if let (Some(a), Some(b), Some(to)) =
                (self.coordinates(before), self.coordinates(after), &mut out.coordinates)
            {
                to.extend(a.iter().zip(b).map(|(a, b)| a + part * (b - a)));
            }
        }
        out
    }

    /// The clip on another clock, at its own rate: `due` says when each frame of a clip of the same motion at `frame_time` is due, in frames,
    /// rising. That clip may have another rate.
    pub fn on_clock(&self, due: &[f64], frame_time: f64) -> Clip {
        let Some(end) = due.last().filter(|_| due.len() > 1 && self.frames() > 1) else { return self.clone() };
        let ratio = frame_time / self.frame_time;
        let frames = 1 + (end * ratio).floor() as usize;
        let mut next = 1;
        let time = |frame: usize| {
            let now = frame as f64 / ratio;
            while next + 1 < due.len() && due[next] < now {
                next += 1;
            }
            let part = ((now - due[next - 1]) / (due[next] - due[next - 1])).clamp(0.0, 1.0);
            (next as f64 - 1.0 + part) * ratio
        };
        let times: Vec<f64> = (0..frames).map(time).collect();
        self.sampled(times.into_iter(), self.frame_time)
    }

    /// Every `step`-th frame.
    fn every(&self, step: usize, frame_time: f64) -> Clip {
        let root = self.root.iter().step_by(step).copied().collect();
        let rotations = (0..self.frames()).step_by(step).flat_map(|f| self.pose(f).iter().copied()).collect();
        let coordinates = self
            .coordinates
            .as_ref()
            .map(|_| (0..self.frames()).step_by(step).filter_map(|f| self.coordinates(f)).flatten().copied().collect());
        Clip { root, rotations, coordinates, ..self.shell(frame_time) }
    }

    fn shell(&self, frame_time: f64) -> Clip {
        let (skeleton, notes) = (self.skeleton.clone(), self.notes.clone());
        let coordinates = self.coordinates.as_ref().map(|_| Vec::new());
        Clip { skeleton, frame_time, root: Vec::new(), rotations: Vec::new(), coordinates, notes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::{Manner, walk};

    #[test]
    fn a_frame_time_of_ten_seconds_is_refused_with_both_numbers() {
        let clip = |frames: usize, frame_time: f64| {
            let walk = walk(&Manner::NEUTRAL, 1.0, 60.0, 0.0, 1);
            let at = |frame: usize| frame % walk.frames();
            Clip {
                root: (0..frames).map(|frame| walk.root[at(frame)]).collect(),
                rotations: (0..frames).flat_map(|frame| walk.pose(at(frame)).to_vec()).collect(),
                ..walk.shell(frame_time)
            }
        };
        let error = clip(800, 10.0).resample(60.0).unwrap_err().to_string();
        assert!(error.contains("7990 s") && error.contains("take 2"), "{error}");
        assert!(error.contains("at most 208 MB") && error.contains("800 frames"), "{error}");
        // A few of them are a slow film.
        assert_eq!(clip(20, 10.0).resample(60.0).unwrap().frames(), 11_401);
        // As long as one likes, at a usual rate: what is played is in proportion to what is read.
        let long = clip(30_000, 1.0 / 30.0);
        assert_eq!(long.resample(60.0).unwrap().frames(), 59_999);
        assert_eq!(long.resample(24.0).unwrap().frames(), 24_000);
    }
}
