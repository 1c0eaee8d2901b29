//! From an impulse response to a balanced state-space model.

use faer::Mat;

use super::ImpulseResponse;

/// `x' = A x + B u`, `y = C x + D u + constant`.
#[derive(Clone, Debug)]
pub struct StateSpace {
    /// Transition, `[n x n]`.
    pub a: Mat<f64>,
    /// Input, `[n x inputs]`.
    pub b: Mat<f64>,
    /// Output, `[outputs x n]`.
    pub c: Mat<f64>,
    /// Feed-through, `[outputs x inputs]`.
    pub d: Mat<f64>,
}

/// Balanced truncation of the impulse response to at most `order` states, by the singular vectors of its Hankel matrix.
///
/// The response is finite, so its shift-register realisation has the identity as controllability Gramian and `H' H` as
/// observability Gramian: truncating the Hankel matrix's singular values *is* balanced truncation, and the result is stable
/// (Pernebo and Silverman 1982). Cost: one singular value decomposition of `taps x channels`.
pub fn balanced(response: &ImpulseResponse, order: usize) -> StateSpace {
    let d = response.taps.first().cloned().unwrap_or_else(Mat::new);
    let (p, m) = (d.nrows(), d.ncols());
    let rest = response.taps.len().saturating_sub(1);
    let entry = |lag: usize, o: usize, i: usize| response.taps.get(lag).map_or(0.0, |tap| tap[(o, i)]);
    let hankel = |shift: usize| Mat::from_fn(p * rest, m * rest, |r, c| entry(r / p + c / m + 1 + shift, r % p, c % m));
    let empty = || StateSpace { a: Mat::zeros(0, 0), b: Mat::zeros(0, m), c: Mat::zeros(p, 0), d: d.clone() };
    let Ok(svd) = hankel(0).svd() else { return empty() };
    let (u, s, v) = (svd.U(), svd.S().column_vector(), svd.V());
    let largest = if s.nrows() > 0 { s[0] } else { 0.0 };
    let n = (0..s.nrows().min(order)).take_while(|i| s[*i] > 1e-10 * largest).count();
    if n == 0 {
        return empty();
    }
    let root = |i: usize| s[i].sqrt();
    let (u, v) = (u.subcols(0, n), v.subcols(0, n));
    let shifted = u.transpose() * hankel(1) * v;
    StateSpace {
        a: Mat::from_fn(n, n, |i, j| shifted[(i, j)] / (root(i) * root(j))),
        b: Mat::from_fn(n, m, |i, j| root(i) * v[(j, i)]),
        c: Mat::from_fn(p, n, |i, j| root(j) * u[(i, j)]),
        d,
    }
}
