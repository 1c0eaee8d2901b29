//! Knees that a change of the pose would bend backwards.

use nalgebra::{Unit, UnitQuaternion};

use super::contacts::Foot;
use super::leg::knee_axis;
use crate::clip::{Clip, JointMap};

/// Bend under which a knee is near its stop, rad.
const STOP: f64 = 0.1;
/// Softness of the stop, in changes of the bend.
const SOFT: f64 = 0.5;

/// Lets no knee of `styled` bend backwards farther than that of `source` does, or than straight. Clips have one skeleton, frame for frame. The
/// stop is soft; a knee that was not changed stays as it is.
pub fn keep_knees(source: &Clip, styled: &mut Clip, map: &JointMap) {
    let joints = source.skeleton.len();
    for foot in Foot::of(&source.skeleton, map) {
        let axis = knee_axis(source, &foot);
        let [hip, knee, ankle] = foot.leg;
        let bend = |clip: &Clip, frame: usize| {
            let at = clip.positions(frame);
            let worlds = clip.skeleton.world_rotations(clip.pose(frame));
            let axis = worlds[hip] * axis;
            let [thigh, shin] = [at[knee] - at[hip], at[ankle] - at[knee]];
            (thigh.cross(&shin).dot(&axis).atan2(thigh.dot(&shin)), axis, worlds)
        };
        for frame in 0..source.frames().min(styled.frames()) {
            let (was, ..) = bend(source, frame);
            let (is, axis, worlds) = bend(styled, frame);
            let least = was.min(STOP);
            let (over, soft) = (is - least, SOFT * (is - was).abs());
            let back = 0.5 * (over.hypot(soft) - over);
            let Some(axis) = Unit::try_new(axis, 1e-9).filter(|_| back > 1e-9) else { continue };
            // The joint right below the thigh turns, so that joints between knee and ankle go with the shin.
            let Some(parent) = source.skeleton.joints[knee].parent else { continue };
            let turn = worlds[parent].inverse() * UnitQuaternion::from_axis_angle(&axis, back) * worlds[parent];
            let local = &mut styled.rotations[frame * joints + knee];
            *local = turn * *local;
        }
    }
}
