//! A change on the pack's rig, carried to the skeleton of the clip that was given.
//!
//! An engine changes a motion on its rig. What it changed is, per joint, a turn in the world: `D = G_after G_before^-1`. The same turn on the
//! clip's own joint, `G' = D G`, gives the clip's own skeleton the change: its joints, names, rest pose, rate and tips stay. Joints that the
//! rig does not know (fingers, further joints of the spine) keep their own rotation against the parent. No change gives the clip as it was read.

use nalgebra::{UnitQuaternion, Vector3};

use crate::clip::{Canonical, Clip};
use crate::prepare::Source;
use crate::retarget::{longer, same_joints};
use crate::rig::Rig;

/// The joints of a clip's skeleton that answer those of a rig.
#[derive(Debug)]
pub struct OwnBody<'a> {
    clip: &'a Clip,
    /// `(joint of the clip, joint of the rig)`, in the order of the clip's joints.
    pairs: Vec<(usize, usize)>,
    /// Length of the rig's legs over that of the clip's.
    scale: f64,
}

impl<'a> OwnBody<'a> {
    /// Joints with the same name where the skeletons have the same joints, else by the two joint maps.
    pub fn new(source: &'a Source, rig: &Rig) -> Self {
        let clip = &source.clip;
        let mut pairs: Vec<(usize, usize)> = match same_joints(&clip.skeleton, &rig.skeleton) {
            true => (0..rig.joints()).map(|joint| (joint, joint)).collect(),
            false => Canonical::ALL.iter().filter_map(|c| Some((source.map.joint(*c)?, rig.map.joint(*c)?))).collect(),
        };
        pairs.sort_unstable();
        pairs.dedup_by_key(|(own, _)| *own);
        Self { clip, pairs, scale: longer(clip, &source.map, rig) }
    }

    /// The clip with what happened between `before` and `after`, both on the rig, at one rate, frame for frame. Cost: the world rotations
    /// of all three.
    pub fn carry(&self, before: &Clip, after: &Clip) -> Clip {
        let changes: Vec<Change> =
            (0..before.frames().min(after.frames())).map(|frame| self.change(before, after, frame)).collect();
        let mut out = self.clip.clone();
        let joints = out.skeleton.len();
        for frame in 0..out.frames() {
            let Some(change) = Change::at(&changes, frame as f64 * self.clip.frame_time / before.frame_time) else {
                break;
            };
            out.root[frame] += change.shift;
            self.turn(&change, frame, &mut out.rotations[frame * joints..(frame + 1) * joints]);
        }
        out
    }

    fn change(&self, before: &Clip, after: &Clip, frame: usize) -> Change {
        let [from, to] = [before, after].map(|clip| clip.skeleton.world_rotations(clip.pose(frame)));
        let turns = self.pairs.iter().map(|(_, joint)| to[*joint] * from[*joint].inverse()).collect();
        Change { turns, shift: (after.root[frame] - before.root[frame]) / self.scale }
    }

    fn turn(&self, change: &Change, frame: usize, locals: &mut [UnitQuaternion<f64>]) {
        let own = self.clip.skeleton.world_rotations(self.clip.pose(frame));
        let mut turns = self.pairs.iter().zip(&change.turns).peekable();
        let mut worlds: Vec<UnitQuaternion<f64>> = Vec::with_capacity(locals.len());
        for (index, joint) in self.clip.skeleton.joints.iter().enumerate() {
            let parent = joint.parent.map_or_else(UnitQuaternion::identity, |parent| worlds[parent]);
            if let Some((_, turn)) = turns.next_if(|((own, _), _)| *own == index) {
                // A joint that does not turn keeps its bits, if its parents do.
                let moved = *turn != UnitQuaternion::identity() || joint.parent.is_some_and(|p| worlds[p] != own[p]);
                if moved {
                    locals[index] = parent.inverse() * turn * own[index];
                }
            }
            worlds.push(parent * locals[index]);
        }
    }
}

/// What changed in a frame: a turn in the world per pair of joints, and the way of the root, m of the clip's body.
#[derive(Clone)]
struct Change {
    turns: Vec<UnitQuaternion<f64>>,
    shift: Vector3<f64>,
}

