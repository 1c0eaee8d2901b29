//! A low-pass without delay: every frame becomes the mean of its neighbours under a bell, rotations on the sphere.
//!
//! The ends are continued by their point reflection, so that a clip begins and ends where it did, and as fast.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::EditError;
use crate::clip::Clip;

/// The bell's width over the period that keeps half its size: `sqrt(ln 2 / 2) / pi`.
const WIDTH: f64 = 0.187_39;
/// Widths of the bell to either side.
const REACH: f64 = 3.0;
/// Seconds at most.
const MOST: f64 = 10.0;

/// Smooths the root's path, all rotations and a machine's coordinates. A movement of a period of `seconds` keeps half its size, one of twice the
/// period 84 %, one of half the period 6 %. Costs `frames x joints x 1.1 seconds x rate` quaternion logarithms.
pub fn smooth(clip: &Clip, seconds: f64) -> Result<Clip, EditError> {
    if !(seconds > 0.0 && seconds <= MOST) {
        let expected = format!("seconds above 0, at most {MOST}");
        return Err(EditError::Range { option: "--smooth", found: seconds, expected });
    }
    let bell = Bell::new(seconds, clip.frame_time);
    let joints = clip.skeleton.len();
    let mut out = clip.clone();
    out.root = bell.points(&clip.root);
    for joint in 0..joints {
        let turns: Vec<_> = clip.rotations.iter().skip(joint).step_by(joints).copied().collect();
        let smoothed = bell.rotations(&turns);
        out.rotations.iter_mut().skip(joint).step_by(joints).zip(smoothed).for_each(|(to, from)| *to = from);
    }
    if let Some(all) = &mut out.coordinates {
        let width = all.len() / clip.frames().max(1);
        for column in 0..width {
            let values: Vec<_> = all.iter().skip(column).step_by(width).map(|x| Vector3::new(*x, 0.0, 0.0)).collect();
            let smoothed = bell.points(&values);
            all.iter_mut().skip(column).step_by(width).zip(smoothed).for_each(|(to, from)| *to = from.x);
        }
    }
    Ok(out)
}

/// Weights of a frame and its neighbours to one side; those to the other are the same.
pub(super) struct Bell {
    weights: Vec<f64>,
}

impl Bell {
    pub fn new(seconds: f64, frame_time: f64) -> Self {
        let width = WIDTH * seconds / frame_time;
        let weights: Vec<f64> = (0..=(REACH * width).ceil() as usize)
            .map(|k| (-0.5 * (k as f64 / width.max(1e-9)).powi(2)).exp())
            .collect();
        let sum = 2.0 * weights.iter().sum::<f64>() - 1.0;
        Self { weights: weights.into_iter().map(|weight| weight / sum).collect() }
    }

    /// Neighbours of a frame: steps to it, weight.
    fn around(&self) -> impl Iterator<Item = (isize, f64)> {
        let sides = self.weights.iter().enumerate().skip(1);
        let both = sides.flat_map(|(k, weight)| [(-(k as isize), *weight), (k as isize, *weight)]);
        self.weights.first().map(|weight| (0, *weight)).into_iter().chain(both)
    }

    /// Means of points.
    pub fn points(&self, of: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let at = |frame: isize| match place(frame, of.len()) {
            (Some(end), frame) => 2.0 * of[end] - of[frame],
            (None, frame) => of[frame],
        };
        let mean = |frame: usize| self.around().map(|(step, weight)| weight * at(frame as isize + step)).sum();
        (0..of.len()).map(mean).collect()
    }

    /// Means of rotations on the sphere: of their quaternions, then once more of what turns that into each of them.
    fn rotations(&self, of: &[UnitQuaternion<f64>]) -> Vec<UnitQuaternion<f64>> {
        let at = |frame: isize| match place(frame, of.len()) {
            (Some(end), frame) => of[end] * of[frame].inverse() * of[end],
            (None, frame) => of[frame],
        };
        let mean = |frame: usize| {
            let own = of[frame];
            let near: Vec<_> = self.around().map(|(step, weight)| (at(frame as isize + step), weight)).collect();
            let sum = near.iter().fold(Quaternion::from(nalgebra::Vector4::zeros()), |sum, (turn, weight)| {
                let sign = if turn.coords.dot(&own.coords) < 0.0 { -weight } else { *weight };
                sum + turn.into_inner() * sign
            });
            let start = UnitQuaternion::try_new(sum, 1e-9).unwrap_or(own);
            let rest: Vector3<f64> =
                near.iter().map(|(turn, weight)| *weight * (start.inverse() * turn).scaled_axis()).sum();
            start * UnitQuaternion::from_scaled_axis(rest)
        };
        (0..of.len()).map(mean).collect()
    }
}

