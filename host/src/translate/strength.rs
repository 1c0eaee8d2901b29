//! How far a style can be exaggerated before the motion stops being one.

use kinesic::Pack;
use kinesic::model::LoadError;

use super::play::{Settings, play};
use crate::clip::Clip;
use crate::rig::{Locals, Rig};

/// Largest strength that is tried.
const LIMIT: f64 = 3.0;
/// The fastest joint may be this many times faster than the fastest of the training clips.
const SPEED_UP: f64 = 1.5;

/// Strengths at which no joint moves (heading-local) more than 1.5 times faster than the fastest of the training clips:
/// `[0, largest]`, in steps of a quarter, at least 1.
pub fn plausible(pack: &Pack, rig: &Rig, sources: &[&Clip], targets: &[&Clip]) -> Result<[f64; 2], LoadError> {
    let fastest =
        |clips: &mut dyn Iterator<Item = &Clip>| clips.map(|c| top_speed(&rig.locals_of(c))).fold(0.0, f64::max);
    let bound = SPEED_UP * fastest(&mut sources.iter().chain(targets).copied());
    let mut largest = 1.0;
    while largest < LIMIT {
        let mut settings = Settings::default();
        settings.controls.strength = (largest + 0.25) as f32;
        let styled = sources.iter().map(|clip| play(pack, rig, clip, &settings)).collect::<Result<Vec<_>, _>>()?;
        if fastest(&mut styled.iter()) > bound {
            break;
        }
        largest += 0.25;
    }
    Ok([0.0, largest])
}

/// Fastest joint of all frames but the few of the start, m a frame.
fn top_speed(locals: &Locals) -> f64 {
    let channels = locals.channels();
    let (before, after) = (locals.positions.chunks_exact(channels), locals.positions.chunks_exact(channels).skip(1));
    let steps = before.zip(after).flat_map(|(a, b)| {
        a.as_chunks::<3>()
            .0
            .iter()
            .zip(b.as_chunks::<3>().0)
            .map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt())
    });
    steps.fold(0.0, f64::max)
}
