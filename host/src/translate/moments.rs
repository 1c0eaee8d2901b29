//! Least squares from second moments: every frame is read once, then each candidate costs a small solve.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

/// Second moments of the stacked vector `v = [features | own inputs | 1 | outputs]`, summed over frames.
#[derive(Clone, Debug)]
pub struct Moments {
    sums: Mat<f64>,
    shape: Shape,
}

/// Lengths of the parts of `v`. Inputs and outputs have the same number of channels: three a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Features: filter states, then drives.
    pub features: usize,
    /// Channels of own inputs and of outputs.
    pub channels: usize,
}

impl Shape {
    fn one(&self) -> usize {
        self.features + self.channels
    }

    fn len(&self) -> usize {
        self.features + 2 * self.channels + 1
    }
}

/// The direct map from a joint to itself that is fitted before the rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    /// None: the mean styled pose.
    Mean,
    /// The source itself: the rest is a difference.
    Identity,
    /// A gain for each channel.
    Channel,
    /// A 3 x 3 matrix for each joint.
    Joint,
}

/// A fitted linear map: `y = weights' features + gains inputs + bias`.
#[derive(Clone, Debug)]
pub struct Map {
    /// `[features x channels]`.
    pub weights: Mat<f64>,
    /// Row-major 3 x 3 a joint.
    pub gains: Vec<[[f64; 3]; 3]>,
    /// `[channels]`.
    pub bias: Vec<f64>,
}

/// Variance below which an input is noise, m^2: one centimetre.
const NOISE: f64 = 1e-4;

impl Moments {
    /// No frames.
    pub fn zero(shape: Shape) -> Self {
        Self { sums: Mat::zeros(shape.len(), shape.len()), shape }
    }

    /// Moments of rows `v` (`[frames x len]`, assembled by [`stack`]).
    pub fn of(shape: Shape, rows: faer::MatRef<'_, f64>) -> Self {
        Self { sums: rows.transpose() * rows, shape }
    }

    /// `self + factor * other`.
    pub fn add(&mut self, other: &Self, factor: f64) {
        faer::zip!(&mut self.sums, &other.sums).for_each(|faer::unzip!(a, b)| *a += factor * *b);
    }

    /// Number of features.
    pub fn features(&self) -> usize {
        self.shape.features
    }

    /// Number of frames.
    pub fn frames(&self) -> f64 {
        self.sums[(self.shape.one(), self.shape.one())]
    }

    /// Ridge regression: features are penalised by `penalty` (per feature, in units of a feature's variance), the base is not.
    pub fn fit(&self, base: Base, penalty: &[f64]) -> Option<Map> {
        let Shape { features, channels } = self.shape;
        let (own, one, out) = (features, self.shape.one(), self.shape.one() + 1);
        let frames = self.frames().max(1.0);
        let mean = |i: usize| self.sums[(i, one)] / frames;
        let covariance = |i: usize, j: usize| self.sums[(i, j)] / frames - mean(i) * mean(j);

        let mut gains = vec![[[0.0; 3]; 3]; channels / 3];
        for (joint, gains) in gains.iter_mut().enumerate() {
            let at = own + 3 * joint;
            match base {
                Base::Mean => {}
                Base::Identity => (0..3).for_each(|d| gains[d][d] = 1.0),
                Base::Channel => {
                    for (d, row) in gains.iter_mut().enumerate() {
                        row[d] = covariance(at + d, out + 3 * joint + d) / (covariance(at + d, at + d) + NOISE);
                    }
                }
                Base::Joint => {
                    let mut normal = Mat::from_fn(3, 3, |i, j| covariance(at + i, at + j));
                    (0..3).for_each(|d| normal[(d, d)] += NOISE);
                    let right = Mat::from_fn(3, 3, |i, j| covariance(at + i, out + 3 * joint + j));
                    let solution = normal.llt(Side::Lower).ok()?.solve(&right);
                    *gains = [0, 1, 2].map(|row| [0, 1, 2].map(|column| solution[(column, row)]));
                }
            }
        }
        let through_base = |of: &dyn Fn(usize) -> f64, channel: usize| -> f64 {
            let (joint, row) = (channel / 3, channel % 3);
            (0..3).map(|d| gains[joint][row][d] * of(own + 3 * joint + d)).sum()
        };
        let right = Mat::from_fn(features, channels, |f, channel| {
            covariance(f, out + channel) - through_base(&|i| covariance(f, i), channel)
        });
        let normal = Mat::from_fn(features, features, |i, j| covariance(i, j) + if i == j { penalty[i] } else { 0.0 });
        let weights = if features == 0 { Mat::zeros(0, channels) } else { normal.llt(Side::Lower).ok()?.solve(&right) };
        let bias = (0..channels)
            .map(|channel| {
                let features: f64 = (0..features).map(|f| weights[(f, channel)] * mean(f)).sum();
                mean(out + channel) - through_base(&mean, channel) - features
            })
            .collect();
        Some(Map { weights, gains, bias })
    }

    /// Sum of the squared errors of a map over these frames, channels weighted.
    pub fn squared_error(&self, map: &Map, weight: &dyn Fn(usize) -> f64) -> f64 {
        let Shape { features, channels } = self.shape;
        let (own, one, out) = (features, self.shape.one(), self.shape.one() + 1);
        // The error is linear in v: e = v K.
        let mut k = Mat::zeros(self.shape.len(), channels);
        for channel in 0..channels {
            for f in 0..features {
                k[(f, channel)] = -map.weights[(f, channel)];
            }
            for d in 0..3 {
                k[(own + channel / 3 * 3 + d, channel)] = -map.gains[channel / 3][channel % 3][d];
            }
            k[(one, channel)] = -map.bias[channel];
            k[(out + channel, channel)] = 1.0;
        }
        let moved = &self.sums * &k;
        (0..channels)
            .map(|channel| weight(channel) * (0..k.nrows()).map(|i| k[(i, channel)] * moved[(i, channel)]).sum::<f64>())
            .sum()
    }
}

/// Moments of all frames, and for each fold those of the frames that train and of those that are held back.
pub struct FoldMoments {
    pub total: Moments,
    pub train: Vec<Moments>,
    pub held: Vec<Moments>,
}

impl FoldMoments {
    /// Sum over folds of the squared error on held-back frames.
    pub fn error(&self, base: Base, penalties: &[f64], weight: &dyn Fn(usize) -> f64) -> f64 {
        let error = |(train, held): (&Moments, &Moments)| {
            let map = train.fit(base, penalties);
            map.map_or(f64::INFINITY, |map| held.squared_error(&map, weight))
        };
        self.train.iter().zip(&self.held).map(error).sum()
    }
}

/// Rows `v` for [`Moments::of`].
pub fn stack(features: &Mat<f64>, inputs: &[f64], outputs: &[f64], channels: usize) -> Mat<f64> {
    let shape = Shape { features: features.ncols(), channels };
    Mat::from_fn(features.nrows(), shape.len(), |t, i| {
        if i < shape.features {
            features[(t, i)]
        } else if i < shape.one() {
            inputs[t * channels + i - shape.features]
        } else if i == shape.one() {
            1.0
        } else {
            outputs[t * channels + i - shape.one() - 1]
        }
    })
}
