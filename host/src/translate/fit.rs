//! From training sequences to a model of a given form: features, ridge regression, cross-validation.

use std::ops::Range;

use faer::Mat;
use rayon::prelude::*;

use super::candidate::{Candidate, QUICK};
use super::dataset::Sequence;
use super::dynamics::{Dynamics, Poles, main_frequency};
use super::experts;
use super::features::{centred, columns, principal, segments, takes, with_states};
use super::gate::GateModel;
use super::identify;
use super::model::{BankModel, TimingModel, TranslatorModel};
use super::moments::{Base, FoldMoments, Map, Moments, Shape, stack};
use crate::rig::Rig;
use crate::step_cache::StepCache;

/// Deviation below which a joint counts as still, m.
const STILL: f64 = 0.01;
/// Time left out around a held-back block, s.
const GAP: f64 = 0.1;

/// Training sequences, prepared.
#[derive(Clone, Debug)]
pub struct Problem<'a> {
    sequences: &'a [Sequence],
    /// Mirrored copies (none, or one a sequence); they are trained on, never validated on.
    mirrored: &'a [Sequence],
    fps: f64,
    rig: &'a Rig,
    channels: usize,
    mean: Vec<f64>,
    /// Right singular vectors of the centred inputs, `[channels x coordinates]`, over the first singular deviation.
    basis: Mat<f64>,
    main_frequency: f64,
    /// `(sequence, covered rows, fold)`.
    segments: Vec<(usize, Range<usize>, usize)>,
    folds: usize,
    /// Whether every clip counts the same, however long it is.
    alike: bool,
}

impl<'a> Problem<'a> {
    /// Normalises, finds the principal coordinates and the main frequency, and lays out the folds.
    pub fn new(rig: &'a Rig, sequences: &'a [Sequence], mirrored: &'a [Sequence], fps: f64) -> Self {
        let channels = sequences.first().map_or(3, |s| s.channels);
        let all = || sequences.iter().chain(mirrored);
        let frames: usize = all().map(|s| s.input.len() / channels).sum();
        let mut mean = vec![0.0; channels];
        for row in all().flat_map(|s| s.input.chunks_exact(channels)) {
            mean.iter_mut().zip(row).for_each(|(m, x)| *m += x / frames.max(1) as f64);
        }
        let mut covariance = Mat::<f64>::zeros(channels, channels);
        for sequence in all() {
            let centred = centred(&sequence.input, &mean);
            covariance += centred.transpose() * &centred;
        }
        let basis = principal(&covariance, frames);
        let coordinates: Vec<Mat<f64>> =
            sequences.iter().map(|s| centred(&s.input, &mean) * basis.subcols(0, basis.ncols().min(4))).collect();
        let (segments, folds) = segments(sequences);
        Self {
            sequences,
            mirrored,
            fps,
            rig,
            channels,
            main_frequency: main_frequency(&coordinates, fps),
            mean,
            basis,
            segments,
            folds,
            alike: false,
        }
    }

    /// The same with clips that all count the same: of several actions the long one must not decide.
    pub fn alike(self) -> Self {
        Self { alike: true, ..self }
    }

    /// The same, judged on other takes of the actions that it is trained on instead of on other actions.
    pub fn by_take(self) -> Self {
        let (segments, folds) = takes(self.sequences);
        Self { segments, folds, ..self }
    }

    /// What the training knows of itself; `None` for a machine.
    pub fn gate(&self) -> Option<GateModel> {
        GateModel::fit(self.rig, self.sequences.iter().chain(self.mirrored), &self.mean, self.fps)
    }

    /// Training sequences, without mirrored copies.
    pub fn sequences(&self) -> &[Sequence] {
        self.sequences
    }

    /// Mean of the inputs.
    pub fn mean(&self) -> &[f64] {
        &self.mean
    }

    /// Frequency of the main resonance, Hz.
    pub fn main_frequency(&self) -> f64 {
        self.main_frequency
    }

    fn rows(&self) -> usize {
        self.channels / 3
    }

