//! The factorisation `M ~ W C` with few joints in every component.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};

use crate::vector::{Work, dot, vectorised};

/// `M ~ W C`. Column `k` of `weights` is the time course of component `k`, at most one in root mean square; column `k` of
/// `components` holds its `[3 rows]` directions, in deviations.
#[derive(Clone, Debug)]
pub struct Factors {
    /// `W`, `[frames x K]`.
    pub weights: Mat<f64>,
    /// `C` transposed, `[3 rows x K]`.
    pub components: Mat<f64>,
}

/// When to stop descending.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Descent {
    /// Sweeps end when one lowers the objective by less than this share of it.
    pub tolerance: f64,
    /// At most so many sweeps.
    pub max_sweeps: usize,
}

impl Default for Descent {
    fn default() -> Self {
        Self { tolerance: 1e-3, max_sweeps: 60 }
    }
}

impl Factors {
    /// Number of components.
    pub fn count(&self) -> usize {
        self.components.ncols()
    }

    /// `W C`.
    pub fn product(&self) -> Mat<f64> {
        product(self.weights.as_ref(), self.components.transpose())
    }

    /// `|M - W C|_F / |M|_F`.
    pub fn error(&self, motion: MatRef<'_, f64>) -> f64 {
        let norm = motion.norm_l2();
        if norm > 0.0 { (motion - self.product()).norm_l2() / norm } else { 0.0 }
    }

    /// `1/F |M - W C|^2 + penalty * sum_k sum_i |C_k,row i|_2`.
    pub fn objective(&self, motion: MatRef<'_, f64>, penalty: f64) -> f64 {
        let frames = motion.nrows().max(1) as f64;
        (motion - self.product()).squared_norm_l2() / frames + penalty * self.group_norms()
    }

    /// Which joints each component moves, `[K x rows]`.
    pub fn support(&self) -> Vec<Vec<bool>> {
        let moves = |k: usize| groups(self.column(k)).map(|g| g != [0.0; 3]).collect();
        (0..self.count()).map(moves).collect()
    }

    /// Share of joint groups that are not zero.
    pub fn density(&self) -> f64 {
        let support = self.support();
        let groups = support.iter().flatten();
        let (all, moved) = (groups.clone().count(), groups.filter(|moved| **moved).count());
        moved as f64 / all.max(1) as f64
    }

    /// Strongest first, every weight column at one in root mean square, its largest value positive.
    pub fn normalise(&mut self) {
        let frames = self.weights.nrows().max(1) as f64;
        let mut order: Vec<(f64, usize)> = Vec::new();
        for k in 0..self.count() {
            let rms = (self.weights.col(k).squared_norm_l2() / frames).sqrt();
            let column = self.column(k);
            let peak = column.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
            let factor = if rms > 0.0 { rms.copysign(if peak < 0.0 { -1.0 } else { 1.0 }) } else { 1.0 };
            column_mut(&mut self.weights, k).iter_mut().for_each(|w| *w /= factor);
            column_mut(&mut self.components, k).iter_mut().for_each(|c| *c *= factor);
            order.push((self.components.col(k).squared_norm_l2(), k));
        }
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let pick = |m: &Mat<f64>| Mat::from_fn(m.nrows(), m.ncols(), |r, k| m[(r, order[k].1)]);
        (self.weights, self.components) = (pick(&self.weights), pick(&self.components));
    }

    fn column(&self, k: usize) -> &[f64] {
        column(&self.components, k)
    }

    fn group_norms(&self) -> f64 {
        (0..self.count()).flat_map(|k| groups(self.column(k))).map(|g| norm(&g)).sum()
    }
}

/// Minimises `1/F |M - W C|^2 + penalty * sum_k sum_i |C_k,row i|_2`, every column of `W` at most one in root mean square,
/// by exact minimisation over one joint group or one column of `W` at a time: the objective never rises.
///
/// Returns the factors, and the objective at the start and after every sweep. Phong 2018, eq. 1, after Neumann 2013. Cost of
/// a sweep: `2 F 3R K + (F + 3R) K^2` multiply-adds.
pub fn descend(motion: MatRef<'_, f64>, start: Factors, penalty: f64, descent: &Descent) -> (Factors, Vec<f64>) {
    let mut factors = start;
    let frames = motion.nrows().max(1) as f64;
    let total = motion.squared_norm_l2();
    let mut history = vec![factors.objective(motion, penalty)];
    let mut inner = product(factors.weights.transpose(), factors.weights.as_ref());
    for _ in 0..descent.max_sweeps {
        let cross = product(motion.transpose(), factors.weights.as_ref());
        update_components(&mut factors.components, &cross, &inner, 0.5 * penalty * frames);
        let cross = product(motion, factors.components.as_ref());
        let outer = product(factors.components.transpose(), factors.components.as_ref());
        update_weights(&mut factors.weights, &cross, &outer, frames);
        inner = product(factors.weights.transpose(), factors.weights.as_ref());
        // |M|^2 - 2 <M C', W> + <W'W, C C'>
        let residual = total - 2.0 * inner_product(&cross, &factors.weights) + inner_product(&inner, &outer);
        let objective = residual / frames + penalty * factors.group_norms();
        let before = history.last().copied().unwrap_or(objective);
        history.push(objective);
        if before - objective <= descent.tolerance * before {
            break;
        }
    }
    (factors, history)
}

