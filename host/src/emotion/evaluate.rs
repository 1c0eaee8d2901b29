//! Reads how strongly clips show something, by the device's ranking functions; says how well that agrees with labels.

use kinesic::Pack;
use kinesic::model::LoadError;
use nalgebra::{Quaternion, UnitQuaternion};
use serde::Serialize;

use super::features::{Projection, features};
use super::keyframes::Keyframes;
use super::model::{EmotionModel, HostEmotion};
use super::motions::Example;
use super::play::Strengths;
use super::segment::{Cut, Segment, cut};
use crate::clip::Clip;
use crate::learn::{Pairs, pair_accuracy, spearman};
use crate::rig::{Rig, RigError};

/// Why a pack cannot read motions.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScorerError {
    /// It holds no emotion model, or a damaged one.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// Its skeleton cannot be a rig.
    #[error(transparent)]
    Rig(#[from] RigError),
}

/// Reads strengths from motions as a pack was trained to.
#[derive(Debug)]
pub struct Scorer<'a> {
    /// Skeleton on which clips must be.
    pub rig: Rig,
    device: HostEmotion<'a>,
    keyframes: Keyframes,
    projection: Projection,
    cut: Cut,
}

impl<'a> Scorer<'a> {
    /// The reader of a pack.
    pub fn load(pack: &Pack<'a>) -> Result<Self, ScorerError> {
        let device = HostEmotion::load(pack)?;
        let rig = Rig::from_pack(pack)?;
        let model = EmotionModel::from_pack(pack)?;
        let rotation = |[i, j, k, w]: &[f32; 4]| UnitQuaternion::new_normalize(Quaternion::new(*w, *i, *j, *k).cast());
        let keyframes = Keyframes::new(&rig, model.parts.clone(), model.reference.iter().map(rotation).collect());
        let cut = if model.cycle { Cut::Cycles } else { Cut::Whole };
        Ok(Self { projection: model.projection(), rig, device, keyframes, cut })
    }

    /// Names of the attributes.
    pub fn attributes(&self) -> Vec<String> {
        self.device.meta().attributes.iter().flatten().map(|attribute| attribute.name.to_owned()).collect()
    }

    /// The middle of every range of strengths.
    pub fn middle(&self) -> Strengths {
        let mut middle = Strengths::default();
        for (to, attribute) in middle.iter_mut().zip(self.device.meta().attributes.iter().flatten()) {
            *to = attribute.strength[0].midpoint(attribute.strength[1]);
        }
        middle
    }

    /// What of a clip is a motion of the pack.
    pub fn cut(&self) -> Cut {
        self.cut
    }

    /// Components `[keyframes x components]` of a motion; `None` if it is shorter than the keyframes.
    pub fn coordinates(&self, motion: &Segment) -> Option<Vec<f64>> {
        Some(self.projection.coordinates(&features(motion, &self.keyframes)?))
    }

    /// Strength of every attribute in every motion of a clip (on the rig, at the pack's rate); none without a whole cycle.
    pub fn read(&self, clip: &Clip) -> Vec<Vec<f64>> {
        let attributes = self.device.attributes();
        let score = |motion: Segment| {
            let coordinates: Vec<f32> = self.coordinates(&motion)?.iter().map(|x| *x as f32).collect();
            Some(self.device.score(&coordinates).iter().take(attributes).map(|x| f64::from(*x)).collect())
        };
        cut(&self.rig, clip, self.cut).into_iter().filter_map(score).collect()
    }
}

/// Mean strength of every attribute over the motions of a clip; empty where there are none.
pub fn mean(motions: &[Vec<f64>]) -> Vec<f64> {
    let attributes = motions.first().map_or(0, Vec::len);
    let of = |attribute: usize| motions.iter().map(|row| row[attribute]).sum::<f64>() / motions.len() as f64;
    (0..attributes).map(of).collect()
}

/// How well strengths agree with labels. NaN, `null` in JSON, where there is no pair.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Clips looked at.
    pub clips: usize,
    /// Motions in them.
    pub motions: usize,
    /// Clips without a motion.
    pub unread: Vec<String>,
    /// Pairs of clips of one group with different levels, of all attributes.
    pub pairs: usize,
    /// Share of these pairs whose strengths are in the order of the levels; a tie counts half.
    pub pair_accuracy: f64,
    /// Spearman's rank correlation of strength and level, the attributes' mean.
    pub spearman: f64,
    /// Attribute by attribute.
    pub attributes: Vec<AttributeReport>,
}

/// The same for one attribute.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AttributeReport {
    /// Name.
    pub attribute: String,
    /// Clips with a level.
    pub labelled: usize,
    /// Pairs of clips.
    pub pairs: usize,
    /// Share of the pairs in the right order.
    pub pair_accuracy: f64,
    /// Rank correlation over all clips with a level.
    pub spearman: f64,
}

/// Measures a pack on labelled clips; `examples` have the pack's attributes in its order.
pub fn evaluate(scorer: &Scorer, examples: &[Example]) -> Report {
    let read: Vec<Vec<Vec<f64>>> = examples.iter().map(|example| scorer.read(&example.clip)).collect();
    let one = |(index, name): (usize, String)| {
        let known = examples.iter().zip(&read).filter_map(|(example, motions)| {
            Some((example.levels.get(index).copied()??, *mean(motions).get(index)?, example.group))
        });
        let known: Vec<(f64, f64, usize)> = known.collect();
        let levels: Vec<Option<f64>> = known.iter().map(|(level, ..)| Some(*level)).collect();
        let scores: Vec<f64> = known.iter().map(|(_, score, _)| *score).collect();
        let groups: Vec<usize> = known.iter().map(|(.., group)| *group).collect();
        let pairs = Pairs::of_levels(&levels, &groups, 0.0).ordered;
        AttributeReport {
            attribute: name,
            labelled: known.len(),
            pairs: pairs.len(),
            pair_accuracy: pair_accuracy(&scores, &pairs),
            spearman: spearman(&known.iter().map(|(level, ..)| *level).collect::<Vec<_>>(), &scores),
        }
    };
    let attributes: Vec<AttributeReport> = scorer.attributes().into_iter().enumerate().map(one).collect();
    let pairs: usize = attributes.iter().map(|report| report.pairs).sum();
    let right =
        |report: &AttributeReport| if report.pairs > 0 { report.pair_accuracy * report.pairs as f64 } else { 0.0 };
    let unread = examples.iter().zip(&read).filter(|(_, motions)| motions.is_empty());
    Report {
        clips: examples.len(),
        motions: read.iter().map(Vec::len).sum(),
        unread: unread.map(|(example, _)| example.name.clone()).collect(),
        pairs,
        pair_accuracy: attributes.iter().map(right).sum::<f64>() / pairs as f64,
        spearman: attributes.iter().map(|report| report.spearman).sum::<f64>() / attributes.len() as f64,
        attributes,
    }
}
