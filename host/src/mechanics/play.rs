//! The applications on whole clips, through the device's own code.

use kinesic::mechanics::{
    Blend, BodyMechanics, Decoupled, MechanicsState, Modulation, mix as mix_step, modulate as modulate_step,
};
use kinesic::{LoadError, Pack, Pose};
use nalgebra::{UnitQuaternion, Vector3};

use super::dataset::MAX_WINDOW;
use crate::rig::MAX_JOINTS;

/// Units of the hidden layer and the code together that the host steps.
const MAX_UNITS: usize = 2048;

/// The device's model at the host's capacity.
pub type HostMechanics<'a> = BodyMechanics<'a, MAX_JOINTS, MAX_UNITS, MAX_WINDOW>;

type HostPose = Pose<MAX_JOINTS>;
type Parts = Decoupled<MAX_JOINTS>;

/// Every frame in its two parts. Poses are at the pack's frame rate.
pub fn decouple(pack: &Pack, poses: &[HostPose]) -> Result<Vec<Parts>, LoadError> {
    let model = HostMechanics::load(pack)?;
    let mut state = Box::new(MechanicsState::new());
    let mut frames = Vec::with_capacity(poses.len());
    for pose in poses {
        let mut parts = Parts::identity();
        model.step(&mut state, pose, &mut parts);
        frames.push(parts);
    }
    Ok(frames)
}

/// The poses with more or less expression.
pub fn modulate(poses: &[HostPose], parts: &[Parts], modulation: &Modulation<MAX_JOINTS>) -> Vec<HostPose> {
    let mut out = HostPose::identity();
    let mut step = |(pose, parts)| {
        modulate_step(pose, parts, modulation, &mut out);
        out
    };
    poses.iter().zip(parts).map(&mut step).collect()
}

/// The mechanics of one clip with the expression of another, frame for frame, as long as both last.
pub fn mix(mechanics: &[Parts], expressive: &[Parts], modulation: &Modulation<MAX_JOINTS>) -> Vec<HostPose> {
    let mut out = HostPose::identity();
    let mut step = |(a, b)| {
        mix_step(a, b, modulation, &mut out);
        out
    };
    mechanics.iter().zip(expressive).map(&mut step).collect()
}

/// How the second clip of a blend is brought to the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Frame of the first clip with which the second one begins.
    pub start: usize,
    /// Frame of the first clip at which the second one is moved and turned to where the first is.
    pub meet: usize,
}

/// Two clips blended, mechanics and expression in windows of their own (frames of the first clip). Before the second begins
/// its first frame is held, after the first has ended its last.
pub fn blend(first: &[Parts], second: &[Parts], blend: &Blend, overlap: Overlap) -> Vec<HostPose> {
    let (Some(last_a), Some(last_b)) = (first.last(), second.last()) else { return Vec::new() };
    let of_second = |frame: usize| second.get(frame.saturating_sub(overlap.start)).unwrap_or(last_b);
    let (a, b) = (first.get(overlap.meet).unwrap_or(last_a), of_second(overlap.meet));
    let turn = yaw(&a.mechanics) * yaw(&b.mechanics).inverse();
    let shift = level(a.mechanics.root) - turn * level(b.mechanics.root);
    let frames = first.len().max(overlap.start + second.len());
    let mut out = HostPose::identity();
    let step = |frame: usize| {
        let mut moved = *of_second(frame);
        moved.mechanics.root = turn * moved.mechanics.root + shift;
        moved.mechanics.rotations[0] = turn * moved.mechanics.rotations[0];
        blend.step(frame as f32, first.get(frame).unwrap_or(last_a), &moved, &mut out);
        out
    };
    (0..frames).map(step).collect()
}

fn level(v: Vector3<f32>) -> Vector3<f32> {
    Vector3::new(v.x, 0.0, v.z)
}

/// The hips' turn about the vertical.
fn yaw(pose: &HostPose) -> UnitQuaternion<f32> {
    let forward = pose.rotations[0] * Vector3::z();
    UnitQuaternion::from_axis_angle(&Vector3::y_axis(), forward.x.atan2(forward.z))
}
