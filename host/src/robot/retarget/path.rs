//! Poses of all frames: one path that does not jump, and keeps limits of speed.

use nalgebra::Vector3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use super::solve::{Pull, Solver};
use super::speed;

/// Where every arrow should point, `[frames][arrows]`, in the root link's axes; `None` where the clip does not say.
pub(super) type Targets = [Vec<Option<Vector3<f64>>>];

/// Starts of the first frame.
const STARTS: usize = 24;
/// Starts whose whole paths are compared, for each frame from which they set out.
const PATHS: usize = 3;
/// Frames from which paths set out.
const ORIGINS: usize = 4;
/// Times that a path within speed limits is gone through, back and forth.
const SWEEPS: usize = 8;
/// A joint's way within `STILL` seconds weighs as much as an arrow's error of the same size, rad.
const STILL: f64 = 5e-4;
/// Pull towards zero, beside an arrow's: joints that no direction asks for go there.
const REST: f64 = 1e-6;
/// The same for the choice among starts.
const NEAR: f64 = 1e-3;

/// What a path is made for.
pub(super) struct Course<'c> {
    pub solver: &'c Solver<'c>,
    pub targets: &'c Targets,
    /// The pose at zero, or as near to it as bounds let.
    pub zero: &'c [f64],
    /// Seconds.
    pub frame_time: f64,
}

