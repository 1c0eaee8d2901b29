//! The motion at one strength: keyframes with their times, and where a cycle leads.

use nalgebra::Vector3;

use super::model::Emotion;
use super::place::{Place, part_of};
use super::spline::Taps;
use crate::kernel::{sin_cos, sqrt};
use crate::model::ATTRIBUTES;
use crate::pose::Heading;

/// A cycle that goes less far is on the spot, m.
const LEAST_WAY: f32 = 0.2;

/// Coordinates at the keyframes. Row 0 of a body that travels is the root's place in the motion's frame: the ground below the first
/// keyframe's root is the origin, its heading +Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion<const ROWS: usize, const KEYS: usize> {
    keys: [Key<ROWS>; KEYS],
    /// From each keyframe to the next, s; 0 after the last piece.
    durations: [f32; KEYS],
    /// Pieces, one fewer than keyframes.
    pub pieces: usize,
    /// True for a body: row 0 is a place.
    pub travels: bool,
    /// Where the last keyframe is against the first one: the next round of a cycle, a step of `None` for any other motion.
    pub round: Option<Place>,
    /// Heading of the last keyframe against the first one's, rad.
    turn: f32,
    /// All pieces together, s.
    pub seconds: f32,
}

/// Coordinates of a keyframe.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Key<const ROWS: usize> {
    rows: [[f32; 3]; ROWS],
    /// Turn from the motion's frame, rad.
    heading: f32,
}

impl<const ROWS: usize> Key<ROWS> {
    const ZERO: Self = Self { rows: [[0.0; 3]; ROWS], heading: 0.0 };

    /// The coordinates of the first `rows` rows, then the heading.
    fn channels(&mut self, rows: usize) -> impl Iterator<Item = &mut f32> {
        self.rows.iter_mut().take(rows).flatten().chain(core::iter::once(&mut self.heading))
    }
}

impl<const ROWS: usize, const KEYS: usize> Motion<ROWS, KEYS> {
    /// Nothing yet.
    pub const fn new() -> Self {
        Self {
            keys: [Key::ZERO; KEYS],
            durations: [0.0; KEYS],
            pieces: 0,
            travels: false,
            round: None,
            turn: 0.0,
            seconds: 0.0,
        }
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

    /// A row at the four keyframes around a piece; the places of a neighbouring round of a cycle are carried over.
    pub fn around(&self, piece: usize, row: usize) -> [Vector3<f32>; 4] {
        let at = |key: usize| {
            let row = self.keys.get(key).and_then(|key| key.rows.get(row));
            row.map_or_else(Vector3::zeros, |row| Vector3::from(*row))
        };
        let place = self.travels && row == 0;
        let (back, on) = (
            |round: &Place, row| if place { round.undo(row) } else { row },
            |round: &Place, row| if place { round.apply(row) } else { row },
        );
        let (start, end) = (at(piece), at(piece + 1));
        let before = match &self.round {
            _ if piece > 0 => at(piece - 1),
            Some(round) => back(round, at(self.pieces.saturating_sub(1))),
            None => start,
        };
        let after = match &self.round {
            _ if piece + 1 < self.pieces => at(piece + 2),
            Some(round) => on(round, at(1)),
            None => end,
        };
        [before, start, end, after]
    }

    /// The same of the heading, rad.
    pub fn headings(&self, piece: usize) -> [f32; 4] {
        let at = |key: usize| self.keys.get(key).map_or(0.0, |key| key.heading);
        let (start, end) = (at(piece), at(piece + 1));
        let before = match self.round {
            _ if piece > 0 => at(piece - 1),
            Some(_) => at(self.pieces.saturating_sub(1)) - self.turn,
            None => start,
        };
        let after = match self.round {
            _ if piece + 1 < self.pieces => at(piece + 2),
            Some(_) => at(1) + self.turn,
            None => end,
        };
        [before, start, end, after]
    }

    /// Makes a cycle of keyframes that nearly are one: what the last posture differs from the first one's is spread over the
    /// whole round, half of it to each end, so that the next round begins exactly where this one ends.
    fn close(&mut self) {
        let (Some(first), Some(last)) = (self.keys.first().copied(), self.keys.get(self.pieces).copied()) else {
            return;
        };
        let mut round = Place::default();
        if self.travels {
            self.turn = last.heading - first.heading;
            let (sin, cos) = sin_cos(self.turn);
            round.heading = Heading::default().turned(sin, cos);
            let ground =
                |key: &Key<ROWS>| key.rows.first().map_or_else(Vector3::zeros, |[x, _, z]| Vector3::new(*x, 0.0, *z));
            round.ground = ground(&last) - round.heading.to_world(ground(&first));
        }
        let mut passed = 0.0;
        for (key, duration) in self.keys.iter_mut().zip(self.durations).take(self.pieces + 1) {
            let share = passed / self.seconds;
            for (at, ((row, first), last)) in key.rows.iter_mut().zip(first.rows).zip(last.rows).enumerate() {
                for (axis, ((x, first), last)) in row.iter_mut().zip(first).zip(last).enumerate() {
                    // Over the ground a round leads on: its ends are not the same.
                    let over_ground = self.travels && at == 0 && axis != 1;
                    let half = if over_ground { 0.0 } else { (last - first) * 0.5 };
                    *x += half * (1.0 - share) - half * share;
                }
            }
            passed += duration;
        }
        self.round = Some(round);
    }
}

impl<const ROWS: usize, const KEYS: usize, const WIDTH: usize> Emotion<'_, ROWS, KEYS, WIDTH> {
    /// Evaluates the network and projects back. Chan 2019, sections 3.4 and 4: the time between keyframes is the way over the speed,
    /// all channels times their levers taken as one vector. Cost: [`multiply_adds`](Self::multiply_adds), a tanh per hidden unit.
    pub(super) fn evaluate(&self, strength: &[f32; ATTRIBUTES], motion: &mut Motion<ROWS, KEYS>) {
        let inputs = self.inputs(strength);
        motion.pieces = self.keys().saturating_sub(1);
        (motion.travels, motion.round, motion.turn, motion.seconds) = (self.travels, None, 0.0, 0.0);
        let mut before: Option<Key<ROWS>> = None;
        for (number, to) in motion.keys.iter_mut().enumerate().take(self.keys()) {
            let components = self.components(number, &inputs);
            let mut key = Key::ZERO;
            let values = self.coordinates.sums(&components).flatten().zip(self.mean);
            key.channels(self.rows).zip(values).for_each(|(to, (value, mean))| *to = mean + value);
            *to = key;
            if let Some(mut before) = before {
                let ways = key.channels(self.rows).zip(before.channels(self.rows)).zip(self.lever);
                let way = length(ways.map(|((to, from), lever)| (*to - *from) * lever));
                let speeds = self.velocity.sums(&components).flatten().zip(self.velocity_mean);
                let duration = self.duration(way, length(speeds.map(|(value, mean)| mean + value)));
                if let Some(to) = motion.durations.get_mut(number - 1) {
                    *to = duration;
                }
                motion.seconds += duration;
            }
            before = Some(key);
        }
        if let Some(end) = motion.durations.get_mut(motion.pieces) {
            *end = 0.0;
        }
        if self.meta.cycle {
            motion.close();
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
