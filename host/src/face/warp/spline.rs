//! Displacement between points where it is known: a sum of smooth bumps.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use nalgebra::Vector2;

/// Reach of a bump, in the face's unit.
const REACH: f64 = 2.2;

/// `u(y) = sum a_i phi(|y - c_i| / R)` with Wendland's C2 function `phi(r) = (1 - r)^4 (4 r + 1)`: positive definite in the plane,
/// so that the system below always has a solution.
#[derive(Clone, Debug)]
pub(super) struct Spline {
    bumps: Vec<[Vector2<f64>; 2]>,
    reach: f64,
}

impl Spline {
    /// The spline through `wanted[i]` at `centres[i]`; centres beyond the last wanted one want 0. `damping` lets it come short.
    pub fn fit(centres: &[Vector2<f64>], wanted: &[Vector2<f64>], scale: f64, damping: f64) -> Self {
        let reach = REACH * scale;
        let entry =
            |i: usize, j: usize| bump((centres[i] - centres[j]).norm() / reach) + if i == j { damping } else { 0.0 };
        let matrix = Mat::from_fn(centres.len(), centres.len(), entry);
        let right = Mat::from_fn(centres.len(), 2, |i, axis| wanted.get(i).map_or(0.0, |wanted| wanted[axis]));
        // Positive definite by the damping; if rounding says no, nothing moves and the caller sees what is missed.
        let weights = matrix.llt(Side::Lower).map_or_else(|_| Mat::zeros(centres.len(), 2), |llt| llt.solve(&right));
        let bumps = centres.iter().enumerate();
        let bumps = bumps.map(|(i, centre)| [*centre, Vector2::new(weights[(i, 0)], weights[(i, 1)])]).collect();
        Self { bumps, reach }
    }

    /// The displacement at a place.
    pub fn at(&self, at: &Vector2<f64>) -> Vector2<f64> {
        self.bumps.iter().map(|[centre, weight]| weight * bump((at - centre).norm() / self.reach)).sum()
    }
}

fn bump(r: f64) -> f64 {
    let rest = (1.0 - r).max(0.0);
    let square = rest * rest;
    square * square * (4.0 * r + 1.0)
}
