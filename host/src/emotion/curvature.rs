//! What the Hessian needs of the samples, in single precision: a Newton step is good to a few digits and corrected by the next
//! gradient, and half the memory is read in half the time.

use super::samples::Samples;
use crate::vector::{Work, vectorised};

/// Samples in single precision, and how far they are spread.
pub struct Curvature {
    values: Vec<f32>,
    columns: usize,
    /// Mean square distance from the mean, by column: for the preconditioner.
    pub(super) spread: Vec<f64>,
}

impl Curvature {
    /// One serves any number of rankings of the same samples.
    pub fn new(samples: &Samples) -> Self {
        let mean = samples.mean();
        let mut spread = vec![0.0; samples.columns()];
        let mut values = vec![0.0; samples.rows() * samples.columns()];
        for (row, to) in samples.iter().zip(values.chunks_exact_mut(samples.columns())) {
            vectorised(|| {
                for (((to, x), m), s) in to.iter_mut().zip(row).zip(&mean).zip(&mut spread) {
                    // Only differences of samples count: without the mean more digits are left for them.
                    *to = (x - m) as f32;
                    *s += (x - m) * (x - m);
                }
            });
        }
        spread.iter_mut().for_each(|s| *s /= samples.rows().max(1) as f64);
        Self { values, columns: samples.columns(), spread }
    }

    /// `X' L X v`: `between` makes `L s` of `s = X v`, `L` a Laplacian over the samples.
    pub(super) fn apply(&self, v: &[f64], out: &mut [f64], between: impl FnOnce(&[f32], &mut [f32])) {
        let rows = self.values.len() / self.columns;
        let v: Vec<f32> = v.iter().map(|v| *v as f32).collect();
        let (mut image, mut pull, mut sum) = (vec![0.0; rows], vec![0.0; rows], vec![0.0; self.columns]);
        vectorised(Product { values: &self.values, weights: &v, out: &mut image });
        between(&image, &mut pull);
        vectorised(AddTransposed { values: &self.values, factors: &pull, out: &mut sum });
        out.iter_mut().zip(&sum).for_each(|(out, sum)| *out = f64::from(*sum));
    }
}

struct Product<'a> {
    values: &'a [f32],
    weights: &'a [f32],
    out: &'a mut [f32],
}

impl Work for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let (weights, last_weights) = self.weights.as_chunks::<16>();
        for (out, row) in self.out.iter_mut().zip(self.values.chunks_exact(self.weights.len())) {
            let (row, last) = row.as_chunks::<16>();
            let mut lanes = [0.0; 16];
            for (row, weights) in row.iter().zip(weights) {
                for ((lane, x), w) in lanes.iter_mut().zip(row).zip(weights) {
                    *lane += x * w;
                }
            }
            let rest: f32 = last.iter().zip(last_weights).map(|(x, w)| x * w).sum();
            *out = lanes.iter().sum::<f32>() + rest;
        }
    }
}

struct AddTransposed<'a> {
    values: &'a [f32],
    factors: &'a [f32],
    out: &'a mut [f32],
}

impl Work for AddTransposed<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let columns = self.out.len();
        let (fours, rest) = self.factors.as_chunks::<4>();
        let (blocks, last) = self.values.split_at(4 * fours.len() * columns);
        // Four rows at once, so that a sum is loaded and stored once for four.
        for (rows, [e, f, g, h]) in blocks.chunks_exact(4 * columns).zip(fours) {
            let (first, second) = rows.split_at(2 * columns);
            let ((a, b), (c, d)) = (first.split_at(columns), second.split_at(columns));
            for ((((out, a), b), c), d) in self.out.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                *out += (e * a + f * b) + (g * c + h * d);
            }
        }
        for (row, factor) in last.chunks_exact(columns).zip(rest) {
            self.out.iter_mut().zip(row).for_each(|(out, x)| *out += factor * x);
        }
    }
}
