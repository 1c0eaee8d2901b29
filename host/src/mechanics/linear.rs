//! The baseline: ridge regression from features to pose. It gets the features as the network does: normalised and cut.

use faer::Mat;
use faer::linalg::solvers::Solve;
use kinesic::mechanics::FEATURES;

/// `pose = W [features, 1]`, row-major `[(FEATURES + 1) x outputs]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    /// Weights, the constant last.
    pub weights: Vec<f32>,
}

impl Linear {
    /// Least squares with a trace of ridge. `None` where the features determine nothing.
    pub fn fit(features: &[f32], poses: &[f32]) -> Option<Self> {
        let samples = features.len() / FEATURES;
        let outputs = poses.len().checked_div(samples)?;
        let at = |row: usize, column: usize| if column < FEATURES { features[row * FEATURES + column] } else { 1.0 };
        let x = Mat::<f64>::from_fn(samples, FEATURES + 1, |i, j| f64::from(at(i, j)));
        let y = Mat::<f64>::from_fn(samples, outputs, |i, j| f64::from(poses[i * outputs + j]));
        let mut normal = x.transpose() * &x;
        for i in 0..FEATURES {
            normal[(i, i)] += 1e-3 * samples as f64;
        }
        let right = x.transpose() * &y;
        let weights = normal.llt(faer::Side::Lower).ok()?.solve(&right);
        let weights = (0..=FEATURES).flat_map(|i| (0..outputs).map(move |j| (i, j))).map(|at| weights[at] as f32);
        Some(Self { weights: weights.collect() })
    }

    /// The pose of one frame's features.
    pub fn apply(&self, features: &[f32]) -> Vec<f32> {
        let outputs = self.weights.len() / (FEATURES + 1);
        let mut pose = vec![0.0; outputs];
        for (weights, x) in self.weights.chunks_exact(outputs.max(1)).zip(features.iter().chain([&1.0])) {
            pose.iter_mut().zip(weights).for_each(|(pose, w)| *pose += w * x);
        }
        pose
    }
}

impl Linear {
    /// Which joints (but the hips) move with the features: the others, fingers that were not recorded or helper joints, would
    /// only dilute a mean.
    pub fn moving(&self) -> Vec<bool> {
        let outputs = self.weights.len() / (FEATURES + 1);
        let mut size = vec![0.0f32; outputs];
        for weights in self.weights.chunks_exact(outputs.max(1)).take(FEATURES) {
            size.iter_mut().zip(weights).for_each(|(size, w)| *size += w.abs());
        }
        size.chunks_exact(4).map(|joint| joint.iter().sum::<f32>() > 1e-2).collect()
    }
}
