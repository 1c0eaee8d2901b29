//! The root's path, and the height at which the feet stand.

use nalgebra::{UnitQuaternion, Vector3};

use super::leg_length;
use crate::clip::{Canonical, Clip, JointMap, Skeleton};
use crate::rig::Rig;

/// The share of the frames in which the lowest point of the feet is taken to be at the floor or under it.
const FLOOR: f64 = 0.05;
/// Feet that are no higher above the floor stand on it, m.
const STANDS: f64 = 0.02;
/// Feet are no deeper under the floor, m.
const UNDER: f64 = 0.008;
/// A clip is lifted no further for feet that are deeper, m: what needs more is a fault of the recording.
const LIFTED: f64 = 0.035;

/// How much longer the rig's legs are. Legs that differ by less than a tenth of a millimetre in a metre are the same legs.
pub(crate) fn longer(clip: &Clip, map: &JointMap, rig: &Rig) -> f64 {
    let scale = leg_length(&rig.skeleton, &rig.map) / leg_length(&clip.skeleton, map);
    if scale.is_finite() && (scale - 1.0).abs() > 1e-4 { scale } else { 1.0 }
}

/// The path of a body that differs by its size at most: that of the pelvis, scaled.
pub(super) fn scaled(clip: &Clip, map: &JointMap, rig: &Rig) -> Vec<Vector3<f64>> {
    let scale = longer(clip, map, rig);
    let pelvis = map.joint(Canonical::Pelvis).filter(|&p| p > 0 && rig.map.joint(Canonical::Pelvis) == Some(0));
    match pelvis {
        Some(pelvis) => (0..clip.frames()).map(|f| clip.positions(f)[pelvis] * scale).collect(),
        None => clip.root.iter().map(|p| p * scale).collect(),
    }
}

/// The path on which the middle of the hips follows the clip's, scaled from the clip's floor up, and one height for the whole clip with
/// which the feet stand on that floor.
pub(super) fn standing(clip: &Clip, map: &JointMap, rig: &Rig, turns: &[UnitQuaternion<f64>]) -> Vec<Vector3<f64>> {
    let hips = |map: &JointMap| map.joint(Canonical::LHip).zip(map.joint(Canonical::RHip));
    let (Some(theirs), Some(own)) = (hips(map), hips(&rig.map)) else { return scaled(clip, map, rig) };
    let scale = longer(clip, map, rig);
    let n = rig.skeleton.len();
    let (from_feet, to_feet) = (feet(&clip.skeleton, map), feet(&rig.skeleton, &rig.map));
    let (mut before, mut after) = (Vec::with_capacity(clip.frames()), Vec::with_capacity(clip.frames()));
    let mut path = Vec::with_capacity(clip.frames());
    for (frame, pose) in turns.chunks_exact(n).enumerate() {
        let positions = clip.positions(frame);
        let goal = (positions[theirs.0] + positions[theirs.1]) * (0.5 * scale);
        let placed = rig.skeleton.pose_positions(&Vector3::zeros(), pose);
        let root = goal - (placed[own.0] + placed[own.1]) * 0.5;
        before.push(lowest(&clip.skeleton, &from_feet, clip.pose(frame), &positions));
        after.push(root.y + lowest(&rig.skeleton, &to_feet, pose, &placed));
        path.push(root);
    }
    let lift = lift(&before, &after, scale);
    path.iter_mut().for_each(|root| root.y += lift);
    path
}

/// How much higher the rig has to be.
fn lift(before: &[f64], after: &[f64], scale: f64) -> f64 {
    let floor = share(before.to_vec(), FLOOR);
    let stands = before.iter().zip(after).filter(|(before, _)| **before < floor + STANDS);
    let above = |before: &f64| (before - floor).max(0.0) * scale;
    let lift = share(stands.map(|(before, after)| floor + above(before) - after).collect(), 0.5);
    let least = after.iter().copied().fold(f64::INFINITY, f64::min);
    let lift = lift.max((floor - UNDER - least).min(lift + LIFTED));
    if lift.is_finite() { lift } else { 0.0 }
}

/// The value that this share of the others is below.
fn share(mut values: Vec<f64>, at: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get((values.len().saturating_sub(1) as f64 * at).round() as usize).copied().unwrap_or(f64::NAN)
}

/// The ankles and what hangs on them.
fn feet(skeleton: &Skeleton, map: &JointMap) -> Vec<usize> {
    let ankles = [Canonical::LAnkle, Canonical::RAnkle].map(|ankle| map.joint(ankle));
    let mut feet = vec![false; skeleton.len()];
    for (index, joint) in skeleton.joints.iter().enumerate() {
        feet[index] = ankles.contains(&Some(index)) || joint.parent.is_some_and(|p| feet[p]);
    }
    (0..skeleton.len()).filter(|joint| feet[*joint]).collect()
}

/// The height of the lowest joint or tip of the feet.
fn lowest(skeleton: &Skeleton, feet: &[usize], pose: &[UnitQuaternion<f64>], positions: &[Vector3<f64>]) -> f64 {
    let worlds = skeleton.world_rotations(pose);
    let tip = |joint: usize| worlds[joint] * skeleton.joints[joint].end.unwrap_or_else(Vector3::zeros);
    feet.iter().map(|&j| positions[j].y.min((positions[j] + tip(j)).y)).fold(f64::INFINITY, f64::min)
}
