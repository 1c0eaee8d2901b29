//! Keyframes: the few moments between which the device's spline draws a motion best.
//!
//! Curve simplification (Lim and Thalmann 2001): keyframes are inserted where the curve is worst, then moved while that helps.
//! The spline is linear in the keyframes, so its error needs only the inner products of the frames, which add up over
//! motions: the *same* moments are chosen for all motions together, in parts of their length. Chan 2019 chooses for each
//! motion by itself; then the k-th keyframe of one motion shows another moment than that of the next, and an average of the
//! two is no moment at all.
//!
//! In each motion the keyframes are then found again by their posture, since no two motions keep the same time.

use kinesic::emotion::spline::Taps;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::segment::Segment;
use crate::rig::Rig;

/// Moments of a motion among which keyframes are chosen.
const MOMENTS: usize = 121;
/// Rounds of finding the keyframes in each motion and averaging what was found.
const ROUNDS: usize = 5;
/// What it costs to find a keyframe early or late, m^2 a squared part of the length; mean square distance of a joint otherwise.
/// Eight times as much draws motions better (walks .30 instead of .92 cm from their spline), but keyframes of gestures are then out
/// of phase, and what is made of them does not score what was asked (`docs/emotion.md`, section 3).
const TIMING: f64 = 0.5;

/// Weights of the four keyframes around a moment by the device's spline, whose ends are parabolas.
fn weights(keys: &[usize], at: usize) -> ([usize; 4], [f64; 4]) {
    let last = keys.len() - 1;
    let piece = keys.partition_point(|key| *key <= at).clamp(1, last) - 1;
    let length = |k: usize| if k < last { (keys[k + 1] - keys[k]) as f32 } else { 0.0 };
    let own = length(piece);
    let before = if piece > 0 { length(piece - 1) } else { 0.0 };
    let taps = Taps::new([before, own, length(piece + 1)], (at - keys[piece]) as f32 / own);
    let index = |slot: usize| (piece + slot).saturating_sub(1).min(last);
    ([index(0), index(1), index(2), index(3)], taps.value.map(f64::from))
}

/// Inner products of the moments of one motion or of several.
#[derive(Clone, Debug)]
pub struct Curve {
    moments: usize,
    /// `[moments x moments]`, summed over joints and divided by their number: m^2.
    products: Vec<f64>,
}

impl Curve {
    /// Of one motion, its frames.
    pub fn of(motion: &Segment) -> Self {
        Self::summed(motion.frames(), std::iter::once(motion))
    }

