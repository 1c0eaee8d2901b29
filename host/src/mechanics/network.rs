//! Small multilayer perceptrons in f32: forward, analytic gradient, Adam. The products go through faer's `gemm`.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::vector::vectorised;

/// Samples that one thread takes at a time. A batch is always cut alike and summed in the same order, so that results do not
/// depend on the number of threads.
const PART: usize = 128;

/// `y = W x + b`, then tanh or nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Layer {
    /// Inputs.
    pub inputs: usize,
    /// Outputs.
    pub outputs: usize,
    /// Row-major `[outputs x inputs]`.
    pub weights: Vec<f32>,
    /// `[outputs]`.
    pub bias: Vec<f32>,
    /// Whether the outputs go through [`kinesic::kernel::tanh`], the device's own.
    pub tanh: bool,
}

impl Layer {
    /// Random weights, uniform with Glorot's bound, and no bias.
    pub fn random(inputs: usize, outputs: usize, tanh: bool, random: &mut ChaCha8Rng) -> Self {
        let bound = (6.0 / (inputs + outputs) as f32).sqrt();
        let weights = (0..inputs * outputs).map(|_| random.random_range(-bound..bound)).collect();
        Self { inputs, outputs, weights, bias: vec![0.0; outputs], tanh }
    }

    fn zeros(&self) -> Self {
        Self { weights: vec![0.0; self.weights.len()], bias: vec![0.0; self.bias.len()], ..*self }
    }

    /// `y` gets one row of outputs a sample.
    fn forward(&self, x: &[f32], samples: usize, y: &mut Vec<f32>) {
        y.clear();
        (0..samples).for_each(|_| y.extend_from_slice(&self.bias));
        let weights = MatRef::from_row_major_slice(&self.weights, self.outputs, self.inputs);
        let out = MatMut::from_row_major_slice_mut(y, samples, self.outputs);
        let x = MatRef::from_row_major_slice(x, samples, self.inputs);
        matmul(out, Accum::Add, x, weights.transpose(), 1.0, Par::Seq);
        if self.tanh {
            vectorised(|| y.iter_mut().for_each(|y| *y = kinesic::kernel::tanh(*y)));
        }
    }
}

/// Layers one after the other.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Network {
    /// The layers, first to last.
    pub layers: Vec<Layer>,
}

/// Rows of samples, row-major.
#[derive(Clone, Copy, Debug)]
pub struct Batch<'a> {
    /// `[samples x inputs]`.
    pub input: &'a [f32],
    /// `[samples x outputs]`.
    pub target: &'a [f32],
}

impl Network {
    /// Numbers that go in.
    pub fn inputs(&self) -> usize {
        self.layers.first().map_or(0, |l| l.inputs)
    }

    /// Numbers that come out.
    pub fn outputs(&self) -> usize {
        self.layers.last().map_or(0, |l| l.outputs)
    }

    /// Outputs of all samples, row-major.
    pub fn apply(&self, input: &[f32]) -> Vec<f32> {
        let inputs = self.inputs().max(1);
        let outputs = |rows: &[f32]| {
            let mut values = Vec::new();
            self.values(rows, &mut values);
            values.pop().unwrap_or_default()
        };
        input.par_chunks(1024 * inputs).map(outputs).flatten().collect()
    }

    /// Outputs of every layer.
    fn values(&self, input: &[f32], values: &mut Vec<Vec<f32>>) {
        let samples = input.len() / self.inputs().max(1);
        values.resize_with(self.layers.len(), Vec::new);
        for (index, layer) in self.layers.iter().enumerate() {
            let (before, own) = values.split_at_mut(index);
            layer.forward(before.last().map_or(input, |v| v), samples, &mut own[0]);
        }
    }

    /// Sum of squared errors and its gradient by weights and biases.
    pub fn gradient(&self, batch: Batch) -> (f64, Network) {
        let mut parts = Vec::new();
        let samples = batch.input.len() / self.inputs().max(1);
        let rows: Vec<u32> = (0..samples as u32).collect();
        self.fill(&mut parts, batch, &rows, &mut |_| ());
        let loss = self.sum(&mut parts, samples);
        (loss, parts.swap_remove(0).gradient)
    }

