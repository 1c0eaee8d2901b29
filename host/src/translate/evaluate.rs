//! How well a pack translates: aligned RMS joint distance and mean angle, beside what simpler models do.

use kinesic::Pack;
use kinesic::model::LoadError;
use serde::Serialize;

use super::baseline;
use super::correspond::{Alignment, OPEN};
use super::play::{Settings, play};
use crate::align::{AlignError, Ends};
use crate::clip::Clip;
use crate::measure::turns::Turns;
use crate::measure::{Degrees, Distance, Measurable, compare};
use crate::pack::Baselines;
use crate::quality::Compared;
use crate::rig::Rig;

/// Why an evaluation is impossible.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluateError {
    /// The pack holds no translator, or one that is too large for the host.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// Two clips cannot be compared.
    #[error(transparent)]
    Align(#[from] AlignError),
}

/// Distances to the target: aligned RMS joint distance, cm, heading-local, without horizontal root movement, and mean angles.
///
/// The plain figures match first frame with first and last with last; `open_*` leave up to a third of a clip unmatched at
/// either end, for walks that start on different feet.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Errors {
    /// The pack's output, played through the device's code.
    pub error_cm: f64,
    /// The source itself: doing nothing.
    pub identity_cm: f64,
    /// The source moved by the mean difference of the training pairs.
    pub offset_cm: f64,
    /// The source through the best affine map of each joint on the training pairs.
    pub affine_cm: f64,
    /// As `error_cm`, with open ends.
    pub open_error_cm: f64,
    /// As `identity_cm`, with open ends.
    pub open_identity_cm: f64,
    /// As `offset_cm`, with open ends.
    pub open_offset_cm: f64,
    /// As `affine_cm`, with open ends.
    pub open_affine_cm: f64,
    /// Angles along the paths of the figures in cm.
    pub degrees: Angles,
    /// The same with open ends, without the joints.
    pub open_degrees: Angles,
}

/// Mean angles to the target, degrees.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Angles {
    /// The pack's output.
    pub error: Degrees,
    /// The source itself.
    pub identity: Degrees,
    /// The source turned by the mean differences of the training pairs; absent in packs that do not hold them.
    pub offset: Option<Degrees>,
    /// The source through the best affine map of each joint's rotation vector; absent like `offset`.
    pub affine: Option<Degrees>,
}

/// Distances of the pack's output, the source, the offset and the affine map.
type Distances = [Distance; 4];

impl Errors {
    /// From distances with closed and with open ends; `turns` says whether those of the simpler models know rotations.
    fn new(closed: Distances, open: Distances, turns: bool) -> Self {
        let [error_cm, identity_cm, offset_cm, affine_cm] = closed.each_ref().map(|d| d.cm);
        let [open_error_cm, open_identity_cm, open_offset_cm, open_affine_cm] = open.each_ref().map(|d| d.cm);
        Self {
            error_cm,
            identity_cm,
            offset_cm,
            affine_cm,
            open_error_cm,
            open_identity_cm,
            open_offset_cm,
            open_affine_cm,
            degrees: Angles::new(closed.map(|d| d.degrees), turns),
            open_degrees: Angles::new(open.map(|d| d.degrees.brief()), turns),
        }
    }
}

impl Errors {
    /// The figures by which a pack is judged whose clips correspond so: with open ends for what is in step, since the ends do not match.
    pub fn judged(&self, alignment: Alignment) -> Errors {
        if alignment.ends() == Ends::Closed {
            return self.clone();
        }
        Errors {
            error_cm: self.open_error_cm,
            identity_cm: self.open_identity_cm,
            offset_cm: self.open_offset_cm,
            affine_cm: self.open_affine_cm,
            degrees: self.open_degrees.clone(),
            ..self.clone()
        }
    }
}

impl Angles {
    fn new([error, identity, offset, affine]: [Degrees; 4], turns: bool) -> Self {
        Self { error, identity, offset: turns.then_some(offset), affine: turns.then_some(affine) }
    }
}

/// Errors of one pair.
#[derive(Clone, Debug, Serialize)]
pub struct PairReport {
    /// Source clip.
    pub source: String,
    /// Target clip.
    pub target: String,
    /// Its errors.
    #[serde(flatten)]
    pub errors: Errors,
    /// Feet, jerk and posture of source, result and target; absent for machines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quality: Option<Compared>,
}

/// Means over the pairs, and every pair.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Means of the pairs.
    #[serde(flatten)]
    pub errors: Errors,
    /// Means of the pairs: feet, jerk and posture of source, result and target; absent for machines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quality: Option<Compared>,
    /// Every pair.
    pub pairs: Vec<PairReport>,
}

/// A source and its target, on the pack's rig and at its frame rate, with names for the report.
#[derive(Clone, Copy, Debug)]
pub struct NamedPair<'a> {
    /// Source clip and its name.
    pub source: (&'a str, &'a Clip),
    /// Target clip and its name.
    pub target: (&'a str, &'a Clip),
}

/// Plays every source through the device's code and compares with its target.
///
/// Without `turns` the angles of the simpler models stay out.
pub fn evaluate(
    pack: &Pack,
    rig: &Rig,
    baselines: &Baselines,
    turns: Option<&Turns>,
    pairs: &[NamedPair],
) -> Result<Report, EvaluateError> {
    let (mut closed, mut open, mut quality) = (Vec::new(), Vec::new(), Vec::new());
    let body = rig.frames().travels();
    for pair in pairs {
        let source = Measurable::new(rig, pair.source.1);
        let target = Measurable::new(rig, pair.target.1);
        let styled = play(pack, rig, pair.source.1, &Settings::default())?;
        quality.push(body.then(|| Compared::of(&rig.map, pair.source.1, &styled, pair.target.1)));
        let styled = Measurable::new(rig, &styled);
        let offset = Measurable {
            positions: baseline::apply_offset(baselines, &source.positions),
            rotations: turns.map_or_else(|| source.rotations.clone(), |t| t.offset(&source.rotations)),
        };
        let affine = Measurable {
            positions: baseline::apply_affine(baselines, &source.positions),
            rotations: turns.map_or_else(|| source.rotations.clone(), |t| t.affine(&source.rotations)),
        };
        let distances = |ends| -> Result<Distances, AlignError> {
            let to_target = |motion| compare(rig, motion, &target, ends);
            Ok([to_target(&styled)?, to_target(&source)?, to_target(&offset)?, to_target(&affine)?])
        };
        closed.push(distances(Ends::Closed)?);
        open.push(distances(OPEN)?);
    }
    let mean = |all: &[Distances]| [0, 1, 2, 3].map(|model| Distance::mean(all.iter().map(move |d| &d[model])));
    let errors = Errors::new(mean(&closed), mean(&open), turns.is_some());
    let mean = Compared::mean(quality.iter().flatten());
    let report = |((pair, quality), (closed, open)): ((&NamedPair, _), (Distances, Distances))| PairReport {
        source: pair.source.0.to_owned(),
        target: pair.target.0.to_owned(),
        errors: Errors::new(closed, open, turns.is_some()),
        quality,
    };
    let pairs = pairs.iter().zip(quality).zip(closed.into_iter().zip(open)).map(report).collect();
    Ok(Report { errors, quality: mean, pairs })
}
