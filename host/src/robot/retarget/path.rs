//! Poses of all frames: one path that does not jump.

use nalgebra::Vector3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use super::solve::{Pull, Solver};

/// Where every arrow should point, `[frames][arrows]`, in the root link's axes; `None` where the clip does not say.
pub(super) type Targets = [Vec<Option<Vector3<f64>>>];

/// Starts of the first frame.
const STARTS: usize = 24;
/// Starts whose whole paths are compared, for each frame from which they set out.
const PATHS: usize = 3;
/// Frames from which paths set out.
const ORIGINS: usize = 4;
/// A joint's way within `STILL` seconds weighs as much as an arrow's error of the same size, rad.
pub(super) const STILL: f64 = 5e-4;
/// Pull towards zero, beside an arrow's: joints that no direction asks for go there.
const REST: f64 = 1e-6;
/// The same for the choice among starts.
const NEAR: f64 = 1e-3;

/// Every frame from its neighbour, outwards from one frame: the first, and then the one where the best path so far is worst. The best of
/// the whole paths stays.
pub(super) fn first_pass(solver: &Solver, targets: &Targets, zero: &[f64], weight: f64) -> Vec<Vec<f64>> {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut best: Option<(f64, Vec<Vec<f64>>, Vec<f64>)> = None;
    let mut origin = 0;
    for _ in 0..ORIGINS {
        let Some(target) = targets.get(origin) else { break };
        let mut better = false;
        for start in starts(solver, target, zero, &mut random) {
            let (path, costs) = spread(solver, targets, zero, weight, origin, start);
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
fn starts(solver: &Solver, target: &[Option<Vector3<f64>>], zero: &[f64], random: &mut ChaCha8Rng) -> Vec<Vec<f64>> {
    let mut starts: Vec<(f64, Vec<f64>)> = (0..STARTS)
        .map(|start| {
            let mut values = zero.to_vec();
            for at in solver.active.iter().filter(|_| start > 0) {
                let variable = &solver.body.variables[*at];
                let (low, high) = (variable.lower.max(-3.0), variable.upper.min(3.0));
                values[*at] = if low < high { random.random_range(low..high) } else { zero[*at] };
            }
            let cost = solver.solve(&mut values, target, &[Pull { to: zero, weight: NEAR }], 40);
            (cost, values)
        })
        .collect();
    starts.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    // Many starts end in one place.
    starts.dedup_by(|(a, _), (b, _)| (*a - *b).abs() < 1e-4);
    starts.into_iter().take(PATHS).map(|(_, values)| values).collect()
}

/// A whole path from a pose at one frame, with the cost of every frame.
fn spread(
    solver: &Solver,
    targets: &Targets,
    zero: &[f64],
    weight: f64,
    origin: usize,
    start: Vec<f64>,
) -> (Vec<Vec<f64>>, Vec<f64>) {
    let mut path = vec![Vec::new(); targets.len()];
    let mut costs = vec![0.0; targets.len()];
    let mut walk = |frames: &mut dyn Iterator<Item = usize>, start: &[f64]| {
        let mut values = start.to_vec();
        for frame in frames {
            let before = values.clone();
            let pulls = [Pull { to: &before, weight }, Pull { to: zero, weight: REST }];
            costs[frame] = solver.solve(&mut values, &targets[frame], &pulls, 12);
            path[frame].clone_from(&values);
        }
    };
    walk(&mut (origin..targets.len()), &start);
    walk(&mut (0..origin).rev(), &start);
    (path, costs)
}

/// Every frame anew, near the mean of its neighbours.
pub(super) fn sweep(solver: &Solver, targets: &Targets, zero: &[f64], weight: f64, path: &mut [Vec<f64>], back: bool) {
    let count = path.len();
    for step in 0..count {
        let at = if back { count - 1 - step } else { step };
        let (before, after) = (at.saturating_sub(1), (at + 1).min(count - 1));
        let near: Vec<f64> = path[before].iter().zip(&path[after]).map(|(a, b)| 0.5 * (a + b)).collect();
        let mut values = path[at].clone();
        let pulls = [Pull { to: &near, weight: 2.0 * weight }, Pull { to: zero, weight: REST }];
        solver.solve(&mut values, &targets[at], &pulls, 12);
        path[at] = values;
    }
}
