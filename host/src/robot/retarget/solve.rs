//! Damped least squares within bounds: Levenberg and Marquardt's steps over the columns that are free to go where they would.

use nalgebra::Vector3;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use super::reach::Reach;

/// Weight of a change since the last frame against a direction that is off, per rad^2.
const STEADY: f64 = 1e-3;
/// Weight of the distance from zero: keeps columns that nothing asks for in place.
const HOME: f64 = 1e-5;
/// Steps of the first frame and of the others.
const STEPS: [usize; 2] = [100, 20];
/// Starts of the first frame beside zero.
const STARTS: usize = 12;
/// Another start must be so much better, rad^2.
const BETTER: f64 = 0.02;
/// A step below this is the last one, rad.
const SMALLEST: f64 = 1e-8;

struct Problem<'a> {
    reach: &'a Reach<'a>,
    goals: &'a [Option<Vector3<f64>>],
    before: Option<&'a [f64]>,
    home: Vec<f64>,
    bounds: Vec<[f64; 2]>,
}

/// The first frame: from zero, and from elsewhere where that is clearly better.
pub(super) fn first(reach: &Reach, goals: &[Option<Vector3<f64>>]) -> Vec<f64> {
    let problem = Problem { reach, goals, before: None, home: reach.start(), bounds: reach.bounds.clone() };
    let mut best = problem.solve(&reach.start(), STEPS[0]);
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for _ in 0..STARTS {
        let half = std::f64::consts::PI;
        let start: Vec<f64> =
            reach.bounds.iter().map(|[l, u]| random.random_range(l.max(-half).min(*u)..=u.min(half).max(*l))).collect();
        let other = problem.solve(&start, STEPS[0]);
        if other.1 < best.1 - BETTER {
            best = other;
        }
    }
    best.0
}

/// A frame after another one: no column goes farther than its speed allows in `step` seconds.
pub(super) fn next(reach: &Reach, goals: &[Option<Vector3<f64>>], before: &[f64], step: f64) -> Vec<f64> {
    let near = |((bounds, at), speed): ((&[f64; 2], &f64), &f64)| {
        [bounds[0].max(at - speed * step).min(bounds[1]), bounds[1].min(at + speed * step).max(bounds[0])]
    };
    let bounds = reach.bounds.iter().zip(before).zip(&reach.speeds).map(near).collect();
    Problem { reach, goals, before: Some(before), home: reach.start(), bounds }.solve(before, STEPS[1]).0
}

impl Problem<'_> {
    /// Where the search ends, and what it costs there.
    fn solve(&self, start: &[f64], steps: usize) -> (Vec<f64>, f64) {
        let mut at: Vec<f64> = start.iter().zip(&self.bounds).map(|(x, [l, u])| x.max(*l).min(*u)).collect();
        let mut cost = self.cost(&at);
        let mut damping: f64 = 1e-3;
        for _ in 0..steps {
            let (slope, bend) = self.quadratic(&at);
            let free: Vec<usize> = (0..at.len())
                .filter(|i| {
                    !(at[*i] <= self.bounds[*i][0] && slope[*i] >= 0.0
                        || at[*i] >= self.bounds[*i][1] && slope[*i] <= 0.0)
                })
                .collect();
            if free.is_empty() {
                break;
            }
            let mut moved = None;
            while moved.is_none() && damping < 1e8 {
                let row = |i: usize| &bend[i * at.len()..(i + 1) * at.len()];
                let mut small: Vec<f64> = free.iter().flat_map(|i| free.iter().map(|j| row(*i)[*j])).collect();
                (0..free.len()).for_each(|i| small[i * free.len() + i] += damping);
                let mut step: Vec<f64> = free.iter().map(|i| -slope[*i]).collect();
                cholesky(&mut small, &mut step);
                let mut to = at.clone();
                for (step, i) in step.iter().zip(&free) {
                    let [lower, upper] = self.bounds[*i];
                    to[*i] = (at[*i] + step).max(lower).min(upper);
                }
                let there = self.cost(&to);
                if there < cost {
                    moved = Some((to, there));
                    damping = (damping / 4.0).max(1e-9);
                } else {
                    damping *= 5.0;
                }
            }
            let Some((to, there)) = moved else { break };
            let far = at.iter().zip(&to).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            (at, cost) = (to, there);
            if far < SMALLEST {
                break;
            }
        }
        (at, cost)
    }

    fn pulls<'b>(&'b self) -> impl Iterator<Item = (f64, &'b [f64])> {
        [(HOME, &self.home[..])].into_iter().chain(self.before.map(|before| (STEADY, before)))
    }

    fn cost(&self, at: &[f64]) -> f64 {
        let ways = self.reach.directions(at);
        let off = |(at, (way, goal)): (usize, (&Option<Vector3<f64>>, &Option<Vector3<f64>>))| {
            Some(self.reach.weight(at) * ((*way)? - (*goal)?).norm_squared())
        };
        let off = ways.iter().zip(self.goals).enumerate().filter_map(off);
        let pull = |(weight, to): (f64, &[f64])| weight * at.iter().zip(to).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        off.sum::<f64>() + self.pulls().map(pull).sum::<f64>()
    }

    /// Half the cost's gradient, and Gauss's approximation of its second derivatives, row-major.
    fn quadratic(&self, at: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (ways, slopes) = self.reach.derivatives(at);
        let width = at.len();
        let (mut gradient, mut bend) = (vec![0.0; width], vec![0.0; width * width]);
        for (limb, (way, goal)) in ways.iter().zip(self.goals).enumerate() {
            let Some((way, goal)) = way.zip(*goal) else { continue };
            let row = &slopes[limb * width..(limb + 1) * width];
            // Most joints turn few limbs.
            let some: Vec<usize> = (0..width).filter(|i| row[*i] != Vector3::zeros()).collect();
            for &i in &some {
                let slope = row[i] * self.reach.weight(limb);
                gradient[i] += slope.dot(&(way - goal));
                some.iter().for_each(|j| bend[i * width + j] += slope.dot(&row[*j]));
            }
        }
        for (weight, to) in self.pulls() {
            for i in 0..width {
                gradient[i] += weight * (at[i] - to[i]);
                bend[i * width + i] += weight;
            }
        }
        (gradient, bend)
    }
}

/// Solves `matrix x = right`, `matrix` symmetric and positive, row-major; `right` becomes x.
fn cholesky(matrix: &mut [f64], right: &mut [f64]) {
    let n = right.len();
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| matrix[i * n + k] * matrix[j * n + k]).sum();
            let rest = matrix[i * n + j] - sum;
            // Damped: what rounding leaves is above zero.
            matrix[i * n + j] = if i == j { rest.max(1e-12).sqrt() } else { rest / matrix[j * n + j] };
        }
        let sum: f64 = (0..i).map(|k| matrix[i * n + k] * right[k]).sum();
        right[i] = (right[i] - sum) / matrix[i * n + i];
    }
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|k| matrix[k * n + i] * right[k]).sum();
        right[i] = (right[i] - sum) / matrix[i * n + i];
    }
}
