//! A start with one group for every direction of every joint: what moves together is gathered into one component.

use faer::{Mat, MatRef};
use nalgebra::{Matrix3, SymmetricEigen};

use super::factor::{Factors, column_mut};
use crate::vector::{Work, dot, oriented, vectorised};

/// `count` components, from the three main directions of every joint, joined pair by pair where it costs least.
///
/// Two components that move different joints, with energies `a`, `b` and correlation `r` in time, leave
/// `(a + b) / 2 - sqrt(((a - b) / 2)^2 + r^2 a b)` when one time course must do for both. No joint is in a component twice
/// unless there is no other way. Cost: `F (3R)^2 / 2` multiply-adds and `(3R)^2` comparisons a join.
pub fn gather(motion: MatRef<'_, f64>, count: usize) -> Factors {
    let channels = motion.ncols();
    let mut parts = single(motion);
    let mut alive: Vec<bool> = vec![true; parts.len()];
    let mut losses: Vec<Vec<f64>> = (0..parts.len()).map(|a| vec![0.0; a]).collect();
    for (a, losses) in losses.iter_mut().enumerate() {
        vectorised(Losses { part: &parts[a], others: &parts[..a], alive: &alive, losses });
    }
    for _ in count..parts.len() {
        let mut best: Option<(f64, usize, usize)> = None;
        for a in (0..parts.len()).filter(|a| alive[*a]) {
            for b in (0..a).filter(|b| alive[*b]) {
                if best.is_none_or(|(lowest, ..)| losses[a][b] < lowest) {
                    best = Some((losses[a][b], a, b));
                }
            }
        }
        let Some((_, a, b)) = best else { break };
        parts[b] = join(&parts[a], &parts[b]);
        alive[a] = false;
        let mut joined = vec![0.0; parts.len()];
        vectorised(Losses { part: &parts[b], others: &parts, alive: &alive, losses: &mut joined });
        for other in (0..parts.len()).filter(|other| alive[*other] && *other != b) {
            losses[b.max(other)][b.min(other)] = joined[other];
        }
    }
    let kept: Vec<&Part> = parts.iter().zip(&alive).filter(|(_, alive)| **alive).map(|(part, _)| part).collect();
    let mut factors = Factors { weights: Mat::zeros(motion.nrows(), count), components: Mat::zeros(channels, count) };
    for (k, part) in kept.iter().enumerate().take(count) {
        column_mut(&mut factors.weights, k).copy_from_slice(&part.weights);
        column_mut(&mut factors.components, k).copy_from_slice(&part.component);
    }
    factors.normalise();
    factors
}

/// A time course of length one and the directions that follow it.
struct Part {
    weights: Vec<f64>,
    component: Vec<f64>,
    energy: f64,
}

/// Three orthogonal parts a joint; those that do not move are left out.
fn single(motion: MatRef<'_, f64>) -> Vec<Part> {
    let mut parts = Vec::new();
    let total = motion.squared_norm_l2();
    for joint in 0..motion.ncols() / 3 {
        let scatter: Matrix3<f64> = Matrix3::from_fn(|a, b| {
            (0..motion.nrows()).map(|f| motion[(f, 3 * joint + a)] * motion[(f, 3 * joint + b)]).sum()
        });
        let eigen = SymmetricEigen::new(scatter);
        for (energy, direction) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            let direction = oriented(direction.iter().copied().collect());
            if *energy <= 1e-12 * total {
                continue;
            }
            let along =
                |f: usize| (0..3).map(|c| motion[(f, 3 * joint + c)] * direction[c]).sum::<f64>() / energy.sqrt();
            let mut component = vec![0.0; motion.ncols()];
            (0..3).for_each(|c| component[3 * joint + c] = direction[c] * energy.sqrt());
            parts.push(Part { weights: (0..motion.nrows()).map(along).collect(), component, energy: *energy });
        }
    }
    parts
}

/// What a part would lose by being joined with each of the others.
struct Losses<'a> {
    part: &'a Part,
    others: &'a [Part],
    alive: &'a [bool],
    losses: &'a mut [f64],
}

impl Work for Losses<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for ((to, other), alive) in self.losses.iter_mut().zip(self.others).zip(self.alive) {
            if *alive {
                *to = loss(self.part, other);
            }
        }
    }
}

/// Squared error of one time course for both.
#[inline(always)]
fn loss(a: &Part, b: &Part) -> f64 {
    let (r, overlap) = (dot(&a.weights, &b.weights), dot(&a.component, &b.component));
    // Singular values of w_a c_a' + w_b c_b': the eigenvalues of (W'W)(C C').
    let trace = a.energy + b.energy + 2.0 * r * overlap;
    let determinant = (1.0 - r * r) * (a.energy * b.energy - overlap * overlap);
    let half = 0.5 * trace;
    half - (half * half - determinant).max(0.0).sqrt()
}

/// The best single time course, and the directions that follow it by least squares.
fn join(a: &Part, b: &Part) -> Part {
    let (r, overlap) = (dot(&a.weights, &b.weights), dot(&a.component, &b.component));
    // Main eigenvector of (C C')(W'W) in the basis w_a, w_b, by power steps: two unknowns, one gap.
    let (mut x, mut y) = if a.energy > b.energy { (1.0, r) } else { (r, 1.0) };
    for _ in 0..50 {
        let (u, v) = (x + r * y, r * x + y);
        (x, y) = (a.energy * u + overlap * v, overlap * u + b.energy * v);
        let norm = (x * x + y * y + 2.0 * r * x * y).sqrt().max(1e-300);
        (x, y) = (x / norm, y / norm);
    }
    let (u, v) = (x + r * y, r * x + y);
    let weights = a.weights.iter().zip(&b.weights).map(|(a, b)| x * a + y * b).collect();
    let component: Vec<f64> = a.component.iter().zip(&b.component).map(|(a, b)| u * a + v * b).collect();
    let energy = dot(&component, &component);
    Part { weights, component, energy }
}
