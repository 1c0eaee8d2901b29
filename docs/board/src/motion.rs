//! Where poses come from and go to. Here: a body that swings its legs and arms; on a board: sensors and servos.

use kinesic::Pose;
use kinesic::kernel::sin_cos;
use kinesic::nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Frames that are played.
pub const FRAMES: u32 = 180;

/// Frames that the radio loses.
const LOST: core::ops::Range<u32> = 97..101;

// Joints of the pack, in the order in which `kinesic inspect` prints them.
const LEFT_THIGH: usize = 1;
const RIGHT_THIGH: usize = 5;
const LEFT_ARM: usize = 13;
const RIGHT_ARM: usize = 16;

/// The pose of a frame, if it came: one stride in a second, one metre a second forward.
pub fn read_pose(frame: u32) -> Option<Pose<19>> {
    if LOST.contains(&frame) {
        return None;
    }
    let time = frame as f32 / 60.0;
    let (swing, _) = sin_cos(time * core::f32::consts::TAU);
    let mut pose = Pose::identity();
    pose.root = Vector3::new(0.0, 0.95, time);
    for (joint, angle) in [(LEFT_THIGH, -0.4), (RIGHT_THIGH, 0.4), (LEFT_ARM, 0.4), (RIGHT_ARM, -0.4)] {
        // Half the angle, about the axis to the left.
        let (sin, cos) = sin_cos(0.5 * angle * swing);
        if let Some(rotation) = pose.rotations.get_mut(joint) {
            *rotation = UnitQuaternion::new_unchecked(Quaternion::new(cos, sin, 0.0, 0.0));
        }
    }
    Some(pose)
}

/// How far the left arm is turned about the axis to the left, milliradians (small angles: twice the half angle's sine).
pub fn arm(pose: &Pose<19>) -> i32 {
    pose.rotations.get(LEFT_ARM).map_or(0, |rotation| (2000.0 * rotation.i) as i32)
}
