//! Least squares on a given support: what the penalty shrank comes back.

use faer::linalg::solvers::Solve;
use faer::{Mat, MatRef, Side};

use super::cholesky::Cholesky;
use super::factor::{Factors, column, column_mut, groups, product};
use crate::vector::{Work, vectorised};

/// Rounds of least squares for `C` and for `W` in turn.
pub(super) const ROUNDS: usize = 30;

/// A round that lowers the squared error by less than this share of it is the last.
const TOLERANCE: f64 = 1e-3;

/// Share of the mean diagonal that is added to every system.
const DAMPING: f64 = 1e-5;

/// Minimises `|M - W C|^2` over `W` and over those joint groups of `C` that are not zero, in turn.
///
/// Cost: `F (3R)^2` multiply-adds once; a round costs `(3R)^2 K + 3 3R K^2` and a Cholesky factorisation a joint of the size
/// of its components, however long the motion is.
pub fn refit(motion: MatRef<'_, f64>, factors: &Factors) -> Factors {
    let scatter = Scatter::new(motion);
    let mut fit = Fit::new(&scatter, &factors.components);
    fit.rounds(ROUNDS);
    fit.factors()
}

/// All that least squares needs of a motion.
pub(super) struct Scatter<'a> {
    motion: MatRef<'a, f64>,
    /// `M'M`, `[3R x 3R]`.
    square: Mat<f64>,
    /// `|M|^2`.
    total: f64,
}

impl<'a> Scatter<'a> {
    pub fn new(motion: MatRef<'a, f64>) -> Self {
        Self { motion, square: product(motion.transpose(), motion), total: motion.squared_norm_l2() }
    }
}

/// `M ~ W C` with the weights that fit the components best, `W = M P`: they are never formed, only what is needed of them.
#[derive(Clone)]
pub(super) struct Fit<'a> {
    scatter: &'a Scatter<'a>,
    /// `C` transposed, `[3R x K]`. After a change, [`rounds`](Self::rounds) fits the rest to it.
    pub components: Mat<f64>,
    /// `P`, `[3R x K]`.
    projection: Mat<f64>,
    /// `W'W`, `[K x K]`.
    pub inner: Mat<f64>,
    /// `M'W`, `[3R x K]`.
    pub cross: Mat<f64>,
}

impl<'a> Fit<'a> {
    pub fn new(scatter: &'a Scatter<'a>, components: &Mat<f64>) -> Self {
        let (channels, count) = (components.nrows(), components.ncols());
        let mut fit = Self {
            scatter,
            components: components.clone(),
            projection: Mat::zeros(channels, count),
            inner: Mat::zeros(count, count),
            cross: Mat::zeros(channels, count),
        };
        fit.fit_weights();
        fit
    }

    /// Which components move a joint, `[joints]` of indices.
    pub fn movers(&self) -> Vec<Vec<usize>> {
        let mut movers = vec![Vec::new(); self.components.nrows() / 3];
        for k in 0..self.components.ncols() {
            for (movers, group) in movers.iter_mut().zip(groups(column(&self.components, k))) {
                if group != [0.0; 3] {
                    movers.push(k);
                }
            }
        }
        movers
    }

    /// Up to `count` rounds of least squares for `C` and for `W`, then once more for `C`.
    pub fn rounds(&mut self, count: usize) {
        let movers = self.movers();
        let mut before = f64::INFINITY;
        for _ in 0..count {
            self.fit_components(&movers);
            let error = self.fit_weights();
            if before - error <= TOLERANCE * before.min(self.scatter.total) {
                break;
            }
            before = error;
        }
        self.fit_components(&movers);
    }

    /// `|M - W C|^2`.
    pub fn error(&self) -> f64 {
        let outer = product(self.components.transpose(), self.components.as_ref());
        let fitted = 2.0 * inner_product(&self.cross, &self.components) - inner_product(&self.inner, &outer);
        (self.scatter.total - fitted).max(0.0)
    }

    /// The weights as a matrix, with the components, normalised.
    pub fn factors(&self) -> Factors {
        let weights = product(self.scatter.motion, self.projection.as_ref());
        let mut factors = Factors { weights, components: self.components.clone() };
        factors.normalise();
        factors
    }

    fn fit_components(&mut self, movers: &[Vec<usize>]) {
        vectorised(FitComponents { fit: self, movers });
    }

    /// `P = C' (C C')^-1`, and what follows from it; returns the squared error.
    fn fit_weights(&mut self) -> f64 {
        let outer = product(self.components.transpose(), self.components.as_ref());
        if let Some(solution) = solve(outer, &self.components.transpose().to_owned()) {
            self.projection = solution.transpose().to_owned();
            self.cross = product(self.scatter.square.as_ref(), self.projection.as_ref());
            self.inner = product(self.projection.transpose(), self.cross.as_ref());
        }
        (self.scatter.total - inner_product(&self.cross, &self.components)).max(0.0)
    }
}

/// For every joint: least squares on the weight columns of the components that move it.
struct FitComponents<'f, 'a> {
    fit: &'f mut Fit<'a>,
    movers: &'f [Vec<usize>],
}

impl Work for FitComponents<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { fit, movers } = self;
        let mut cholesky = Cholesky::default();
        let mut right = Vec::new();
        for (joint, movers) in movers.iter().enumerate() {
            cholesky.factorise(movers.len(), DAMPING, |a, b| fit.inner[(movers[a], movers[b])]);
            right.clear();
            right.extend(movers.iter().map(|k| {
                let [x, y, z] = [0, 1, 2].map(|axis| fit.cross[(3 * joint + axis, *k)]);
                [x, y, z, 0.0]
            }));
            cholesky.solve(&mut right);
            for (k, value) in movers.iter().zip(&right) {
                column_mut(&mut fit.components, *k)[3 * joint..][..3].copy_from_slice(&value[..3]);
            }
        }
    }
}

fn inner_product(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    (0..a.ncols()).map(|k| crate::vector::dot(column(a, k), column(b, k))).sum()
}

/// `gram^-1 right` with a trace of damping.
pub(super) fn solve(mut gram: Mat<f64>, right: &Mat<f64>) -> Option<Mat<f64>> {
    let size = gram.nrows();
    let trace: f64 = (0..size).map(|k| gram[(k, k)]).sum();
    (0..size).for_each(|k| gram[(k, k)] += DAMPING * trace / size.max(1) as f64 + f64::MIN_POSITIVE);
    (size > 0).then_some(())?;
    gram.llt(Side::Lower).ok().map(|cholesky| cholesky.solve(right))
}
