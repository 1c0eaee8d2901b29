//! How far a style can be exaggerated before the motion stops being one.

use kinesic::Pack;
use kinesic::model::LoadError;

use super::play::{Settings, play};
use crate::clip::Clip;
use crate::plausible::{Bounds, Plausible};
use crate::rig::Rig;

/// Largest strength that is tried.
const LIMIT: f64 = 3.0;
/// Sources that are played at each strength: so many, evenly chosen, say what all do.
const PLAYED: usize = 12;

/// Strengths in steps of a quarter at which the training sources stay within what sources and targets do: see [`Bounds`].
pub fn plausible(pack: &Pack, rig: &Rig, sources: &[&Clip], targets: &[&Clip]) -> Result<Plausible, LoadError> {
    let bounds = Bounds::new(rig, sources.iter().copied(), targets.iter().copied());
    let step = sources.len().div_ceil(PLAYED).max(1);
    let played = |strength: f64| {
        let mut settings = Settings::default();
        settings.controls.strength = strength as f32;
        sources.iter().step_by(step).map(|clip| play(pack, rig, clip, &settings)).collect()
    };
    bounds.largest(rig, LIMIT, played)
}
