//! Reads how strongly clips show something, by the pack's ranking functions; says how well that agrees with labels.

use kinesic::Pack;
use kinesic::model::LoadError;
use serde::Serialize;

use super::features::features;
use super::keyframes::Keyframes;
use super::model::{EmotionModel, Reading};
use super::motions::Example;
use super::play::{Settings, Strengths, play};
use super::segment::{Cut, FRAME_RATE, Segment, cut};
use crate::clip::Clip;
use crate::learn::{Pairs, pair_accuracy, spearman};
use crate::rig::{Rig, RigError};
use crate::vector::dot;

/// Frames of a made motion between two keyframes, at least, when it is read.
const BETWEEN: usize = 8;

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

/// Reads strengths from motions as a pack was trained to: from positions and velocities of the joints, whatever the motion is made of.
#[derive(Debug)]
pub struct Scorer {
    /// Skeleton on which clips must be.
    pub rig: Rig,
    model: EmotionModel,
    keyframes: Keyframes,
}

impl Scorer {
    /// The reader of a pack.
    pub fn load(pack: &Pack) -> Result<Self, ScorerError> {
        let model = EmotionModel::from_pack(pack)?;
        let Reading { parts, postures, .. } = &model.reading;
        let keyframes = Keyframes { parts: parts.clone(), postures: postures.clone() };
        Ok(Self { rig: Rig::from_pack(pack)?, model, keyframes })
    }

    /// Names of the attributes.
    pub fn attributes(&self) -> Vec<String> {
        self.model.attributes.iter().map(|attribute| attribute.name.clone()).collect()
    }

    /// The middle of every range of strengths.
    pub fn middle(&self) -> Strengths {
        let mut middle = Strengths::default();
        for (to, attribute) in middle.iter_mut().zip(&self.model.attributes) {
            *to = attribute.strength[0].midpoint(attribute.strength[1]);
        }
        middle
    }

    /// What of a clip is a motion of the pack.
    pub fn cut(&self) -> Cut {
        if self.model.cycle { Cut::Cycles } else { Cut::Whole }
    }

    /// Strength of every attribute in one motion; `None` if it is shorter than the keyframes.
    pub fn score(&self, motion: &Segment) -> Option<Vec<f64>> {
        let features = features(motion, &self.keyframes)?;
        let Reading { rank, bias, .. } = &self.model.reading;
        Some(rank.chunks_exact(features.len()).zip(bias).map(|(w, bias)| bias + dot(w, &features)).collect())
    }

    /// Strength of every attribute in every motion of a clip (on the rig, at the pack's rate); none without a whole cycle.
    pub fn read(&self, clip: &Clip) -> Vec<Vec<f64>> {
        cut(&self.rig, clip, self.cut()).iter().filter_map(|motion| self.score(motion)).collect()
    }

    /// What is read from the motion that a pack of this reader's makes at strengths: from one round of a cycle.
    pub fn made(&self, pack: &Pack, strength: &Strengths) -> Result<Vec<f64>, RigError> {
        let once = Settings { from: *strength, to: *strength, fps: FRAME_RATE, seconds: Some(0.0) };
        let seconds = f64::from(play(pack, &once)?.round[0]);
        // The last frame is the end.
        let frames = ((seconds * FRAME_RATE).round() as usize).max(BETWEEN * self.model.keyframes);
        let settings = Settings { fps: frames as f64 / seconds, seconds: Some(seconds), ..once };
        let clip = play(pack, &settings)?.clip;
        let motion = Segment::new(&self.rig, &clip, 0..clip.frames());
        Ok(self.score(&motion).unwrap_or_else(|| unreachable!("the motion has more frames than keyframes")))
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
