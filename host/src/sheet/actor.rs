//! A clip as stick figures: bones with their sides, turned to face +Z, on the ground.

use nalgebra::{UnitQuaternion, Vector3};

use crate::clip::{Canonical, Clip, JointMap};
use crate::robot::look::Look;

/// Which limb a line belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// The person's own left.
    Left,
    /// The person's own right.
    Right,
    /// Trunk, neck and all of a robot.
    Middle,
}

/// One frame of an [`Actor`].
#[derive(Clone, Debug)]
pub(super) struct Figure {
    /// Ends of lines, m, with their side; the root is above the origin, the ground is at 0.
    pub strokes: Vec<(Vector3<f64>, Vector3<f64>, Side)>,
    /// Middle of the head and its radius, m.
    pub head: Option<(Vector3<f64>, f64)>,
    /// Where the root is above the ground, m.
    pub place: Vector3<f64>,
}

/// Least distance of the hips that says where a person faces, m.
const HIPS: f64 = 0.01;

/// A motion and how it is drawn.
#[derive(Clone, Debug)]
pub struct Actor {
    /// What is written beside it.
    pub name: String,
    clip: Clip,
    look: Option<Look>,
    sides: Vec<Side>,
    head: Option<usize>,
    turn: UnitQuaternion<f64>,
    floor: f64,
}

impl Actor {
    /// A body. Without a map of its joints, their names say what is left and right, and the clip's +Z is the front.
    pub fn body(name: &str, clip: Clip, map: Option<&JointMap>) -> Self {
        let side = |(index, joint): (usize, &crate::clip::Joint)| {
            let known = map.and_then(|map| map.canonical(index)).map_or("", Canonical::name);
            let own = joint.name.to_lowercase();
            match known.get(..2) {
                Some("l_") => Side::Left,
                Some("r_") => Side::Right,
                _ if known.is_empty() && own.contains("left") => Side::Left,
                _ if known.is_empty() && own.contains("right") => Side::Right,
                _ => Side::Middle,
            }
        };
        let mut sides: Vec<Side> = clip.skeleton.joints.iter().enumerate().map(side).collect();
        // Fingers and toes go with the hand or foot that carries them.
        for (index, joint) in clip.skeleton.joints.iter().enumerate() {
            let carrier = joint.parent.map_or(Side::Middle, |parent| sides[parent]);
            if sides[index] == Side::Middle {
                sides[index] = carrier;
            }
        }
        let hips = map.and_then(|map| Some([map.joint(Canonical::LHip)?, map.joint(Canonical::RHip)?]));
        let turn = hips.map_or_else(UnitQuaternion::identity, |hips| facing(&clip, hips));
        let lowest = |frame: usize| clip.positions(frame).iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
        let floor = (0..clip.frames()).map(lowest).fold(f64::INFINITY, f64::min);
        let head = map.and_then(|map| map.joint(Canonical::Head));
        let floor = if floor.is_finite() { floor } else { 0.0 };
        Self { name: name.to_owned(), clip, look: None, sides, head, turn, floor }
    }

    /// A robot, whose clip holds its coordinates.
    pub fn machine(name: &str, clip: Clip, look: Look) -> Self {
        let (sides, turn) = (Vec::new(), UnitQuaternion::identity());
        Self { name: name.to_owned(), clip, look: Some(look), sides, head: None, turn, floor: 0.0 }
    }

    /// Whether it may leave its place; a robot does not.
    pub(super) fn travels(&self) -> bool {
        self.look.is_none()
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.clip.frames()
    }

    /// Length in seconds.
    pub fn duration(&self) -> f64 {
        self.clip.duration()
    }

    /// When a frame is due, s.
    pub fn time(&self, frame: usize) -> f64 {
        self.clip.frame_time * frame as f64
    }

    /// The frame nearest to a time, the last one after the end.
    pub fn frame_at(&self, time: f64) -> usize {
        let frame = (time / self.clip.frame_time).round();
        (frame.max(0.0) as usize).min(self.frames().saturating_sub(1))
    }

    /// So many frames, evenly chosen from the first to the last.
    pub fn even(&self, count: usize) -> Vec<usize> {
        let last = self.frames().saturating_sub(1);
        (0..count).map(|at| at * last / count.saturating_sub(1).max(1)).collect()
    }

