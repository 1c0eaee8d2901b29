//! Candidate dynamics: the poles and input matrix of a filter bank, in the device's modal form.

use std::f64::consts::TAU;

use faer::Mat;

/// `x' = A x + B u` with `A` block diagonal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dynamics {
    /// 2 x 2 blocks, row-major.
    pub transition: Vec<[f64; 4]>,
    /// `B`, row-major `[states x inputs]`.
    pub input: Vec<f64>,
    /// Number of inputs.
    pub inputs: usize,
}

/// A choice of poles, made by validation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Poles {
    /// No states: a static map.
    Static,
    /// Two real poles: 50 and 200 ms of memory.
    Relaxation,
    /// Resonances at the first 2 harmonics of the main frequency.
    Harmonics2,
    /// Resonances at the first 3 harmonics.
    Harmonics3,
    /// Two real poles and resonances at 1/2, 1, 2, 3 and 4 times the main frequency.
    Full,
    /// Found from the data, of at most this order: regularised impulse response, then truncation of its Hankel matrix.
    Identified(usize),
}

/// How long a resonance remembers, s.
const MEMORY: f64 = 0.41;

impl Poles {
    /// States per input; identified models have their order for all inputs together.
    pub fn states(self, inputs: usize) -> usize {
        match self {
            Self::Static => 0,
            Self::Relaxation => 2 * inputs,
            Self::Harmonics2 => 4 * inputs,
            Self::Harmonics3 => 6 * inputs,
            Self::Full => 12 * inputs,
            Self::Identified(order) => order,
        }
    }

    /// A bank in which every input drives the same poles; `None` for [`Poles::Identified`], which needs data.
    pub fn bank(self, inputs: usize, main_frequency: f64, fps: f64) -> Option<Dynamics> {
        let (times, harmonics): (&[f64], &[f64]) = match self {
            Self::Static => (&[], &[]),
            Self::Relaxation => (&[0.05, 0.2], &[]),
            Self::Harmonics2 => (&[], &[1.0, 2.0]),
            Self::Harmonics3 => (&[], &[1.0, 2.0, 3.0]),
            Self::Full => (&[0.03, 0.12], &[0.5, 1.0, 2.0, 3.0, 4.0]),
            Self::Identified(_) => return None,
        };
        let mut dynamics = Dynamics { inputs, ..Dynamics::default() };
        for input in 0..inputs {
            for pair in times.chunks(2) {
                let pole = |t: Option<&f64>| t.map_or(0.0, |t| (-1.0 / (fps * t)).exp());
                let (p, q) = (pole(pair.first()), pole(pair.get(1)));
                let gains = [1.0 - p, if pair.len() > 1 { 1.0 - q } else { 0.0 }];
                dynamics.push([p, 0.0, 0.0, q], input, gains);
            }
            for harmonic in harmonics {
                let radius = (-1.0 / (fps * MEMORY)).exp();
                let (sin, cos) = (TAU * main_frequency * harmonic / fps).sin_cos();
                dynamics.push([radius * cos, -radius * sin, radius * sin, radius * cos], input, [1.0 - radius, 0.0]);
            }
        }
        Some(dynamics)
    }
}

impl Dynamics {
    fn push(&mut self, block: [f64; 4], input: usize, gains: [f64; 2]) {
        self.transition.push(block);
        for gain in gains {
            self.input.extend((0..self.inputs).map(|i| if i == input { gain } else { 0.0 }));
        }
    }

    /// Number of states.
    pub fn states(&self) -> usize {
        2 * self.transition.len()
    }

    /// Runs through `u` (`[frames x inputs]`) from the state in which the first frame would have been held for ever, and
    /// returns `x[t + 1] = A x[t] + B u[t]`, `[frames x states]`: what frame `t` has made of the state.
    pub fn simulate(&self, u: &Mat<f64>) -> Mat<f64> {
        self.run(u).1
    }

    /// As [`simulate`](Self::simulate), but `x[t]`: the state that frame `t` finds.
    pub fn states_before(&self, u: &Mat<f64>) -> Mat<f64> {
        self.run(u).0
    }