    /// The root's travel is no position, and no error either.
    fn is_travel(&self, channel: usize) -> bool {
        self.rig.frames().travels() && (channel == 0 || channel == 2)
    }

    /// Dynamics and features (`[x' | drives]`, all frames) of every sequence, then of every mirrored one.
    fn whole_body(&self, coordinates: usize, poles: Poles) -> (Dynamics, Vec<Mat<f64>>) {
        let coordinates = coordinates.min(self.basis.ncols());
        let basis = self.basis.subcols(0, coordinates);
        let drives = |s: &Sequence| centred(&s.input, &self.mean) * basis;
        let all = || self.sequences.iter().chain(self.mirrored);
        let inputs: Vec<Mat<f64>> = all().map(drives).collect();
        let dynamics = poles.bank(coordinates, self.main_frequency, self.fps).unwrap_or_else(|| {
            let outputs: Vec<Mat<f64>> = all().map(|s| centred(&s.output, &vec![0.0; self.channels])).collect();
            self.identified(&inputs, &outputs, poles)
        });
        let features = inputs.into_iter().map(|u| with_states(&dynamics, u)).collect();
        (dynamics, features)
    }

    /// The same for one joint, with the scale of its inputs.
    fn per_joint(&self, joint: usize, poles: Poles) -> (Dynamics, f64, Vec<Mat<f64>>) {
        let all = || self.sequences.iter().chain(self.mirrored);
        let own = |s: &Sequence| columns(&s.input, self.channels, joint, &self.mean);
        let inputs: Vec<Mat<f64>> = all().map(own).collect();
        let (square, count) =
            inputs.iter().fold((0.0, 0), |(sum, n), u| (sum + u.squared_norm_l2(), n + 3 * u.nrows()));
        let scale = 1.0 / (square / count.max(1) as f64).sqrt().max(STILL);
        let inputs: Vec<Mat<f64>> = inputs.into_iter().map(|u| u * faer::Scale(scale)).collect();
        let dynamics = poles.bank(3, self.main_frequency, self.fps).unwrap_or_else(|| {
            let outputs: Vec<Mat<f64>> = all().map(|s| columns(&s.output, self.channels, joint, &[])).collect();
            self.identified(&inputs, &outputs, poles)
        });
        let features = inputs.into_iter().map(|u| with_states(&dynamics, u)).collect();
        (dynamics, scale, features)
    }

    /// Dynamics found from the data; those without states where `poles` says otherwise.
    fn identified(&self, inputs: &[Mat<f64>], outputs: &[Mat<f64>], poles: Poles) -> Dynamics {
        let Poles::Identified(order) = poles else { return Dynamics::default() };
        let all = self.sequences.iter().chain(self.mirrored);
        let covered: Vec<Range<usize>> = all.map(|s| s.covered.clone()).collect();
        identify::dynamics(inputs, outputs, &covered, order, self.fps)
    }

    /// Moments of all frames, and for each fold those of the training and of the held-back frames.
    fn moments(&self, features: &[Mat<f64>], channels: Range<usize>) -> FoldMoments {
        let shape = Shape { features: features.first().map_or(0, Mat::ncols), channels: channels.len() };
        let stacked: Vec<Mat<f64>> = self
            .sequences
            .iter()
            .chain(self.mirrored)
            .zip(features)
            .map(|(s, features)| {
                let covered = features.subrows(s.covered.start, s.covered.len()).to_owned();
                let pick = |rows: &[f64]| -> Vec<f64> {
                    rows.chunks_exact(self.channels).flat_map(|row| &row[channels.clone()]).copied().collect()
                };
                stack(&covered, &pick(s.covered_input()), &pick(&s.output), channels.len())
            })
            .collect();
        let of =
            |index: usize, range: Range<usize>| Moments::of(shape, stacked[index].subrows(range.start, range.len()));
        let mean = stacked.iter().map(Mat::nrows).sum::<usize>() as f64 / stacked.len().max(1) as f64;
        let counts = |index: usize| if self.alike { mean / stacked[index].nrows().max(1) as f64 } else { 1.0 };
        let mut total = Moments::zero(shape);
        for (index, rows) in stacked.iter().enumerate() {
            total.add(&of(index, 0..rows.nrows()), counts(index));
        }
        let mut train = vec![total.clone(); self.folds];
        let mut held = vec![Moments::zero(shape); self.folds];
        let gap = (GAP * self.fps).round() as usize;
        for (index, range, fold) in &self.segments {
            held[*fold].add(&of(*index, range.clone()), 1.0);
            // Neighbours of a held-back block are nearly copies of it.
            let wide = range.start.saturating_sub(gap)..(range.end + gap).min(stacked[*index].nrows());
            train[*fold].add(&of(*index, wide.clone()), -counts(*index));
            if !self.mirrored.is_empty() {
                let image = self.sequences.len() + index;
                train[*fold].add(&of(image, wide), -counts(image));
            }
        }
        FoldMoments { total, train, held }
    }

