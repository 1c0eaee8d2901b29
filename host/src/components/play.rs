//! Plays a pack of components through the device's own code, frame by frame.

use kinesic::Pack;
use kinesic::components::{Components, ComponentsState};
use kinesic::engine::Controls;
use kinesic::model::LoadError;

use crate::clip::Clip;
use crate::rig::{HostFrame, MAX_ROWS, Rig};

/// Components that the host steps.
pub const MAX_COMPONENTS: usize = 256;

/// The device's components at the host's capacity.
pub type HostComponents<'a> = Components<'a, MAX_ROWS, MAX_COMPONENTS>;

/// How a pack is played.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Strength and mask.
    pub controls: Controls<MAX_ROWS>,
}

/// Restyles a clip on the pack's rig and at its frame rate, as on a live stream.
pub fn play(pack: &Pack, rig: &Rig, source: &Clip, settings: &Settings) -> Result<Clip, LoadError> {
    let components = HostComponents::load(pack)?;
    let mut state = ComponentsState::new();
    state.controls = settings.controls;
    Ok(rig.play(source, |frame| components.step(&mut state, frame)))
}

/// Plays the stored stream once, from the origin, facing +Z. Empty where the pack holds none. `rig` is the pack's.
pub fn play_stored(pack: &Pack, rig: &Rig, settings: &Settings) -> Result<Clip, LoadError> {
    let components = HostComponents::load(pack)?;
    let mut state = ComponentsState::new();
    state.controls = settings.controls;
    let mut frame = HostFrame::new();
    let step = |_| {
        components.step_stored(&mut state, &mut frame);
        frame
    };
    let frames: Vec<HostFrame> = (0..components.frames()).map(step).collect();
    Ok(rig.clip_of(&frames, 1.0 / f64::from(pack.metadata().frame_rate)))
}
