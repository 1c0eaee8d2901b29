//! Strength -> features: a network with one hidden layer of tanh units (Chan 2019, section 3.4).
//!
//! The output layer is linear, so for given hidden units it is a least-squares problem: it is eliminated (variable projection,
//! Golub and Pereyra 1973, Kaufman's slopes), and what is left, two numbers a unit for one input, is found by Levenberg-Marquardt
//! steps. A slope of the fit by a hidden parameter is a product of one vector over the samples and one over the outputs, so that a
//! step costs little more than fitting the output layer.
//!
//! Beyond the paper a linear path from the inputs to the outputs, without penalty. Scores are linear in the features, so what is
//! synthesised for a score has that score, in the range of the training motions and beyond it.

use faer::linalg::matmul::matmul;
use faer::linalg::solvers::Solve;
use faer::{Accum, Mat, MatRef, Par, Side};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use super::hidden::{Hidden, tanh};
use super::samples::Samples;
use crate::vector::{dot, vectorised};

/// How to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegressOptions {
    /// Hidden units.
    pub hidden: usize,
    /// Penalty on the square of an output weight, for outputs and hidden values of size one.
    pub ridge: f64,
    /// Penalty on the square of an input weight, as a share of the outputs' variance.
    pub decay: f64,
    /// Whether inputs also go to the outputs directly.
    pub linear: bool,
    /// Done when a step lowers the objective by less than this share.
    pub tolerance: f64,
    /// At most so many steps.
    pub max_steps: usize,
    /// Seed of the first hidden units.
    pub seed: u64,
}

impl Default for RegressOptions {
    fn default() -> Self {
        Self { hidden: 10, ridge: 1e-4, decay: 1e-5, linear: true, tolerance: 1e-5, max_steps: 100, seed: 1 }
    }
}

/// `y = bias + linear s + output tanh(hidden s + hidden bias)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Regression {
    /// Number of inputs.
    pub inputs: usize,
    /// `[units x inputs]`.
    pub hidden: Vec<f64>,
    /// `[units]`.
    pub hidden_bias: Vec<f64>,
    /// `[outputs x units]`.
    pub output: Vec<f64>,
    /// `[outputs x inputs]`; zeros where [`RegressOptions::linear`] was off.
    pub linear: Vec<f64>,
    /// `[outputs]`.
    pub bias: Vec<f64>,
}

impl Regression {
    /// The outputs at some inputs.
    pub fn apply(&self, inputs: &[f64]) -> Vec<f64> {
        let weighted = |weights: &[f64], x: &[f64]| weights.iter().zip(x).map(|(w, x)| w * x).sum::<f64>();
        let rows = self.hidden.chunks_exact(self.inputs).zip(&self.hidden_bias);
        let hidden: Vec<f64> = rows.map(|(w, b)| tanh(b + weighted(w, inputs)).0).collect();
        let units = hidden.len();
        let output = |(index, bias): (usize, &f64)| {
            bias + weighted(&self.linear[index * self.inputs..][..self.inputs], inputs)
                + weighted(&self.output[index * units..][..units], &hidden)
        };
        self.bias.iter().enumerate().map(output).collect()
    }
}

/// A regression and how it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Regressed {
    /// The network.
    pub network: Regression,
    /// Root mean square error of an output.
    pub error: f64,
    /// The objective at the start and after every step.
    pub history: Vec<f64>,
}

/// Fits `outputs` to `inputs`, one row a sample.
///
/// Cost of a step: `2 samples x outputs x units` multiply-adds.
pub fn regress(inputs: &Samples, outputs: &Samples, options: &RegressOptions) -> Regressed {
    let range = Range::new(inputs);
    let scaled = range.scaled(inputs);
    let problem = Problem::new(Samples::new(&scaled, inputs.columns()), outputs, *options);
    let mut hidden = start(inputs.columns(), options);
    let mut fit = problem.fit(&hidden);
    let mut history = vec![fit.objective];
    let mut damping = 1e-2;
    for _ in 0..options.max_steps {
        let (gradient, curvature) = problem.slopes(&hidden, &fit);
        let mut better = None;
        while damping < 1e8 && better.is_none() {
            better = step(&gradient, &curvature, damping).map(|step| {
                let parameters = hidden.parameters.iter().zip(&step).map(|(p, s)| p + s).collect();
                let next = Hidden { parameters, ..hidden };
                let fit = problem.fit(&next);
                (next, fit)
            });
            better = better.filter(|(_, next)| next.objective < fit.objective);
            damping *= if better.is_some() { 0.2 } else { 4.0 };
        }
        let Some((next, next_fit)) = better else { break };
        let gain = fit.objective - next_fit.objective;
        (hidden, fit) = (next, next_fit);
        history.push(fit.objective);
        damping = damping.max(1e-9);
        if gain <= options.tolerance * fit.objective {
            break;
        }
    }
    let count = (outputs.rows() * outputs.columns()).max(1) as f64;
    let error = (fit.residual / count).sqrt();
    Regressed { network: problem.network(&hidden, &fit, &range), error, history }
}