    /// Cross-validated RMS joint distance of each candidate, m. Candidates that share their features share the work. `name` tells
    /// this validation from others of the same training.
    pub fn validate(&self, candidates: &[Candidate], cache: &StepCache, name: &str) -> Vec<f64> {
        let mut groups: Vec<(Option<usize>, Poles)> = Vec::new();
        for candidate in candidates {
            let group = (candidate.coordinates, candidate.poles);
            if !groups.contains(&group) {
                groups.push(group);
            }
        }
        let units: Vec<(usize, Unit)> = groups
            .iter()
            .enumerate()
            .flat_map(|(index, (coordinates, _))| {
                let joints = if coordinates.is_some() { 0..0 } else { 0..self.rows() };
                let whole = coordinates.map(|_| (index, Unit::Body));
                whole.into_iter().chain(joints.map(move |joint| (index, Unit::Joint(joint))))
            })
            .collect();
        let frames: usize = self.segments.iter().map(|(_, range, _)| range.len()).sum();
        let mut errors = vec![0.0; candidates.len()];
        let partial: Vec<Vec<(usize, f64)>> = units
            .par_iter()
            .map(|(group, unit)| {
                let (coordinates, poles) = groups[*group];
                let members =
                    || candidates.iter().enumerate().filter(|(_, c)| (c.coordinates, c.poles) == groups[*group]);
                let work = || {
                    let (features, channels) = match unit {
                        Unit::Body => (self.whole_body(coordinates.unwrap_or(0), poles).1, 0..self.channels),
                        Unit::Joint(joint) => (self.per_joint(*joint, poles).2, 3 * joint..3 * joint + 3),
                    };
                    let folds = self.moments(&features, channels.clone());
                    let states =
                        features.first().map_or(0, Mat::ncols) - coordinates.map_or(3, |c| c.min(self.basis.ncols()));
                    let weight = |c: usize| if self.is_travel(channels.start + c) { 0.0 } else { 1.0 };
                    let drives = folds.total.features() - states;
                    let error =
                        |(_, c): (usize, &Candidate)| folds.error(c.base, &c.penalties(states, drives), &weight);
                    members().map(error).collect()
                };
                let errors = cache.always(&format!("{name} {coordinates:?} {poles:?} {unit:?}"), work);
                members().map(|(i, _)| i).zip(errors).collect()
            })
            .collect();
        for (index, error) in partial.into_iter().flatten() {
            errors[index] += error;
        }
        errors.iter().map(|e| (e / (frames.max(1) * self.rows()) as f64).sqrt()).collect()
    }

    /// As [`validate`](Self::validate), for candidates with experts.
    pub fn validate_experts(&self, candidates: &[Candidate], gate: &GateModel) -> Vec<f64> {
        let frames: usize = self.segments.iter().map(|(_, range, _)| range.len()).sum();
        let weight = |c: usize| if self.is_travel(c) { 0.0 } else { 1.0 };
        let error = |candidate: &Candidate| {
            let (dynamics, shared) = self.whole_body(candidate.coordinates.unwrap_or(0), candidate.poles);
            let all = self.expert_features(gate, &shared);
            let penalties = experts::penalties(candidate, gate.clusters(), dynamics.states(), dynamics.inputs);
            let sum = self.moments(&all, 0..self.channels).error(candidate.base, &penalties, &weight);
            (sum / (frames.max(1) * self.rows()) as f64).sqrt()
        };
        candidates.par_iter().map(error).collect()
    }

