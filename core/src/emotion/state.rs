//! What a playing motion remembers.

use nalgebra::Vector3;

use super::motion::Motion;
use super::place::Place;
use crate::model::ATTRIBUTES;

/// What a playing motion remembers: its keyframes, where it is in them and in the world, and what still fades out after a
/// change. About `12 JOINTS (KEYS + 2)` bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmotionState<const JOINTS: usize, const KEYS: usize> {
    /// Strength of each attribute that is wanted, in units of the training's ranking function; it may change at any frame. Held
    /// inside the pack's range; one that is not finite leaves the attribute as it is.
    pub strength: [f32; ATTRIBUTES],
    /// Strengths that the keyframes are for; `None` before the first frame.
    pub(super) played: Option<[f32; ATTRIBUTES]>,
    pub(super) motion: Motion<JOINTS, KEYS>,
    /// Between keyframes `piece` and `piece + 1`.
    pub(super) piece: usize,
    /// Time since keyframe `piece`, s.
    pub(super) into: f32,
    /// True once a motion that is no cycle has ended.
    pub(super) ended: bool,
    pub(super) place: Place,
    pub(super) fade: Fade<JOINTS>,
}

impl<const JOINTS: usize, const KEYS: usize> EmotionState<JOINTS, KEYS> {
    /// At the first keyframe, at the origin, facing +Z, strengths 0.
    pub fn new() -> Self {
        Self {
            strength: [0.0; ATTRIBUTES],
            played: None,
            motion: Motion::new(),
            piece: 0,
            into: 0.0,
            ended: false,
            place: Place::default(),
            fade: Fade::none(),
        }
    }

    /// Back to the first keyframe at the origin, at once; keeps the wanted strengths.
    pub fn reset(&mut self) {
        *self = Self { strength: self.strength, ..Self::new() };
    }

    /// Strengths that play; `None` before the first frame.
    pub fn playing(&self) -> Option<[f32; ATTRIBUTES]> {
        self.played
    }

    /// How long the motion, or one round of it, takes at the present strength, s; 0 before the first frame.
    pub fn seconds(&self) -> f32 {
        self.motion.seconds
    }

    /// Keyframe that was passed last, and the part of the way to the next one, 0 to 1.
    pub fn phase(&self) -> (usize, f32) {
        let own = self.motion.duration(self.piece);
        (self.piece, if own > 0.0 { self.into / own } else { 0.0 })
    }

    /// True once a motion that is no cycle has ended: its last pose stays.
    pub fn has_ended(&self) -> bool {
        self.ended
    }

    /// Where the motion's first keyframe stands: of a cycle, of this round.
    pub fn place(&self) -> Place {
        self.place
    }

    /// Moves everything, at once: to start somewhere, or to bring a walk of hours back to the origin, where single precision
    /// is finest. (Ten kilometres away a millimetre is its last digit.)
    pub fn put(&mut self, place: Place) {
        let [sin, cos] = place.heading.turn_from(self.place.heading);
        self.fade.turn(Place { ground: Vector3::zeros(), heading: crate::pose::Heading::default().turned(sin, cos) });
        self.place = place;
    }
}

impl<const JOINTS: usize, const KEYS: usize> Default for EmotionState<JOINTS, KEYS> {
    fn default() -> Self {
        Self::new()
    }
}

/// Time in which an offset fades out, s.
pub const FADE: f32 = 0.3;

/// What joints are ahead of the spline after a change, in position and in velocity, and how it fades: a cubic that begins with
/// both and ends with neither. Its acceleration is at most `6 |offset| / FADE^2 + 4 |rate| / FADE`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fade<const JOINTS: usize> {
    /// m, along the world's axes.
    offset: [Vector3<f32>; JOINTS],
    /// m/s.
    rate: [Vector3<f32>; JOINTS],
    /// Time since the change, s; [`FADE`] once nothing is left.
    since: f32,
}

impl<const JOINTS: usize> Fade<JOINTS> {
    pub fn none() -> Self {
        Self { offset: [Vector3::zeros(); JOINTS], rate: [Vector3::zeros(); JOINTS], since: FADE }
    }

    /// From now on these offsets and rates.
    pub fn start(offset: [Vector3<f32>; JOINTS], rate: [Vector3<f32>; JOINTS]) -> Self {
        Self { offset, rate, since: 0.0 }
    }

    /// Time passes.
    pub fn advance(&mut self, seconds: f32) {
        self.since = (self.since + seconds).min(FADE);
    }

    fn turn(&mut self, turn: Place) {
        for v in self.offset.iter_mut().chain(&mut self.rate) {
            *v = turn.apply(*v);
        }
    }

    /// Offset and rate of every joint now. Cost: 12 multiply-adds a joint.
    pub fn now(&self) -> impl Iterator<Item = (Vector3<f32>, Vector3<f32>)> {
        let u = self.since / FADE;
        let v = 1.0 - u;
        let (offset, rate) = (v * v * (1.0 + 2.0 * u), FADE * u * v * v);
        let (offset_rate, rate_rate) = (-6.0 * u * v / FADE, v * (1.0 - 3.0 * u));
        let pairs = self.offset.iter().zip(&self.rate);
        pairs.map(move |(o, r)| (o * offset + r * rate, o * offset_rate + r * rate_rate))
    }
}
