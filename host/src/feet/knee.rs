//! Knees that a change of the pose would bend backwards, or through.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Unit, UnitQuaternion};

use super::contacts::Foot;
use super::leg::knee_axis;
use crate::clip::{Clip, JointMap};
use crate::steady::under_bell;

/// Bend of a knee near its two stops, rad.
const STOPS: [f64; 2] = [0.1, 2.4];
/// Softness of a stop, in changes of the bend.
const SOFT: f64 = 0.5;

/// Lets no knee of `styled` go farther past a stop than that of `source` does, nearly. Clips have one skeleton, frame for frame. Stops are soft,
/// and reached and left under a bell of `width` seconds; a knee that was not changed stays as it is.
pub fn keep_knees(source: &Clip, styled: &mut Clip, map: &JointMap, width: f64) {
    let (joints, frames) = (source.skeleton.len(), source.frames().min(styled.frames()));
    for foot in Foot::of(&source.skeleton, map) {
        let Some(axis) = Unit::try_new(knee_axis(source, &foot), 1e-9) else { continue };
        let [hip, knee, ankle] = foot.leg;
        // The joint right below the thigh turns, so that joints between knee and ankle go with the shin.
        let Some(parent) = source.skeleton.joints[knee].parent else { continue };
        let bend = |clip: &Clip, frame: usize| {
            let (at, worlds) = (clip.positions(frame), clip.skeleton.world_rotations(clip.pose(frame)));
            let [thigh, shin] = [at[knee] - at[hip], at[ankle] - at[knee]];
            let bend = thigh.cross(&shin).dot(&(worlds[hip] * axis.into_inner())).atan2(thigh.dot(&shin));
            // A knee that is bent through was bent forwards.
            if bend < -FRAC_PI_2 { bend + TAU } else { bend }
        };
        let back = |frame: usize| {
            let [was, is] = [bend(source, frame), bend(styled, frame)];
            let soft = SOFT * (is - was).abs();
            let past = |over: f64| 0.5 * (over.hypot(soft) - over);
            past(is - was.min(STOPS[0])) - past(was.max(STOPS[1]) - is)
        };
        let backs: Vec<f64> = (0..frames).map(back).collect();
        for frame in 0..frames {
            let mut back = 0.0;
            under_bell(frame as f64, width * source.fps(), frames, |weight, near| back += weight * backs[near]);
            if back.abs() < 1e-9 {
                continue;
            }
            let worlds = styled.skeleton.world_rotations(styled.pose(frame));
            let turn = UnitQuaternion::from_axis_angle(&(worlds[hip] * axis), back);
            let local = &mut styled.rotations[frame * joints + knee];
            *local = worlds[parent].inverse() * turn * worlds[parent] * *local;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::{Manner, walk};
    use nalgebra::Vector3;

    #[test]
    fn a_knee_is_kept_from_bending_backwards_and_one_that_was_not_changed_stays() {
        let clip = walk(&Manner::NEUTRAL, 2.0, 60.0, 0.0, 1);
        let map = JointMap::choose(&clip.skeleton, None).unwrap().unwrap();
        let mut same = clip.clone();
        keep_knees(&clip, &mut same, &map, 0.05);
        assert!(same.rotations == clip.rotations);

        let foot = Foot::of(&clip.skeleton, &map)[0];
        let axis = Unit::new_normalize(knee_axis(&clip, &foot));
        let bent = |clip: &Clip, by: f64| {
            let mut out = clip.clone();
            for frame in 0..clip.frames() {
                out.rotations[frame * clip.skeleton.len() + foot.leg[1]] *= UnitQuaternion::from_axis_angle(&axis, by);
            }
            out
        };
        let least = |clip: &Clip| {
            let of = |frame: usize| {
                let at = clip.positions(frame);
                let [thigh, shin] = [at[foot.leg[1]] - at[foot.leg[0]], at[foot.leg[2]] - at[foot.leg[1]]];
                let side = clip.skeleton.world_rotations(clip.pose(frame))[foot.leg[0]] * axis.into_inner();
                thigh.cross(&shin).dot(&side).atan2(Vector3::dot(&thigh, &shin))
            };
            (0..clip.frames()).map(of).fold(f64::INFINITY, f64::min)
        };
        let mut kept = bent(&clip, -0.6);
        let broken = least(&kept);
        keep_knees(&clip, &mut kept, &map, 0.05);
        assert!(broken < -0.3 && least(&kept) > -0.1, "{broken} -> {}", least(&kept));
    }
}
