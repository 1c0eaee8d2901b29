//! The two bones of a leg, bent so that the ankle is moved.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::model::Leg;
use crate::kernel::sqrt;
use crate::pose::{Pose, Skeleton, unit};

/// Parts of its length at which a leg begins to resist, and to which it is stretched at most: at full stretch a knee snaps.
const STRETCH: [f32; 2] = [0.98, 0.999];
/// Way over which a leg that was stretched farther, or bent to the wrong side, gives that up, m.
const GIVES_UP: f32 = 0.01;
/// Distance of a knee from the line between hip and ankle, in lengths of the leg, at which it is as sure of its side as its axis is.
const SURE: f32 = 0.05;
/// Weight of a frame in the mean of a knee's axis.
const NEW: f32 = 0.02;

/// A leg of a pose: hip, knee and ankle against the root, world axes, m.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bones {
    hip: Vector3<f32>,
    knee: Vector3<f32>,
    ankle: Vector3<f32>,
    thigh_turned: UnitQuaternion<f32>,
}

impl Bones {
    pub fn of<const JOINTS: usize>(skeleton: &Skeleton, leg: &Leg, pose: &Pose<JOINTS>) -> Self {
        let at = |joint| skeleton.point(pose, joint, Vector3::zeros());
        let thigh_turned = skeleton.turned(pose, leg.hip);
        Self { hip: at(leg.hip), knee: at(leg.knee), ankle: at(leg.ankle), thigh_turned }
    }

    /// The mean axis about which the knee bends, one frame later; `axis` is 0 before the first.
    pub fn learn(&self, axis: &mut Vector3<f32>) {
        let bends = (self.knee - self.hip).cross(&(self.ankle - self.knee));
        let bends = self.thigh_turned.inverse() * bends;
        *axis = if *axis == Vector3::zeros() { bends } else { *axis + (bends - *axis) * NEW };
    }

    /// Bends the leg so that its ankle is moved by `way`, m, as far as the leg reaches. The foot keeps its rotation in the world. The knee
    /// keeps its side; the straighter it is, the more its axis decides. Cost: about 500 multiply-adds, 15 roots.
    pub fn reach<const JOINTS: usize>(
        &self,
        skeleton: &Skeleton,
        leg: &Leg,
        axis: &Vector3<f32>,
        way: Vector3<f32>,
        pose: &mut Pose<JOINTS>,
    ) {
        let Self { hip, knee, ankle, thigh_turned } = *self;
        let (thigh, shin) = (norm(knee - hip), norm(ankle - knee));
        let (old, new) = (ankle - hip, ankle + way - hip);
        let (was, wanted, length) = (norm(old), norm(new), thigh + shin);
        if !(was > 1e-3 * length && wanted > 1e-3 * length) {
            return;
        }
        let (old, aim) = (old * (1.0 / was), new * (1.0 / wanted));
        let moved = norm(way) * (1.0 / GIVES_UP);
        let kept = 1.0 / (1.0 + moved * moved);
        let beyond = (was - resisted(was, length)) * kept;
        let distance = (resisted(wanted, length) + beyond).max(1.02 * (thigh - shin).abs()).max(1e-3 * length);
        // The knee's side goes with the leg.
        let swing = arc(old, aim);
        let axis = unit_vector(*axis).unwrap_or_else(Vector3::zeros);
        let sure = SURE * length * (1.0 - kept);
        let side = swing * (knee - hip) + aim.cross(&(swing * (thigh_turned * axis))) * sure;
        let Some(side) = unit_vector(side - aim * side.dot(&aim)) else { return };
        let along = (thigh * thigh - shin * shin + distance * distance) / (2.0 * distance);
        let bent = hip + aim * along + side * sqrt((thigh * thigh - along * along).max(0.0));
        let end = hip + aim * distance;
        let at_hip = arc(knee - hip, bent - hip);
        let at_knee = arc(ankle - knee, end - bent);
        let [at_hip, at_knee, at_ankle] =
            [(leg.hip, at_hip), (leg.knee, at_hip.inverse() * at_knee), (leg.ankle, at_knee.inverse())].map(
                |(joint, turn)| {
                    let turned = skeleton.turned(pose, joint);
                    (joint, turned.inverse() * turn * turned)
                },
            );
        for (joint, turn) in [at_hip, at_knee, at_ankle] {
            if let Some(local) = pose.rotations.get_mut(usize::from(joint)) {
                *local = unit((*local * turn).into_inner());
            }
        }
    }
}

/// A distance from hip to ankle that a leg of this length resists: as it is at first, then ever less of it.
fn resisted(distance: f32, length: f32) -> f32 {
    let [begin, end] = STRETCH.map(|part| part * length);
    let (beyond, room) = (distance - begin, end - begin);
    if beyond <= 0.0 { distance } else { end - room * room / (beyond + room) }
}

