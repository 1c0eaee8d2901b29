//! Series of turns without leaps and without jitter: followed past half a turn, medians, a bell.

use nalgebra::{UnitQuaternion, Vector3};

/// A turn goes on the way it turned up to here; past it the short way is taken: cosine of half of 240 degrees.
const LONG_WAY: f64 = -0.5;
/// Widths of a bell to either side.
const REACH: f64 = 3.0;

/// The quaternion of a turn that goes on from the last one: past half a turn it is further round, until the short way is much shorter.
pub fn goes_on(last: &UnitQuaternion<f64>, next: UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    let other = UnitQuaternion::new_unchecked(-next.into_inner());
    let near = if last.coords.dot(&next.coords) < 0.0 { other } else { next };
    if near.w < LONG_WAY { UnitQuaternion::new_unchecked(-near.into_inner()) } else { near }
}

/// Rotation vector of a quaternion as it is: longer than half a turn where its real part is negative.
pub fn vector(q: &UnitQuaternion<f64>) -> Vector3<f64> {
    let sine = q.imag().norm();
    if sine < 1e-12 { Vector3::zeros() } else { q.imag() * (2.0 * sine.atan2(q.w) / sine) }
}

/// Rotation vectors of turns, one after the other.
pub fn vectors(turns: impl IntoIterator<Item = UnitQuaternion<f64>>) -> Vec<Vector3<f64>> {
    let mut last = UnitQuaternion::identity();
    let mut follow = |turn| {
        last = goes_on(&last, turn);
        vector(&last)
    };
    turns.into_iter().map(&mut follow).collect()
}

/// Median of every component over so many frames to either side: a frame that leaps, or a few, do not. Near an end as many as there are to
/// both sides, so that a movement does not bend there.
pub fn medians(of: &[Vector3<f64>], reach: usize) -> Vec<Vector3<f64>> {
    let mut near = Vec::with_capacity(2 * reach + 1);
    let mut middle = |frame: usize, axis: usize| {
        let reach = reach.min(frame).min(of.len() - 1 - frame);
        near.clear();
        near.extend(of[frame - reach..=frame + reach].iter().map(|at| at[axis]));
        *near.select_nth_unstable_by(reach, f64::total_cmp).1
    };
    (0..of.len()).map(|frame| Vector3::from_fn(|axis, _| middle(frame, axis))).collect()
}

/// Frames of `count` near a place under a bell of so many frames, with weights that add up to 1.
pub fn under_bell(at: f64, width: f64, count: usize, mut each: impl FnMut(f64, usize)) {
    let first = (at - REACH * width).ceil().max(0.0) as usize;
    let last = ((at + REACH * width).floor().max(0.0) as usize).min(count.saturating_sub(1));
    let weight = |frame: usize| (-0.5 * ((frame as f64 - at) / width).powi(2)).exp();
    let sum: f64 = (first..=last).map(weight).sum();
    if sum > 0.0 {
        (first..=last).for_each(|frame| each(weight(frame) / sum, frame));
    } else if count > 0 {
        each(1.0, last);
    }
}

/// Turns whose leaps of at most `reach` frames are gone, under a bell of `width` frames.
pub fn steady(turns: impl IntoIterator<Item = UnitQuaternion<f64>>, reach: usize, width: f64) -> Vec<Vector3<f64>> {
    let middle = medians(&vectors(turns), reach);
    let mean = |frame: usize| {
        let mut sum = Vector3::zeros();
        under_bell(frame as f64, width, middle.len(), |weight, near| sum += weight * middle[near]);
        sum
    };
    (0..middle.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turn(angle: f64) -> UnitQuaternion<f64> {
        UnitQuaternion::from_axis_angle(&Vector3::y_axis(), angle)
    }

    #[test]
    fn turns_are_followed_past_half_a_turn_and_back() {
        let angles = (0..100).map(|frame| 3.6 * (0.05 * f64::from(frame)).sin());
        for (angle, vector) in angles.clone().zip(vectors(angles.map(turn))) {
            assert!((vector.y - angle).abs() < 1e-9, "{angle}: {vector}");
        }
        // Whoever has gone three quarters round is nearer the other way.
        let round = vectors((0..60).map(|frame| turn(0.1 * f64::from(frame))));
        assert!(round.iter().all(|vector| vector.norm() < 4.3));
    }

    #[test]
    fn a_leap_is_gone_and_what_is_slow_stays() {
        let slow = |frame: usize| 0.5 * (0.02 * frame as f64).sin();
        let leaps = (0..200).map(|frame| turn(slow(frame) + if frame == 90 { 0.7 } else { 0.0 }));
        for (frame, vector) in steady(leaps, 3, 4.0).into_iter().enumerate() {
            // At the ends the bell has one side only.
            let allowed = if (10..190).contains(&frame) { 0.02 } else { 0.05 };
            assert!((vector.y - slow(frame)).abs() < allowed, "{frame}: {vector}");
        }
        assert!(steady((0..9).map(|_| turn(0.0)), 3, 4.0).iter().all(|vector| *vector == Vector3::zeros()));
    }
}
