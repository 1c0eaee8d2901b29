//! Another frame rate.

use super::Clip;

/// Why a clip cannot be resampled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ResampleError {
    /// Not a frame rate.
    #[error("the frame rate is {found}, expected a number from 0.1 to 10000 frames per second")]
    Rate {
        /// What was asked for.
        found: f64,
    },
    /// More than fits into the memory of a workstation.
    #[error(
        "{seconds:.0} s of {joints} joints at {fps} frames per second are {rotations:.1e} rotations, at most {MAX_ROTATIONS:.1e} \
         are taken: ask for a lower rate, or cut the clip"
    )]
    TooLong {
        /// Length of the clip, s.
        seconds: f64,
        /// Its joints.
        joints: usize,
        /// The rate asked for.
        fps: f64,
        /// Frames times joints.
        rotations: f64,
    },
}

/// Most rotations of a clip: 3 GB, or four hours of 60 joints at 120 frames per second.
const MAX_ROTATIONS: f64 = 1e8;

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
        if !(0.1..=10_000.0).contains(&fps) {
            return Err(ResampleError::Rate { found: fps });
        }
        let joints = self.skeleton.len();
        let rotations = (1.0 + self.duration() * fps) * joints as f64;
        if rotations > MAX_ROTATIONS {
            return Err(ResampleError::TooLong { seconds: self.duration(), joints, fps, rotations });
        }
        let ratio = self.fps() / fps;
        let whole = ratio.round();
        let drift = (ratio - whole).abs() / whole.max(1.0);
        if whole >= 1.0 && drift < RATIO_TOLERANCE {
            return Ok(self.every(whole as usize, 1.0 / fps));
        }
        let n = self.skeleton.len();
        let count = 1 + (self.duration() * fps + 1e-6).floor() as usize;
        let last = self.frames().saturating_sub(1);
        let mut out = Clip { root: Vec::new(), rotations: Vec::with_capacity(count * n), ..self.shell(1.0 / fps) };
        for frame in 0..count {
            let at = (frame as f64 * ratio).min(last as f64);
            let (before, part) = (at.floor() as usize, at.fract());
            let after = (before + 1).min(last);
            if let (Some(a), Some(b)) = (self.root.get(before), self.root.get(after)) {
                out.root.push(a.lerp(b, part));
            }
            let pairs = self.pose(before).iter().zip(self.pose(after));
            // A half turn within a frame has no shortest arc; the nearer frame is as good as any.
            let nearer = |a, b| if part < 0.5 { a } else { b };
            out.rotations.extend(pairs.map(|(a, b)| a.try_slerp(b, part, 1e-12).unwrap_or(*nearer(a, b))));
        }
        Ok(out)
    }

    /// Every `step`-th frame.
    fn every(&self, step: usize, frame_time: f64) -> Clip {
        let root = self.root.iter().step_by(step).copied().collect();
        let rotations = (0..self.frames()).step_by(step).flat_map(|f| self.pose(f).iter().copied()).collect();
        Clip { root, rotations, ..self.shell(frame_time) }
    }

    fn shell(&self, frame_time: f64) -> Clip {
        let (skeleton, notes) = (self.skeleton.clone(), self.notes.clone());
        Clip { skeleton, frame_time, root: Vec::new(), rotations: Vec::new(), notes }
    }
}