/// Hidden units that cut the range -1..1 of each input into pieces (Nguyen and Widrow 1990), drawn from the seed.
fn start(inputs: usize, options: &RegressOptions) -> Hidden {
    let mut random = ChaCha8Rng::seed_from_u64(options.seed);
    let steep = 0.7 * (options.hidden as f64).powf(1.0 / inputs as f64);
    let mut parameters = Vec::with_capacity(options.hidden * (inputs + 1));
    for unit in 0..options.hidden {
        let direction: Vec<f64> = (0..inputs).map(|_| random.random_range(-1.0..1.0)).collect();
        let norm = direction.iter().map(|d| d * d).sum::<f64>().sqrt().max(1e-9);
        parameters.extend(direction.iter().map(|d| steep * d / norm));
        let spread = (unit as f64 + random.random_range(0.0..1.0)) / options.hidden as f64;
        parameters.push(steep * (2.0 * spread - 1.0));
    }
    Hidden { inputs, parameters }
}

/// Solves the damped normal equations.
fn step(gradient: &[f64], curvature: &Mat<f64>, damping: f64) -> Option<Vec<f64>> {
    let size = gradient.len();
    let mean = (0..size).map(|k| curvature[(k, k)]).sum::<f64>() / size.max(1) as f64;
    let mut damped = curvature.clone();
    (0..size).for_each(|k| damped[(k, k)] += damping * (damped[(k, k)] + 1e-3 * mean) + f64::MIN_POSITIVE);
    let right = Mat::from_fn(size, 1, |k, _| -gradient[k]);
    let solution = damped.llt(Side::Lower).ok()?.solve(&right);
    let step: Vec<f64> = (0..size).map(|k| solution[(k, 0)]).collect();
    step.iter().all(|s| s.is_finite()).then_some(step)
}

/// Middle and half width of every input.
struct Range(Vec<[f64; 2]>);

impl Range {
    fn new(inputs: &Samples) -> Self {
        let ends = |column: usize| {
            let values = inputs.iter().map(|row| row[column]);
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
        };
        let range = |[low, high]: [f64; 2]| {
            let half = 0.5 * (high - low);
            // An input that never changes says nothing: one constant more.
            if half > 1e-12 { [0.5 * (low + high), half] } else { [if low.is_finite() { low } else { 0.0 }, 1.0] }
        };
        Self((0..inputs.columns()).map(ends).map(range).collect())
    }

    fn scaled(&self, inputs: &Samples) -> Vec<f64> {
        inputs.iter().flat_map(|row| row.iter().zip(&self.0).map(|(x, [middle, half])| (x - middle) / half)).collect()
    }
}

struct Problem<'a> {
    inputs: Samples<'a>,
    /// `Y`, samples x outputs.
    outputs: MatRef<'a, f64>,
    options: RegressOptions,
    /// `|Y|^2`, and `|Y - mean|^2`.
    total: f64,
    varied: f64,
}

/// The output layer for given hidden units.
struct Fit {
    /// `[columns x samples]` row-major: hidden values, ones, and the inputs where they go through.
    basis: Vec<f64>,
    /// Slopes of the hidden values by what goes into their units.
    bends: Vec<f64>,
    /// Inverse of the damped Gram matrix of the basis.
    inverse: Mat<f64>,
    /// `[columns x outputs]`.
    weights: Mat<f64>,
    objective: f64,
    /// `|Y - basis' W|^2`.
    residual: f64,
}

impl<'a> Problem<'a> {
    fn new(inputs: Samples<'a>, outputs: &'a Samples<'a>, options: RegressOptions) -> Self {
        let mean = outputs.mean();
        let mut from_mean = vec![0.0; outputs.columns()];
        let (mut total, mut varied) = (0.0, 0.0);
        for row in outputs.iter() {
            vectorised(|| from_mean.iter_mut().zip(row).zip(&mean).for_each(|((to, y), m)| *to = y - m));
            total += dot(row, row);
            varied += dot(&from_mean, &from_mean);
        }
        Self { inputs, outputs: outputs.matrix(), options, total, varied }
    }

    fn columns(&self, units: usize) -> usize {
        units + 1 + if self.options.linear { self.inputs.columns() } else { 0 }
    }

