//! A trained translator, in f64, and how it goes into a pack.

use kinesic::model::{Form, Kind, ModelMeta, TranslatorMeta};

use super::gate::GateModel;
use crate::pack::{PackWriter, Provenance};
use crate::rig::Rig;

/// A trained translator. Shapes and units are those of [`kinesic::translate`]; matrices are row-major.
#[derive(Clone, Debug)]
pub struct TranslatorModel {
    /// Name of the style.
    pub style: String,
    /// Frames per second.
    pub frame_rate: f64,
    /// Input mean, rad or m, `[3 rows]`.
    pub mean: Vec<f64>,
    /// 1 / input deviation, `[3 rows]`; 0 for a channel that never moved.
    pub inverse_deviation: Vec<f64>,
    /// Output at the mean input, `[3 rows]`.
    pub bias: Vec<f64>,
    /// Direct term of each row, `[rows x 9]`.
    pub direct: Vec<f64>,
    /// The dynamic part.
    pub bank: BankModel,
    /// The clock.
    pub timing: TimingModel,
    /// Plausible strengths.
    pub strength: [f64; 2],
    /// What it knows of its training: bodies only.
    pub gate: Option<GateModel>,
    /// Output stages of several actions, one a cluster of the gate.
    pub experts: Option<ExpertModel>,
}

/// Output stages of low rank. Matrices are row-major.
#[derive(Clone, Debug)]
pub struct ExpertModel {
    /// Directions in which they write.
    pub rank: usize,
    /// `rank x (states + drives)` of each expert.
    pub input: Vec<f64>,
    /// `rank` of each expert.
    pub bias: Vec<f64>,
    /// `[3 rows x rank]`.
    pub output: Vec<f64>,
}

/// The dynamic part of a translator.
#[derive(Clone, Debug)]
pub enum BankModel {
    /// One model per row (a ball, or up to three servos), any number of blocks each, as [`kinesic::kernel::JointBlock`].
    PerJoint(Vec<Vec<[f64; 16]>>),
    /// One model for all.
    WholeBody {
        /// `[drives x 3 rows]`.
        project: Vec<f64>,
        /// 2 x 2 blocks.
        transition: Vec<[f64; 4]>,
        /// `[states x drives]`.
        input: Vec<f64>,
        /// `[3 rows x (states + drives)]`.
        output: Vec<f64>,
    },
}

/// log2 of the styled frames a source frame lasts, linear in the normalised input and (whole body) the states.
#[derive(Clone, Debug, Default)]
pub struct TimingModel {
    /// Value at the mean input.
    pub bias: f64,
    /// Lowest and highest value allowed.
    pub range: [f64; 2],
    /// `[3 rows]`.
    pub input: Vec<f64>,
    /// `[states + drives]`, empty in the per-joint form.
    pub states: Vec<f64>,
}

impl TranslatorModel {
    /// Rows of coordinates.
    pub fn rows(&self) -> usize {
        self.mean.len() / 3
    }

    /// A model that was fitted on coordinates times `levers`, for coordinates.
    pub(super) fn unscale(&mut self, levers: &[f64]) {
        self.mean.iter_mut().zip(levers).for_each(|(mean, lever)| *mean /= lever);
        self.inverse_deviation.iter_mut().zip(levers).for_each(|(inverse, lever)| *inverse *= lever);
        self.bias.iter_mut().zip(levers).for_each(|(bias, lever)| *bias /= lever);
        for (row, lever) in self.direct.chunks_exact_mut(3).zip(levers) {
            row.iter_mut().for_each(|gain| *gain /= lever);
        }
        match &mut self.bank {
            BankModel::PerJoint(bank) => {
                for (blocks, levers) in bank.iter_mut().zip(levers.chunks_exact(3)) {
                    for block in blocks {
                        (0..6).for_each(|entry| block[10 + entry] /= levers[entry % 3]);
                    }
                }
            }
            BankModel::WholeBody { output, .. } => {
                let columns = output.len() / levers.len();
                for (row, lever) in output.chunks_exact_mut(columns.max(1)).zip(levers) {
                    row.iter_mut().for_each(|weight| *weight /= lever);
                }
            }
        }
        if let Some(gate) = &mut self.gate {
            gate.coarse.iter_mut().zip(levers).for_each(|(coarse, lever)| *coarse /= lever);
        }
        if let Some(experts) = &mut self.experts {
            for (row, lever) in experts.output.chunks_exact_mut(experts.rank).zip(levers) {
                row.iter_mut().for_each(|weight| *weight /= lever);
            }
        }
    }