/// Soft threshold, group by group: `c = (1 - t / |g|)+ g / |w|^2` with `g = w'(M - sum of the others)`.
fn update_components(components: &mut Mat<f64>, cross: &Mat<f64>, inner: &Mat<f64>, threshold: f64) {
    let mut gradient = vec![0.0; components.nrows()];
    for k in 0..components.ncols() {
        let own = inner[(k, k)];
        rest(components, cross, inner, k, &mut gradient);
        for (c, g) in column_mut(components, k).chunks_exact_mut(3).zip(gradient.chunks_exact(3)) {
            let size = norm(g);
            let keep = if size > threshold && own > 0.0 { (1.0 - threshold / size) / own } else { 0.0 };
            c.iter_mut().zip(g).for_each(|(c, g)| *c = keep * g);
        }
    }
}

/// Least squares, then back into the ball `|w|^2 <= F`: exact, because the objective is round in `w`.
fn update_weights(weights: &mut Mat<f64>, cross: &Mat<f64>, outer: &Mat<f64>, bound: f64) {
    let mut gradient = vec![0.0; weights.nrows()];
    for k in 0..weights.ncols() {
        let own = outer[(k, k)];
        // A component without joints leaves its weights free: keep them, so that it may come back.
        if own > 0.0 {
            rest(weights, cross, outer, k, &mut gradient);
            let squares = vectorised(|| dot(&gradient, &gradient)) / (own * own);
            let shrink = if squares > bound { (bound / squares).sqrt() } else { 1.0 } / own;
            column_mut(weights, k).iter_mut().zip(&gradient).for_each(|(w, g)| *w = shrink * g);
        }
    }
}

/// `cross_k - sum over j != k of factor_j gram_jk`.
fn rest(factor: &Mat<f64>, cross: &Mat<f64>, gram: &Mat<f64>, k: usize, out: &mut [f64]) {
    out.copy_from_slice(column(cross, k));
    vectorised(Rest { factor, gram: column(gram, k), k, out });
}

struct Rest<'a> {
    factor: &'a Mat<f64>,
    gram: &'a [f64],
    k: usize,
    out: &'a mut [f64],
}

impl Work for Rest<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { factor, gram, k, out } = self;
        let weight = |j: usize| if j == k { 0.0 } else { gram[j] };
        let (fours, last) = gram.as_chunks::<4>();
        // Four columns at once, so that a sum is loaded and stored once for four.
        for four in 0..fours.len() {
            let [e, f, g, h] = [0, 1, 2, 3].map(|at| weight(4 * four + at));
            let [a, b, c, d] = [0, 1, 2, 3].map(|at| column(factor, 4 * four + at));
            for ((((out, a), b), c), d) in out.iter_mut().zip(a).zip(b).zip(c).zip(d) {
                *out -= (e * a + f * b) + (g * c + h * d);
            }
        }
        for j in gram.len() - last.len()..gram.len() {
            let weight = weight(j);
            out.iter_mut().zip(column(factor, j)).for_each(|(out, x)| *out -= weight * x);
        }
    }
}

/// `a b` on one thread: the same bits on every run.
pub(super) fn product(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let mut out = Mat::zeros(a.nrows(), b.ncols());
    matmul(&mut out, Accum::Replace, a, b, 1.0, Par::Seq);
    out
}

fn inner_product(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    vectorised(|| (0..a.ncols()).map(|k| dot(column(a, k), column(b, k))).sum())
}

/// Column `k`; a [`Mat`] keeps its columns in one piece.
pub(super) fn column(m: &Mat<f64>, k: usize) -> &[f64] {
    m.col_as_slice(k)
}

pub(super) fn column_mut(m: &mut Mat<f64>, k: usize) -> &mut [f64] {
    m.col_as_slice_mut(k)
}

pub(super) fn groups(column: &[f64]) -> impl Iterator<Item = [f64; 3]> {
    column.as_chunks::<3>().0.iter().copied()
}

fn norm(group: &[f64]) -> f64 {
    group.iter().map(|x| x * x).sum::<f64>().sqrt()
}
/// The entries column by column.
pub(super) fn flat(matrix: &Mat<f64>) -> Vec<f64> {
    (0..matrix.ncols()).flat_map(|k| column(matrix, k).to_vec()).collect()
}

/// A matrix of so many columns from its entries column by column.
pub(super) fn unflat(values: &[f64], columns: usize) -> Mat<f64> {
    let rows = values.len().checked_div(columns).unwrap_or(0);
    Mat::from_fn(rows, columns, |row, column| values[column * rows + row])
}
