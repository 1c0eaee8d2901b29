//! The motion at one strength: keyframes with their times, and where a cycle leads.

use nalgebra::Vector3;

use super::model::Emotion;
use super::place::{Place, part_of};
use super::spline::Taps;
use crate::kernel::sqrt;
use crate::model::ATTRIBUTES;
use crate::pose::{Heading, World};

/// A cycle that goes less far is on the spot, m.
const LEAST_WAY: f32 = 0.2;

/// Joint positions at the keyframes, in the motion's frame: the ground below the first keyframe's root is the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion<const JOINTS: usize, const KEYS: usize> {
    positions: [[[f32; 3]; JOINTS]; KEYS],
    /// From each keyframe to the next, s; 0 after the last piece.
    durations: [f32; KEYS],
    /// Pieces, one fewer than keyframes.
    pub pieces: usize,
    /// Where the last keyframe is against the first one: the next round of a cycle, a step of `None` for any other motion.
    pub round: Option<Place>,
    /// All pieces together, s.
    pub seconds: f32,
}

impl<const JOINTS: usize, const KEYS: usize> Motion<JOINTS, KEYS> {
    /// Nothing yet.
    pub fn new() -> Self {
        Self { positions: [[[0.0; 3]; JOINTS]; KEYS], durations: [0.0; KEYS], pieces: 0, round: None, seconds: 0.0 }
    }

    /// Duration of a piece, s.
    pub fn duration(&self, piece: usize) -> f32 {
        self.durations.get(piece).copied().unwrap_or(0.0)
    }

    /// Share of the motion's time that has passed at the start of a piece and `into` it.
    pub fn share(&self, piece: usize, into: f32) -> f32 {
        let passed = self.durations.iter().take(piece).sum::<f32>() + into;
        if self.seconds > 0.0 { passed / self.seconds } else { 0.0 }
    }

    /// Direction in which the motion goes at a share of its time: of a cycle the way from its first to its last keyframe, turned
    /// evenly on both sides of the middle; of any other motion, and of one on the spot, the first keyframe's heading.
    pub fn course(&self, share: f32) -> Heading {
        let Some(round) = self.round else { return Heading::default() };
        let [sin, cos] = part_of(round.heading, share).turn_from(Heading::default());
        let way = length([round.ground.x, round.ground.z].into_iter());
        if way < LEAST_WAY {
            return Heading::default().turned(sin, cos);
        }
        let [back, ahead] = Heading::default().turn_from(part_of(round.heading, 0.5));
        Heading::default().turned(round.ground.x / way, round.ground.z / way).turned(back, ahead).turned(sin, cos)
    }

    /// Weights of the four keyframes around a point.
    pub fn taps(&self, piece: usize, into: f32) -> Taps {
        let last = self.pieces.saturating_sub(1);
        let beyond = |other: usize| if self.round.is_some() { self.duration(other) } else { 0.0 };
        let before = if piece > 0 { self.duration(piece - 1) } else { beyond(last) };
        let after = if piece < last { self.duration(piece + 1) } else { beyond(0) };
        let own = self.duration(piece);
        Taps::new([before, own, after], into / own)
    }

    /// A joint at the four keyframes around a piece; those of a neighbouring round of a cycle are carried over.
    pub fn around(&self, piece: usize, joint: usize) -> [Vector3<f32>; 4] {
        let at = |key: usize| {
            let key = self.positions.get(key).and_then(|positions| positions.get(joint));
            key.map_or_else(Vector3::zeros, |position| Vector3::from(*position))
        };
        let (start, end) = (at(piece), at(piece + 1));
        let before = match self.round {
            _ if piece > 0 => at(piece - 1),
            Some(round) => round.undo(at(self.pieces.saturating_sub(1))),
            None => start,
        };
        let after = match self.round {
            _ if piece + 1 < self.pieces => at(piece + 2),
            Some(round) => round.apply(at(1)),
            None => end,
        };
        [before, start, end, after]
    }

    /// Heading at the last keyframe against the first one's.
    fn turn(&self, skeleton: &crate::pose::Skeleton) -> Heading {
        let at = |key: usize| {
            let mut world = World::<JOINTS>::identity();
            for (to, from) in world.positions.iter_mut().zip(self.positions.get(key).into_iter().flatten()) {
                *to = Vector3::from(*from);
            }
            Heading::default().follow(skeleton, &world)
        };
        let [sin, cos] = at(self.pieces).turn_from(at(0));
        Heading::default().turned(sin, cos)
    }

