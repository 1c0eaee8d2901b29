//! Finite impulse response with a decaying prior (TC kernel; Chen, Ohlsson, Ljung 2012), scaled by its evidence.

use std::ops::Range;

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

use crate::vector::{Work, dot, vectorised};

/// A finite impulse response: `y[t] = sum over k of g[k] u[t - k] + constant`.
#[derive(Clone, Debug)]
pub struct ImpulseResponse {
    /// `g[k]`, one `[outputs x inputs]` matrix a tap.
    pub taps: Vec<Mat<f64>>,
    /// Constant of each output.
    pub constant: Vec<f64>,
}

/// Memory of the prior, s.
const DECAYS: [f64; 3] = [0.08, 0.2, 0.5];
/// Noise over prior variance.
const RATIOS: [f64; 6] = [1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3];

/// Estimates `taps` taps; hyper-parameters maximise the marginal likelihood. Before its first frame a clip is taken to have
/// held it. `None` if there are no frames. Cost: one Gram matrix and 18 Cholesky factorisations of `taps x inputs`.
pub fn impulse_response(
    inputs: &[Mat<f64>],
    outputs: &[Mat<f64>],
    covered: &[Range<usize>],
    taps: usize,
    fps: f64,
) -> Option<ImpulseResponse> {
    let (m, p) = (inputs.first()?.ncols(), outputs.first()?.ncols());
    let frames: usize = outputs.iter().map(Mat::nrows).sum();
    if frames == 0 || taps == 0 {
        return None;
    }
    let size = m * taps;
    let mut gram = Mat::<f64>::zeros(size, size);
    let mut cross = Mat::<f64>::zeros(size, p);
    let mut mean_in = vec![0.0; size];
    let mut mean_out = vec![0.0; p];
    let mut power = vec![0.0; p];
    for ((u, y), range) in inputs.iter().zip(outputs).zip(covered) {
        let past = Past::new(u, taps, range.clone());
        vectorised(Products { past: &past, y, gram: &mut gram, cross: &mut cross });
        for (i, mean) in mean_in.iter_mut().enumerate() {
            *mean += past.delayed(i).iter().sum::<f64>() / frames as f64;
        }
        for (o, (mean, power)) in mean_out.iter_mut().zip(&mut power).enumerate() {
            *mean += y.col(o).iter().sum::<f64>() / frames as f64;
            *power += y.col(o).iter().map(|y| y * y).sum::<f64>();
        }
    }
    let n = frames as f64;
    let gram = Mat::from_fn(size, size, |i, j| gram[(i, j)] - n * mean_in[i] * mean_in[j]);
    let cross = Mat::from_fn(size, p, |i, o| cross[(i, o)] - n * mean_in[i] * mean_out[o]);
    let power: Vec<f64> = power.iter().zip(&mean_out).map(|(s, mean)| (s - n * mean * mean).max(1e-12)).collect();

    let mut best: Option<(f64, Mat<f64>)> = None;
    for decay in DECAYS {
        let lambda = (-1.0 / (fps * decay)).exp();
        let (precision, log_det) = tc_precision(taps, lambda);
        for ratio in RATIOS {
            let mut penalised = gram.clone();
            for input in 0..m {
                let mut own = penalised.submatrix_mut(input * taps, input * taps, taps, taps);
                faer::zip!(&mut own, &precision).for_each(|faer::unzip!(sum, prior)| *sum += ratio * prior);
            }
            let Ok(cholesky) = penalised.llt(Side::Lower) else { continue };
            let solution = cholesky.solve(&cross);
            let factor = cholesky.L();
            let log_det_posterior = 2.0 * (0..size).map(|i| factor[(i, i)].ln()).sum::<f64>();
            let complexity = log_det_posterior + m as f64 * log_det - size as f64 * ratio.ln();
            let misfit: f64 = (0..p)
                .map(|o| {
                    let explained: f64 = (0..size).map(|i| cross[(i, o)] * solution[(i, o)]).sum();
                    n * ((power[o] - explained).max(1e-12 * power[o]) / n).ln() + complexity
                })
                .sum();
            if best.as_ref().is_none_or(|(least, _)| misfit < *least) {
                best = Some((misfit, solution));
            }
        }
    }
    let (_, solution) = best?;
    let constant =
        (0..p).map(|o| mean_out[o] - (0..size).map(|i| solution[(i, o)] * mean_in[i]).sum::<f64>()).collect();
    let taps = (0..taps).map(|k| Mat::from_fn(p, m, |o, i| solution[(i * taps + k, o)])).collect();
    Some(ImpulseResponse { taps, constant })
}

