//! The ranking function: `w` such that `w x` is larger where a sample shows more (Chan 2019, eq. 1, after Parikh 2011).
//!
//! `1/2 |w|^2 + C (sum over ordered max(0, 1 - w(xi - xj))^2 + sum over similar (w(xi - xj))^2)` is convex with a continuous
//! gradient: Newton's method in the primal (Chapelle 2007). A pair is two indices, the matrix of pair differences never
//! exists: gradient and Hessian are `X'` times a vector over the samples, which the pairs fill.

use super::curvature::Curvature;
use super::pairs::Pairs;
use super::samples::{Samples, add_scaled};
use crate::vector::{Work, dot, vectorised};

/// How to minimise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankOptions {
    /// `C`, the cost of a violated pair. [`choose_cost`](super::choose_cost) finds one by validation.
    pub cost: f64,
    /// Done when the gradient has fallen to this share of the first one.
    pub tolerance: f64,
    /// At most so many Newton steps.
    pub max_steps: usize,
}

impl Default for RankOptions {
    fn default() -> Self {
        Self { cost: 1.0, tolerance: 1e-5, max_steps: 60 }
    }
}

/// A ranking function and how it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranked {
    /// `w`.
    pub weights: Vec<f64>,
    /// The objective at the start and after every Newton step.
    pub history: Vec<f64>,
}

impl Ranked {
    /// `w x`.
    pub fn score(&self, sample: &[f64]) -> f64 {
        dot(&self.weights, sample)
    }

    /// `w x` of every sample.
    pub fn scores(&self, samples: &Samples) -> Vec<f64> {
        let mut scores = Vec::new();
        samples.product(&self.weights, &mut scores);
        scores
    }
}

/// Down to here the samples of [`Curvature`] will do; what follows corrects what they lack.
const ROUGH: f64 = 1e-3;

/// Minimises from `start` (zeros: `&[]`). Only differences of samples count: subtract a mean or not.
///
/// Cost of a conjugate-gradient step: `2 rows x columns` multiply-adds and two a violated pair. Memory: the samples in 16 bits,
/// a few vectors.
pub fn rank(samples: &Samples, pairs: &Pairs, options: &RankOptions, start: &[f64]) -> Ranked {
    rank_with(samples, &Curvature::new(samples), pairs, options, start)
}

/// As [`rank`], with a [`Curvature`] of the samples that is used again.
pub fn rank_with(
    samples: &Samples,
    curvature: &Curvature,
    pairs: &Pairs,
    options: &RankOptions,
    start: &[f64],
) -> Ranked {
    let pairs = &pairs.by_first();
    // Most steps are made where a quarter of the memory is read.
    let rough = RankOptions { tolerance: ROUGH.max(options.tolerance), ..*options };
    let first = norm_at_zero(curvature, pairs, options.cost);
    let mut weights = vec![0.0; samples.columns()];
    weights.iter_mut().zip(start).for_each(|(to, from)| *to = *from);
    Problem::new(curvature, curvature, pairs, options.cost).minimise(&mut weights, first, &rough);
    let mut history = Vec::new();
    if start.is_empty() {
        // Every ordered pair is short by one.
        history.push(options.cost * pairs.ordered.len() as f64);
    }
    history.extend(Problem::new(samples, curvature, pairs, options.cost).minimise(&mut weights, first, options));
    Ranked { weights, history }
}

/// The weights by the samples of a [`Curvature`] alone: good to a few digits, however small the tolerance. Pairs are best
/// sorted by their first sample.
pub(super) fn rank_roughly(curvature: &Curvature, pairs: &Pairs, options: &RankOptions, start: &[f64]) -> Vec<f64> {
    let mut weights = vec![0.0; curvature.columns()];
    weights.iter_mut().zip(start).for_each(|(to, from)| *to = *from);
    let first = norm_at_zero(curvature, pairs, options.cost);
    Problem::new(curvature, curvature, pairs, options.cost).minimise(&mut weights, first, options);
    weights
}

