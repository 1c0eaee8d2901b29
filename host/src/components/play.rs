//! Plays a pack of components through the device's own code, frame by frame.

use kinesic::components::{Components, ComponentsState};
use kinesic::model::LoadError;
use kinesic::pose::Controls;
use kinesic::{Pack, Pose};

use crate::rig::MAX_JOINTS;

/// Components that the host steps.
pub const MAX_COMPONENTS: usize = 256;

/// The device's components at the host's capacity.
pub type HostComponents<'a> = Components<'a, MAX_JOINTS, MAX_COMPONENTS>;

/// How a pack is played.
#[derive(Clone, Debug, Default)]
pub struct Settings {
    /// Strength and mask.
    pub controls: Controls<MAX_JOINTS>,
}

/// Restyles the poses of a clip at the pack's frame rate, as on a live stream.
pub fn play(pack: &Pack, source: &[Pose<MAX_JOINTS>], settings: &Settings) -> Result<Vec<Pose<MAX_JOINTS>>, LoadError> {
    let components = HostComponents::load(pack)?;
    let mut state = ComponentsState::new();
    state.controls = settings.controls;
    let step = |pose| {
        let mut styled = Pose::identity();
        components.step(&mut state, pose, &mut styled);
        styled
    };
    Ok(source.iter().map(step).collect())
}

/// Plays the stored stream once, from the origin, facing +Z. Empty where the pack holds none.
pub fn play_stored(pack: &Pack, settings: &Settings) -> Result<Vec<Pose<MAX_JOINTS>>, LoadError> {
    let components = HostComponents::load(pack)?;
    let mut state = ComponentsState::new();
    state.controls = settings.controls;
    let step = |_| {
        let mut styled = Pose::identity();
        components.step_stored(&mut state, &mut styled);
        styled
    };
    Ok((0..components.frames()).map(step).collect())
}
