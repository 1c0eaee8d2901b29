//! A styled clip whose feet are held as the device holds them.

use kinesic::model::LoadError;
use kinesic::{Feet, FeetState, Pack};

use crate::clip::Clip;
use crate::rig::Rig;

/// Holds feet through the device's own code, frame by frame, where the feet of `source` stand. Both clips are on the pack's rig, at its frame
/// rate, frame for frame.
pub fn live(pack: &Pack, rig: &Rig, source: &Clip, styled: &Clip) -> Result<Clip, LoadError> {
    let feet = Feet::load(pack)?;
    let mut state = FeetState::new();
    let mut held = rig.poses(styled);
    for (source, out) in rig.poses(source).iter().zip(&mut held) {
        feet.step(&mut state, Some(source), out);
    }
    Ok(rig.clip(&held, styled.frame_time))
}