/// Value at `weights`, for checks: the definition.
pub fn objective(samples: &Samples, pairs: &Pairs, cost: f64, weights: &[f64]) -> f64 {
    let mut scores = Vec::new();
    samples.product(weights, &mut scores);
    let curvature = Curvature::new(samples);
    let mut problem = Problem::new(samples, &curvature, pairs, cost);
    problem.locate(&scores);
    problem.gradient(weights, &scores, &mut vec![0.0; weights.len()])
}

/// The two products of samples with vectors.
pub(super) trait Rows {
    /// `X w`.
    fn product(&self, weights: &[f64], out: &mut Vec<f64>);
    /// `out += X' r`.
    fn add_transposed(&self, factors: &[f64], out: &mut [f64]);
    fn rows(&self) -> usize;
}

/// Size of the gradient at zero, where every ordered pair is short by one.
fn norm_at_zero(curvature: &Curvature, pairs: &Pairs, cost: f64) -> f64 {
    let mut pull = vec![0.0; curvature.rows()];
    for [i, j] in &pairs.ordered {
        pull[*i as usize] -= 2.0 * cost;
        pull[*j as usize] += 2.0 * cost;
    }
    let mut gradient = vec![0.0; curvature.columns()];
    curvature.add_transposed(&pull, &mut gradient);
    norm(&gradient)
}

struct Problem<'a, R: Rows> {
    samples: &'a R,
    pairs: &'a Pairs,
    curvature: &'a Curvature,
    cost: f64,
    /// What every ordered pair lacks of a distance of one: it is violated if that is positive.
    short: Vec<f64>,
    /// How much farther a step takes every ordered pair apart.
    apart: Vec<f64>,
    /// The violated pairs at the last gradient, and what they lack.
    active: Vec<[u32; 2]>,
    lack: Vec<f64>,
    /// One number a sample, filled by pairs.
    pull: Vec<f64>,
}

impl<'a, R: Rows> Problem<'a, R> {
    fn new(samples: &'a R, curvature: &'a Curvature, pairs: &'a Pairs, cost: f64) -> Self {
        let (count, pull) = (pairs.ordered.len(), vec![0.0; samples.rows()]);
        let (short, apart) = (vec![1.0; count], vec![0.0; count]);
        Self { samples, pairs, curvature, cost, short, apart, active: vec![], lack: vec![], pull }
    }

    /// Newton steps from `weights`; the objective there and after every step.
    ///
    /// `first`: the size of the gradient at zero, of which the tolerance is a share; a warm start begins with a small one.
    fn minimise(&mut self, weights: &mut [f64], first: f64, options: &RankOptions) -> Vec<f64> {
        let least = options.tolerance * first;
        let mut scores = vec![0.0; self.samples.rows()];
        if weights.iter().any(|w| *w != 0.0) {
            self.samples.product(weights, &mut scores);
            self.locate(&scores);
        }
        let mut gradient = vec![0.0; weights.len()];
        let mut objective = self.gradient(weights, &scores, &mut gradient);
        let mut history = vec![objective];
        let mut moved = Vec::new();
        for _ in 0..options.max_steps {
            let size = norm(&gradient);
            if size <= least {
                break;
            }
            // As far as Newton's method can use; near the end, right to it.
            let left = least / size;
            let useful = (options.tolerance / left).sqrt().min(0.1);
            let step = self.newton_step(&gradient, if useful < 4.0 * left { 0.5 * left } else { useful });
            self.samples.product(&step, &mut moved);
            let slope = dot(&gradient, &step);
            let length = self.line_search(weights, &scores, &step, &moved, slope);
            let before = (weights.to_vec(), objective);
            add_scaled(weights, length, &step);
            add_scaled(&mut scores, length, &moved);
            vectorised(|| add_scaled(&mut self.short, -length, &self.apart));
            objective = self.gradient(weights, &scores, &mut gradient);
            // Where only rounding is left to gain.
            if objective >= before.1 {
                if objective > before.1 {
                    weights.copy_from_slice(&before.0);
                }
                break;
            }
            history.push(objective);
        }
        history
    }

