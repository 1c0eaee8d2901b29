//! What the Hessian needs of the samples, in 16 bits: a Newton step is good to a few digits and corrected by the next gradient,
//! and a quarter of the memory is read in a quarter of the time.

use super::rank::Rows;
use super::samples::Samples;
use crate::vector::{Work, vectorised};

/// Lanes in which products are summed; rows are filled up to a multiple of them by zeros.
const LANES: usize = 32;
/// The ends of a column's range become this and its negative.
const LARGEST: f64 = 32767.0;

/// Samples in steps of their own for every column, from the middle of its range: of `n` samples none is farther than `sqrt(n)`
/// deviations from the mean, so that a deviation is many steps.
pub struct Curvature {
    /// `[rows x width]`, `width` a multiple of [`LANES`].
    values: Vec<i16>,
    width: usize,
    /// What one step of a column is worth.
    steps: Vec<f64>,
}

impl Curvature {
    /// One serves any number of rankings of the same samples.
    pub fn new(samples: &Samples) -> Self {
        let columns = samples.columns();
        let width = columns.next_multiple_of(LANES);
        let mut ends = [vec![f64::INFINITY; columns], vec![f64::NEG_INFINITY; columns]];
        vectorised(Ends { samples, ends: &mut ends });
        let [least, most] = ends;
        let middle: Vec<f64> = least.iter().zip(&most).map(|(a, b)| 0.5 * (a + b)).collect();
        let steps: Vec<f64> = least.iter().zip(&most).map(|(a, b)| 0.5 * (b - a) / LARGEST).collect();
        let inverse: Vec<f64> = steps.iter().map(|step| if *step > 0.0 { 1.0 / step } else { 0.0 }).collect();
        let mut values = vec![0; samples.rows() * width];
        vectorised(Round { samples, middle: &middle, inverse: &inverse, width, values: &mut values });
        Self { values, width, steps }
    }

    /// Numbers of a sample.
    pub(super) fn columns(&self) -> usize {
        self.steps.len()
    }

    /// `X v`, with `v` in steps.
    fn image(&self, v: &[f64]) -> Vec<f32> {
        let mut weights: Vec<f32> = v.iter().zip(&self.steps).map(|(v, step)| (v * step) as f32).collect();
        weights.resize(self.width, 0.0);
        let mut image = vec![0.0; self.rows()];
        vectorised(Product { values: &self.values, weights: &weights, out: &mut image });
        image
    }

    /// `X' r` in steps.
    fn sum(&self, pull: &[f32]) -> Vec<f32> {
        let mut sum = vec![0.0; self.width];
        vectorised(AddTransposed { values: &self.values, factors: pull, out: &mut sum });
        sum
    }

    /// `X' L X v`: `between` makes `L s` of `s = X v`, `L` a Laplacian over the samples: only their differences count.
    pub(super) fn apply(&self, v: &[f64], out: &mut [f64], between: impl FnOnce(&[f32], &mut [f32])) {
        let image = self.image(v);
        let mut pull = vec![0.0; self.rows()];
        between(&image, &mut pull);
        let sum = self.sum(&pull);
        out.iter_mut().zip(&sum).zip(&self.steps).for_each(|((out, sum), step)| *out = f64::from(*sum) * step);
    }
}

impl Rows for Curvature {
    fn product(&self, weights: &[f64], out: &mut Vec<f64>) {
        out.clear();
        out.extend(self.image(weights).into_iter().map(f64::from));
    }

    fn add_transposed(&self, factors: &[f64], out: &mut [f64]) {
        let factors: Vec<f32> = factors.iter().map(|factor| *factor as f32).collect();
        let sum = self.sum(&factors);
        out.iter_mut().zip(&sum).zip(&self.steps).for_each(|((out, sum), step)| *out += f64::from(*sum) * step);
    }

    fn rows(&self) -> usize {
        self.values.len() / self.width
    }
}

/// The least and the largest value of every column.
struct Ends<'a, 'b> {
    samples: &'a Samples<'b>,
    ends: &'a mut [Vec<f64>; 2],
}

impl Work for Ends<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let [least, most] = self.ends;
        for row in self.samples.iter() {
            for ((least, most), x) in least.iter_mut().zip(most.iter_mut()).zip(row) {
                *least = if *x < *least { *x } else { *least };
                *most = if *x > *most { *x } else { *most };
            }
        }
    }
}

struct Round<'a, 'b> {
    samples: &'a Samples<'b>,
    middle: &'a [f64],
    inverse: &'a [f64],
    width: usize,
    values: &'a mut [i16],
}

impl Work for Round<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (row, to) in self.samples.iter().zip(self.values.chunks_exact_mut(self.width)) {
            for (((to, x), middle), inverse) in to.iter_mut().zip(row).zip(self.middle).zip(self.inverse) {
                *to = ((x - middle) * inverse).round_ties_even() as i16;
            }
        }
    }
}

struct Product<'a> {
    values: &'a [i16],
    weights: &'a [f32],
    out: &'a mut [f32],
}

impl Work for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let weights = self.weights.as_chunks::<LANES>().0;
        for (out, row) in self.out.iter_mut().zip(self.values.chunks_exact(self.weights.len())) {
            let mut lanes = [0.0; LANES];
            for (row, weights) in row.as_chunks::<LANES>().0.iter().zip(weights) {
                for ((lane, x), w) in lanes.iter_mut().zip(row).zip(weights) {
                    *lane += f32::from(*x) * w;
                }
            }
            // Halves on halves: as vectors, not one after the other. The box keeps this from choosing the order of the lanes above.
            let mut lanes = std::hint::black_box(lanes);
            let mut left = LANES;
            while left > 1 {
                left /= 2;
                let (low, high) = lanes.split_at_mut(left);
                low.iter_mut().zip(high).for_each(|(low, high)| *low += *high);
            }
            *out = lanes[0];
        }
    }
}

struct AddTransposed<'a> {
    values: &'a [i16],
    factors: &'a [f32],
    out: &'a mut [f32],
}

impl Work for AddTransposed<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let width = self.out.len();
        let (fours, rest) = self.factors.as_chunks::<4>();
        let (blocks, last) = self.values.split_at(4 * fours.len() * width);
        // Four rows at once, so that a sum is loaded and stored once for four.
        for (rows, [e, f, g, h]) in blocks.chunks_exact(4 * width).zip(fours) {
            let (first, second) = rows.split_at(2 * width);
            let ((a, b), (c, d)) = (first.split_at(width), second.split_at(width));
            for ((((out, a), b), c), d) in self.out.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                let [a, b, c, d] = [*a, *b, *c, *d].map(f32::from);
                *out += (e * a + f * b) + (g * c + h * d);
            }
        }
        for (row, factor) in last.chunks_exact(width).zip(rest) {
            self.out.iter_mut().zip(row).for_each(|(out, x)| *out += factor * f32::from(*x));
        }
    }
}