/// Where a frame is found: itself, or by reflection in an end.
fn place(frame: isize, count: usize) -> (Option<usize>, usize) {
    let last = count as isize - 1;
    let inside = |frame: isize| frame.clamp(0, last.max(0)) as usize;
    match frame {
        ..0 => (Some(0), inside(-frame)),
        _ if frame > last => (Some(inside(last)), inside(2 * last - frame)),
        _ => (None, inside(frame)),
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::gait::{Manner, walk};

    fn swing(period: f64) -> Vec<Vector3<f64>> {
        (0..600).map(|frame| Vector3::new((TAU * f64::from(frame) / 60.0 / period).sin(), 0.0, 0.0)).collect()
    }

    #[test]
    fn what_is_fast_is_taken_out_and_nothing_comes_late() {
        let bell = Bell::new(0.5, 1.0 / 60.0);
        for (period, kept) in [(0.5, 0.5), (1.0, 0.84), (0.25, 0.06), (5.0, 0.99)] {
            let before = swing(period);
            let after = bell.points(&before);
            let share = |f: usize| after[f].x / before[f].x;
            let peak = (300..400).max_by(|a, b| before[*a].x.total_cmp(&before[*b].x)).unwrap();
            assert!((share(peak) - kept).abs() < 0.02, "{period}: {}", share(peak));
            // Without delay: the highest place is where it was.
            let late = (peak - 3..peak + 4).max_by(|a, b| after[*a].x.total_cmp(&after[*b].x)).unwrap();
            assert!(late.abs_diff(peak) <= 1, "{period}: {late} {peak}");
        }
        // Even motion stays as it is, to its ends.
        let line: Vec<_> = (0..50).map(|f| Vector3::new(f64::from(f), 1.0, 0.0)).collect();
        for (a, b) in line.iter().zip(bell.points(&line)) {
            assert!((a - b).norm() < 1e-9);
        }
    }

    #[test]
    fn rotations_are_smoothed_as_angles_even_beyond_a_half_turn() {
        let bell = Bell::new(0.5, 1.0 / 60.0);
        let axis = Vector3::new(1.0, 2.0, -0.5).normalize();
        let even: Vec<_> = (0..200).map(|f| UnitQuaternion::from_scaled_axis(axis * 0.05 * f64::from(f))).collect();
        for (a, b) in even.iter().zip(bell.rotations(&even)) {
            assert!(a.angle_to(&b) < 1e-9, "{}", a.angle_to(&b));
        }
        let swung: Vec<_> = swing(0.5).iter().map(|p| UnitQuaternion::from_scaled_axis(axis * 0.6 * p.x)).collect();
        let after = bell.rotations(&swung);
        let angle = |turns: &[UnitQuaternion<f64>]| turns[200..400].iter().map(|q| q.angle()).fold(0.0, f64::max);
        assert!((angle(&after) / angle(&swung) - 0.5).abs() < 0.02, "{}", angle(&after));
    }

    #[test]
    fn noise_on_a_walk_is_less_and_the_walk_is_the_same() {
        let clip = walk(&Manner::NEUTRAL, 3.0, 60.0, 0.0, 1);
        let mut noisy = clip.clone();
        for (at, turn) in noisy.rotations.iter_mut().enumerate() {
            *turn *= UnitQuaternion::from_scaled_axis(Vector3::x() * 0.05 * (at as f64 * 12.9898).sin());
        }
        let far = |a: &Clip| a.rotations.iter().zip(&clip.rotations).map(|(a, b)| a.angle_to(b)).sum::<f64>();
        let smoothed = smooth(&noisy, 0.15).unwrap();
        assert!(far(&smoothed) < 0.5 * far(&noisy), "{} {}", far(&smoothed), far(&noisy));
        for bad in [0.0, -1.0, f64::NAN, 11.0] {
            assert!(smooth(&clip, bad).unwrap_err().to_string().contains("--smooth"));
        }
        assert_eq!(smooth(&clip.slice(0..1), 0.2).unwrap().frames(), 1);
    }
}