    fn run(&self, u: &Mat<f64>) -> (Mat<f64>, Mat<f64>) {
        let mut before = Mat::zeros(u.nrows(), self.states());
        let mut after = before.clone();
        if u.nrows() == 0 {
            return (before, after);
        }
        let row = |frame: usize| -> Vec<f64> { (0..self.inputs).map(|i| u[(frame, i)]).collect() };
        let mut x = self.held(&row(0));
        for frame in 0..u.nrows() {
            x.iter().enumerate().for_each(|(state, x)| before[(frame, state)] = *x);
            self.step(&mut x, &row(frame));
            x.iter().enumerate().for_each(|(state, x)| after[(frame, state)] = *x);
        }
        (before, after)
    }

    /// The state in which `u` has been held for ever.
    pub(super) fn held(&self, u: &[f64]) -> Vec<f64> {
        let mut x = Vec::with_capacity(self.states());
        for ([a, b, c, d], rows) in self.blocks() {
            let [u0, u1] = drive(rows, u);
            let det = (1.0 - a) * (1.0 - d) - b * c;
            x.extend([((1.0 - d) * u0 + b * u1) / det, (c * u0 + (1.0 - a) * u1) / det]);
        }
        x
    }

    /// `x <- A x + B u`.
    pub(super) fn step(&self, x: &mut [f64], u: &[f64]) {
        for (([a, b, c, d], rows), x) in self.blocks().zip(x.as_chunks_mut::<2>().0) {
            let [u0, u1] = drive(rows, u);
            *x = [a * x[0] + b * x[1] + u0, c * x[0] + d * x[1] + u1];
        }
    }

    /// The blocks of `A`, each with its two rows of `B`. None without inputs.
    fn blocks(&self) -> impl Iterator<Item = (&[f64; 4], &[f64])> {
        self.transition.iter().zip(self.input.chunks_exact(2 * self.inputs.max(1)))
    }

    /// `W [x'; u]` written for the state before the step: `W_x A` and `W_x B + W_u`, row-major `[outputs x states]` and
    /// `[outputs x inputs]`, from `weights` `[states + inputs x outputs]`.
    pub fn output_of(&self, weights: &Mat<f64>) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
        let states = self.states();
        let mut of_state = vec![vec![0.0; states]; weights.ncols()];
        let mut of_input = vec![vec![0.0; self.inputs]; weights.ncols()];
        for output in 0..weights.ncols() {
            for (block, [a, b, c, d]) in self.transition.iter().enumerate() {
                let (w0, w1) = (weights[(2 * block, output)], weights[(2 * block + 1, output)]);
                of_state[output][2 * block] = w0 * a + w1 * c;
                of_state[output][2 * block + 1] = w0 * b + w1 * d;
            }
            for input in 0..self.inputs {
                let through: f64 =
                    (0..states).map(|s| weights[(s, output)] * self.input[s * self.inputs + input]).sum();
                of_input[output][input] = through + weights[(states + input, output)];
            }
        }
        (of_state, of_input)
    }
}

/// Two rows of `B` times `u`.
fn drive(rows: &[f64], u: &[f64]) -> [f64; 2] {
    let (first, second) = rows.split_at(u.len());
    [first, second].map(|row| row.iter().zip(u).map(|(w, u)| w * u).sum())
}

/// Frequency that carries most of a motion, Hz, between 0.4 and 3: the gait's, where there is one.
///
/// Peak of the summed windowed spectra of the coordinates `z`, one `[frames x coordinates]` matrix a clip.
pub fn main_frequency(clips: &[Mat<f64>], fps: f64) -> f64 {
    let power = |frequency: f64| -> f64 {
        clips
            .iter()
            .flat_map(|z| (0..z.ncols()).map(move |column| (z, column)))
            .map(|(z, column)| {
                let frames = z.nrows() as f64;
                let mean = (0..z.nrows()).map(|t| z[(t, column)]).sum::<f64>() / frames;
                let (mut re, mut im) = (0.0, 0.0);
                for t in 0..z.nrows() {
                    let window = 0.5 - 0.5 * (TAU * (t as f64 + 0.5) / frames).cos();
                    let (sin, cos) = (TAU * frequency * t as f64 / fps).sin_cos();
                    let value = window * (z[(t, column)] - mean);
                    (re, im) = (re + value * cos, im - value * sin);
                }
                (re * re + im * im) / frames.max(1.0)
            })
            .sum()
    };
    let candidates = (0..=130).map(|k| 0.4 + 0.02 * f64::from(k));
    candidates.max_by(|a, b| power(*a).total_cmp(&power(*b))).unwrap_or(1.0)
}