    /// Makes a cycle of keyframes that nearly are one: what the last posture differs from the first one's is spread over the
    /// whole round, half of it to each end, so that the next round begins exactly where this one ends.
    fn close(&mut self, skeleton: &crate::pose::Skeleton) {
        let heading = self.turn(skeleton);
        let ground = |key: usize| {
            let [x, _, z] = self.positions.get(key).and_then(|p| p.first()).copied().unwrap_or_default();
            Vector3::new(x, 0.0, z)
        };
        let round = Place { ground: ground(self.pieces) - heading.to_world(ground(0)), heading };
        let (first, last) = (self.positions.first().copied(), self.positions.get(self.pieces).copied());
        let (Some(first), Some(last)) = (first, last) else { return };
        let mut passed = 0.0;
        for (positions, duration) in self.positions.iter_mut().zip(self.durations).take(self.pieces + 1) {
            let share = passed / self.seconds;
            for ((position, first), last) in positions.iter_mut().zip(first).zip(last) {
                let half = (Vector3::from(last) - round.apply(Vector3::from(first))) * 0.5;
                let change = heading.to_local(half) * (1.0 - share) - half * share;
                *position = (Vector3::from(*position) + change).into();
            }
            passed += duration;
        }
        self.round = Some(round);
    }
}

impl<const JOINTS: usize, const KEYS: usize, const WIDTH: usize> Emotion<'_, JOINTS, KEYS, WIDTH> {
    /// Evaluates the network and projects back. Chan 2019, sections 3.4 and 4: the time between keyframes is the way that the
    /// joints go over the speed at which they go, all joints taken as one vector. Cost: [`multiply_adds`](Self::multiply_adds), a tanh a hidden unit.
    pub(super) fn evaluate(&self, strength: &[f32; ATTRIBUTES], motion: &mut Motion<JOINTS, KEYS>) {
        let inputs = self.inputs(strength);
        let joints = self.skeleton.joints();
        motion.pieces = self.keys().saturating_sub(1);
        (motion.round, motion.seconds) = (None, 0.0);
        let mut before: Option<[[f32; 3]; JOINTS]> = None;
        for key in 0..self.keys() {
            let components = self.components(key, &inputs);
            let mut velocity = [[0.0; 3]; JOINTS];
            let Some(positions) = motion.positions.get_mut(key) else { return };
            positions.iter_mut().zip(self.position_mean).for_each(|(to, mean)| *to = *mean);
            self.position.multiply_add(&components, positions.as_flattened_mut());
            if let Some(before) = before {
                velocity.iter_mut().zip(self.velocity_mean).for_each(|(to, mean)| *to = *mean);
                self.velocity.multiply_add(&components, velocity.as_flattened_mut());
                let ways = positions.as_flattened().iter().zip(before.as_flattened()).map(|(to, from)| to - from);
                let way = length(ways.take(3 * joints));
                let speed = length(velocity.as_flattened().iter().copied().take(3 * joints));
                let duration = self.duration(way, speed);
                if let Some(to) = motion.durations.get_mut(key - 1) {
                    *to = duration;
                }
                motion.seconds += duration;
            }
            before = Some(*positions);
        }
        if let Some(end) = motion.durations.get_mut(motion.pieces) {
            *end = 0.0;
        }
        if self.meta.cycle {
            motion.close(&self.skeleton);
        }
    }

    /// `way / speed`, held inside the pack's durations. (Least squares, `way . velocity / speed^2`, is nearer to the clips' length by
    /// some percent where components are left out, but where a network errs about the direction it makes a motion leap.)
    fn duration(&self, way: f32, speed: f32) -> f32 {
        let [shortest, longest] = self.meta.duration;
        // Nothing moves: as the shortest. Not a number: the same.
        let duration = if speed > 0.0 { way / speed } else { shortest };
        duration.max(shortest).min(longest)
    }
}

fn length(values: impl Iterator<Item = f32>) -> f32 {
    let mut squares = 0.0;
    for value in values {
        squares += value * value;
    }
    sqrt(squares)
}