    /// Puts the chosen rows of the data into as many parts as they need; `corrupt` may change the inputs.
    fn fill(&self, parts: &mut Vec<Part>, data: Batch, rows: &[u32], corrupt: &mut dyn FnMut(&mut [f32])) {
        let (inputs, outputs) = (self.inputs(), self.outputs());
        let count = rows.len().div_ceil(PART).max(1);
        while parts.len() < count {
            parts.push(Part::new(self));
        }
        parts.iter_mut().for_each(|part| part.clear());
        for (part, rows) in parts.iter_mut().zip(rows.chunks(PART)) {
            for row in rows.iter().map(|row| *row as usize) {
                part.input.extend_from_slice(&data.input[row * inputs..][..inputs]);
                part.target.extend_from_slice(&data.target[row * outputs..][..outputs]);
            }
            corrupt(&mut part.input);
        }
    }

    /// Sum of squared errors over the parts that hold `samples` rows; the first part's gradient becomes that of all.
    fn sum(&self, parts: &mut [Part], samples: usize) -> f64 {
        let count = samples.div_ceil(PART).max(1);
        parts[..count].par_iter_mut().for_each(|part| part.run(self));
        let (first, others) = parts[..count].split_at_mut(1);
        for other in others.iter() {
            for (to, from) in first[0].gradient.parameters_mut().zip(other.gradient.parameters()) {
                vectorised(|| to.iter_mut().zip(from).for_each(|(to, from)| *to += from));
            }
        }
        first[0].loss + others.iter().map(|other| other.loss).sum::<f64>()
    }

    /// Weights and bias of every layer in turn.
    pub fn parameters(&self) -> impl Iterator<Item = &Vec<f32>> {
        self.layers.iter().flat_map(|l| [&l.weights, &l.bias])
    }

    /// Weights and bias of every layer in turn.
    pub fn parameters_mut(&mut self) -> impl Iterator<Item = &mut Vec<f32>> {
        self.layers.iter_mut().flat_map(|l| [&mut l.weights, &mut l.bias])
    }
}

/// A part of a batch with all that its gradient needs, kept from batch to batch: memory that is asked for anew every time costs
/// as much as the arithmetic.
struct Part {
    input: Vec<f32>,
    target: Vec<f32>,
    /// Outputs of every layer.
    values: Vec<Vec<f32>>,
    /// Slope of the loss by the outputs of a layer, and of the layer before.
    delta: Vec<f32>,
    before: Vec<f32>,
    gradient: Network,
    loss: f64,
}

impl Part {
    fn new(network: &Network) -> Self {
        let gradient = Network { layers: network.layers.iter().map(Layer::zeros).collect() };
        let [input, target, delta, before] = [(); 4].map(|()| Vec::new());
        Self { input, target, values: Vec::new(), delta, before, gradient, loss: 0.0 }
    }

    fn clear(&mut self) {
        self.input.clear();
        self.target.clear();
    }

    fn run(&mut self, network: &Network) {
        let samples = self.input.len() / network.inputs().max(1);
        network.values(&self.input, &mut self.values);
        let Self { input, target, values, delta, before, gradient, loss } = self;
        delta.clear();
        delta.extend(values.last().map_or(&*input, |v| v).iter().zip(&*target).map(|(y, t)| y - t));
        *loss = delta.iter().map(|d| f64::from(*d).powi(2)).sum();
        vectorised(|| delta.iter_mut().for_each(|d| *d *= 2.0));
        for (index, layer) in network.layers.iter().enumerate().rev() {
            if layer.tanh {
                vectorised(|| delta.iter_mut().zip(&values[index]).for_each(|(d, y)| *d *= 1.0 - y * y));
            }
            let x = if index == 0 { &*input } else { &values[index - 1] };
            let to = &mut gradient.layers[index];
            let rows = MatRef::from_row_major_slice(delta, samples, layer.outputs);
            matmul(
                MatMut::from_row_major_slice_mut(&mut to.weights, layer.outputs, layer.inputs),
                Accum::Replace,
                rows.transpose(),
                MatRef::from_row_major_slice(x, samples, layer.inputs),
                1.0,
                Par::Seq,
            );
            to.bias.fill(0.0);
            vectorised(|| {
                for row in delta.chunks_exact(layer.outputs) {
                    to.bias.iter_mut().zip(row).for_each(|(b, d)| *b += d);
                }
            });
            if index > 0 {
                before.resize(samples * layer.inputs, 0.0);
                matmul(
                    MatMut::from_row_major_slice_mut(before, samples, layer.inputs),
                    Accum::Replace,
                    rows,
                    MatRef::from_row_major_slice(&layer.weights, layer.outputs, layer.inputs),
                    1.0,
                    Par::Seq,
                );
                std::mem::swap(delta, before);
            }
        }
    }
}