/// The smallest turn from one direction to another; none between opposite ones.
fn arc(from: Vector3<f32>, to: Vector3<f32>) -> UnitQuaternion<f32> {
    let (Some(from), Some(to)) = (unit_vector(from), unit_vector(to)) else { return UnitQuaternion::identity() };
    let axis = from.cross(&to);
    unit(Quaternion::new(1.0 + from.dot(&to), axis.x, axis.y, axis.z))
}

fn unit_vector(v: Vector3<f32>) -> Option<Vector3<f32>> {
    let norm = norm(v);
    (norm > 1e-9).then(|| v * (1.0 / norm))
}

pub(super) fn norm(v: Vector3<f32>) -> f32 {
    sqrt(v.dot(&v))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEG: Leg = Leg { hip: 1, knee: 2, ankle: 3, joint: 4, tip: Vector3::new(0.0, 0.0, 0.0) };
    const PARENTS: [u16; 5] = [0, 0, 1, 2, 3];
    const OFFSETS: [[f32; 3]; 5] =
        [[0.0; 3], [0.1, -0.05, 0.0], [0.0, -0.42, 0.0], [0.0, -0.41, 0.0], [0.0, -0.06, 0.14]];

    fn skeleton() -> Skeleton<'static> {
        Skeleton::new(&PARENTS, &OFFSETS, &[]).unwrap()
    }

    fn bent(knee: f32) -> Pose<5> {
        let mut pose = Pose::identity();
        pose.rotations[0] = UnitQuaternion::from_euler_angles(0.1, 0.7, -0.05);
        pose.rotations[1] = UnitQuaternion::from_euler_angles(-0.3 - 0.5 * knee, 0.1, 0.05);
        pose.rotations[2] = UnitQuaternion::from_euler_angles(knee, 0.0, 0.0);
        pose.rotations[3] = UnitQuaternion::from_euler_angles(0.2, -0.1, 0.0);
        pose
    }

    fn at(pose: &Pose<5>, joint: u16) -> Vector3<f32> {
        skeleton().point(pose, joint, Vector3::zeros())
    }

    fn moved(from: &Pose<5>, way: Vector3<f32>) -> Pose<5> {
        let (mut pose, mut axis) = (*from, Vector3::zeros());
        let bones = Bones::of(&skeleton(), &LEG, from);
        bones.learn(&mut axis);
        bones.reach(&skeleton(), &LEG, &axis, way, &mut pose);
        pose
    }

    #[test]
    fn the_foot_arrives_and_keeps_its_rotation_and_the_hip_stays() {
        for knee in [0.6, 1.0, 1.6] {
            let from = bent(knee);
            for way in [Vector3::new(0.02, 0.03, -0.05), Vector3::new(-0.04, 0.0, 0.06), Vector3::new(0.0, 0.08, 0.0)] {
                let to = moved(&from, way);
                for joint in [3, 4] {
                    assert!((at(&to, joint) - at(&from, joint) - way).norm() < 2e-3, "{knee}: {way}");
                }
                assert_eq!([at(&to, 1), to.root], [at(&from, 1), from.root]);
                let [was, is] = [&from, &to].map(|pose| skeleton().turned(pose, 3));
                assert!(was.angle_to(&is) < 1e-3);
            }
        }
    }

    #[test]
    fn a_place_out_of_reach_is_aimed_at_and_the_knee_does_not_snap() {
        let from = bent(0.4);
        let to = moved(&from, Vector3::new(0.0, -3.0, 0.0));
        let reached = (at(&to, 3) - at(&to, 1)).norm();
        assert!((0.82..0.83).contains(&reached), "{reached}");
        // A leg that is straight already: a small way moves it a little.
        let straight = bent(0.0);
        let little = moved(&straight, Vector3::new(0.0, 0.001, 0.0));
        assert!((at(&little, 2) - at(&straight, 2)).norm() < 0.03);
        // No way is no change, to rounding.
        let same = moved(&from, Vector3::zeros());
        assert!((1..4).all(|joint| same.rotations[joint].angle_to(&from.rotations[joint]) < 1e-3));
    }

    #[test]
    fn whatever_the_way_rotations_stay_rotations() {
        for knee in [-1.0, 0.0, 1.0, 3.0] {
            for way in [0.0, 1e-30, 1e-3, 0.4, 0.83, 1e3, 1e6] {
                for way in [Vector3::new(way, 0.0, 0.0), Vector3::new(0.0, way, -way), Vector3::new(-way, -way, way)] {
                    let to = moved(&bent(knee), way);
                    assert!(to.is_sound(5), "{knee}: {way}: {to:?}");
                }
            }
        }
    }
}