/// Sums over one sequence.
struct Products<'a> {
    past: &'a Past,
    y: &'a Mat<f64>,
    gram: &'a mut Mat<f64>,
    cross: &'a mut Mat<f64>,
}

impl Work for Products<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.past.add_gram(self.gram);
        self.past.add_cross(self.y, self.cross);
    }
}

/// The inputs of one sequence as regressors: number `i` is input `i / taps`, delayed by `i % taps` frames.
struct Past {
    /// Each input with its first value repeated before it.
    columns: Vec<Vec<f64>>,
    taps: usize,
    covered: Range<usize>,
}

impl Past {
    fn new(u: &Mat<f64>, taps: usize, covered: Range<usize>) -> Self {
        let value = |input: usize, at: usize| u[(at.saturating_sub(taps), input)];
        let column = |input: usize| (0..taps + covered.end).map(|at| value(input, at)).collect();
        Self { columns: (0..u.ncols()).map(column).collect(), taps, covered }
    }

    /// Regressor `i` over the covered frames.
    #[inline]
    fn delayed(&self, i: usize) -> &[f64] {
        let from = self.taps + self.covered.start - i % self.taps;
        &self.columns[i / self.taps][from..from + self.covered.len()]
    }

    /// Value of an input in the frame before regressor `i`'s first, and its last: what a further delay takes in, and leaves out.
    fn ends(&self, i: usize) -> [f64; 2] {
        let column = &self.columns[i / self.taps];
        let first = self.taps + self.covered.start - i % self.taps;
        [column[first - 1], column[first + self.covered.len() - 1]]
    }

    /// Adds the products of all regressors with each other.
    ///
    /// Delaying both by one frame moves the window by one: only products with an undelayed input are summed over the frames,
    /// `inputs^2 (2 taps - 1)` sums instead of `(inputs taps)^2`.
    #[inline(always)]
    fn add_gram(&self, gram: &mut Mat<f64>) {
        let size = self.columns.len() * self.taps;
        if self.covered.is_empty() {
            return;
        }
        let mut products = Mat::<f64>::zeros(size, size);
        for j in 0..size {
            for i in 0..=j {
                let product = if i % self.taps == 0 || j % self.taps == 0 {
                    dot(self.delayed(i), self.delayed(j))
                } else {
                    let ([a, b], [c, d]) = (self.ends(i - 1), self.ends(j - 1));
                    products[(i - 1, j - 1)] + a * c - b * d
                };
                (products[(i, j)], products[(j, i)]) = (product, product);
            }
        }
        *gram += products;
    }

    /// Adds the products of all regressors with the outputs.
    #[inline(always)]
    fn add_cross(&self, y: &Mat<f64>, cross: &mut Mat<f64>) {
        for (o, y) in y.col_iter().enumerate() {
            let y: Vec<f64> = y.iter().copied().collect();
            for i in 0..cross.nrows() {
                cross[(i, o)] += dot(self.delayed(i), &y);
            }
        }
    }
}

/// Inverse of `K[i][j] = lambda^max(i, j)` and the logarithm of the determinant of `K`.
///
/// Under this prior the differences of neighbouring taps are independent, so the inverse is tridiagonal.
fn tc_precision(taps: usize, lambda: f64) -> (Mat<f64>, f64) {
    let mut precision = Mat::zeros(taps, taps);
    let mut log_det = 0.0;
    for k in 0..taps {
        let last = k + 1 == taps;
        // A response that decays far enough is zero: keep its weight finite.
        let variance = (lambda.powi(k as i32) * if last { 1.0 } else { 1.0 - lambda }).max(1e-12);
        log_det += variance.ln();
        precision[(k, k)] += 1.0 / variance;
        if !last {
            precision[(k + 1, k + 1)] += 1.0 / variance;
            precision[(k, k + 1)] -= 1.0 / variance;
            precision[(k + 1, k)] -= 1.0 / variance;
        }
    }
    (precision, log_det)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_products_are_those_of_the_regressors() {
        let u = Mat::from_fn(50, 2, |t, i| ((t * (3 + i)) as f64 * 0.37).sin() + 0.1 * i as f64);
        let past = Past::new(&u, 7, 2..41);
        let regressor = |t: usize, i: usize| u[(t.saturating_sub(i % 7), i / 7)];
        let expected = Mat::from_fn(14, 14, |i, j| (2..41).map(|t| regressor(t, i) * regressor(t, j)).sum::<f64>());
        let mut gram = Mat::zeros(14, 14);
        past.add_gram(&mut gram);
        assert!((gram - expected).norm_max() < 1e-12);
        (0..14).for_each(|i| assert!((2..41).all(|t| past.delayed(i)[t - 2] == regressor(t, i))));
    }
}
