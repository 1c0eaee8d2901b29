//! Real modal form: the transition matrix becomes 2 x 2 blocks.

use faer::Mat;
use faer::linalg::solvers::Solve;

use super::StateSpace;
use crate::translate::dynamics::Dynamics;

/// A model in real modal form.
#[derive(Clone, Debug)]
pub struct Modal {
    /// `A` and `B`.
    pub dynamics: Dynamics,
    /// `C`, `[outputs x states]`.
    pub output: Mat<f64>,
    /// Condition number of the eigenvectors: how much rounding the change of basis can amplify. Beyond about 1e6 the modes
    /// are no longer trustworthy one by one; the fit of the output matrix then spreads the response over them again.
    pub condition: f64,
}

/// Poles are kept at least this far inside the unit circle: an error dies out within 200 frames.
const LARGEST_RADIUS: f64 = 0.995;

/// The modal form of a state-space model. Each mode is scaled so that white input of unit variance gives it unit variance,
/// which keeps all numbers of the device's f32 in one range. Cost: one eigenvalue decomposition.
pub fn modal(model: &StateSpace) -> Modal {
    let n = model.a.nrows();
    let m = model.b.ncols();
    let p = model.c.nrows();
    let nothing =
        || Modal { dynamics: Dynamics { inputs: m, ..Dynamics::default() }, output: Mat::zeros(p, 0), condition: 1.0 };
    if n == 0 {
        return nothing();
    }
    let Ok(eigen) = model.a.eigen() else { return nothing() };
    let (values, vectors) = (eigen.S().column_vector(), eigen.U());
    let is_real = |i: usize| values[i].im.abs() < 1e-9;
    let mut real: Vec<usize> = (0..n).filter(|i| is_real(*i)).collect();
    real.sort_by(|a, b| values[*b].re.total_cmp(&values[*a].re));
    let mut complex: Vec<usize> = (0..n).filter(|i| !is_real(*i) && values[*i].im > 0.0).collect();
    complex.sort_by(|a, b| values[*a].im.total_cmp(&values[*b].im));

    // Columns of T: A T = T diag(blocks).
    let mut blocks: Vec<[f64; 4]> = Vec::new();
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let inside = |radius: f64| if radius > LARGEST_RADIUS { LARGEST_RADIUS / radius } else { 1.0 };
    for i in complex {
        let k = inside(values[i].re.hypot(values[i].im));
        let (re, im) = (k * values[i].re, k * values[i].im);
        blocks.push([re, im, -im, re]);
        columns.push((0..n).map(|r| vectors[(r, i)].re).collect());
        columns.push((0..n).map(|r| vectors[(r, i)].im).collect());
    }
    for pair in real.chunks(2) {
        let pole = |i: Option<&usize>| i.map_or(0.0, |i| values[*i].re * inside(values[*i].re.abs()));
        blocks.push([pole(pair.first()), 0.0, 0.0, pole(pair.get(1))]);
        columns.extend(pair.iter().map(|i| (0..n).map(|r| vectors[(r, *i)].re).collect::<Vec<_>>()));
    }
    let basis = Mat::from_fn(n, n, |r, c| columns.get(c).map_or(0.0, |column| column[r]));
    let input = basis.partial_piv_lu().solve(&model.b);
    let output = &model.c * &basis;
    let singular = basis.singular_values().unwrap_or_default();
    let condition = match (singular.first(), singular.last()) {
        (Some(largest), Some(smallest)) if *smallest > 0.0 => largest / smallest,
        _ => f64::INFINITY,
    };

    let states = 2 * blocks.len();
    let mut scaled = Modal {
        dynamics: Dynamics { transition: blocks, input: vec![0.0; states * m], inputs: m },
        output: Mat::zeros(p, states),
        condition,
    };
    for state in 0..n {
        let [a, b, _, d] = scaled.dynamics.transition[state / 2];
        let is_pair = b != 0.0;
        // Both states of a complex pair share one scale, or the block would not stay a rotation.
        let rows = if is_pair { state / 2 * 2..state / 2 * 2 + 2 } else { state..state + 1 };
        let power: f64 = rows.flat_map(|r| (0..m).map(move |i| (r, i))).map(|(r, i)| input[(r, i)].powi(2)).sum();
        let pole = if is_pair {
            a.hypot(b)
        } else if state % 2 == 0 {
            a
        } else {
            d
        };
        let size = (power / (1.0 - pole * pole) / if is_pair { 2.0 } else { 1.0 }).sqrt();
        let scale = if size > 1e-12 { 1.0 / size } else { 0.0 };
        for i in 0..m {
            scaled.dynamics.input[state * m + i] = scale * input[(state, i)];
        }
        for o in 0..p {
            scaled.output[(o, state)] = if scale > 0.0 { output[(o, state)] / scale } else { 0.0 };
        }
    }
    scaled
}
