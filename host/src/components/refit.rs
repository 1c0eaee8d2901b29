//! Least squares on a given support: what the penalty shrank comes back.

use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef, Side};

use super::factor::{Factors, column, column_mut, product};

/// Rounds of least squares for `C` and for `W` in turn.
const ROUNDS: usize = 30;

/// A round that lowers the squared error by less than this share of it is the last.
const TOLERANCE: f64 = 1e-3;

/// Minimises `|M - W C|^2` over `W` and over those joint groups of `C` that are not zero, in turn.
///
/// Cost of a round: `4 F 3N K + F K^2` multiply-adds and a Cholesky factorisation a joint of the size of its components.
pub fn refit(motion: MatRef<'_, f64>, factors: &Factors) -> Factors {
    let mut refitted = factors.clone();
    rounds(motion, &mut refitted, ROUNDS);
    refitted.normalise();
    refitted
}

/// Up to `count` rounds of least squares.
pub(super) fn rounds(motion: MatRef<'_, f64>, factors: &mut Factors, count: usize) {
    let support = factors.support();
    let total = motion.squared_norm_l2();
    let mut before = f64::INFINITY;
    for _ in 0..count {
        fit_components(motion, &support, factors);
        let error = fit_weights(motion, total, factors);
        if before - error <= TOLERANCE * before.min(total) {
            break;
        }
        before = error;
    }
    fit_components(motion, &support, factors);
}

/// For every joint: least squares on the weight columns of the components that move it.
fn fit_components(motion: MatRef<'_, f64>, support: &[Vec<bool>], factors: &mut Factors) {
    let inner = product(factors.weights.transpose(), factors.weights.as_ref());
    let cross = product(factors.weights.transpose(), motion);
    for joint in 0..factors.components.nrows() / 3 {
        let active: Vec<usize> = (0..support.len()).filter(|k| support[*k][joint]).collect();
        let gram = Mat::from_fn(active.len(), active.len(), |a, b| inner[(active[a], active[b])]);
        let right = Mat::from_fn(active.len(), 3, |a, c| cross[(active[a], 3 * joint + c)]);
        if let Some(solution) = solve(gram, &right) {
            for (a, k) in active.iter().enumerate() {
                (0..3).for_each(|c| column_mut(&mut factors.components, *k)[3 * joint + c] = solution[(a, c)]);
            }
        }
    }
}

/// `W = M C' (C C')^-1`; returns the squared error.
fn fit_weights(motion: MatRef<'_, f64>, total: f64, factors: &mut Factors) -> f64 {
    let outer = product(factors.components.transpose(), factors.components.as_ref());
    let cross = product(motion, factors.components.as_ref());
    if let Some(solution) = solve(outer, &cross.transpose().to_owned()) {
        factors.weights = solution.transpose().to_owned();
    }
    let fitted: f64 = (0..factors.count())
        .map(|k| column(&cross, k).iter().zip(column(&factors.weights, k)).map(|(a, b)| a * b).sum::<f64>())
        .sum();
    (total - fitted).max(0.0)
}

/// `gram^-1 right` with a trace of damping, so that two components that have become alike do not grow against each other.
pub(super) fn solve(mut gram: Mat<f64>, right: &Mat<f64>) -> Option<Mat<f64>> {
    let size = gram.nrows();
    let trace: f64 = (0..size).map(|k| gram[(k, k)]).sum();
    (0..size).for_each(|k| gram[(k, k)] += 1e-5 * trace / size.max(1) as f64 + 1e-300);
    (size > 0).then_some(())?;
    gram.llt(Side::Lower).ok().map(|cholesky| cholesky.solve(right))
}