impl Change {
    /// Between two frames; past the last one the last.
    fn at(changes: &[Change], at: f64) -> Option<Change> {
        let last = changes.len().checked_sub(1)?;
        let at = at.min(last as f64);
        // Rates are written with few digits: a time this near to a frame is meant to be it.
        let (frame, part) = if (at - at.round()).abs() < 1e-3 { (at.round(), 0.0) } else { (at.floor(), at.fract()) };
        let before = &changes[frame as usize];
        if part == 0.0 {
            return Some(before.clone());
        }
        let after = &changes[(frame as usize + 1).min(last)];
        let between = |(a, b): (&UnitQuaternion<f64>, &UnitQuaternion<f64>)| a.try_slerp(b, part, 1e-9).unwrap_or(*a);
        let turns = before.turns.iter().zip(&after.turns).map(between).collect();
        Some(Change { turns, shift: before.shift.lerp(&after.shift, part) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip::{Joint, JointMap, Skeleton};
    use crate::gait::{self, Manner, walk};

    /// A walk on a taller body with fingers and one more joint in the spine, other names, at 120 frames a second.
    fn foreign() -> Source {
        let clip = walk(&Manner::NEUTRAL, 1.5, 120.0, 0.0, 3);
        let (mut joints, mut index): (Vec<Joint>, Vec<usize>) = (Vec::new(), Vec::new());
        let mut rotations: Vec<Vec<UnitQuaternion<f64>>> = vec![Vec::new(); clip.frames()];
        let mut add = |joint: Joint, from: Option<usize>| {
            for (frame, row) in rotations.iter_mut().enumerate() {
                let held = UnitQuaternion::from_euler_angles(0.2, 0.1, 0.0);
                row.push(from.map_or(held, |from| clip.pose(frame)[from]));
            }
            joints.push(joint);
        };
        for (at, joint) in clip.skeleton.joints.iter().enumerate() {
            index.push(
                index.last().map_or(0, |last| last + 1 + usize::from(clip.skeleton.joints[at - 1].name == "LeftHand")),
            );
            let parent = joint.parent.map(|parent| index[parent]);
            add(Joint { parent, offset: 1.2 * joint.offset, ..joint.clone() }, Some(at));
            if joint.name == "LeftHand" {
                let offset = Vector3::new(0.0, -0.1, 0.02);
                add(Joint { name: "LeftFinger".into(), parent: Some(index[at]), offset, end: None }, None);
            }
        }
        let skeleton = Skeleton { joints };
        let map = JointMap::choose(&skeleton, None).unwrap().unwrap();
        let root = clip.root.iter().map(|p| 1.2 * p).collect();
        Source::new("foreign", Clip { skeleton, root, rotations: rotations.concat(), ..clip }, map)
    }

    fn rig() -> Rig {
        let skeleton = gait::skeleton();
        let map = JointMap::choose(&skeleton, None).unwrap().unwrap();
        Rig::new(&skeleton, &map).unwrap()
    }

    #[test]
    fn no_change_gives_the_clip_to_the_last_bits() {
        let (source, rig) = (foreign(), rig());
        let before = source.on_rig(&rig, 60.0).unwrap();
        let out = OwnBody::new(&source, &rig).carry(&before, &before);
        let far = out.rotations.iter().zip(&source.clip.rotations).map(|(a, b)| (a.coords - b.coords).norm());
        let far = far.fold(0.0, f64::max);
        assert!(far < 1e-13, "{far:e}");
        assert!(out.root == source.clip.root && out.skeleton == source.clip.skeleton);
    }

    #[test]
    fn a_turn_of_a_joint_turns_the_own_one_and_fingers_follow() {
        let (source, rig) = (foreign(), rig());
        let before = source.on_rig(&rig, 60.0).unwrap();
        let mut after = before.clone();
        let head = rig.skeleton.find("LeftForeArm").unwrap();
        let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.5);
        for frame in 0..after.frames() {
            after.rotations[frame * rig.joints() + head] *= turn;
            after.root[frame].z += 0.1;
        }
        let out = OwnBody::new(&source, &rig).carry(&before, &after);
        let own = out.skeleton.find("LeftForeArm").unwrap();
        let finger = out.skeleton.find("LeftFinger").unwrap();
        for frame in 0..out.frames() {
            let (was, is) = (source.clip.pose(frame), out.pose(frame));
            for joint in 0..out.skeleton.len() {
                let far = was[joint].angle_to(&is[joint]);
                assert!((far - if joint == own { 0.5 } else { 0.0 }).abs() < 1e-3, "{joint}: {far}");
            }
            assert!(was[finger] == is[finger], "the style says nothing about fingers");
            assert!((out.root[frame] - source.clip.root[frame] - Vector3::new(0.0, 0.0, 0.12)).norm() < 1e-4);
        }
    }
}
