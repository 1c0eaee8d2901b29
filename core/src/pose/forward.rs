//! Forward kinematics.

use nalgebra::{UnitQuaternion, Vector3};

use super::{Pose, Skeleton};

/// Where every joint is and how it is turned, in the world.
#[derive(Clone, Copy, Debug)]
pub struct World<const JOINTS: usize> {
    /// Position of each joint, m.
    pub positions: [Vector3<f32>; JOINTS],
    /// Rotation of each joint's frame.
    pub rotations: [UnitQuaternion<f32>; JOINTS],
}

impl<const JOINTS: usize> World<JOINTS> {
    /// Everything at the origin.
    pub fn identity() -> Self {
        Self { positions: [Vector3::zeros(); JOINTS], rotations: [UnitQuaternion::identity(); JOINTS] }
    }

    /// The frame of the parent of joint `joint`; for the root, the world with the origin at `root`.
    pub(super) fn parent(&self, joint: usize, parent: u16, root: Vector3<f32>) -> (Vector3<f32>, UnitQuaternion<f32>) {
        match (joint, self.positions.get(parent as usize), self.rotations.get(parent as usize)) {
            (1.., Some(position), Some(rotation)) => (*position, *rotation),
            _ => (root, UnitQuaternion::identity()),
        }
    }
}

/// Position and rotation of every joint. Cost: about 45 multiply-adds a joint.
pub fn forward<const JOINTS: usize>(skeleton: &Skeleton, pose: &Pose<JOINTS>, world: &mut World<JOINTS>) {
    for (joint, ((parent, offset), local)) in
        skeleton.parents.iter().zip(skeleton.offsets).zip(&pose.rotations).enumerate()
    {
        let (origin, turned) = world.parent(joint, *parent, pose.root);
        let offset = if joint == 0 { Vector3::zeros() } else { Vector3::from(*offset) };
        if let (Some(position), Some(rotation)) = (world.positions.get_mut(joint), world.rotations.get_mut(joint)) {
            *position = origin + turned * offset;
            *rotation = turned * local;
        }
    }
}
