//! A motion through the limits of its pack, as the last stage of the device would pass it on.

use kinesic::limit::SmoothLimitState;
use kinesic::model::LoadError;
use kinesic::{Pack, Rig as DeviceRig};
use serde::Serialize;

use super::HostLimiter;
use crate::clip::Clip;
use crate::rig::{MAX_ROWS, Rig};

/// What limits did to a motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Clamps {
    /// Frames of the motion.
    pub frames: usize,
    /// Frames in which a coordinate did not go where it was told.
    pub clamped_frames: u32,
    /// The joints that did not, and in how many frames each.
    pub joints: Vec<JointClamps>,
}

/// One joint's.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct JointClamps {
    /// Its name.
    pub joint: String,
    /// Frames in which it was told to go beyond its range.
    pub position: usize,
    /// Frames in which it was too slow.
    pub rate: usize,
}

/// The motion within the limits of the pack, from where its first frame is; `None` if the pack has no limits. `rig` is the pack's.
pub fn play(pack: &Pack, rig: &Rig, clip: &Clip) -> Result<Option<(Clip, Clamps)>, LoadError> {
    let limiter = match HostLimiter::load(pack) {
        Err(LoadError::NoModel { .. }) => return Ok(None),
        limiter => limiter?,
    };
    let mut state = Box::new(SmoothLimitState::<MAX_ROWS>::new());
    let mut joints: Vec<JointClamps> = Vec::new();
    joints.extend(
        rig.skeleton.joints.iter().map(|joint| JointClamps { joint: joint.name.clone(), ..Default::default() }),
    );
    let mut started = false;
    let limited = rig.play(clip, |frame| {
        if !std::mem::replace(&mut started, true) {
            limiter.start(&mut state, frame);
        }
        limiter.step(&mut state, frame);
        count(&rig.frames(), &state, &mut joints);
    });
    let clamped_frames = state.report().clamped_frames;
    joints.retain(|joint| joint.position + joint.rate > 0);
    Ok(Some((limited, Clamps { frames: clip.frames(), clamped_frames, joints })))
}

fn count(rig: &DeviceRig, state: &SmoothLimitState<MAX_ROWS>, joints: &mut [JointClamps]) {
    for ((kind, first), joint) in rig.places().zip(joints) {
        let own = || (first..first + kind.coordinates()).filter_map(|at| state.clamped(at));
        joint.position += usize::from(own().any(|clamped| clamped.position));
        joint.rate += usize::from(own().any(|clamped| clamped.rate));
    }
}
