//! From the numbers of a frame to rotations and positions.

use nalgebra::{UnitQuaternion, Vector3};

use super::euler;
use super::fields::Channel;
use super::hierarchy::RawJoint;

/// Frames in file units: the rotations of all joints, row-major `[frames x joints]`, and where joints with position channels are.
pub(super) struct Rows {
    pub rotations: Vec<UnitQuaternion<f64>>,
    /// Empty for a joint without position channels.
    pub positions: Vec<Vec<Vector3<f64>>>,
    pub frames: usize,
}

impl Rows {
    /// No frames, with room for so many.
    pub(super) fn new(joints: &[RawJoint], room: usize) -> Rows {
        let moved = |joint: &RawJoint| joint.channels.iter().any(|c| matches!(c, Channel::Position(_)));
        Rows {
            rotations: Vec::with_capacity(room * joints.len()),
            positions: joints.iter().map(|j| Vec::with_capacity(if moved(j) { room } else { 0 })).collect(),
            frames: 0,
        }
    }

    /// Adds a frame of the numbers of its channels.
    pub(super) fn push(&mut self, joints: &[RawJoint], mut values: impl Iterator<Item = f64>) {
        for (joint, track) in joints.iter().zip(&mut self.positions) {
            let (mut position, mut moved) = (joint.offset, false);
            let mut rotation = UnitQuaternion::identity();
            for (channel, value) in joint.channels.iter().zip(&mut values) {
                match *channel {
                    Channel::Position(axis) => (position[axis], moved) = (value, true),
                    Channel::Rotation(axis) => rotation = euler::then_about_axis(&rotation, axis, value),
                    Channel::Unused(_) => {}
                }
            }
            if moved {
                track.push(position);
            }
            self.rotations.push(rotation);
        }
        self.frames += 1;
    }

    /// Adds the frames of others behind these.
    pub(super) fn extend(&mut self, other: &Rows) {
        self.rotations.extend_from_slice(&other.rotations);
        for (track, more) in self.positions.iter_mut().zip(&other.positions) {
            track.extend_from_slice(more);
        }
        self.frames += other.frames;
    }
}
