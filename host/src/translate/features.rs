//! Features of the training frames, and how the frames are held back in validation.

use std::ops::Range;

use faer::Mat;

use super::dataset::Sequence;
use super::dynamics::Dynamics;

/// Blocks that a single training sequence is cut into for validation.
const BLOCKS: usize = 4;
/// Most folds when there are several sequences.
const MOST_FOLDS: usize = 8;

/// `[x' | u]` of all frames.
pub fn with_states(dynamics: &Dynamics, u: Mat<f64>) -> Mat<f64> {
    let x = dynamics.simulate(&u);
    let states = x.ncols();
    Mat::from_fn(u.nrows(), states + u.ncols(), |t, i| if i < states { x[(t, i)] } else { u[(t, i - states)] })
}

/// Rows minus their mean, `[frames x channels]`.
pub fn centred(rows: &[f64], mean: &[f64]) -> Mat<f64> {
    let channels = mean.len();
    Mat::from_fn(rows.len() / channels, channels, |t, c| rows[t * channels + c] - mean[c])
}

/// One joint's columns minus their mean (none if it is empty), `[frames x 3]`.
pub fn columns(rows: &[f64], channels: usize, joint: usize, mean: &[f64]) -> Mat<f64> {
    let mean = |c: usize| mean.get(c).copied().unwrap_or(0.0);
    Mat::from_fn(rows.len() / channels, 3, |t, d| rows[t * channels + 3 * joint + d] - mean(3 * joint + d))
}

/// Principal directions over the first deviation, most important first; those without variance are left out.
pub fn principal(covariance: &Mat<f64>, frames: usize) -> Mat<f64> {
    let Ok(eigen) = covariance.self_adjoint_eigen(faer::Side::Lower) else { return Mat::zeros(covariance.nrows(), 0) };
    let (values, vectors) = (eigen.S().column_vector(), eigen.U());
    let n = covariance.nrows();
    let first = values[n - 1].max(0.0);
    let kept = (0..n).filter(|i| values[n - 1 - i] > 1e-9 * first).count().min(32);
    let deviation = (first / frames.max(1) as f64).sqrt();
    Mat::from_fn(n, kept, |c, k| {
        // The sign is free: fix it so that the same data give the same pack.
        let column = vectors.col(n - 1 - k);
        let largest = (0..n).max_by(|a, b| column[*a].abs().total_cmp(&column[*b].abs())).unwrap_or(0);
        column[c] * column[largest].signum() / deviation
    })
}

/// The same take of every group where each has several, else blocks of time: what is held back is an action that was trained on.
pub fn takes(sequences: &[Sequence]) -> (Vec<(usize, Range<usize>, usize)>, usize) {
    let take = |index: usize| sequences[..index].iter().filter(|s| s.group == sequences[index].group).count();
    let several = |group: usize| sequences.iter().filter(|s| s.group == group).count() >= 2;
    if sequences.iter().all(|s| several(s.group)) {
        let takes: Vec<usize> = (0..sequences.len()).map(|index| take(index) % BLOCKS).collect();
        let folds = takes.iter().max().map_or(0, |most| most + 1);
        let whole = sequences.iter().zip(takes).enumerate();
        return (whole.map(|(index, (s, take))| (index, 0..s.covered.len(), take)).collect(), folds);
    }
    let cut = |(index, s): (usize, &Sequence)| {
        let edge = |block: usize| block * s.covered.len() / BLOCKS;
        (0..BLOCKS).map(|block| (index, edge(block)..edge(block + 1), block)).collect::<Vec<_>>()
    };
    (sequences.iter().enumerate().flat_map(cut).collect(), BLOCKS)
}

/// Whole groups where there are at least three, else whole sequences, else blocks of time.
pub fn segments(sequences: &[Sequence]) -> (Vec<(usize, Range<usize>, usize)>, usize) {
    let count = sequences.len();
    let mut groups: Vec<usize> = sequences.iter().map(|s| s.group).collect();
    groups.sort_unstable();
    groups.dedup();
    if count >= 3 {
        let by_group = groups.len() >= 3;
        let units = if by_group { groups.len() } else { count };
        let folds = units.min(MOST_FOLDS);
        let fold = |(index, s): (usize, &Sequence)| {
            let unit = if by_group { groups.iter().position(|g| *g == s.group).unwrap_or(0) } else { index };
            (index, 0..s.covered.len(), unit * folds / units)
        };
        return (sequences.iter().enumerate().map(fold).collect(), folds);
    }
    let cut = |(index, s): (usize, &Sequence)| {
        let edge = |block: usize| block * s.covered.len() / BLOCKS;
        (0..BLOCKS).map(|block| (index, edge(block)..edge(block + 1), index * BLOCKS + block)).collect::<Vec<_>>()
    };
    (sequences.iter().enumerate().flat_map(cut).collect(), BLOCKS * count)
}