    fn expert_features(&self, gate: &GateModel, shared: &[Mat<f64>]) -> Vec<Mat<f64>> {
        experts::features(gate, self.sequences.iter().chain(self.mirrored), &self.mean, shared)
    }

    /// What a candidate makes of each sequence when it has not seen the fold it speaks of: coordinates, `[frames x 3 rows]`,
    /// rad or m. Frames without a partner are left to the model of all folds. Experts need the `gate`.
    pub fn held_out(&self, candidate: &Candidate, gate: Option<&GateModel>) -> Option<Vec<Vec<f64>>> {
        let mut predicted: Vec<Vec<f64>> = self.sequences.iter().map(|s| vec![0.0; s.input.len()]).collect();
        match candidate.coordinates {
            Some(coordinates) => {
                let (dynamics, mut features) = self.whole_body(coordinates, candidate.poles);
                let mut penalties = candidate.penalties(dynamics.states(), dynamics.inputs);
                if candidate.experts {
                    let gate = gate?;
                    features = self.expert_features(gate, &features);
                    penalties = experts::penalties(candidate, gate.clusters(), dynamics.states(), dynamics.inputs);
                }
                self.predict_held_out(candidate.base, &penalties, &features, 0..self.channels, &mut predicted)?;
            }
            None => {
                for joint in 0..self.rows() {
                    let (dynamics, _, features) = self.per_joint(joint, candidate.poles);
                    let channels = 3 * joint..3 * joint + 3;
                    let penalties = candidate.penalties(dynamics.states(), dynamics.inputs);
                    self.predict_held_out(candidate.base, &penalties, &features, channels, &mut predicted)?;
                }
            }
        }
        let levers = self.rig.levers();
        predicted
            .iter_mut()
            .flat_map(|p| p.chunks_exact_mut(self.channels))
            .for_each(|row| row.iter_mut().zip(&levers).for_each(|(x, lever)| *x /= lever));
        Some(predicted)
    }

    fn predict_held_out(
        &self,
        base: Base,
        penalties: &[f64],
        features: &[Mat<f64>],
        channels: Range<usize>,
        predicted: &mut [Vec<f64>],
    ) -> Option<()> {
        let folds = self.moments(features, channels.clone());
        let mut predict = |index: usize, frames: Range<usize>, map: &Map| {
            let of = features[index].subrows(frames.start, frames.len()) * &map.weights;
            let input = self.sequences[index].input.chunks_exact(self.channels).skip(frames.start);
            let out = predicted[index].chunks_exact_mut(self.channels).skip(frames.start);
            for ((t, input), out) in (0..frames.len()).zip(input).zip(out) {
                let own = &input[channels.clone()];
                for (channel, out) in out[channels.clone()].iter_mut().enumerate() {
                    let at = channel / 3 * 3;
                    let gains = map.gains[channel / 3][channel % 3].iter().zip(&own[at..at + 3]);
                    *out = map.bias[channel] + gains.map(|(g, u)| g * u).sum::<f64>() + of[(t, channel)];
                }
            }
        };
        let all = folds.total.fit(base, penalties)?;
        for (index, features) in features.iter().enumerate().take(self.sequences.len()) {
            predict(index, 0..features.nrows(), &all);
        }
        let maps: Vec<Option<Map>> = folds.train.iter().map(|m| m.fit(base, penalties)).collect();
        for (index, range, fold) in &self.segments {
            let start = self.sequences[*index].covered.start;
            predict(*index, start + range.start..start + range.end, maps[*fold].as_ref()?);
        }
        Some(())
    }

