//! The output equation by least squares on the simulation.

use std::ops::Range;

use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::solvers::Solve;
use faer::{Accum, Mat, MatRef, Par, Side};

use crate::translate::dynamics::Dynamics;

/// A whole model: `x[t + 1] = A x[t] + B u[t]`, `y[t] = C x[t] + D u[t] + constant`.
#[derive(Clone, Debug)]
pub struct Identified {
    /// `A` and `B`.
    pub dynamics: Dynamics,
    /// `[C D]` transposed, `[states + inputs x outputs]`.
    pub output: Mat<f64>,
    /// One number an output.
    pub constant: Vec<f64>,
}

/// Penalty on a weight, as a share of the variance of its state or input.
const RIDGE: f64 = 1e-4;
/// Frames whose products are summed at once: they stay in the cache, and memory does not grow with a clip.
const FRAMES: usize = 128;

impl Identified {
    /// The output for `u` (`[frames x inputs]`), before whose first frame it has been held for ever; `[frames x outputs]`.
    pub fn simulate(&self, u: &Mat<f64>) -> Mat<f64> {
        let states = self.dynamics.states();
        let mut y = self.dynamics.states_before(u) * self.output.subrows(0, states);
        y += u * self.output.subrows(states, u.ncols());
        Mat::from_fn(y.nrows(), y.ncols(), |t, c| y[(t, c)] + self.constant[c])
    }

    /// Largest magnitude of a pole; the model is stable below 1.
    pub fn radius(&self) -> f64 {
        let radius = |[a, b, c, d]: &[f64; 4]| {
            let (half, det) = (0.5 * (a + d), a * d - b * c);
            let square = half * half - det;
            if square < 0.0 { det.sqrt() } else { half.abs() + square.sqrt() }
        };
        self.dynamics.transition.iter().map(radius).fold(0.0, f64::max)
    }
}

/// Gives dynamics the output that fits best what they make of the inputs: ridge regression on states and inputs. `None` without
/// frames. Cost: `frames (states + inputs)^2 / 2` multiply-adds; memory does not depend on the frames.
pub(super) fn with_output(
    dynamics: Dynamics,
    inputs: &[Mat<f64>],
    outputs: &[Mat<f64>],
    covered: &[Range<usize>],
) -> Option<Identified> {
    let (states, m, p) = (dynamics.states(), inputs.first()?.ncols(), outputs.first()?.ncols());
    let (features, one) = (states + m, states + m + p);
    // Rows `[x | u | y | 1]`.
    let width = one + 1;
    let mut sums = Mat::<f64>::zeros(width, width);
    let mut rows = Vec::with_capacity(width * FRAMES);
    for ((u, y), covered) in inputs.iter().zip(outputs).zip(covered).filter(|((u, _), _)| u.nrows() > 0) {
        let mut frame: Vec<f64> = u.row(0).iter().copied().collect();
        let mut x = dynamics.held(&frame);
        for t in 0..covered.end {
            frame.iter_mut().zip(u.row(t).iter()).for_each(|(to, u)| *to = *u);
            if covered.contains(&t) {
                rows.extend_from_slice(&x);
                rows.extend_from_slice(&frame);
                rows.extend(y.row(t - covered.start).iter());
                rows.push(1.0);
            }
            if rows.len() == width * FRAMES || t + 1 == covered.end {
                add_products(&mut sums, MatRef::from_row_major_slice(&rows, rows.len() / width, width));
                rows.clear();
            }
            dynamics.step(&mut x, &frame);
        }
    }
    let frames = sums[(one, one)];
    (frames > 0.0).then_some(())?;
    let mean = |i: usize| sums[(one, i)] / frames;
    // Of a symmetric matrix the lower half is there.
    let covariance = |i: usize, j: usize| sums[(i.max(j), i.min(j))] / frames - mean(i) * mean(j);
    let mut normal = Mat::from_fn(features, features, covariance);
    // What does not move has no variance to take a share of.
    let least = 1e-12 * (0..features).map(|k| normal[(k, k)]).fold(f64::MIN_POSITIVE, f64::max);
    (0..features).for_each(|k| normal[(k, k)] = (1.0 + RIDGE) * normal[(k, k)].max(0.0) + least);
    let output = normal.llt(Side::Lower).ok()?.solve(Mat::from_fn(features, p, |k, o| covariance(k, features + o)));
    let constant =
        (0..p).map(|o| mean(features + o) - (0..features).map(|k| mean(k) * output[(k, o)]).sum::<f64>()).collect();
    Some(Identified { dynamics, output, constant })
}

/// Adds the lower half of `rows' rows`.
fn add_products(sums: &mut Mat<f64>, rows: MatRef<'_, f64>) {
    let (lower, all) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
    matmul(sums, lower, Accum::Add, rows.transpose(), all, rows, all, 1.0, Par::Seq);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_output_of_a_known_system_comes_back() {
        let dynamics = Dynamics {
            transition: vec![[0.8, -0.3, 0.3, 0.8], [0.5, 0.0, 0.0, 0.0]],
            input: vec![1.0, 0.2, -0.4, 0.7, 0.3, 1.0, 0.0, 0.0],
            inputs: 2,
        };
        let u = Mat::from_fn(700, 2, |t, i| ((t * t + 3 * t * i) as f64 * 0.37).sin());
        let c = Mat::from_fn(4, 3, |k, o| if k < 3 { (k as f64 - 1.5 * o as f64).cos() } else { 0.0 });
        let x = dynamics.states_before(&u);
        let y = &x * &c;
        let y = Mat::from_fn(700, 3, |t, o| y[(t, o)] + 0.5 * u[(t, 1)] + o as f64);
        let covered = 20..690;
        let seen = y.subrows(20, 670).to_owned();
        let found = with_output(dynamics, std::slice::from_ref(&u), &[seen], &[covered]).expect("there are frames");
        assert!((found.simulate(&u) - y).norm_max() < 2e-3, "the ridge alone is between them");
        assert!((found.radius() - 0.73f64.sqrt()).abs() < 1e-12);
        assert_eq!(found.output[(3, 0)], 0.0, "a state that nothing moves gets no weight");
    }
}
