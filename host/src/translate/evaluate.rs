//! How well a pack translates: aligned RMS joint distance, beside what simpler models do.

use kinesic::Pack;
use kinesic::model::LoadError;
use serde::Serialize;

use super::baseline;
use super::correspond::OPEN;
use super::play::{Settings, play};
use crate::align::{AlignError, Ends, Series, aligned_distance};
use crate::clip::Clip;
use crate::pack::Baselines;
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

/// Aligned RMS joint distances to the target, cm, heading-local, without horizontal root movement.
///
/// The plain figures match first frame with first and last with last; `open_*` leave up to a third of a clip unmatched at
/// either end, for walks that start on different feet.
#[derive(Clone, Copy, Debug, Default, Serialize)]
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
}

/// Means over the pairs, and every pair.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Means of the pairs.
    #[serde(flatten)]
    pub errors: Errors,
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
pub fn evaluate(pack: &Pack, rig: &Rig, baselines: &Baselines, pairs: &[NamedPair]) -> Result<Report, EvaluateError> {
    let mut reports = Vec::new();
    for pair in pairs {
        let poses = rig.poses(pair.source.1);
        let source = rig.locals(&poses).positions;
        let target = rig.locals(&rig.poses(pair.target.1)).positions;
        let styled = rig.locals(&play(pack, rig, &poses, &Settings::default())?).positions;
        let offset = baseline::apply_offset(baselines, &source);
        let affine = baseline::apply_affine(baselines, &source);
        let distance = |positions: &[f64], ends| -> Result<f64, AlignError> {
            let channels = 3 * rig.joints();
            let found = aligned_distance(Series::new(positions, channels)?, Series::new(&target, channels)?, ends)?;
            Ok(100.0 * found.rms)
        };
        let errors = Errors {
            error_cm: distance(&styled, Ends::Closed)?,
            identity_cm: distance(&source, Ends::Closed)?,
            offset_cm: distance(&offset, Ends::Closed)?,
            affine_cm: distance(&affine, Ends::Closed)?,
            open_error_cm: distance(&styled, OPEN)?,
            open_identity_cm: distance(&source, OPEN)?,
            open_offset_cm: distance(&offset, OPEN)?,
            open_affine_cm: distance(&affine, OPEN)?,
        };
        reports.push(PairReport { source: pair.source.0.to_owned(), target: pair.target.0.to_owned(), errors });
    }
    let mean =
        |of: fn(&Errors) -> f64| reports.iter().map(|p| of(&p.errors)).sum::<f64>() / reports.len().max(1) as f64;
    let errors = Errors {
        error_cm: mean(|e| e.error_cm),
        identity_cm: mean(|e| e.identity_cm),
        offset_cm: mean(|e| e.offset_cm),
        affine_cm: mean(|e| e.affine_cm),
        open_error_cm: mean(|e| e.open_error_cm),
        open_identity_cm: mean(|e| e.open_identity_cm),
        open_offset_cm: mean(|e| e.open_offset_cm),
        open_affine_cm: mean(|e| e.open_affine_cm),
    };
    Ok(Report { errors, pairs: reports })
}
