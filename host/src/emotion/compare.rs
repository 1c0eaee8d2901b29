//! How near the played motions are to recorded ones at the strengths of their labels.

use kinesic::Pack;
use serde::Serialize;

use super::evaluate::{Scorer, mean};
use super::motions::{Example, motions};
use super::play::{Settings, Strengths, play};
use crate::align::{AlignError, Ends};
use crate::clip::Clip;
use crate::measure::{Distance, Measurable, compare};
use crate::quality::Compared;
use crate::rig::RigError;

/// Why motions cannot be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// The pack cannot be played.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// Two motions cannot be compared.
    #[error(transparent)]
    Align(#[from] AlignError),
}

/// Mean distances to the recorded motions, at the best alignment in time. An emotion pack has no source clip: the motion that is
/// the same for all labels stands for doing nothing.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Distances {
    /// The motion at the strengths of the clip's labels (as read from the clip where there is no label).
    pub error: Distance,
    /// The motion at the middle of every range of strengths.
    pub identity: Distance,
    /// Feet, jerk and posture: the middle, the labels, the recorded motions; absent for machines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quality: Option<Compared>,
}

/// Compares every motion of the examples with what the pack plays; none where there is no motion.
pub fn compare_motions(pack: &Pack, scorer: &Scorer, examples: &[Example]) -> Result<Option<Distances>, CompareError> {
    let played = |strengths: Strengths, fps: f64| -> Result<(Measurable, Clip), RigError> {
        let still = Settings { from: strengths, to: strengths, fps, seconds: Some(0.0) };
        let round = f64::from(play(pack, &still)?.round[0]);
        let once = play(pack, &Settings { seconds: Some(round), ..still })?;
        Ok((Measurable::new(&scorer.rig, &once.clip), once.clip))
    };
    let middle = scorer.middle();
    let (mut errors, mut identities, mut quality) = (Vec::new(), Vec::new(), Vec::new());
    let body = scorer.rig.frames().travels();
    for example in examples {
        let cut = motions(&scorer.rig, std::slice::from_ref(example), scorer.cut());
        if cut.is_empty() {
            continue;
        }
        let read = mean(&scorer.read(&example.clip));
        let mut strengths = middle;
        for (index, strength) in strengths.iter_mut().enumerate() {
            let level = example.levels.get(index).copied().flatten().or_else(|| read.get(index).copied());
            *strength = level.map_or(*strength, |level| level as f32);
        }
        let fps = example.clip.fps();
        let ((labelled, made), (plain, unmoved)) = (played(strengths, fps)?, played(middle, fps)?);
        for motion in cut {
            let frames = motion.segment.start..motion.segment.start + motion.segment.frames();
            let clip = example.clip.slice(frames);
            quality.extend(body.then(|| Compared::of(&scorer.rig.map, &unmoved, &made, &clip)));
            let recorded = Measurable::new(&scorer.rig, &clip);
            errors.push(compare(&scorer.rig, &labelled, &recorded, Ends::Closed)?);
            identities.push(compare(&scorer.rig, &plain, &recorded, Ends::Closed)?);
        }
    }
    let distances = Distances {
        error: Distance::mean(errors.iter()),
        identity: Distance::mean(identities.iter()),
        quality: Compared::mean(quality.iter()),
    };
    Ok((!errors.is_empty()).then_some(distances))
}
