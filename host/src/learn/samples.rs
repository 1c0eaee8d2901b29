//! Rows of samples and the two products that everything here is made of.

use faer::MatRef;

use super::rank::Rows;
use crate::vector::{Work, dot, vectorised};

/// Samples, row-major `[rows x columns]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Samples<'a> {
    values: &'a [f64],
    columns: usize,
}

impl<'a> Samples<'a> {
    /// `values` cut into rows of `columns`; what is left over is ignored.
    pub fn new(values: &'a [f64], columns: usize) -> Self {
        Self { values, columns: columns.max(1) }
    }

    /// Number of samples.
    pub fn rows(&self) -> usize {
        self.values.len() / self.columns
    }

    /// Numbers of a sample.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The samples in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &'a [f64]> + Clone + use<'a> {
        self.values.chunks_exact(self.columns)
    }

    /// One sample.
    pub fn row(&self, index: usize) -> &'a [f64] {
        &self.values[index * self.columns..][..self.columns]
    }

    /// `X w`: one number a sample. Cost: `rows x columns` multiply-adds.
    pub fn product(&self, weights: &[f64], out: &mut Vec<f64>) {
        out.clear();
        out.resize(self.rows(), 0.0);
        vectorised(Product { samples: self, weights, out });
    }

    /// `out += X' r`. Cost: `rows x columns` multiply-adds.
    pub fn add_transposed(&self, factors: &[f64], out: &mut [f64]) {
        vectorised(|| {
            for (row, factor) in self.iter().zip(factors) {
                // Many a motion is in no violated pair.
                if *factor != 0.0 {
                    add_scaled(out, *factor, row);
                }
            }
        });
    }

    /// The samples as a matrix of faer's.
    pub(super) fn matrix(&self) -> MatRef<'a, f64> {
        MatRef::from_row_major_slice(&self.values[..self.rows() * self.columns], self.rows(), self.columns)
    }

    /// Mean of every column.
    pub fn mean(&self) -> Vec<f64> {
        let mut mean = vec![0.0; self.columns];
        self.add_transposed(&vec![1.0; self.rows()], &mut mean);
        mean.iter_mut().for_each(|m| *m /= self.rows().max(1) as f64);
        mean
    }
}

impl Rows for Samples<'_> {
    fn product(&self, weights: &[f64], out: &mut Vec<f64>) {
        self.product(weights, out);
    }

    fn add_transposed(&self, factors: &[f64], out: &mut [f64]) {
        self.add_transposed(factors, out);
    }

    fn rows(&self) -> usize {
        self.rows()
    }
}

struct Product<'a> {
    samples: &'a Samples<'a>,
    weights: &'a [f64],
    out: &'a mut [f64],
}

impl Work for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (out, row) in self.out.iter_mut().zip(self.samples.iter()) {
            *out = dot(row, self.weights);
        }
    }
}

/// `to += factor from`.
#[inline(always)]
pub(crate) fn add_scaled(to: &mut [f64], factor: f64, from: &[f64]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
}