    fn decay(&self, hidden: &Hidden) -> f64 {
        self.options.decay * self.varied / hidden.units().max(1) as f64
    }

    fn ridge(&self) -> f64 {
        self.options.ridge * self.inputs.rows() as f64
    }

    fn fit(&self, hidden: &Hidden) -> Fit {
        let (samples, units) = (self.inputs.rows(), hidden.units());
        let (mut basis, bends) = hidden.values(&self.inputs);
        basis.resize(basis.len() + samples, 1.0);
        if self.options.linear {
            for input in 0..self.inputs.columns() {
                basis.extend(self.inputs.iter().map(|row| row[input]));
            }
        }
        let columns = self.columns(units);
        let rows = MatRef::from_row_major_slice(&basis, columns, samples);
        let mut gram = product(rows, rows.transpose());
        let trace = (0..columns).map(|k| gram[(k, k)]).sum::<f64>() / columns as f64;
        // Inputs that say the same, or a constant one, leave the rest open: a trace of damping closes it.
        let damping = |k: usize| if k < units { self.ridge() } else { 0.0 } + 1e-12 * trace + f64::MIN_POSITIVE;
        (0..columns).for_each(|k| gram[(k, k)] += damping(k));
        let identity = Mat::<f64>::identity(columns, columns);
        let inverse =
            gram.llt(Side::Lower).map(|l| l.solve(&identity)).unwrap_or_else(|_| Mat::zeros(columns, columns));
        let cross = product(rows, self.outputs);
        let weights = product(inverse.as_ref(), cross.as_ref());
        // Of normal equations: |Y - basis' W|^2 = |Y|^2 - <cross, W> - <W, damping W>.
        // A sum for every column of the basis: sums that do not wait for each other.
        let (mut explained, mut squares) = (vec![0.0; columns], vec![0.0; columns]);
        for o in 0..weights.ncols() {
            let (cross, weights) = (cross.col_as_slice(o), weights.col_as_slice(o));
            for (((explained, squares), cross), weight) in
                explained.iter_mut().zip(&mut squares).zip(cross).zip(weights)
            {
                *explained += cross * weight;
                *squares += weight * weight;
            }
        }
        let explained: f64 = explained.iter().sum();
        let damped: f64 = squares.iter().enumerate().map(|(k, square)| damping(k) * square).sum();
        let weight = self.decay(hidden);
        let steep: f64 = hidden.parameters.iter().map(|p| p * p).sum();
        let residual = (self.total - explained - damped).max(0.0);
        Fit { basis, bends, inverse, weights, objective: self.total - explained + weight * steep, residual }
    }

    /// Half the gradient of the objective by the hidden parameters, exact, and Kaufman's curvature.
    fn slopes(&self, hidden: &Hidden, fit: &Fit) -> (Vec<f64>, Mat<f64>) {
        let (samples, units) = (self.inputs.rows(), hidden.units());
        let columns = fit.weights.nrows();
        let (basis, weights) = (MatRef::from_row_major_slice(&fit.basis, columns, samples), fit.weights.as_ref());
        let by_parameter = hidden.slopes(&self.inputs, &fit.bends);
        let count = hidden.parameters.len();
        let slopes = MatRef::from_row_major_slice(&by_parameter, count, samples);
        let own = weights.subrows(0, units);
        // Residuals seen from each unit: (Y - basis' W) W_h'.
        let inner = product(weights, own.transpose());
        let seen = product(self.outputs, own.transpose()) - product(basis.transpose(), inner.as_ref());
        let weight = self.decay(hidden);
        let per_unit = hidden.inputs + 1;
        let gradient = (0..count).map(|k| {
            let along = dot(&by_parameter[k * samples..][..samples], seen.col_as_slice(k / per_unit));
            weight * hidden.parameters[k] - along
        });
        let cross = product(basis, slopes.transpose());
        let explained = product(cross.transpose(), product(fit.inverse.as_ref(), cross.as_ref()).as_ref());
        let mut curvature = product(slopes, slopes.transpose()) - explained;
        for k in 0..count {
            for l in 0..count {
                curvature[(k, l)] *= inner[(k / per_unit, l / per_unit)];
            }
            curvature[(k, k)] += weight;
        }
        (gradient.collect(), curvature)
    }

