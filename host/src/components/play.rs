//! Plays a pack of components through the device's own code, frame by frame.

use kinesic::Pack;
use kinesic::components::{Components, ComponentsState};
use kinesic::engine::Controls;
use kinesic::model::LoadError;

use crate::clip::Clip;
use crate::rig::{HostFrame, MAX_ROWS, Rig};
use crate::strength::Curve;

/// Components that the host steps.
pub const MAX_COMPONENTS: usize = 256;

/// The device's components at the host's capacity.
pub type HostComponents<'a> = Components<'a, MAX_ROWS, MAX_COMPONENTS>;

/// How a pack is played.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Strength and mask.
    pub controls: Controls<MAX_ROWS>,
    /// A strength that changes while the motion plays, instead of that of `controls`.
    pub curve: Option<Curve>,
}

impl Settings {
    fn strength(&self, frame: usize, frame_time: f64) -> f32 {
        self.curve.as_ref().map_or(self.controls.strength, |curve| curve.at(frame as f64 * frame_time))
    }
}

/// Restyles a clip on the pack's rig and at its frame rate, as on a live stream.
pub fn play(pack: &Pack, rig: &Rig, source: &Clip, settings: &Settings) -> Result<Clip, LoadError> {
    let components = HostComponents::load(pack)?;
    let mut state = ComponentsState::new();
    state.controls = settings.controls;
    let mut played = 0;
    Ok(rig.play(source, |frame| {
        state.controls.strength = settings.strength(played, source.frame_time);
        played += 1;
        components.step(&mut state, frame);
    }))
}

/// Plays the stored stream once, from the origin, facing +Z. Empty where the pack holds none. `rig` is the pack's.
pub fn play_stored(pack: &Pack, rig: &Rig, settings: &Settings) -> Result<Clip, LoadError> {
    let components = HostComponents::load(pack)?;
    let mut state = ComponentsState::new();
    state.controls = settings.controls;
    let mut frame = HostFrame::new();
    let frame_time = 1.0 / f64::from(pack.metadata().frame_rate);
    let step = |at| {
        state.controls.strength = settings.strength(at, frame_time);
        components.step_stored(&mut state, &mut frame);
        frame
    };
    let frames: Vec<HostFrame> = (0..components.frames()).map(step).collect();
    Ok(rig.clip_of(&frames, frame_time))
}
