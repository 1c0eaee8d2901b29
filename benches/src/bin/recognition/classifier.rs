//! A linear classifier: ridge regression of one-hot labels on standardised features.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

/// Penalty, in units of a feature's variance.
const PENALTY: f64 = 0.1;
/// Deviation below which a feature says nothing, rad or m.
const STILL: f64 = 1e-4;

/// Scores of the classes are affine in the features.
pub struct Classifier {
    mean: Vec<f64>,
    inverse_deviation: Vec<f64>,
    /// `[features x classes]`.
    weights: Mat<f64>,
    bias: Vec<f64>,
}

impl Classifier {
    /// From samples `(features, class)`.
    pub fn fit(samples: &[(Vec<f64>, usize)], classes: usize) -> Option<Self> {
        let (count, features) = (samples.len() as f64, samples.first()?.0.len());
        let mean_of = |f: usize| samples.iter().map(|(x, _)| x[f]).sum::<f64>() / count;
        let mean: Vec<f64> = (0..features).map(mean_of).collect();
        let deviation = |f: usize| (samples.iter().map(|(x, _)| (x[f] - mean[f]).powi(2)).sum::<f64>() / count).sqrt();
        let inverse = |deviation: f64| if deviation > STILL { 1.0 / deviation } else { 0.0 };
        let inverse_deviation: Vec<f64> = (0..features).map(|f| inverse(deviation(f))).collect();
        let share = |class: usize| samples.iter().filter(|(_, c)| *c == class).count() as f64 / count;
        let bias: Vec<f64> = (0..classes).map(share).collect();
        let x = Mat::from_fn(samples.len(), features, |i, f| (samples[i].0[f] - mean[f]) * inverse_deviation[f]);
        let y = Mat::from_fn(samples.len(), classes, |i, c| f64::from(samples[i].1 == c) - bias[c]);
        let mut normal = x.transpose() * &x;
        (0..features).for_each(|f| normal[(f, f)] += PENALTY * count);
        let weights = normal.llt(Side::Lower).ok()?.solve(&(x.transpose() * y));
        Some(Self { mean, inverse_deviation, weights, bias })
    }

    /// The class with the highest score.
    pub fn class(&self, features: &[f64]) -> usize {
        let score = |class: usize| {
            let of = |(f, x): (usize, &f64)| (x - self.mean[f]) * self.inverse_deviation[f] * self.weights[(f, class)];
            self.bias[class] + features.iter().enumerate().map(of).sum::<f64>()
        };
        (0..self.bias.len()).max_by(|a, b| score(*a).total_cmp(&score(*b))).unwrap_or(0)
    }
}

/// Means and standard deviations of the columns from `skip` on, of rows of `channels` numbers.
pub fn features(rows: &[f64], channels: usize, skip: usize) -> Vec<f64> {
    let frames = (rows.len() / channels) as f64;
    let column = |c: usize| rows.iter().skip(c).step_by(channels);
    let mean = |c: usize| column(c).sum::<f64>() / frames;
    let means: Vec<f64> = (skip..channels).map(mean).collect();
    let deviation = |(c, mean): (usize, &f64)| (column(c).map(|x| (x - mean).powi(2)).sum::<f64>() / frames).sqrt();
    let deviations: Vec<f64> = (skip..channels).zip(&means).map(deviation).collect();
    [means, deviations].concat()
}
