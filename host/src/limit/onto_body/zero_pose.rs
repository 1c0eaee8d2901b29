//! How the skeleton stands when all angles of the robot are zero.

use nalgebra::{Isometry3, Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::RobotMap;
use crate::clip::Canonical;
use crate::rig::Rig;
use crate::robot::Robot;

/// Robot joints nearer than this to each other show no direction, m.
const SHORTEST: f64 = 0.02;
/// An axis this near to a bone (cosine) twists it.
const ALONG: f64 = 0.9;

/// Rotation from the robot's root link to the skeleton's world: up to up, forward to where the resting skeleton faces.
pub(super) fn world(map: &RobotMap, rig: &Rig) -> UnitQuaternion<f64> {
    let place = |canonical| {
        let chain = std::iter::successors(rig.map.joint(canonical), |at| rig.skeleton.joints[*at].parent);
        chain.map(|at| rig.skeleton.joints[at].offset).sum::<Vector3<f64>>()
    };
    let across = place(Canonical::LHip) - place(Canonical::RHip);
    // A skeleton whose hips say nothing faces +Z, as the packs' do.
    let left = Vector3::new(across.x, 0.0, across.z).try_normalize(1e-6).unwrap_or_else(Vector3::x);
    let to = Matrix3::from_columns(&[left, Vector3::y(), left.cross(&Vector3::y())]);
    let from = Matrix3::from_columns(&[map.up.cross(&map.forward), map.up, map.forward]);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(to * from.transpose()))
}

/// World rotation of every joint of the skeleton at the robot's zero: each bone between two mapped joints, or whose direction the map
/// gives, is laid along the robot's by the shortest turn; everything else goes with its parent.
///
/// `joints` are the robot's joints of each skeleton joint, from the trunk outwards.
pub(super) fn zero(
    robot: &Robot,
    frames: &[Isometry3<f64>],
    map: &RobotMap,
    rig: &Rig,
    joints: &[Vec<usize>],
) -> Vec<UnitQuaternion<f64>> {
    let to_world = world(map, rig);
    let skeleton = &rig.skeleton;
    let mut turned: Vec<UnitQuaternion<f64>> = Vec::new();
    for (joint, bone) in skeleton.joints.iter().enumerate() {
        let parent = bone.parent.map_or_else(UnitQuaternion::identity, |parent| turned[parent]);
        let given = map.entries.iter().find(|entry| rig_joint(rig, &entry.joint) == Some(joint)).and_then(|e| e.bone);
        let (end, rest) = far_end(rig, joints, joint);
        let seen = end.filter(|_| !map.zero_is_rest).and_then(|end| {
            let place = |at: usize| frames[at].translation.vector;
            let first = *joints[end].first()?;
            // A twist of this bone that the next joint was given: the bone ends at that joint's next hinge.
            let twist = || {
                let start = place(*joints[joint].last()?);
                let near = (place(first) - start).norm() <= SHORTEST;
                let way = joints[end].iter().map(|at| place(*at) - start).find(|way| way.norm() > SHORTEST)?;
                let axis = frames[first].rotation * robot.joints[first].axis;
                (near && way.normalize().dot(&axis).abs() > ALONG).then_some(way)
            };
            let starts = joints[joint].iter().rev().map(|at| place(first) - place(*at));
            twist().or_else(|| starts.into_iter().find(|way| way.norm() > SHORTEST))
        });
        let way = given.or(seen).map(|way| to_world * way);
        turned.push(match (way, rest.try_normalize(1e-6)) {
            (Some(way), Some(rest)) => {
                let from = parent * rest;
                // A bone that points the other way turns about the robot's own axis.
                let half = || {
                    let axis =
                        joints[joint].first().map(|at| to_world * (frames[*at].rotation * robot.joints[*at].axis));
                    let square = axis.unwrap_or_else(Vector3::x);
                    let square = square - from * square.dot(&from);
                    let square = square.try_normalize(1e-3).unwrap_or_else(|| from.cross(&Vector3::new(0.3, 0.5, 0.8)));
                    UnitQuaternion::from_scaled_axis(square.normalize() * std::f64::consts::PI)
                };
                UnitQuaternion::rotation_between(&from, &way).unwrap_or_else(half) * parent
            }
            _ => parent,
        });
    }
    turned
}

/// The one mapped joint that this joint's bones lead to, if it is one, and the way there at rest; else the tip of a leaf.
fn far_end(rig: &Rig, joints: &[Vec<usize>], joint: usize) -> (Option<usize>, Vector3<f64>) {
    let skeleton = &rig.skeleton;
    let (mut ends, mut open) = (Vec::new(), vec![(joint, Vector3::zeros())]);
    while let Some((at, way)) = open.pop() {
        for child in skeleton.children(at) {
            let way: Vector3<f64> = way + skeleton.joints[child].offset;
            if joints[child].is_empty() { open.push((child, way)) } else { ends.push((child, way)) }
        }
    }
    let tip = || {
        let child = skeleton.children(joint).next().map(|child| skeleton.joints[child].offset);
        child.or(skeleton.joints[joint].end).unwrap_or_default()
    };
    match (&ends[..], joints[joint].is_empty()) {
        (&[(end, way)], false) => (Some(end), way),
        _ => (None, tip()),
    }
}

/// Index of a joint by its own or by its canonical name.
pub(super) fn rig_joint(rig: &Rig, name: &str) -> Option<usize> {
    rig.skeleton.find(name).or_else(|| rig.map.joint(Canonical::from_name(name)?))
}
