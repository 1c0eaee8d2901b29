//! What a playing motion remembers.

use nalgebra::Vector3;

use super::motion::Motion;
use super::place::Place;
use crate::model::ATTRIBUTES;

/// What a playing motion remembers: its keyframes, where it is in them and in the world, and what still fades out after a
/// change. About `12 ROWS (KEYS + 2)` bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmotionState<const ROWS: usize, const KEYS: usize> {
    /// Strength of each attribute that is wanted, in units of the training's ranking function; it may change at any frame. Held
    /// inside the pack's range; one that is not finite leaves the attribute as it is.
    pub strength: [f32; ATTRIBUTES],
    /// Strengths that the keyframes are for; `None` before the first frame.
    pub(super) played: Option<[f32; ATTRIBUTES]>,
    pub(super) motion: Motion<ROWS, KEYS>,
    /// Between keyframes `piece` and `piece + 1`.
    pub(super) piece: usize,
    /// Time since keyframe `piece`, s.
    pub(super) into: f32,
    /// True once a motion that is no cycle has ended.
    pub(super) ended: bool,
    pub(super) place: Place,
    pub(super) fade: Fade<ROWS>,
    /// Where the root was in the last frame, on the ground; `None` before the first one.
    pub(super) last: Option<Vector3<f32>>,
}

impl<const ROWS: usize, const KEYS: usize> EmotionState<ROWS, KEYS> {
    /// At the first keyframe, at the origin, facing +Z, strengths 0.
    pub const fn new() -> Self {
        Self {
            strength: [0.0; ATTRIBUTES],
            played: None,
            motion: Motion::new(),
            piece: 0,
            into: 0.0,
            ended: false,
            place: Place::new(),
            fade: Fade::none(),
            last: None,
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

    /// True once a motion that is no cycle has ended: its last frame stays.
    pub fn has_ended(&self) -> bool {
        self.ended
    }

    /// Where the motion's first keyframe stands: of a cycle, of this round. Between pose and pose
    /// ([`Pipeline`](crate::engine::Pipeline)) it is measured from where the body stands.
    pub fn place(&self) -> Place {
        self.place
    }

    /// Moves everything, at once: to start somewhere, or to bring a walk of hours back to the origin, where single precision
    /// is finest. (Ten kilometres away a millimetre is its last digit.) It is no travel. A machine that stands has no place.
    pub fn put(&mut self, place: Place) {
        let [sin, cos] = place.heading.turn_from(self.place.heading);
        let turn = Place { heading: Place::new().heading.turned(sin, cos), ..Place::new() };
        if self.motion.travels {
            self.fade.turn(&turn);
        }
        self.last = self.last.map(|last| place.apply(self.place.undo(last)));
        self.place = place;
    }

    /// The origin moves to where the root was last.
    pub(super) fn come_along(&mut self) {
        if let Some(last) = self.last {
            self.place.ground -= last;
            self.last = Some(Vector3::zeros());
        }
    }
}

impl<const ROWS: usize, const KEYS: usize> Default for EmotionState<ROWS, KEYS> {
    fn default() -> Self {
        Self::new()
    }
}

/// Time in which an offset fades out, s.
pub const FADE: f32 = 0.3;

/// What coordinates are ahead of the spline after a change, in value and in velocity, and how it fades: a cubic that begins with
/// both and ends with neither. Its acceleration is at most `6 |offset| / FADE^2 + 4 |rate| / FADE`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fade<const ROWS: usize> {
    /// The change that fades, as it was at first.
    from: Lead<ROWS>,
    /// Time since the change, s; [`FADE`] once nothing is left.
    since: f32,
}

/// How far coordinates are ahead, and how much faster they go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lead<const ROWS: usize> {
    /// rad or m; the root's along the world's axes.
    pub offset: [Vector3<f32>; ROWS],
    /// The same in a second.
    pub rate: [Vector3<f32>; ROWS],
    /// Offset and rate of the heading, rad and rad/s.
    pub heading: [f32; 2],
}

impl<const ROWS: usize> Lead<ROWS> {
    pub const NONE: Self = Self {
        offset: [Vector3::new(0.0, 0.0, 0.0); ROWS],
        rate: [Vector3::new(0.0, 0.0, 0.0); ROWS],
        heading: [0.0; 2],
    };
}

impl<const ROWS: usize> Fade<ROWS> {
    pub const fn none() -> Self {
        Self { from: Lead::NONE, since: FADE }
    }

    /// From now on these offsets and rates.
    pub fn start(from: Lead<ROWS>) -> Self {
        Self { from, since: 0.0 }
    }

    /// Time passes.
    pub fn advance(&mut self, seconds: f32) {
        self.since = (self.since + seconds).min(FADE);
    }

    /// Turns the root's.
    fn turn(&mut self, turn: &Place) {
        for v in self.from.offset.first_mut().into_iter().chain(self.from.rate.first_mut()) {
            *v = turn.apply(*v);
        }
    }

    /// Offset by offset and by rate, then rate by offset and by rate.
    fn factors(&self) -> [f32; 4] {
        let u = self.since / FADE;
        let v = 1.0 - u;
        [v * v * (1.0 + 2.0 * u), FADE * u * v * v, -6.0 * u * v / FADE, v * (1.0 - 3.0 * u)]
    }

    /// Offset and rate of every row now. Cost: 12 multiply-adds per row.
    pub fn now(&self) -> impl Iterator<Item = (Vector3<f32>, Vector3<f32>)> {
        let [a, b, c, d] = self.factors();
        self.from.offset.iter().zip(&self.from.rate).map(move |(o, r)| (o * a + r * b, o * c + r * d))
    }

    /// Offset and rate of the heading now.
    pub fn heading(&self) -> [f32; 2] {
        let [a, b, c, d] = self.factors();
        let [o, r] = self.from.heading;
        [o * a + r * b, o * c + r * d]
    }
}
