//! One frame of a pair of skeletons.

use nalgebra::{UnitQuaternion, Vector3};

use super::pair::{Aim, Base, Lay, Pair, Shoulders};
use super::swing;
use crate::clip::Clip;

/// A pose of the clip.
struct Pose {
    positions: Vec<Vector3<f64>>,
    worlds: Vec<UnitQuaternion<f64>>,
}

impl Pair<'_> {
    /// The rig's local rotations of every frame.
    pub fn rotations(&self, clip: &Clip) -> Vec<UnitQuaternion<f64>> {
        let n = self.rig.len();
        let mut out = Vec::with_capacity(clip.frames() * n);
        for frame in 0..clip.frames() {
            let pose =
                Pose { positions: clip.positions(frame), worlds: clip.skeleton.world_rotations(clip.pose(frame)) };
            let worlds = self.worlds(&pose);
            out.extend(self.rig.joints.iter().zip(&worlds).map(|(joint, world)| match joint.parent {
                Some(p) => worlds[p].inverse() * world,
                None => *world,
            }));
        }
        out
    }

    fn worlds(&self, pose: &Pose) -> Vec<UnitQuaternion<f64>> {
        let mut worlds = vec![UnitQuaternion::identity(); self.rig.len()];
        for (world, base) in worlds.iter_mut().zip(&self.bases) {
            match base {
                Base::Partner { joint, align } => *world = pose.worlds[*joint] * align,
                Base::Between { above, below, share, stance } => {
                    let turned = |joint: usize| pose.worlds[joint] * self.rested[joint];
                    let (a, b) = (turned(*above), turned(*below));
                    *world = a.try_slerp(&b, *share, 1e-9).unwrap_or(a) * stance;
                }
                Base::Follow(_) => {}
            }
        }
        for carrier in &self.lays {
            lay(carrier, pose, &mut worlds[carrier.joint]);
        }
        for aim in &self.aims {
            point(aim, pose, &mut worlds);
        }
        self.follow(&mut worlds);
        if let Some(shoulders) = &self.shoulders {
            self.place(shoulders, pose, &mut worlds);
        }
        self.follow(&mut worlds);
        worlds
    }

    /// Joints that go with their parents.
    fn follow(&self, worlds: &mut [UnitQuaternion<f64>]) {
        for (index, base) in self.bases.iter().enumerate() {
            if let Base::Follow(local) = base {
                let above = self.rig.joints[index].parent.map_or_else(UnitQuaternion::identity, |p| worlds[p]);
                worlds[index] = above * local;
            }
        }
    }

    /// Turns the collars until the shoulders lie in the clip's line, as far apart as in the rig's stance, and their middle is as far from
    /// its place in the stance as the clip's is.
    fn place(&self, shoulders: &Shoulders, pose: &Pose, worlds: &mut [UnitQuaternion<f64>]) {
        let [chest, left, right] = shoulders.from;
        let (left, right) = (pose.positions[left], pose.positions[right]);
        let away = (left + right) * 0.5 - pose.positions[chest] - pose.worlds[chest] * shoulders.from_middle;
        let middle = worlds[shoulders.chest] * shoulders.middle + away * shoulders.scale;
        let half = (left - right) * (0.5 * shoulders.width / shoulders.from_width);
        for (collar, side) in shoulders.collars.iter().zip([1.0, -1.0]) {
            let to = middle + half * side - worlds[shoulders.chest] * collar.start;
            let bone = worlds[collar.joint] * collar.bone;
            worlds[collar.joint] = swing(&bone, &to) * worlds[collar.joint];
        }
    }
}

/// Lays the pelvis along the line of the hips, or a chest along that of the shoulders. The bone that is rigid in it then decides how far
/// it is tipped about that line.
fn lay(carrier: &Lay, pose: &Pose, world: &mut UnitQuaternion<f64>) {
    let [left, right] = carrier.from;
    let line = pose.positions[left] - pose.positions[right];
    *world = swing(&(*world * carrier.line), &line) * *world;
    let Some((bone, [from, to])) = carrier.bone else { return };
    let Some(axis) = line.try_normalize(1e-9) else { return };
    let across = |v: Vector3<f64>| v - axis * v.dot(&axis);
    let (own, theirs) = (across(*world * bone), across(pose.positions[to] - pose.positions[from]));
    *world = swing(&own, &theirs) * *world;
}

/// Turns a chain until its end lies where the clip's limb points.
fn point(aim: &Aim, pose: &Pose, worlds: &mut [UnitQuaternion<f64>]) {
    let way = aim.to.place(&pose.positions, &pose.worlds) - pose.positions[aim.from];
    let Some(way) = way.try_normalize(1e-6) else { return };
    let (fixed, turning) = aim.chain.split_at(usize::from(aim.fixed));
    let sum = |bones: &[(usize, Vector3<f64>)]| bones.iter().map(|(k, bone)| worlds[*k] * bone).sum::<Vector3<f64>>();
    let (start, bone) = (sum(fixed), sum(turning));
    // How far out on the limb's line the end can lie, if the start does not lie on it.
    let along = start.dot(&way);
    let out = along + (along * along - start.norm_squared() + bone.norm_squared()).max(0.0).sqrt();
    let turn = swing(&bone, &(way * out - start));
    for (joint, _) in turning {
        worlds[*joint] = turn * worlds[*joint];
    }
}