    /// What every pair lacks, from the scores of the samples.
    fn locate(&mut self, scores: &[f64]) {
        differences(&self.pairs.ordered, scores, &mut self.short);
        self.short.iter_mut().for_each(|short| *short = 1.0 - *short);
    }

    /// Objective, gradient, and the violated pairs, from what the pairs lack.
    fn gradient(&mut self, weights: &[f64], scores: &[f64], gradient: &mut [f64]) -> f64 {
        self.pull.fill(0.0);
        self.find_violated();
        let mut loss = dot(&self.lack, &self.lack);
        let mut lacks = self.lack.iter();
        for run in self.active.chunk_by(|a, b| a[0] == b[0]) {
            let mut sum = 0.0;
            for ([_, j], lack) in run.iter().zip(&mut lacks) {
                sum += lack;
                self.pull[*j as usize] += lack;
            }
            self.pull[run[0][0] as usize] -= sum;
        }
        for [i, j] in &self.pairs.similar {
            let (i, j) = (*i as usize, *j as usize);
            let apart = scores[i] - scores[j];
            loss += apart * apart;
            self.pull[i] += apart;
            self.pull[j] -= apart;
        }
        self.pull.iter_mut().for_each(|p| *p *= 2.0 * self.cost);
        gradient.copy_from_slice(weights);
        self.samples.add_transposed(&self.pull, gradient);
        0.5 * dot(weights, weights) + self.cost * loss
    }

    /// Keeps a pair by where the next one goes: which pairs are violated, no processor can foresee.
    fn find_violated(&mut self) {
        self.active.resize(self.short.len() + 1, [0; 2]);
        self.lack.resize(self.short.len() + 1, 0.0);
        let mut count = 0;
        for (pair, short) in self.pairs.ordered.iter().zip(&self.short) {
            (self.active[count], self.lack[count]) = (*pair, *short);
            count += usize::from(*short > 0.0);
        }
        self.active.truncate(count);
        self.lack.truncate(count);
    }

    /// `H v = v + 2 C X' L X v`, `L` the Laplacian of the similar and of the violated pairs.
    fn hessian(&self, v: &[f64], out: &mut [f64]) {
        self.curvature.apply(v, out, |image, pull| {
            // By their first sample: one of the two sums stays in a register.
            for pairs in [&self.active, &self.pairs.similar] {
                for run in pairs.chunk_by(|a, b| a[0] == b[0]) {
                    let first = run[0][0] as usize;
                    let (own, mut sum) = (image[first], 0.0);
                    for [_, j] in run {
                        let apart = own - image[*j as usize];
                        sum += apart;
                        pull[*j as usize] -= apart;
                    }
                    pull[first] += sum;
                }
            }
        });
        out.iter_mut().zip(v).for_each(|(out, v)| *out = v + 2.0 * self.cost * *out);
    }

    /// `-H^-1 gradient` by conjugate gradients, down to the share `rest` of the gradient. The diagonal as a preconditioner would
    /// make the coordinates alike in curvature and the noise in them as important as the rest: half as many steps again.
    fn newton_step(&self, gradient: &[f64], rest: f64) -> Vec<f64> {
        let mut step = vec![0.0; gradient.len()];
        let mut residual: Vec<f64> = gradient.iter().map(|g| -g).collect();
        let mut direction = residual.clone();
        let mut energy = dot(&residual, &residual);
        let wanted = rest * rest * energy;
        let mut image = vec![0.0; gradient.len()];
        // In exact arithmetic it ends after as many steps as there are columns.
        for _ in 0..2 * gradient.len() {
            self.hessian(&direction, &mut image);
            let length = energy / dot(&direction, &image);
            if !length.is_finite() {
                break;
            }
            add_scaled(&mut step, length, &direction);
            add_scaled(&mut residual, -length, &image);
            let after = dot(&residual, &residual);
            if after <= wanted {
                break;
            }
            let share = after / energy;
            energy = after;
            direction.iter_mut().zip(&residual).for_each(|(d, r)| *d = r + share * *d);
        }
        step
    }