    /// Of all motions, each cut into 121 moments.
    pub fn of_all<'a>(motions: impl Iterator<Item = &'a Segment>) -> Self {
        Self::summed(MOMENTS, motions)
    }

    fn summed<'a>(moments: usize, motions: impl Iterator<Item = &'a Segment>) -> Self {
        let mut products = vec![0.0; moments * moments];
        let mut count = 0.0;
        for motion in motions {
            let rows: Vec<Vec<f64>> = (0..moments).map(|at| at_part(motion, at, moments)).collect();
            for (a, first) in rows.iter().enumerate() {
                for (b, second) in rows.iter().enumerate().skip(a) {
                    let product = crate::vector::dot(first, second);
                    products[a * moments + b] += product;
                    products[b * moments + a] += if a == b { 0.0 } else { product };
                }
            }
            count += (motion.channels() / 3) as f64;
        }
        products.iter_mut().for_each(|p| *p /= f64::max(count, 1.0));
        Self { moments, products }
    }

    /// Mean square distance of a joint from the spline at one moment, m^2.
    fn error_at(&self, keys: &[usize], at: usize) -> f64 {
        let (indices, weights) = weights(keys, at);
        let terms = indices.iter().zip(weights).map(|(k, w)| (keys[*k], w)).chain([(at, -1.0)]);
        let product =
            |(a, v): (usize, f64)| terms.clone().map(|(b, w)| v * w * self.products[a * self.moments + b]).sum::<f64>();
        terms.clone().map(product).sum::<f64>().max(0.0)
    }

    /// Root mean square distance of a joint from the spline through these moments, m.
    pub fn error(&self, keys: &[usize]) -> f64 {
        let squares: f64 = (0..self.moments).map(|at| self.error_at(keys, at)).sum();
        (squares / self.moments as f64).sqrt()
    }

    /// The `count` moments between which the spline is best, the first and the last among them.
    ///
    /// The better of two local optima: from keyframes that were inserted one by one where the curve was worst, and from evenly
    /// spaced ones.
    pub fn simplify(&self, count: usize) -> Vec<usize> {
        if count >= self.moments {
            return (0..self.moments).collect();
        }
        let (inserted, mut even) = (self.inserted(count), self.uniform(count));
        self.settle(&mut even);
        if self.error(&inserted) < self.error(&even) { inserted } else { even }
    }

    fn inserted(&self, count: usize) -> Vec<usize> {
        let mut keys = vec![0, self.moments - 1];
        while keys.len() < count {
            let free = (0..self.moments).filter(|at| keys.binary_search(at).is_err());
            let worst = free.map(|at| (self.error_at(&keys, at), at)).max_by(|a, b| a.0.total_cmp(&b.0));
            let Some((_, worst)) = worst else { break };
            keys.insert(keys.partition_point(|key| *key < worst), worst);
            self.settle(&mut keys);
        }
        keys
    }

    /// Moves keyframes one by one while the error falls.
    fn settle(&self, keys: &mut [usize]) {
        let mut error = self.error(keys);
        loop {
            let before = error;
            for k in 1..keys.len().saturating_sub(1) {
                for step in [-4i64, -1, 1, 4] {
                    let (was, moved) = (keys[k], keys[k] as i64 + step);
                    if moved <= keys[k - 1] as i64 || moved >= keys[k + 1] as i64 {
                        continue;
                    }
                    keys[k] = moved as usize;
                    let now = self.error(keys);
                    if now < error { error = now } else { keys[k] = was }
                }
            }
            if error >= before * (1.0 - 1e-6) {
                return;
            }
        }
    }

    /// Evenly spaced moments: what choosing is compared with.
    pub fn uniform(&self, count: usize) -> Vec<usize> {
        let step = (self.moments - 1) as f64 / (count - 1) as f64;
        (0..count).map(|k| (k as f64 * step).round() as usize).collect()
    }
}

/// Positions at moment `at` of `moments`, between frames by straight lines.
fn at_part(motion: &Segment, at: usize, moments: usize) -> Vec<f64> {
    let place = at as f64 / (moments - 1).max(1) as f64 * (motion.frames() - 1) as f64;
    let frame = (place as usize).min(motion.frames().saturating_sub(2));
    let part = place - frame as f64;
    let next = motion.frame((frame + 1).min(motion.frames() - 1));
    motion.frame(frame).iter().zip(next).map(|(a, b)| a + part * (b - a)).collect()
}

/// How keyframes are recognised: where in a motion, and in which posture.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyframes {
    /// Part of the length at which a keyframe lies on average: from 0 to 1.
    pub parts: Vec<f64>,
    /// Positions seen from the root, along its heading, m, `[keyframes x 3 joints]`: those of the mean rotations.
    pub postures: Vec<f64>,
}

impl Keyframes {
    /// Chooses `count` keyframes for all motions; those shorter than that many frames are not looked at.
    pub fn learn(rig: &Rig, motions: &[&Segment], count: usize) -> Self {
        let long = || motions.iter().copied().filter(|motion| motion.frames() >= count);
        let curve = Curve::of_all(long());
        let parts: Vec<f64> =
            curve.simplify(count).iter().map(|key| *key as f64 / (curve.moments - 1) as f64).collect();
        let place = |motion: &Segment| -> Vec<usize> {
            parts.iter().map(|part| (part * (motion.frames() - 1) as f64).round() as usize).collect()
        };
        let mut keyframes = Self::mean(rig, long().map(|motion| (motion, place(motion))), count);
        for _ in 0..ROUNDS {
            keyframes = Self::mean(rig, long().filter_map(|motion| Some((motion, keyframes.find(motion)?))), count);
        }
        keyframes
    }