impl Course<'_> {
    /// The best path without limits of speed.
    pub fn free(&self) -> Vec<Vec<f64>> {
        let unlimited = vec![f64::INFINITY; self.zero.len()];
        let mut path = self.first(&unlimited);
        for back in [true, false] {
            self.sweep(&mut path, &unlimited, back);
        }
        path
    }

    /// The best path whose variables change by no more than `most` from frame to frame. Two are compared: the free one, slowed down joint
    /// by joint, and one whose every frame is within reach of the one before. In both, joints that are quick enough then make up for
    /// those that are not.
    pub fn limited(&self, free: &[Vec<f64>], most: &[f64]) -> Vec<Vec<f64>> {
        let mut slowed = free.to_vec();
        for (at, most) in most.iter().enumerate() {
            let mut one: Vec<f64> = free.iter().map(|values| values[at]).collect();
            speed::keep(&mut one, *most);
            slowed.iter_mut().zip(one).for_each(|(values, value)| values[at] = value);
        }
        let mut paths = [slowed, self.first(most)];
        for path in &mut paths {
            for back in [true, false].repeat(SWEEPS) {
                self.sweep(path, most, back);
            }
        }
        let [slowed, stepped] = paths;
        if self.cost(&stepped) < self.cost(&slowed) { stepped } else { slowed }
    }

    /// How much a joint's way to the next frame weighs.
    fn stillness(&self) -> f64 {
        (STILL / self.frame_time).powi(2)
    }

    fn cost(&self, path: &[Vec<f64>]) -> f64 {
        path.iter().zip(self.targets).map(|(values, target)| self.solver.cost(values, target, &[])).sum()
    }

    /// Every frame from its neighbour, outwards from one frame: the first, and then the one where the best path so far is worst. The best
    /// of the whole paths stays.
    fn first(&self, most: &[f64]) -> Vec<Vec<f64>> {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let mut best: Option<(f64, Vec<Vec<f64>>, Vec<f64>)> = None;
        let mut origin = 0;
        for _ in 0..ORIGINS {
            let Some(target) = self.targets.get(origin) else { break };
            let mut better = false;
            for start in self.starts(target, &mut random) {
                let (path, costs) = self.spread(origin, start, most);
                let sum: f64 = costs.iter().sum();
                if best.as_ref().is_none_or(|(least, ..)| sum < *least) {
                    better = true;
                    best = Some((sum, path, costs));
                }
            }
            let costs = best.iter().flat_map(|(_, _, costs)| costs.iter().copied()).enumerate();
            let worst = costs.max_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(at, _)| at);
            if !better || worst == origin {
                break;
            }
            origin = worst;
        }
        best.map(|(_, path, _)| path).unwrap_or_default()
    }

    /// The best few poses for one frame, each of its own kind.
    fn starts(&self, target: &[Option<Vector3<f64>>], random: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
        let bounds = self.solver.bounds();
        let mut starts: Vec<(f64, Vec<f64>)> = (0..STARTS)
            .map(|start| {
                let mut values = self.zero.to_vec();
                for at in self.solver.active.iter().filter(|_| start > 0) {
                    let [lower, upper] = bounds[*at];
                    let (low, high) = (lower.max(-3.0), upper.min(3.0));
                    values[*at] = if low < high { random.random_range(low..high) } else { self.zero[*at] };
                }
                let pull = [Pull { to: self.zero, weight: NEAR }];
                let cost = self.solver.solve(&mut values, target, &pull, &bounds, 40);
                (cost, values)
            })
            .collect();
        starts.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        // Many starts end in one place.
        starts.dedup_by(|(a, _), (b, _)| (*a - *b).abs() < 1e-4);
        starts.into_iter().take(PATHS).map(|(_, values)| values).collect()
    }

    /// A whole path from a pose at one frame, with the cost of every frame.
    fn spread(&self, origin: usize, start: Vec<f64>, most: &[f64]) -> (Vec<Vec<f64>>, Vec<f64>) {
        let count = self.targets.len();
        let mut path = vec![start; count];
        let mut costs = vec![0.0; count];
        let outwards = (origin + 1..count).map(|frame| (frame, frame - 1));
        let inwards = (0..origin).rev().map(|frame| (frame, frame + 1));
        for (frame, from) in std::iter::once((origin, origin)).chain(outwards).chain(inwards) {
            let (before, mut values) = (path[from].clone(), path[from].clone());
            // The start may move anywhere.
            let within = if frame == from { self.solver.bounds() } else { self.near(&[&before], most) };
            let pulls = [Pull { to: &before, weight: self.stillness() }, Pull { to: self.zero, weight: REST }];
            costs[frame] = self.solver.solve(&mut values, &self.targets[frame], &pulls, &within, 12);
            path[frame] = values;
        }
        (path, costs)
    }

    /// Every frame anew, near the mean of its neighbours.
    fn sweep(&self, path: &mut [Vec<f64>], most: &[f64], back: bool) {
        let count = path.len();
        for step in 0..count {
            let at = if back { count - 1 - step } else { step };
            let (before, after) = (&path[at.saturating_sub(1)], &path[(at + 1).min(count - 1)]);
            let mean: Vec<f64> = before.iter().zip(after).map(|(a, b)| 0.5 * (a + b)).collect();
            // At the ends the frame itself would be its neighbour.
            let neighbours: Vec<&Vec<f64>> =
                [(at > 0).then_some(before), (at + 1 < count).then_some(after)].into_iter().flatten().collect();
            let within = self.near(&neighbours, most);
            let mut values = path[at].clone();
            let pulls = [Pull { to: &mean, weight: 2.0 * self.stillness() }, Pull { to: self.zero, weight: REST }];
            self.solver.solve(&mut values, &self.targets[at], &pulls, &within, 12);
            path[at] = values;
        }
    }

    /// Bounds of every variable, no further than `most` from any of these poses.
    fn near(&self, poses: &[&Vec<f64>], most: &[f64]) -> Vec<[f64; 2]> {
        let mut within = self.solver.bounds();
        for pose in poses {
            for (([lower, upper], value), most) in within.iter_mut().zip(*pose).zip(most) {
                (*lower, *upper) = (lower.max(value - most), upper.min(value + most));
            }
        }
        // Between neighbours that are as far apart as may be, rounding may leave nothing.
        for [lower, upper] in within.iter_mut().filter(|[lower, upper]| lower > upper) {
            *lower = 0.5 * (*lower + *upper);
            *upper = *lower;
        }
        within
    }
}
