//! What a pack of components does, measured through the device's code.

use kinesic::Pack;
use kinesic::model::LoadError;
use serde::Serialize;

use super::matrix::FRAME_RATE;
use super::measure::jerk;
use super::play::{HostComponents, Settings, play_stored};
use crate::align::{AlignError, Ends};
use crate::clip::Clip;
use crate::measure::{Distance, Measurable, compare, compare_frames};
use crate::pack::Metric;
use crate::pack::layout::row_major;
use crate::quality::Compared;
use crate::rig::Rig;

/// Why an evaluation is impossible.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluateError {
    /// The pack holds no components, or more than the host steps.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// Two motions cannot be compared.
    #[error(transparent)]
    Align(#[from] AlignError),
    /// There is nothing to play.
    #[error("the pack holds no stored stream of weights: train it again with this release")]
    NoStream,
    /// A figure that needs the training clips is missing.
    #[error("the pack does not record {name}: train it again with this release")]
    NoMetric {
        /// Which.
        name: &'static str,
    },
}

/// Figures of a pack. Those that need the training clips were recorded by the training; the others are measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// `|M - W C| / |M|` of the content clip (recorded).
    pub reconstruction_error: f64,
    /// `|Gram(C_S) - Gram(C_X)| / |Gram(C_S)|` (recorded).
    pub style_distance: f64,
    /// Angles from the content to the style, frames matched by dynamic time warping (recorded).
    pub degrees_before: RecordedDegrees,
    /// Angles from the restyled content to the style, matched alike (recorded).
    pub degrees_after: RecordedDegrees,
    /// Number of components.
    pub components: usize,
    /// Share of the joint groups of the content components that are not zero.
    pub density: f64,
    /// `|C_C - C_X| / |C_C|`.
    pub content_distance: f64,
    /// Jerk of the stored stream at strength 1 over that at strength 0.
    pub jerk_ratio: f64,
    /// Mean size of the third derivative of the joints' heading-local positions at strength 1, m/s^3.
    pub jerk: f64,
    /// How far strength 1 takes the stored stream from strength 0, frame for frame.
    pub change: Distance,
}

/// Mean angles that a training recorded, degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RecordedDegrees {
    /// Over all joints.
    pub all: f64,
    /// Over the joints from which no other joint hangs: head, hands, feet.
    pub leaves: f64,
}

/// How far the stored stream is from a clip, at the best alignment in time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ToClip {
    /// At strength 1.
    pub error: Distance,
    /// At strength 0: doing nothing.
    pub identity: Distance,
    /// Feet, jerk and posture: strength 0, strength 1, the clip; absent for machines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quality: Option<Compared>,
}

/// Plays the stored stream with and without the style and compares both with a clip on the rig at [`FRAME_RATE`].
pub fn to_clip(pack: &Pack, rig: &Rig, clip: &Clip) -> Result<ToClip, EvaluateError> {
    let (target, [styled, plain]) = (Measurable::new(rig, clip), streams(pack, rig)?);
    let to_target = |motion: &Clip| compare(rig, &Measurable::new(rig, motion), &target, Ends::Closed);
    let quality = rig.frames().travels().then(|| Compared::of(&rig.map, &plain, &styled, clip));
    Ok(ToClip { error: to_target(&styled)?, identity: to_target(&plain)?, quality })
}

/// The stored stream at strength 1 and at strength 0.
fn streams(pack: &Pack, rig: &Rig) -> Result<[Clip; 2], EvaluateError> {
    if HostComponents::load(pack)?.frames() == 0 {
        return Err(EvaluateError::NoStream);
    }
    let mut settings = Settings::default();
    let styled = play_stored(pack, rig, &settings)?;
    settings.controls.strength = 0.0;
    Ok([styled, play_stored(pack, rig, &settings)?])
}

/// Names under which the training records what [`evaluate`] cannot measure.
pub const RECORDED: [&str; 6] = [
    "reconstruction_error",
    "style_distance",
    "degrees_before",
    "leaf_degrees_before",
    "degrees_after",
    "leaf_degrees_after",
];

/// Plays the stored stream and measures it.
pub fn evaluate(pack: &Pack, rig: &Rig, recorded: &[Metric]) -> Result<Report, EvaluateError> {
    let components = HostComponents::load(pack)?;
    let [styled, plain] = streams(pack, rig)?.map(|clip| Measurable::new(rig, &clip));
    let find = |name: &'static str| {
        recorded.iter().find(|m| m.name == name).map(|m| m.value).ok_or(EvaluateError::NoMetric { name })
    };
    let mut found = [0.0; RECORDED.len()];
    for (to, name) in found.iter_mut().zip(RECORDED) {
        *to = find(name)?;
    }
    let [reconstruction_error, style_distance, before, leaves_before, after, leaves_after] = found;
    let (count, channels) = (components.meta().count as usize, 3 * rig.rows());
    let matrix = |name| -> Result<Vec<f64>, LoadError> {
        Ok(row_major(pack, name, channels, count)?.into_iter().map(f64::from).collect())
    };
    let (content, change) = (matrix("components/compose")?, matrix("components/change")?);
    let levers = rig.levers();
    // Coordinates count by their levers, as in the training.
    let norm = |values: &[f64]| {
        let rows = values.chunks_exact(count.max(1)).zip(&levers);
        rows.flat_map(|(row, lever)| row.iter().map(move |x| (x * lever).powi(2))).sum::<f64>().sqrt()
    };
    let moved = |(row, k): (usize, usize)| (0..3).any(|c| content[(3 * row + c) * count + k] != 0.0);
    let groups = (0..rig.rows()).flat_map(|row| (0..count).map(move |k| (row, k)));
    let density = groups.filter(|group| moved(*group)).count() as f64 / (rig.rows() * count).max(1) as f64;

    let jerks = [&styled, &plain].map(|motion| jerk(&motion.positions, 3 * rig.joints(), FRAME_RATE));
    Ok(Report {
        reconstruction_error,
        style_distance,
        degrees_before: RecordedDegrees { all: before, leaves: leaves_before },
        degrees_after: RecordedDegrees { all: after, leaves: leaves_after },
        components: count,
        density,
        content_distance: norm(&change) / norm(&content).max(1e-300),
        jerk_ratio: jerks[0] / jerks[1].max(1e-300),
        jerk: jerks[0],
        change: compare_frames(rig, &styled, &plain),
    })
}