    /// Inputs of the shared model, 0 in the per-joint form.
    fn drives(&self) -> usize {
        match &self.bank {
            BankModel::PerJoint(_) => 0,
            BankModel::WholeBody { project, .. } => project.len().checked_div(self.mean.len()).unwrap_or(0),
        }
    }

    fn meta(&self) -> TranslatorMeta<'_> {
        let (form, blocks) = match &self.bank {
            BankModel::PerJoint(bank) => (Form::PerJoint, bank.iter().map(Vec::len).sum()),
            BankModel::WholeBody { transition, .. } => (Form::WholeBody, transition.len()),
        };
        TranslatorMeta {
            style: &self.style,
            form,
            blocks: blocks as u32,
            drives: self.drives() as u32,
            strength: self.strength.map(|x| x as f32),
        }
    }

    /// The model as a pack for `rig`.
    pub fn pack(&self, rig: &Rig, provenance: &Provenance) -> Vec<u8> {
        let mut pack = PackWriter::new(Kind::Translator, &self.style, self.frame_rate as f32);
        rig.write(&mut pack);
        pack.model(&ModelMeta::Translator(self.meta()));
        pack.f32s("translate/mean", 3, &single(&self.mean));
        pack.f32s("translate/inverse_deviation", 3, &single(&self.inverse_deviation));
        pack.f32s("translate/bias", 3, &single(&self.bias));
        pack.f32s("translate/direct", 9, &single(&self.direct));
        let [low, high] = self.timing.range;
        pack.f32s("translate/timing", 3, &single(&[self.timing.bias, low, high]));
        pack.f32s("translate/timing_input", 1, &single(&self.timing.input));
        pack.f32s("translate/timing_states", 1, &single(&self.timing.states));
        if let Some(gate) = &self.gate {
            pack.tiled("translate/gate_project", self.mean.len(), &single(&gate.project));
            pack.f32s("translate/gate_speed", 1, &single(&gate.speed));
            pack.f32s("translate/gate_centres", 2, &single(gate.centres.as_flattened()));
            pack.f32s("translate/gate_rates", 4, &single(&gate.rates));
            pack.f32s("translate/gate_coarse", 3, &single(&gate.coarse));
        }
        if let Some(experts) = &self.experts {
            let columns = experts.input.len() / experts.bias.len().max(1);
            pack.tiled("translate/expert_input", columns, &single(&experts.input));
            pack.f32s("translate/expert_bias", 1, &single(&experts.bias));
            pack.tiled("translate/expert_output", experts.rank, &single(&experts.output));
        }
        match &self.bank {
            BankModel::PerJoint(bank) => {
                let counts: Vec<u16> = bank.iter().map(|blocks| blocks.len() as u16).collect();
                pack.u16s("translate/blocks_per_joint", 1, &counts);
                pack.f32s("translate/joint_blocks", 16, &single(bank.concat().as_flattened()));
            }
            BankModel::WholeBody { project, transition, input, output } => {
                let states = 2 * transition.len();
                pack.f32s("translate/transition", 4, &single(transition.as_flattened()));
                pack.tiled("translate/project", self.mean.len(), &single(project));
                pack.tiled("translate/input", self.drives(), &single(input));
                pack.tiled("translate/output", states + self.drives(), &single(output));
            }
        }
        pack.finish(provenance)
    }
}

fn single(values: &[f64]) -> Vec<f32> {
    values.iter().map(|x| *x as f32).collect()
}
