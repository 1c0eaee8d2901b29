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

impl Skeleton<'_> {
    /// Where a point of a joint's frame is against the root joint, in the world's axes, m: what [`forward`] says of a joint, without all others.
    /// Cost: about 20 multiply-adds for each joint from there to the root.
    pub(crate) fn point<const JOINTS: usize>(
        &self,
        pose: &Pose<JOINTS>,
        joint: u16,
        mut point: Vector3<f32>,
    ) -> Vector3<f32> {
        self.ancestors(joint, |joint, offset| {
            point = pose.rotations.get(joint).map_or(point, |rotation| rotation * point);
            point += offset;
        });
        point
    }

    /// How a joint's frame is turned in the world. Cost: 16 multiply-adds for each joint from there to the root.
    pub(crate) fn turned<const JOINTS: usize>(&self, pose: &Pose<JOINTS>, joint: u16) -> UnitQuaternion<f32> {
        let mut turned = UnitQuaternion::identity();
        self.ancestors(joint, |joint, _| turned = pose.rotations.get(joint).map_or(turned, |local| local * turned));
        turned
    }

    /// A joint and those above it, each with the way to it from its parent; the root's is none.
    pub(crate) fn ancestors(&self, joint: u16, mut visit: impl FnMut(usize, Vector3<f32>)) {
        let mut joint = usize::from(joint);
        while let (1.., Some(parent), Some(offset)) = (joint, self.parents.get(joint), self.offsets.get(joint)) {
            visit(joint, Vector3::from(*offset));
            // Smaller, as was checked.
            joint = usize::from(*parent);
        }
        visit(0, Vector3::zeros());
    }

    /// True if `above` is on the way from `joint` to the root, and not `joint` itself.
    pub(crate) fn is_above(&self, above: u16, joint: u16) -> bool {
        let mut found = false;
        self.ancestors(joint, |ancestor, _| found |= ancestor == usize::from(above));
        found && above != joint
    }
}
