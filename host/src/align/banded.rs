//! Symmetric banded equations, several independent systems side by side.

/// Half bandwidth: `a_t, b_t` interleaved, coupled with each other and with `t - 1` and `t - 2`.
pub(super) const BAND: usize = 4;
/// Systems solved side by side, one channel each: hides the latency of the divisions.
pub(super) const LANES: usize = 4;

/// One value for each system.
pub(super) type Lane = [f64; LANES];

/// A row of the system: the diagonal, the `BAND` elements left of it (nearest first), the right-hand side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    pub diagonal: Lane,
    pub left: [Lane; BAND],
    pub right: Lane,
}

/// Solver with its storage. `A = L D L^T` without pivoting, which is stable for positive definite A
/// (Golub and Van Loan, Matrix Computations, 4.1.2 and 4.3.5). O(size x BAND^2) time, O(size x BAND) memory.
#[derive(Debug, Default)]
pub(super) struct BandedSolver {
    lower: Vec<[Lane; BAND]>,
    solution: Vec<Lane>,
}

impl BandedSolver {
    /// Solves the system whose rows `row(0), .., row(size - 1)` are, asked for in order; elements left of column 0 must be
    /// zero. `None` where a pivot is not positive (or not finite): A is not positive definite.
    pub fn solve(&mut self, size: usize, mut row: impl FnMut(usize) -> Row) -> Option<&[Lane]> {
        self.lower.clear();
        self.solution.clear();
        // The last four rows, nearest first; those before row 0 are zero, so that all loops have fixed bounds.
        let mut lower_near = [[[0.0; LANES]; BAND]; BAND];
        let mut inverse_near = [[0.0; LANES]; BAND];
        let mut solution_near = [[0.0; LANES]; BAND];
        for r in 0..size {
            let mut given = row(r);
            // product[s - 1] = L[r][r-s] D[r-s]
            let mut product = given.left;
            let mut lower = [[0.0; LANES]; BAND];
            for s in (0..BAND).rev() {
                for t in s + 1..BAND {
                    for x in 0..LANES {
                        product[s][x] -= product[t][x] * lower_near[s][t - s - 1][x];
                    }
                }
                for x in 0..LANES {
                    lower[s][x] = product[s][x] * inverse_near[s][x];
                    given.diagonal[x] -= product[s][x] * lower[s][x];
                    given.right[x] -= lower[s][x] * solution_near[s][x];
                }
            }
            if !given.diagonal.iter().all(|&d| d > 0.0 && d.is_finite()) {
                return None;
            }
            let inverse = given.diagonal.map(f64::recip);
            lower_near = [lower, lower_near[0], lower_near[1], lower_near[2]];
            inverse_near = [inverse, inverse_near[0], inverse_near[1], inverse_near[2]];
            solution_near = [given.right, solution_near[0], solution_near[1], solution_near[2]];
            self.lower.push(lower);
            // Already divided by D, for the way back.
            self.solution.push(std::array::from_fn(|x| given.right[x] * inverse[x]));
        }
        // pending[s]: what rows below take from the row s + 1 above the current one.
        let mut pending = [[0.0; LANES]; BAND];
        for (solution, lower) in self.solution.iter_mut().zip(&self.lower).rev() {
            for x in 0..LANES {
                solution[x] -= pending[0][x];
            }
            pending = [pending[1], pending[2], pending[3], [0.0; LANES]];
            for s in 0..BAND {
                for x in 0..LANES {
                    pending[s][x] += lower[s][x] * solution[x];
                }
            }
        }
        Some(&self.solution)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::{Mat, prelude::Solve};

    #[test]
    fn agrees_with_a_dense_solve() {
        for size in 1..40 {
            // A deterministic, diagonally dominant matrix, different in each lane.
            let at = |r: usize, c: usize, x: usize| {
                let (r, c) = (r.max(c), r.min(c));
                match r - c {
                    0 => 9.0 + ((r * 7 + x * 3) % 5) as f64,
                    d if d <= BAND => ((r * 13 + d * 5 + x) % 7) as f64 / 3.5 - 1.0,
                    _ => 0.0,
                }
            };
            let right = |r: usize, x: usize| ((r * 31 + x * 17) % 11) as f64 - 5.0;
            let lanes = |f: &dyn Fn(usize) -> f64| std::array::from_fn(f);
            let mut solver = BandedSolver::default();
            let found = solver
                .solve(size, |r| Row {
                    diagonal: lanes(&|x| at(r, r, x)),
                    left: std::array::from_fn(|s| lanes(&|x| if s < r { at(r, r - s - 1, x) } else { 0.0 })),
                    right: lanes(&|x| right(r, x)),
                })
                .expect("positive definite");
            for x in 0..LANES {
                let dense = Mat::from_fn(size, size, |r, c| at(r, c, x));
                let want = dense.partial_piv_lu().solve(Mat::from_fn(size, 1, |r, _| right(r, x)));
                for (r, row) in found.iter().enumerate() {
                    assert!((row[x] - want[(r, 0)]).abs() < 1e-12, "size {size}, row {r}, lane {x}");
                }
            }
        }
    }

    #[test]
    fn refuses_an_indefinite_matrix() {
        let row = |_| Row { diagonal: [0.0; LANES], left: [[0.0; LANES]; BAND], right: [1.0; LANES] };
        assert!(BandedSolver::default().solve(3, row).is_none());
    }
}