    fn mean<'a>(rig: &Rig, found: impl Iterator<Item = (&'a Segment, Vec<usize>)>, count: usize) -> Self {
        let (mut parts, mut motions) = (vec![0.0; count], 0.0);
        let mut sums = vec![Quaternion::from_parts(0.0, Vector3::zeros()); count * rig.joints()];
        for (motion, frames) in found {
            motions += 1.0;
            for ((frame, part), row) in frames.iter().zip(&mut parts).zip(sums.chunks_exact_mut(rig.joints())) {
                *part += *frame as f64 / (motion.frames() - 1) as f64;
                for (sum, q) in row.iter_mut().zip(motion.pose(*frame)) {
                    *sum += q.into_inner() * if sum.coords.dot(&q.coords) < 0.0 { -1.0 } else { 1.0 };
                }
            }
        }
        parts.iter_mut().for_each(|x| *x /= f64::max(motions, 1.0));
        let unit = |sum: &Quaternion<f64>| UnitQuaternion::try_new(*sum, 1e-9).unwrap_or_default();
        let rotations: Vec<UnitQuaternion<f64>> = sums.iter().map(unit).collect();
        let posture = |pose: &[UnitQuaternion<f64>]| rig.skeleton.pose_positions(&Vector3::zeros(), pose);
        let postures = rotations.chunks_exact(rig.joints()).flat_map(posture).flat_map(<[f64; 3]>::from).collect();
        Self { parts, postures }
    }

    /// Number of keyframes.
    pub fn count(&self) -> usize {
        self.parts.len()
    }

    /// The frames of a motion that are most like the keyframes, in their order, the first and the last among them; `None` if
    /// it has fewer frames. Dynamic programming: `frames x keyframes x channels` multiply-adds.
    pub fn find(&self, motion: &Segment) -> Option<Vec<usize>> {
        let (frames, count) = (motion.frames(), self.count());
        if frames < count || count < 2 {
            return None;
        }
        let joints = (motion.channels() / 3) as f64;
        let cost = |k: usize, frame: usize| {
            let row = &self.postures[k * motion.channels()..][..motion.channels()];
            let distance: f64 = row.iter().zip(motion.posture(frame)).map(|(a, b)| (a - b) * (a - b)).sum();
            let late = frame as f64 / (frames - 1) as f64 - self.parts[k];
            distance / joints + TIMING * late * late
        };
        // best[frame]: least cost with this keyframe there; from[k][frame]: where the one before is.
        let mut best: Vec<f64> = (0..frames).map(|frame| if frame == 0 { 0.0 } else { f64::INFINITY }).collect();
        let mut from = vec![vec![0; frames]; count];
        for (k, from) in from.iter_mut().enumerate().skip(1) {
            let (mut least, mut place) = (f64::INFINITY, 0);
            let before = best.clone();
            for frame in 0..frames {
                let free = frame >= k && frame + count <= frames + k;
                best[frame] = if free && least.is_finite() { least + cost(k, frame) } else { f64::INFINITY };
                from[frame] = place;
                if before[frame] < least {
                    (least, place) = (before[frame], frame);
                }
            }
        }
        let mut found = vec![frames - 1];
        for k in (1..count).rev() {
            found.push(from[k][found[found.len() - 1]]);
        }
        found.reverse();
        Some(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::JointMap;
    use crate::emotion::segment::{Cut, FRAME_RATE, cut};
    use crate::gait::{Manner, skeleton, walk};

    fn rig() -> Rig {
        let skeleton = skeleton();
        Rig::new(&skeleton, &JointMap::detect(&skeleton).unwrap()).unwrap()
    }

    fn motions(manner: &Manner) -> Vec<Segment> {
        cut(&rig(), &walk(manner, 8.0, FRAME_RATE, 0.2, 2), Cut::Cycles)
    }

    #[test]
    fn the_spline_goes_through_its_keyframes_and_keeps_parabolas() {
        let keys = [0, 3, 10, 12, 20];
        for at in 0..=20 {
            let (indices, weights) = weights(&keys, at);
            let spline = |f: &dyn Fn(f64) -> f64| -> f64 {
                indices.iter().zip(weights).map(|(k, w)| w * f(keys[*k] as f64)).sum()
            };
            let x = at as f64;
            assert!((spline(&|_| 1.0) - 1.0).abs() < 1e-6);
            assert!((spline(&|t| t) - x).abs() < 1e-5);
            assert!((spline(&|t| t * t) - x * x).abs() < 1e-4, "{at}");
            if keys.contains(&at) {
                assert!((spline(&|t| t.powi(3)) - x.powi(3)).abs() < 1e-2);
            }
        }
    }

    #[test]
    fn more_keyframes_are_better_and_chosen_ones_better_than_uniform() {
        for motion in motions(&Manner::NEUTRAL).iter().take(2) {
            let curve = Curve::of(motion);
            let mut last = f64::INFINITY;
            for count in [5, 9, 13, 17] {
                let (keys, even) = (curve.simplify(count), curve.uniform(count));
                assert_eq!((keys.len(), keys[0], keys[count - 1]), (count, 0, motion.frames() - 1));
                let error = curve.error(&keys);
                assert!(error < last && error <= curve.error(&even), "{count}: {error} {}", curve.error(&even));
                last = error;
            }
            // The inner products say what the curve itself says.
            let keys = curve.simplify(7);
            let mut squares = 0.0;
            for at in 0..motion.frames() {
                let (indices, weights) = weights(&keys, at);
                for c in 0..motion.channels() {
                    let drawn: f64 = indices.iter().zip(weights).map(|(k, w)| w * motion.frame(keys[*k])[c]).sum();
                    squares += (drawn - motion.frame(at)[c]).powi(2);
                }
            }
            let direct = (squares / (motion.frames() * motion.channels() / 3) as f64).sqrt();
            assert!((direct - curve.error(&keys)).abs() < 1e-7, "{direct} {}", curve.error(&keys));
        }
    }

    #[test]
    fn keyframes_are_found_again_in_a_motion_of_another_timing() {
        let walks = motions(&Manner::NEUTRAL);
        let all: Vec<&Segment> = walks.iter().collect();
        let keyframes = Keyframes::learn(&rig(), &all, 9);
        let usual = keyframes.find(&walks[0]).unwrap();
        // Every third frame of the first half twice.
        let mut slow = walks[0].clone();
        let half = slow.frames() / 2;
        let frames: Vec<usize> =
            (0..slow.frames()).flat_map(|f| vec![f; if f < half && f % 3 == 0 { 2 } else { 1 }]).collect();
        slow.positions = frames.iter().flat_map(|f| walks[0].frame(*f).to_vec()).collect();
        slow.postures = frames.iter().flat_map(|f| walks[0].posture(*f).to_vec()).collect();
        let found = keyframes.find(&slow).unwrap();
        assert_eq!((found[0], found[8]), (0, slow.frames() - 1));
        assert!(found.windows(2).all(|pair| pair[0] < pair[1]));
        let off = |found: &[usize]| -> usize {
            found.iter().zip(&usual).map(|(slow, usual)| frames[*slow].abs_diff(*usual)).sum()
        };
        let last = (slow.frames() - 1) as f64;
        let unsought: Vec<usize> = keyframes.parts.iter().map(|part| (part * last).round() as usize).collect();
        assert!(off(&found) < off(&unsought), "{found:?} {usual:?} {unsought:?}");
        slow.positions.truncate(5 * slow.channels());
        assert_eq!(keyframes.find(&slow), None);
    }
}