    /// The model of a candidate with a gate or without one, fitted on all frames; `None` if the data leave it undetermined.
    pub fn fit(&self, candidate: &Candidate, style: &str, gate: Option<GateModel>) -> Option<TranslatorModel> {
        let mut model = TranslatorModel {
            style: style.to_owned(),
            frame_rate: self.fps,
            mean: self.mean.clone(),
            inverse_deviation: vec![1.0; self.channels],
            bias: Vec::with_capacity(self.channels),
            direct: Vec::with_capacity(9 * self.rows()),
            bank: BankModel::PerJoint(Vec::new()),
            timing: TimingModel { input: vec![0.0; self.channels], ..TimingModel::default() },
            strength: [0.0, 1.0],
            gate,
            experts: None,
        };
        match candidate.coordinates {
            Some(coordinates) => self.fit_whole_body(&mut model, candidate, coordinates)?,
            None => self.fit_per_joint(&mut model, candidate)?,
        }
        if let Some(gate) = &mut model.gate {
            gate.normalise(&model.inverse_deviation);
        }
        model.unscale(&self.rig.levers());
        Some(model)
    }

    fn fit_whole_body(&self, model: &mut TranslatorModel, candidate: &Candidate, coordinates: usize) -> Option<()> {
        let (dynamics, features) = self.whole_body(coordinates, candidate.poles);
        let states = dynamics.states();
        let map = match model.gate.as_ref().filter(|_| candidate.experts) {
            Some(gate) => {
                let all = self.expert_features(gate, &features);
                let penalties = experts::penalties(candidate, gate.clusters(), states, dynamics.inputs);
                let map = self.moments(&all, 0..self.channels).total.fit(candidate.base, &penalties)?;
                let (map, experts) = experts::split(map, &dynamics, gate.clusters(), &all)?;
                model.experts = Some(experts);
                map
            }
            None => {
                let total = self.moments(&features, 0..self.channels).total;
                total.fit(candidate.base, &candidate.penalties(states, dynamics.inputs))?
            }
        };
        for joint in 0..self.rows() {
            push_joint(model, &map, joint, &self.mean[3 * joint..3 * joint + 3], 1.0);
        }
        let (of_state, of_input) = dynamics.output_of(&map.weights);
        let timing = self.fit_timing(&features, states)?;
        let (timing_state, timing_input) = dynamics.output_of(&timing.weights);
        model.timing = TimingModel {
            bias: timing.bias[0],
            range: self.durations(),
            input: vec![0.0; self.channels],
            states: [&timing_state[0][..], &timing_input[0]].concat(),
        };
        let basis = self.basis.subcols(0, dynamics.inputs);
        model.bank = BankModel::WholeBody {
            project: (0..dynamics.inputs).flat_map(|p| (0..self.channels).map(move |c| basis[(c, p)])).collect(),
            output: of_state.iter().zip(&of_input).flat_map(|(x, u)| x.iter().chain(u)).copied().collect(),
            transition: dynamics.transition,
            input: dynamics.input,
        };
        Some(())
    }

    fn fit_per_joint(&self, model: &mut TranslatorModel, candidate: &Candidate) -> Option<()> {
        let joints: Vec<Option<(Dynamics, f64, Map)>> = (0..self.rows())
            .into_par_iter()
            .map(|joint| {
                let (dynamics, scale, features) = self.per_joint(joint, candidate.poles);
                let total = self.moments(&features, 3 * joint..3 * joint + 3).total;
                let map = total.fit(candidate.base, &candidate.penalties(dynamics.states(), 3))?;
                Some((dynamics, scale, map))
            })
            .collect();
        let mut bank = Vec::with_capacity(joints.len());
        for (joint, fitted) in joints.into_iter().enumerate() {
            let (dynamics, scale, map) = fitted?;
            push_joint(model, &map, 0, &self.mean[3 * joint..3 * joint + 3], scale);
            model.inverse_deviation[3 * joint..3 * joint + 3].fill(scale);
            let (of_state, of_input) = dynamics.output_of(&map.weights);
            let direct = model.direct.len() - 9;
            for (row, weights) in of_input.iter().enumerate() {
                for (column, weight) in weights.iter().enumerate() {
                    model.direct[direct + 3 * row + column] += weight;
                }
            }
            bank.push(joint_blocks(&dynamics, &of_state));
        }
        model.bank = BankModel::PerJoint(bank);
        let inputs = |s: &Sequence| {
            let centred = centred(&s.input, &self.mean);
            Mat::from_fn(centred.nrows(), self.channels, |t, c| centred[(t, c)] * model.inverse_deviation[c])
        };
        let features: Vec<Mat<f64>> = self.sequences.iter().chain(self.mirrored).map(inputs).collect();
        let timing = self.fit_timing(&features, 0)?;
        model.timing = TimingModel {
            bias: timing.bias[0],
            range: self.durations(),
            input: (0..self.channels).map(|c| timing.weights[(c, 0)]).collect(),
            states: Vec::new(),
        };
        Some(())
    }

