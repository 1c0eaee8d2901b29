//! Principal components of samples.

use faer::{Mat, Side};

use super::samples::{Samples, add_scaled, dot};

/// Mean and orthonormal directions of largest variance.
#[derive(Clone, Debug, PartialEq)]
pub struct Pca {
    /// `[columns]`.
    pub mean: Vec<f64>,
    /// Directions, strongest first, row-major `[count x columns]`; the largest entry of each is positive.
    pub basis: Vec<f64>,
    /// Variance along each.
    pub variance: Vec<f64>,
    /// Variance of the samples.
    pub total: f64,
}

impl Pca {
    /// Number of directions.
    pub fn count(&self) -> usize {
        self.variance.len()
    }

    /// Share of the variance along the directions.
    pub fn explained(&self) -> f64 {
        if self.total > 0.0 { self.variance.iter().sum::<f64>() / self.total } else { 1.0 }
    }

    /// Coordinates of a sample.
    pub fn project(&self, sample: &[f64]) -> Vec<f64> {
        let centred: Vec<f64> = sample.iter().zip(&self.mean).map(|(x, m)| x - m).collect();
        self.basis.chunks_exact(self.mean.len().max(1)).map(|b| dot(b, &centred)).collect()
    }

    /// The sample with these coordinates.
    pub fn compose(&self, coordinates: &[f64]) -> Vec<f64> {
        let mut sample = self.mean.clone();
        let rows = self.basis.chunks_exact(self.mean.len().max(1));
        coordinates.iter().zip(rows).for_each(|(c, b)| add_scaled(&mut sample, *c, b));
        sample
    }
}

/// The `count` strongest components, fewer where the samples span less.
///
/// Cost: `rows x columns^2 / 2` multiply-adds and an eigendecomposition of `columns x columns`, or the same with the two exchanged
/// where there are fewer samples than columns.
pub fn pca(samples: &Samples, count: usize) -> Pca {
    let mean = samples.mean();
    let columns = samples.columns();
    let mut centred = Vec::with_capacity(samples.rows() * columns);
    centred.extend(samples.iter().flat_map(|row| row.iter().zip(&mean).map(|(x, m)| x - m)));
    let centred = Samples::new(&centred, columns);
    let rows = samples.rows().max(1) as f64;
    let few = samples.rows() < columns;
    let matrix = centred.matrix();
    let gram: Mat<f64> = if few { matrix * matrix.transpose() } else { matrix.transpose() * matrix };
    let size = gram.nrows();
    let total = (0..size).map(|k| gram[(k, k)]).sum::<f64>() / rows;
    let (mut basis, mut variance) = (Vec::new(), Vec::new());
    if let Ok(eigen) = gram.self_adjoint_eigen(Side::Lower) {
        // Ascending in faer.
        for k in (0..size).rev().take(count) {
            let value = eigen.S()[k] / rows;
            if value <= 1e-12 * total || value <= 0.0 {
                break;
            }
            let vector: Vec<f64> = (0..size).map(|r| eigen.U()[(r, k)]).collect();
            let mut direction = vec![0.0; columns];
            if few {
                centred.add_transposed(&vector, &mut direction)
            } else {
                direction.copy_from_slice(&vector)
            }
            let peak = direction.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
            let norm = dot(&direction, &direction).sqrt().copysign(peak);
            basis.extend(direction.iter().map(|d| d / norm));
            variance.push(value);
        }
    }
    Pca { mean, basis, variance, total }
}

#[cfg(test)]
mod tests {
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};

    use super::*;

    #[test]
    fn finds_the_plane_that_samples_lie_in_whichever_way_it_is_computed() {
        let mut random = ChaCha8Rng::seed_from_u64(2);
        let mut made = |rows: usize| -> Vec<f64> {
            let row = |_| {
                let [a, b] = [random.random_range(-3.0..3.0), random.random_range(-1.0..1.0)];
                (0..12).map(|c| f64::from(c) + a * f64::from(c % 3) + b * f64::from(c % 5 - 2)).collect::<Vec<f64>>()
            };
            (0..rows).flat_map(row).collect()
        };
        for rows in [8, 40] {
            let values = made(rows);
            let samples = Samples::new(&values, 12);
            let found = pca(&samples, 5);
            assert_eq!(found.count(), 2, "{:?}", found.variance);
            assert!((found.explained() - 1.0).abs() < 1e-9);
            for row in samples.iter() {
                let back = found.compose(&found.project(row));
                assert!(back.iter().zip(row).all(|(a, b)| (a - b).abs() < 1e-9));
            }
            let [a, b] = [&found.basis[..12], &found.basis[12..]];
            assert!(dot(a, b).abs() < 1e-9 && (dot(a, a) - 1.0).abs() < 1e-9);
        }
    }
}