    /// The figure of a frame.
    pub(super) fn figure(&self, frame: usize) -> Figure {
        if let Some(look) = &self.look {
            let sticks = look.sticks(self.clip.coordinates(frame).unwrap_or(&[]));
            let strokes = sticks.into_iter().map(|(from, to)| (from, to, Side::Middle)).collect();
            return Figure { strokes, head: None, place: Vector3::zeros() };
        }
        let root = self.clip.root.get(frame).copied().unwrap_or_default();
        let ground = Vector3::new(root.x, self.floor, root.z);
        let positions: Vec<_> = self.clip.positions(frame).iter().map(|p| self.turn * (p - ground)).collect();
        let worlds = self.clip.skeleton.world_rotations(self.clip.pose(frame));
        let joints = || self.clip.skeleton.joints.iter().enumerate();
        let bones = joints().filter_map(|(index, joint)| {
            Some((*positions.get(joint.parent?)?, *positions.get(index)?, self.sides[index]))
        });
        let tip = |index: usize| {
            let end = self.clip.skeleton.joints.get(index)?.end?;
            Some(positions.get(index)? + self.turn * (worlds.get(index)? * end))
        };
        let head = self.head.and_then(|index| {
            let base = *positions.get(index)?;
            let above = tip(index).or_else(|| positions.get(self.clip.skeleton.children(index).next()?).copied());
            let (middle, radius) =
                above.map_or((base, 0.0), |above| (0.5 * (base + above), 0.5 * (above - base).norm()));
            Some((middle, radius.clamp(0.07, 0.13)))
        });
        let tips = joints().filter(|(index, _)| Some(*index) != self.head);
        let tips = tips.filter_map(|(index, _)| Some((*positions.get(index)?, tip(index)?, self.sides[index])));
        Figure { strokes: bones.chain(tips).collect(), head, place: self.turn * root }
    }
}

/// The turn about the vertical that lets a person face +Z: on average, or at the start where that says little.
fn facing(clip: &Clip, [left, right]: [usize; 2]) -> UnitQuaternion<f64> {
    let forward = |frame: usize| {
        let positions = clip.positions(frame);
        let across = positions.get(left)? - positions.get(right)?;
        // From the right hip to the left one is +X of who faces +Z.
        Vector3::new(-across.z, 0.0, across.x).try_normalize(HIPS)
    };
    let all: Vec<_> = (0..clip.frames()).filter_map(forward).collect();
    let mean = all.iter().sum::<Vector3<f64>>() / all.len().max(1) as f64;
    let direction = if mean.norm() > 0.5 { mean } else { all.first().copied().unwrap_or_else(Vector3::z) };
    UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -direction.x.atan2(direction.z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::{Manner, walk};

    #[test]
    fn a_person_faces_the_viewer_wherever_the_clip_goes() {
        let clip = walk(&Manner::NEUTRAL, 2.0, 30.0, 0.0, 1);
        let map = JointMap::detect(&clip.skeleton).unwrap();
        let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 2.1);
        let mut turned = clip.clone();
        turned.root.iter_mut().for_each(|p| *p = turn * *p + Vector3::new(3.0, 0.5, -2.0));
        let joints = turned.skeleton.len();
        turned.rotations.iter_mut().step_by(joints).for_each(|q| *q = turn * *q);
        let [a, b] = [clip, turned].map(|clip| Actor::body("walk", clip, Some(&map)).figure(7));
        assert_eq!(a.strokes.len(), b.strokes.len());
        for (a, b) in a.strokes.iter().zip(&b.strokes) {
            assert!((a.0 - b.0).norm() + (a.1 - b.1).norm() < 1e-6, "{a:?} {b:?}");
        }
        // The left foot is at +X.
        let left = a.strokes.iter().filter(|(_, _, side)| *side == Side::Left).map(|(_, to, _)| to.x);
        assert!(left.fold(0.0, f64::max) > 0.05);
        let lowest = a.strokes.iter().map(|(_, to, _)| to.y).fold(1.0, f64::min);
        assert!((-1e-9..0.1).contains(&lowest), "{lowest}");
    }

    #[test]
    fn frames_are_chosen_from_the_first_to_the_last() {
        let actor = Actor::body("walk", walk(&Manner::NEUTRAL, 2.0, 30.0, 0.0, 1), None);
        let last = actor.frames() - 1;
        let even = actor.even(8);
        assert_eq!((even.len(), even[0], even[7]), (8, 0, last));
        assert_eq!((actor.even(1), actor.even(0)), (vec![0], vec![]));
        assert_eq!((actor.frame_at(-1.0), actor.frame_at(1.0), actor.frame_at(99.0)), (0, 30, last));
    }
}