    /// The network on inputs as they were given.
    fn network(&self, hidden: &Hidden, fit: &Fit, range: &Range) -> Regression {
        let (units, inputs) = (hidden.units(), self.inputs.columns());
        let outputs = fit.weights.ncols();
        let mut network = Regression {
            inputs,
            hidden: Vec::new(),
            hidden_bias: Vec::new(),
            output: (0..outputs).flat_map(|o| (0..units).map(move |k| (k, o))).map(|at| fit.weights[at]).collect(),
            linear: vec![0.0; outputs * inputs],
            bias: (0..outputs).map(|o| fit.weights[(units, o)]).collect(),
        };
        for p in hidden.parameters.chunks_exact(inputs + 1) {
            let mut bias = p[inputs];
            for (p, [middle, half]) in p.iter().zip(&range.0) {
                network.hidden.push(p / half);
                bias -= p * middle / half;
            }
            network.hidden_bias.push(bias);
        }
        if self.options.linear {
            for (o, bias) in network.bias.iter_mut().enumerate() {
                for (input, [middle, half]) in range.0.iter().enumerate() {
                    let slope = fit.weights[(units + 1 + input, o)] / half;
                    network.linear[o * inputs + input] = slope;
                    *bias -= slope * middle;
                }
            }
        }
        network
    }
}

fn product(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let mut out = Mat::zeros(a.nrows(), b.ncols());
    matmul(out.as_mut(), Accum::Replace, a, b, 1.0, Par::Seq);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curve in five dimensions over one input, or a surface over two.
    fn made(inputs: usize) -> (Vec<f64>, Vec<f64>) {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let s: Vec<f64> = (0..150 * inputs).map(|_| random.random_range(-2.0..5.0)).collect();
        let y = s.chunks_exact(inputs).flat_map(|s| {
            let x = s.iter().sum::<f64>();
            [x, (0.8 * x).sin(), 1.0 / (1.0 + x * x), 3.0, s[0] * 0.1 - x.cos()]
        });
        (s.clone(), y.collect())
    }

    #[test]
    fn the_gradient_is_that_of_finite_differences() {
        for (inputs, linear) in [(1, true), (1, false), (2, true)] {
            let (s, y) = made(inputs);
            let (s, y) = (Samples::new(&s, inputs), Samples::new(&y, 5));
            let options = RegressOptions { hidden: 4, linear, decay: 1e-3, ..RegressOptions::default() };
            let scaled = Range::new(&s).scaled(&s);
            let problem = Problem::new(Samples::new(&scaled, inputs), &y, options);
            let hidden = start(inputs, &options);
            let (gradient, _) = problem.slopes(&hidden, &problem.fit(&hidden));
            for (k, analytic) in gradient.iter().enumerate() {
                let at = |shift: f64| {
                    let mut moved = hidden.clone();
                    moved.parameters[k] += shift;
                    problem.fit(&moved).objective
                };
                let numeric = (at(1e-5) - at(-1e-5)) / 4e-5;
                assert!((numeric - analytic).abs() < 1e-4 * (1.0 + analytic.abs()), "{k}: {numeric} {analytic}");
            }
        }
    }

    #[test]
    fn the_objective_falls_and_the_curve_is_found() {
        for inputs in [1, 2] {
            let (s, y) = made(inputs);
            let (s, y) = (Samples::new(&s, inputs), Samples::new(&y, 5));
            let fitted = regress(&s, &y, &RegressOptions { ridge: 1e-8, decay: 0.0, ..RegressOptions::default() });
            assert!(fitted.history.windows(2).all(|w| w[1] < w[0]));
            assert!(fitted.error < [0.02, 0.2][inputs - 1], "{inputs}: {} {:?}", fitted.error, fitted.history.len());
            let row = fitted.network.apply(s.row(3));
            let worst = row.iter().zip(y.row(3)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(worst < 0.6, "the folded network is the fitted one: {worst}");
            assert_eq!(
                fitted,
                regress(&s, &y, &RegressOptions { ridge: 1e-8, decay: 0.0, ..RegressOptions::default() })
            );
        }
    }

    #[test]
    fn a_score_that_is_asked_for_is_what_comes_out() {
        // Outputs whose weighted sum is the input: whatever the units do, the linear path keeps that sum, far outside too.
        let (s, mut y) = made(1);
        let weights = [0.5, -1.0, 2.0, 0.3];
        for (s, y) in s.iter().zip(y.chunks_exact_mut(5)) {
            y[4] = s - y.iter().zip(weights).map(|(y, w)| y * w).sum::<f64>();
        }
        let fitted = regress(&Samples::new(&s, 1), &Samples::new(&y, 5), &RegressOptions::default());
        for asked in [-20.0, -1.0, 0.3, 4.0, 50.0] {
            let y = fitted.network.apply(&[asked]);
            let score = y[4] + y.iter().zip(weights).map(|(y, w)| y * w).sum::<f64>();
            assert!((score - asked).abs() < 1e-6 * (1.0 + asked.abs()), "{asked}: {score}");
        }
    }
}
