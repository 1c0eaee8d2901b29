//! Principal components: the start of the sparse factorisation, and the baseline beside it.

use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::{Accum, Mat, MatRef, Par, Side};

use super::factor::{Factors, column, column_mut, product};
use crate::vector::oriented;

/// The `count` strongest principal components, weight columns at one in root mean square.
///
/// Cost: `F (3R)^2 / 2` multiply-adds and an eigendecomposition of `3R x 3R`.
pub fn pca(motion: MatRef<'_, f64>, count: usize) -> Factors {
    let (frames, channels) = (motion.nrows(), motion.ncols());
    // One half of it is all that the decomposition reads.
    let (lower, all) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
    let mut covariance = Mat::zeros(channels, channels);
    matmul(&mut covariance, lower, Accum::Replace, motion.transpose(), all, motion, all, 1.0, Par::Seq);
    let mut components = Mat::zeros(channels, count);
    let mut weights = Mat::zeros(frames, count);
    if let Ok(eigen) = covariance.self_adjoint_eigen(Side::Lower) {
        // Ascending in faer.
        for k in 0..count.min(channels) {
            let value = eigen.S()[channels - 1 - k].max(0.0);
            let vector = oriented((0..channels).map(|c| eigen.U()[(c, channels - 1 - k)]).collect());
            let deviation = (value / frames.max(1) as f64).sqrt();
            column_mut(&mut components, k).iter_mut().zip(&vector).for_each(|(c, v)| *c = deviation * v);
        }
        weights = product(motion, components.as_ref());
        for k in 0..count {
            let squares: f64 = column(&components, k).iter().map(|c| c * c).sum();
            let scale = if squares > 1e-18 { 1.0 / squares } else { 0.0 };
            column_mut(&mut weights, k).iter_mut().for_each(|w| *w *= scale);
        }
    }
    Factors { weights, components }
}
