//! Plays a pack of components through the device's own code, frame by frame.

use kinesic::components::{Components, ComponentsState};
use kinesic::engine::Controls;
use kinesic::model::LoadError;
use kinesic::rig::Drift;
use kinesic::{Pack, Pose};

use crate::rig::{HostFrame, MAX_JOINTS, MAX_ROWS, Rig};

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

/// Restyles the poses of a clip at the pack's frame rate, as on a live stream. `rig` is the pack's.
pub fn play(
    pack: &Pack,
    rig: &Rig,
    source: &[Pose<MAX_JOINTS>],
    settings: &Settings,
) -> Result<Vec<Pose<MAX_JOINTS>>, LoadError> {
    let components = HostComponents::load(pack)?;
    let mut state = ComponentsState::new();
    state.controls = settings.controls;
    Ok(rig.restyle(source, |frame| components.step(&mut state, frame)))
}

/// Plays the stored stream once, from the origin, facing +Z. Empty where the pack holds none. `rig` is the pack's.
pub fn play_stored(pack: &Pack, rig: &Rig, settings: &Settings) -> Result<Vec<Pose<MAX_JOINTS>>, LoadError> {
    let components = HostComponents::load(pack)?;
    let device = rig.frames();
    let mut state = ComponentsState::new();
    state.controls = settings.controls;
    let (mut frame, mut drift) = (HostFrame::new(), Drift::new());
    let zero = rig.zero_pose();
    let step = |_| {
        let mut pose = zero;
        components.step_stored(&mut state, &mut frame);
        device.show(&frame, &frame, &mut drift, &mut pose);
        pose
    };
    Ok((0..components.frames()).map(step).collect())
}
