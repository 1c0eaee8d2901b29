//! The two bones of a leg, bent so that the ankle reaches a place.

use nalgebra::{UnitQuaternion, Vector3};

use super::contacts::Foot;
use crate::clip::{Clip, Skeleton};

/// Parts of its length at which a leg begins to resist, and to which it is stretched at most: at full stretch a knee snaps.
const STRETCH: [f64; 2] = [0.98, 0.999];
/// Way over which a leg that was stretched farther, or bent to the wrong side, gives that up, m.
const GIVES_UP: f64 = 0.01;
/// Distance of a knee from the line between hip and ankle, in lengths of the leg, at which it is as sure of its side as its axis is.
const SURE: f64 = 0.05;

/// The axis about which a knee bends, in the frame of the thigh: the mean over a clip, by how far the knee bends. Zero if it never does.
pub(super) fn knee_axis(clip: &Clip, foot: &Foot) -> Vector3<f64> {
    let [hip, knee, ankle] = foot.leg;
    let of = |frame: usize| {
        let at = clip.positions(frame);
        let axis = (at[knee] - at[hip]).cross(&(at[ankle] - at[knee]));
        clip.skeleton.world_rotations(clip.pose(frame))[hip].inverse() * axis
    };
    (0..clip.frames()).map(of).sum::<Vector3<f64>>().try_normalize(1e-9).unwrap_or_else(Vector3::zeros)
}

/// Bends a leg so that its ankle is moved by `way`, m, as far as the leg reaches. The foot keeps its rotation in the world. The knee keeps its
/// side; the straighter it is, the more its axis decides. `locals` are the rotations of the whole pose.
pub(super) fn reach(
    skeleton: &Skeleton,
    (foot, axis): (&Foot, &Vector3<f64>),
    root: &Vector3<f64>,
    locals: &mut [UnitQuaternion<f64>],
    way: Vector3<f64>,
) {
    let positions = skeleton.pose_positions(root, locals);
    let worlds = skeleton.world_rotations(locals);
    let [hip, knee, ankle] = foot.leg.map(|joint| positions[joint]);
    let (thigh, shin) = ((knee - hip).norm(), (ankle - knee).norm());
    let (Some(old), Some(aim)) = ((ankle - hip).try_normalize(1e-6), (ankle + way - hip).try_normalize(1e-6)) else {
        return;
    };
    let (was, wanted) = ((ankle - hip).norm(), (ankle + way - hip).norm());
    let beyond = (was - resisted(was, thigh + shin)) * (-way.norm() / GIVES_UP).exp();
    let distance = (resisted(wanted, thigh + shin) + beyond).max(1.02 * (thigh - shin).abs());
    // The knee's side goes with the leg.
    let swing = UnitQuaternion::rotation_between(&old, &aim).unwrap_or_else(UnitQuaternion::identity);
    let sure = SURE * (thigh + shin) * (1.0 - (-way.norm() / GIVES_UP).exp());
    let side = swing * (knee - hip) + sure * aim.cross(&(swing * worlds[foot.leg[0]] * axis));
    let Some(side) = (side - aim * side.dot(&aim)).try_normalize(1e-6) else { return };
    let along = (thigh * thigh - shin * shin + distance * distance) / (2.0 * distance);
    let bent = hip + aim * along + side * (thigh * thigh - along * along).max(0.0).sqrt();
    let end = hip + aim * distance;
    let arc = |from: Vector3<f64>, to: Vector3<f64>| UnitQuaternion::rotation_between(&from, &to);
    let (Some(at_hip), Some(at_knee)) = (arc(knee - hip, bent - hip), arc(ankle - knee, end - bent)) else { return };

    let [hip, knee, ankle] = foot.leg;
    let above = |joint: usize| skeleton.joints[joint].parent;
    let parent = above(hip).map_or_else(UnitQuaternion::identity, |p| worlds[p]);
    locals[hip] = parent.inverse() * at_hip * worlds[hip];
    // Joints between hip and knee, knee and ankle go with the bone.
    let parent = above(knee).map_or_else(UnitQuaternion::identity, |p| at_hip * worlds[p]);
    locals[knee] = parent.inverse() * at_knee * worlds[knee];
    let parent = above(ankle).map_or_else(UnitQuaternion::identity, |p| at_knee * worlds[p]);
    locals[ankle] = parent.inverse() * worlds[ankle];
}

/// A distance from hip to ankle that a leg of this length resists: as it is at first, then ever less of it.
fn resisted(distance: f64, length: f64) -> f64 {
    let [begin, end] = STRETCH.map(|part| part * length);
    if distance <= begin {
        return distance;
    }
    end - (end - begin) * (-(distance - begin) / (end - begin)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::JointMap;
    use crate::gait::{Manner, walk};

    #[test]
    fn the_ankle_arrives_and_nothing_else_moves() {
        let clip = walk(&Manner::NEUTRAL, 1.0, 30.0, 0.0, 1);
        let map = JointMap::choose(&clip.skeleton, None).unwrap().unwrap();
        let foot = Foot::of(&clip.skeleton, &map)[1];
        for frame in 0..clip.frames() {
            let mut pose = clip.pose(frame).to_vec();
            let way = Vector3::new(0.02, 0.03, -0.05);
            reach(&clip.skeleton, (&foot, &knee_axis(&clip, &foot)), &clip.root[frame], &mut pose, way);
            let (was, is) = (clip.positions(frame), clip.skeleton.pose_positions(&clip.root[frame], &pose));
            for joint in 0..clip.skeleton.len() {
                let moved = is[joint] - was[joint];
                let [_, knee, ankle] = foot.leg;
                if joint == ankle || joint == foot.joint {
                    assert!((moved - way).norm() < 5e-3, "{frame}: {moved}");
                } else if joint != knee {
                    assert!(moved.norm() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn a_place_out_of_reach_is_aimed_at() {
        let clip = walk(&Manner::NEUTRAL, 1.0, 30.0, 0.0, 1);
        let map = JointMap::choose(&clip.skeleton, None).unwrap().unwrap();
        let foot = Foot::of(&clip.skeleton, &map)[0];
        let mut pose = clip.pose(3).to_vec();
        reach(
            &clip.skeleton,
            (&foot, &knee_axis(&clip, &foot)),
            &clip.root[3],
            &mut pose,
            Vector3::new(0.0, -3.0, 0.0),
        );
        let at = clip.skeleton.pose_positions(&clip.root[3], &pose);
        let [hip, _, ankle] = foot.leg.map(|joint| at[joint]);
        assert!((ankle - hip).norm() <= 0.83 + 1e-9 && (ankle - hip).norm() > 0.82);
        assert!(pose.iter().all(|q| q.coords.iter().all(|x| x.is_finite())));
    }
}