    /// log2 of the duration from features; the penalty is chosen by validation, up to "it is constant".
    fn fit_timing(&self, features: &[Mat<f64>], states: usize) -> Option<Map> {
        let of = |s: &Sequence| Sequence {
            channels: 3,
            input: vec![0.0; 3 * (s.input.len() / s.channels)],
            covered: s.covered.clone(),
            output: s.log_duration.iter().flat_map(|d| [*d, 0.0, 0.0]).collect(),
            log_duration: Vec::new(),
            group: s.group,
        };
        let sequences: Vec<Sequence> = self.sequences.iter().map(of).collect();
        let mirrored: Vec<Sequence> = self.mirrored.iter().map(of).collect();
        let clock = Problem {
            sequences: &sequences,
            mirrored: &mirrored,
            channels: 3,
            mean: vec![0.0; 3],
            basis: Mat::zeros(0, 0),
            segments: self.segments.clone(),
            ..*self
        };
        let moments = clock.moments(features, 0..3);
        let static_features = features.first().map_or(0, Mat::ncols) - states;
        let penalties_of =
            |penalty| Candidate { penalty, dynamic_penalty: penalty, ..QUICK }.penalties(states, static_features);
        let weight = |c: usize| if c == 0 { 1.0 } else { 0.0 };
        let error = |penalty: &f64| moments.error(Base::Mean, &penalties_of(*penalty), &weight);
        let penalties = [0.1, 1.0, 10.0, 1e9];
        let best = penalties.into_iter().min_by(|a, b| error(a).total_cmp(&error(b)))?;
        moments.total.fit(Base::Mean, &penalties_of(best))
    }

    fn durations(&self) -> [f64; 2] {
        let all = self.sequences.iter().flat_map(|s| &s.log_duration);
        all.fold([0.0f64, 0.0f64], |[low, high], d| [low.min(*d), high.max(*d)])
    }
}

#[derive(Debug)]
enum Unit {
    Body,
    Joint(usize),
}

/// Bias and direct term of one joint, for inputs `(u - mean) * scale`.
fn push_joint(model: &mut TranslatorModel, map: &Map, joint: usize, mean: &[f64], scale: f64) {
    let gains = &map.gains[joint];
    for (row, gains) in gains.iter().enumerate() {
        let at_mean: f64 = gains.iter().zip(mean).map(|(g, m)| g * m).sum();
        model.bias.push(map.bias[3 * joint + row] + at_mean);
        model.direct.extend(gains.iter().map(|g| g / scale));
    }
}

fn joint_blocks(dynamics: &Dynamics, output: &[Vec<f64>]) -> Vec<[f64; 16]> {
    let blocks = dynamics.transition.iter().enumerate();
    blocks
        .map(|(k, transition)| {
            let mut block = [0.0; 16];
            block[..4].copy_from_slice(transition);
            block[4..10].copy_from_slice(&dynamics.input[6 * k..6 * k + 6]);
            for row in 0..3 {
                block[10 + row] = output[row][2 * k];
                block[13 + row] = output[row][2 * k + 1];
            }
            block
        })
        .collect()
}
