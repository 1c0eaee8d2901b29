//! Skeletons of the same joints.

use nalgebra::{UnitQuaternion, Vector3};

use super::NO_BONE;
use crate::clip::solve::turn;
use crate::clip::{Clip, Skeleton};

/// Whether two skeletons have the same joints in the same order.
pub(crate) fn same_joints(a: &Skeleton, b: &Skeleton) -> bool {
    a.joints.len() == b.joints.len()
        && a.joints.iter().zip(&b.joints).all(|(a, b)| a.name == b.name && a.parent == b.parent)
}

/// Bones of two skeletons that differ in direction by less rest alike, rad.
const ALIKE: f64 = 2e-3;

/// Whether the bones of two skeletons with the same joints point the same way at rest.
pub(super) fn same_rest(a: &Skeleton, b: &Skeleton) -> bool {
    let alike = |a: &Vector3<f64>, b: &Vector3<f64>| a.norm() < NO_BONE || b.norm() < NO_BONE || a.angle(b) < ALIKE;
    a.joints
        .iter()
        .zip(&b.joints)
        .all(|(a, b)| alike(&a.offset, &b.offset) && a.end.zip(b.end).is_none_or(|(a, b)| alike(&a, &b)))
}

/// Rotations that lay the rig's bones where the clip's are: `G_rig = G_clip A`, where `A` turns the rig's bones at a joint into the clip's
/// by the smallest turn. A joint without bones goes with its parent.
pub(super) fn corrected(clip: &Clip, rig: &Skeleton) -> Vec<UnitQuaternion<f64>> {
    let mut turns: Vec<UnitQuaternion<f64>> = Vec::new();
    for (index, joint) in rig.joints.iter().enumerate() {
        let own = &clip.skeleton.joints;
        let tips = joint.end.zip(own[index].end);
        let bones = rig.children(index).map(|c| (rig.joints[c].offset, own[c].offset)).chain(tips);
        let pairs: Vec<_> = bones.filter(|(a, b)| a.norm() > NO_BONE && b.norm() > NO_BONE).collect();
        let above = joint.parent.map_or_else(UnitQuaternion::identity, |p| turns[p]);
        // From the parent's turn on: a straight limb that hangs otherwise turns as a whole.
        let started: Vec<_> = pairs.iter().map(|(a, b)| (above * a, *b)).collect();
        turns.push(if pairs.is_empty() { above } else { nearest(&pairs, &started, above) });
    }
    let n = rig.len();
    let mut out = Vec::with_capacity(clip.rotations.len());
    for frame in 0..clip.frames() {
        for (index, local) in clip.pose(frame).iter().enumerate().take(n) {
            let above = rig.joints[index].parent.map_or_else(UnitQuaternion::identity, |p| turns[p]);
            out.push(above.inverse() * local * turns[index]);
        }
    }
    out
}

/// The turn of a joint: none where its own bones rest alike, else what its parent's turn leaves to do.
fn nearest(
    pairs: &[(Vector3<f64>, Vector3<f64>)],
    started: &[(Vector3<f64>, Vector3<f64>)],
    above: UnitQuaternion<f64>,
) -> UnitQuaternion<f64> {
    match pairs.iter().all(|(a, b)| a.angle(b) < ALIKE) {
        true => UnitQuaternion::identity(),
        false => turn(started) * above,
    }
}