    /// The length that minimises along `step`: a convex, piecewise quadratic function of one number; Newton on its slope,
    /// kept between a length at which it falls and one at which it rises.
    /// `start`: the slope where it begins.
    fn line_search(&mut self, weights: &[f64], scores: &[f64], step: &[f64], moved: &[f64], start: f64) -> f64 {
        let (mut along, mut own) = (dot(weights, step), dot(step, step));
        let across = |values: &[f64], [i, j]: [u32; 2]| values[i as usize] - values[j as usize];
        // Similar pairs are quadratic along the step.
        for pair in &self.pairs.similar {
            let apart = across(moved, *pair);
            along += 2.0 * self.cost * across(scores, *pair) * apart;
            own += 2.0 * self.cost * apart * apart;
        }
        differences(&self.pairs.ordered, moved, &mut self.apart);
        let (short, apart) = (&self.short, &self.apart);
        let slope = |t: f64| {
            let [first, second] = vectorised(Violated { short, apart, at: t });
            (along + t * own - 2.0 * self.cost * first, own + 2.0 * self.cost * second)
        };
        let (mut low, mut high, mut t) = (0.0, f64::INFINITY, 1.0);
        let steep = start.abs();
        for _ in 0..30 {
            let (first, second) = slope(t);
            if first.abs() <= 1e-3 * steep {
                break;
            }
            if first < 0.0 {
                low = t
            } else {
                high = t
            }
            let newton = t - first / second;
            t = if newton > low && newton < high { newton } else { 0.5 * (low + high.min(2.0 * low + 1.0)) };
        }
        t
    }
}

/// `values[i] - values[j]` of every pair.
fn differences(pairs: &[[u32; 2]], values: &[f64], out: &mut [f64]) {
    for ([i, j], out) in pairs.iter().zip(out) {
        *out = values[*i as usize] - values[*j as usize];
    }
}

/// Sums of `(short - at apart) apart` and of `apart^2` over the pairs that are violated there, in eight lanes.
struct Violated<'a> {
    short: &'a [f64],
    apart: &'a [f64],
    at: f64,
}

impl Work for Violated<'_> {
    type Output = [f64; 2];

    #[inline(always)]
    fn call(self) -> [f64; 2] {
        let mut sums = [[0.0; 8]; 2];
        let mut add = |lane: usize, short: f64, apart: f64| {
            let left = short - self.at * apart;
            let counted = if left > 0.0 { apart } else { 0.0 };
            sums[0][lane] += left * counted;
            sums[1][lane] += apart * counted;
        };
        let ((short, last_short), (apart, last_apart)) = (self.short.as_chunks::<8>(), self.apart.as_chunks::<8>());
        for (short, apart) in short.iter().zip(apart) {
            for lane in 0..8 {
                add(lane, short[lane], apart[lane]);
            }
        }
        last_short.iter().zip(last_apart).for_each(|(short, apart)| add(0, *short, *apart));
        sums.map(|lanes| lanes.iter().sum())
    }
}