/// How to fit.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// Passes over the samples.
    pub epochs: usize,
    /// Samples of a step.
    pub batch: usize,
    /// First learning rate; it falls to zero along a half cosine.
    pub rate: f32,
    /// Half the width over root 3 of the uniform noise added to the inputs: its deviation.
    pub noise: f32,
    /// Decoupled weight decay (per unit of learning rate).
    pub decay: f32,
}

/// Fits a network by Adam. `input` may be corrupted with noise, `target` never is. `progress` hears the epoch and the mean
/// squared error over it.
pub fn fit(
    network: &mut Network,
    data: Batch,
    how: &Fit,
    random: &mut ChaCha8Rng,
    progress: &dyn Fn(usize, f64),
) -> f64 {
    let mut descent = Descent::new(std::mem::take(network), data, twin(random));
    descent.run(data, how, &mut |descent| progress(descent.errors.len(), descent.error()));
    let error = descent.error();
    (*network, *random) = (descent.network, descent.random);
    error
}

/// A fit between two epochs: all that the next one depends on, so that it can be kept and gone on with.
#[derive(Serialize, Deserialize)]
pub struct Descent {
    /// The network so far.
    pub network: Network,
    /// Source of order and noise.
    #[serde(with = "generator")]
    pub random: ChaCha8Rng,
    /// Mean squared error over each epoch so far.
    pub errors: Vec<f64>,
    adam: Adam,
    /// The samples as last shuffled: the next epoch shuffles on from there.
    order: Vec<u32>,
}

impl Descent {
    /// Before the first epoch.
    pub fn new(network: Network, data: Batch, random: ChaCha8Rng) -> Self {
        let samples = (data.input.len() / network.inputs().max(1)) as u32;
        Self { adam: Adam::new(&network), network, random, errors: Vec::new(), order: (0..samples).collect() }
    }

    /// Whether `self` can be a later state of `start`: as many samples, the same layers, no more epochs than are wanted.
    pub fn goes_on_from(&self, start: &Self, how: &Fit) -> bool {
        let shape = |network: &Network| -> Vec<(usize, usize, bool, usize, usize)> {
            let layers = network.layers.iter();
            layers.map(|l| (l.inputs, l.outputs, l.tanh, l.weights.len(), l.bias.len())).collect()
        };
        let networks = [&self.network, &self.adam.first, &self.adam.second];
        let samples = start.order.len() as u32;
        networks.into_iter().all(|network| shape(network) == shape(&start.network))
            && self.order.len() == start.order.len()
            && self.order.iter().all(|row| *row < samples)
            && self.errors.len() <= how.epochs
    }

    /// Error over the last epoch.
    pub fn error(&self) -> f64 {
        self.errors.last().copied().unwrap_or(f64::NAN)
    }

    /// Runs the epochs that are left; `after` hears of each.
    pub fn run(&mut self, data: Batch, how: &Fit, after: &mut dyn FnMut(&Self)) {
        let mut parts = Vec::new();
        while self.errors.len() < how.epochs {
            self.epoch(data, how, &mut parts);
            after(self);
        }
    }

    fn epoch(&mut self, data: Batch, how: &Fit, parts: &mut Vec<Part>) {
        let Self { network, random, errors, adam, order } = self;
        let outputs = network.outputs().max(1);
        let samples = order.len();
        let steps = (how.epochs * samples.div_ceil(how.batch.max(1))).max(1) as f32;
        let width = how.noise * 3f32.sqrt();
        for last in (1..samples).rev() {
            order.swap(last, random.random_range(0..=last));
        }
        let mut sum = 0.0;
        for chosen in order.chunks(how.batch.max(1)) {
            network.fill(parts, data, chosen, &mut |input| {
                if width > 0.0 {
                    input.iter_mut().for_each(|x| *x += random.random_range(-width..width));
                }
            });
            sum += network.sum(parts, chosen.len());
            let rate = how.rate * 0.5 * (1.0 + (std::f32::consts::PI * adam.step as f32 / steps).cos());
            let scale = 1.0 / (chosen.len() * outputs) as f32;
            adam.descend(network, &parts[0].gradient, scale, rate, how.decay);
        }
        errors.push(sum / (samples * outputs) as f64);
    }
}

/// A generator that goes on as `random` will; the type has no `Clone`.
pub(super) fn twin(random: &ChaCha8Rng) -> ChaCha8Rng {
    ChaCha8Rng::deserialize_state(&random.serialize_state())
}

