//! What a pack of components does, measured through the device's code.

use kinesic::Pack;
use kinesic::kernel::ROWS;
use kinesic::model::LoadError;
use serde::Serialize;

use super::degrees::{Degrees, degrees};
use super::matrix::FRAME_RATE;
use super::measure::jerk;
use super::play::{HostComponents, Settings, play_stored};
use crate::pack::Metric;
use crate::rig::Rig;

/// Why an evaluation is impossible.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluateError {
    /// The pack holds no components, or more than the host steps.
    #[error(transparent)]
    Load(#[from] LoadError),
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
    pub degrees_before: Degrees,
    /// Angles from the restyled content to the style, matched alike (recorded).
    pub degrees_after: Degrees,
    /// Number of components.
    pub components: usize,
    /// Share of the joint groups of the content components that are not zero.
    pub density: f64,
    /// `|C_C - C_X| / |C_C|`.
    pub content_distance: f64,
    /// Mean distance of a joint's heading-local positions in the stored stream at strength 1 from those at strength 0, cm.
    pub moved_cm: f64,
    /// Mean angles between the same two.
    pub moved_degrees: Degrees,
    /// Jerk of the stored stream at strength 1 over that at strength 0.
    pub jerk_ratio: f64,
    /// Mean size of the third derivative of the joints' heading-local positions at strength 1, m/s^3.
    pub jerk: f64,
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
    if components.frames() == 0 {
        return Err(EvaluateError::NoStream);
    }
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
        let tiles: &[[f32; ROWS]] = pack.slice(name, channels.div_ceil(ROWS) * count)?;
        let at = |r: usize, k: usize| f64::from(tiles[r / ROWS * count + k][r % ROWS]);
        Ok((0..channels).flat_map(|r| (0..count).map(move |k| (r, k))).map(|(r, k)| at(r, k)).collect())
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

    let mut settings = Settings::default();
    let styled = play_stored(pack, rig, &settings)?;
    settings.controls.strength = 0.0;
    let plain = play_stored(pack, rig, &settings)?;
    let moved_degrees = degrees(rig, &styled.iter().zip(&plain).collect::<Vec<_>>());
    let [styled, plain] = [styled, plain].map(|poses| rig.locals(&poses).positions);
    let jerks = [&styled, &plain].map(|positions| jerk(positions, 3 * rig.joints(), FRAME_RATE));
    let joints = styled.as_chunks::<3>().0.iter().zip(plain.as_chunks::<3>().0);
    let moved: f64 = joints.map(|(a, b)| (0..3).map(|c| (a[c] - b[c]).powi(2)).sum::<f64>().sqrt()).sum();
    Ok(Report {
        reconstruction_error,
        style_distance,
        degrees_before: Degrees { all: before, leaves: leaves_before },
        degrees_after: Degrees { all: after, leaves: leaves_after },
        components: count,
        density,
        content_distance: norm(&change) / norm(&content).max(1e-300),
        moved_cm: 100.0 * moved / (plain.len() / 3).max(1) as f64,
        moved_degrees,
        jerk_ratio: jerks[0] / jerks[1].max(1e-300),
        jerk: jerks[0],
    })
}
