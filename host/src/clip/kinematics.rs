//! Forward kinematics on the host, in f64, and sign continuity of quaternions.

use nalgebra::{UnitQuaternion, Vector3};

use super::{Clip, Skeleton};

impl Skeleton {
    /// Positions `[joints]` in m of the rest pose: all rotations identity, the root at the origin.
    pub fn rest_positions(&self) -> Vec<Vector3<f64>> {
        let rotations = vec![UnitQuaternion::identity(); self.len()];
        self.pose_positions(&Vector3::zeros(), &rotations)
    }

    /// World positions `[joints]` in m of one pose: root position and local rotations `[joints]`.
    ///
    /// `p_j = p_parent + G_parent offset_j`, `G_j = G_parent R_j`. One quaternion product and one rotation a joint.
    pub fn pose_positions(&self, root: &Vector3<f64>, rotations: &[UnitQuaternion<f64>]) -> Vec<Vector3<f64>> {
        let mut worlds = Vec::with_capacity(self.len());
        self.pose_worlds(root, rotations, &mut worlds);
        worlds.into_iter().map(|(position, _)| position).collect()
    }

    /// World positions and rotations of one pose, in place of what `worlds` held.
    pub(super) fn pose_worlds(
        &self,
        root: &Vector3<f64>,
        rotations: &[UnitQuaternion<f64>],
        worlds: &mut Vec<(Vector3<f64>, UnitQuaternion<f64>)>,
    ) {
        worlds.clear();
        for (joint, local) in self.joints.iter().zip(rotations) {
            let world = match joint.parent.and_then(|p| worlds.get(p)) {
                Some((position, rotation)) => (position + rotation * joint.offset, rotation * local),
                None => (*root, *local),
            };
            worlds.push(world);
        }
    }

    /// World rotations `[joints]` of one pose of local rotations `[joints]`.
    pub fn world_rotations(&self, rotations: &[UnitQuaternion<f64>]) -> Vec<UnitQuaternion<f64>> {
        let mut worlds: Vec<UnitQuaternion<f64>> = Vec::with_capacity(self.len());
        for (joint, local) in self.joints.iter().zip(rotations) {
            let parent = joint.parent.and_then(|p| worlds.get(p));
            worlds.push(parent.map_or(*local, |p| p * local));
        }
        worlds
    }
}

impl Clip {
    /// World positions `[joints]` of one frame, m; empty when there is no such frame.
    pub fn positions(&self, frame: usize) -> Vec<Vector3<f64>> {
        match self.root.get(frame) {
            Some(root) => self.skeleton.pose_positions(root, self.pose(frame)),
            None => Vec::new(),
        }
    }

    /// World positions of all frames, m, row-major `[frames x joints]`.
    pub fn all_positions(&self) -> Vec<Vector3<f64>> {
        (0..self.frames()).flat_map(|f| self.positions(f)).collect()
    }

    /// Chooses between q and -q, which are the same rotation, so that each joint's quaternion never jumps: w >= 0 in the
    /// first frame, then always the nearer of the two.
    pub fn make_signs_continuous(&mut self) {
        let n = self.skeleton.len();
        for at in 0..self.rotations.len() {
            let flip = match at.checked_sub(n) {
                Some(before) => self.rotations[at].coords.dot(&self.rotations[before].coords) < 0.0,
                None => self.rotations[at].w < 0.0,
            };
            if flip {
                let negated = -self.rotations[at].into_inner();
                self.rotations[at] = UnitQuaternion::new_unchecked(negated);
            }
        }
    }
}