/// A generator kept as its seed and its place.
mod generator {
    use rand::rngs::ChaCha8Rng;
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(random: &ChaCha8Rng, serializer: S) -> Result<S::Ok, S::Error> {
        random.serialize_state().to_vec().serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<ChaCha8Rng, D::Error> {
        let state = Vec::<u8>::deserialize(deserializer)?;
        let state = state.try_into().map_err(|_| D::Error::custom("not the state of a generator"))?;
        Ok(ChaCha8Rng::deserialize_state(&state))
    }
}

/// Adam (Kingma 2015) with decoupled weight decay.
#[derive(Serialize, Deserialize)]
struct Adam {
    first: Network,
    second: Network,
    step: i32,
}

impl Adam {
    fn new(network: &Network) -> Self {
        let first = Network { layers: network.layers.iter().map(Layer::zeros).collect() };
        Self { second: first.clone(), first, step: 0 }
    }

    /// One step against `scale` times the gradient.
    fn descend(&mut self, network: &mut Network, gradient: &Network, scale: f32, rate: f32, decay: f32) {
        const FADE: [f32; 2] = [0.9, 0.999];
        self.step += 1;
        let [b1, b2] = FADE;
        let (c1, c2) = (1.0 - b1.powi(self.step), 1.0 - b2.powi(self.step));
        let moments = self.first.parameters_mut().zip(self.second.parameters_mut());
        for ((w, g), (m, v)) in network.parameters_mut().zip(gradient.parameters()).zip(moments) {
            vectorised(|| {
                for (((w, g), m), v) in w.iter_mut().zip(g).zip(m).zip(v) {
                    let g = g * scale;
                    *m = b1 * *m + (1.0 - b1) * g;
                    *v = b2 * *v + (1.0 - b2) * g * g;
                    *w -= rate * ((*m / c1) / ((*v / c2).sqrt() + 1e-8) + decay * *w);
                }
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    fn sample(count: usize, random: &mut ChaCha8Rng) -> Vec<f32> {
        (0..count).map(|_| random.random_range(-1.0..1.0)).collect()
    }

    #[test]
    fn gradients_are_those_of_finite_differences() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let sizes = [(5, 7, true), (7, 4, true), (4, 3, false)];
        let mut network = Network { layers: sizes.map(|(i, o, tanh)| Layer::random(i, o, tanh, &mut random)).to_vec() };
        let (input, target) = (sample(200 * 5, &mut random), sample(200 * 3, &mut random));
        let batch = Batch { input: &input, target: &target };
        let (_, gradient) = network.gradient(batch);
        let gradient: Vec<Vec<f32>> = gradient.parameters().cloned().collect();
        let norm = gradient.iter().flatten().map(|g| f64::from(*g).powi(2)).sum::<f64>().sqrt();
        let step = 1e-2f32;
        for (block, gradient) in gradient.iter().enumerate() {
            for (index, analytic) in gradient.iter().enumerate() {
                let mut at = |shift: f32| {
                    let parameter = &mut network.parameters_mut().nth(block).unwrap()[index];
                    let before = *parameter;
                    *parameter = before + shift;
                    let loss = network.gradient(batch).0;
                    network.parameters_mut().nth(block).unwrap()[index] = before;
                    loss
                };
                let difference = (at(step) - at(-step)) / f64::from(2.0 * step);
                let error = (difference - f64::from(*analytic)).abs();
                assert!(error < 2e-4 * norm, "block {block}, parameter {index}: {difference} {analytic}, norm {norm}");
            }
        }
    }

    #[test]
    fn learns_a_curve_and_repeats_itself() {
        let input: Vec<f32> = (0..400).map(|i| i as f32 / 200.0 - 1.0).collect();
        let target: Vec<f32> = input.iter().map(|x| (3.0 * x).sin()).collect();
        let how = Fit { epochs: 200, batch: 32, rate: 1e-2, noise: 0.0, decay: 0.0 };
        let run = || {
            let mut random = ChaCha8Rng::seed_from_u64(1);
            let mut network = Network {
                layers: vec![Layer::random(1, 16, true, &mut random), Layer::random(16, 1, false, &mut random)],
            };
            let error = fit(&mut network, Batch { input: &input, target: &target }, &how, &mut random, &|_, _| ());
            (error, network)
        };
        let (error, network) = run();
        // The curve's variance is .5. How far the descent gets depends on the matrix kernel that the build chose.
        assert!(error < 1e-2, "{error}");
        assert_eq!(network, run().1);
    }
}