fn norm(v: &[f64]) -> f64 {
    dot(v, v).sqrt()
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::super::pairs::pair_accuracy;
    use super::*;

    /// Samples with a hidden direction, and pairs by it.
    fn made(rows: usize, columns: usize, seed: u64) -> (Vec<f64>, Vec<f64>, Pairs) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let values: Vec<f64> = (0..rows * columns).map(|_| random.random_range(-1.0..1.0)).collect();
        let truth: Vec<f64> = (0..columns).map(|_| random.random_range(-1.0..1.0)).collect();
        let scores: Vec<f64> = values.chunks_exact(columns).map(|row| dot(row, &truth)).collect();
        let levels: Vec<Option<f64>> = scores.iter().map(|s| Some((2.0 * s).round())).collect();
        (values, scores, Pairs::of_levels(&levels, &vec![0; rows], 0.0))
    }

    #[test]
    fn the_gradient_is_that_of_finite_differences_and_the_hessian_that_of_the_gradient() {
        let (values, _, pairs) = made(30, 7, 1);
        let samples = Samples::new(&values, 7);
        let curvature = Curvature::new(&samples);
        let mut problem = Problem::new(&samples, &curvature, &pairs, 0.3);
        let weights: Vec<f64> = (0..7).map(|k| 0.3 * f64::from(k) - 1.0).collect();
        let mut at = |weights: &[f64]| {
            let mut gradient = vec![0.0; 7];
            let scores = Ranked { weights: weights.to_vec(), history: vec![] }.scores(&samples);
            problem.locate(&scores);
            let value = problem.gradient(weights, &scores, &mut gradient);
            (value, gradient)
        };
        let step = 1e-6;
        let mut columns = Vec::new();
        for k in 0..7 {
            let (mut up, mut down) = (weights.clone(), weights.clone());
            up[k] += step;
            down[k] -= step;
            let (up, down) = (at(&up), at(&down));
            let slope = (up.0 - down.0) / (2.0 * step);
            let analytic = at(&weights).1[k];
            assert!((slope - analytic).abs() < 1e-6 * analytic.abs().max(1.0), "{k}: {slope} {analytic}");
            columns.push(up.1.iter().zip(&down.1).map(|(u, d)| (u - d) / (2.0 * step)).collect::<Vec<f64>>());
        }
        at(&weights);
        let v: Vec<f64> = (0..7).map(|k| f64::from(k * k % 5) - 2.0).collect();
        let mut image = vec![0.0; 7];
        problem.hessian(&v, &mut image);
        for (k, image) in image.iter().enumerate() {
            let numeric: f64 = columns.iter().zip(&v).map(|(column, v)| column[k] * v).sum();
            assert!((numeric - image).abs() < 1e-3 * image.abs().max(1.0), "{k}: {numeric} {image}");
        }
    }

    #[test]
    fn the_objective_falls_to_where_its_gradient_vanishes() {
        let (values, _, pairs) = made(60, 12, 2);
        let samples = Samples::new(&values, 12);
        for cost in [1e-4, 1e-2, 1.0, 100.0] {
            let options = RankOptions { cost, tolerance: 1e-9, ..RankOptions::default() };
            let ranked = rank(&samples, &pairs, &options, &[]);
            assert!(ranked.history.windows(2).all(|w| w[1] < w[0]), "{:?}", ranked.history);
            let curvature = Curvature::new(&samples);
            let mut problem = Problem::new(&samples, &curvature, &pairs, cost);
            let mut gradient = vec![0.0; 12];
            let scores = ranked.scores(&samples);
            problem.locate(&scores);
            problem.gradient(&ranked.weights, &scores, &mut gradient);
            assert!(norm(&gradient) < 1e-6 * norm_at_zero(&curvature, &pairs, cost), "C = {cost}: {}", norm(&gradient));
            let last = *ranked.history.last().unwrap();
            assert!((objective(&samples, &pairs, cost, &ranked.weights) - last).abs() < 1e-9 * last);
            let warm = rank(&samples, &pairs, &options, &ranked.weights);
            assert!(warm.history.len() <= 2, "a solution is left alone: {:?}", warm.history);
        }
    }

    #[test]
    fn unseen_samples_are_put_in_order() {
        let (values, _, pairs) = made(200, 20, 3);
        let samples = Samples::new(&values, 20);
        let half: Vec<bool> = (0..200).map(|i| i % 2 == 0).collect();
        let other: Vec<bool> = half.iter().map(|h| !h).collect();
        let ranked = rank(&samples, &pairs.among(&half), &RankOptions::default(), &[]);
        let accuracy = pair_accuracy(&ranked.scores(&samples), &pairs.among(&other).ordered);
        assert!(accuracy > 0.97, "{accuracy}");
    }

    #[test]
    fn without_pairs_nothing_is_preferred() {
        let (values, ..) = made(5, 3, 4);
        let ranked = rank(&Samples::new(&values, 3), &Pairs::default(), &RankOptions::default(), &[]);
        assert_eq!(ranked.weights, [0.0; 3]);
    }
}
