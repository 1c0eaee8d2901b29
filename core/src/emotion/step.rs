//! One frame of playback, and a change of strength.

use nalgebra::Vector3;

use super::model::Emotion;
use super::place::Place;
use super::spline::Taps;
use super::state::{EmotionState, Fade, Lead};
use crate::kernel::sin_cos;
use crate::pose::Heading;
use crate::rig::Frame;

/// Coordinates as they move; the root relative to the point on the ground below the spline, along the world's axes.
struct Moving<const ROWS: usize> {
    rows: [Vector3<f32>; ROWS],
    rates: [Vector3<f32>; ROWS],
    heading: Heading,
    /// rad/s.
    turning: f32,
}

impl<const ROWS: usize, const KEYS: usize, const WIDTH: usize> Emotion<'_, ROWS, KEYS, WIDTH> {
    /// The frame now to `frame`; then `dt` seconds pass. Infallible; every loop has a length fixed at load time.
    ///
    /// `dt` may differ from frame to frame: 30, 60 and 120 frames a second show the same coordinates at the same times. It is held
    /// between 0 and the length of one round; one that is not finite counts as 0. Where `state.strength` is not what plays,
    /// [`change`](Self::change) comes first.
    /// Coordinates and their velocities have no jump. A body that travels gets its heading and its ground too; travel is the step
    /// since the last frame. Should the frame not be [sound](Frame::is_sound), `frame` stays as it was.
    /// Cost: about 30 multiply-adds per row.
    pub fn step(&self, state: &mut EmotionState<ROWS, KEYS>, dt: f32, frame: &mut Frame<ROWS>) {
        self.change(state);
        self.show(state, frame);
        self.advance(state, dt);
    }

    /// Evaluates the network where `state.strength` is not what plays, and does nothing otherwise. [`step`](Self::step) does it
    /// too: call it before where a frame has no time for it. Cost: [`multiply_adds`](Self::multiply_adds), a hundred per row.
    ///
    /// The phase is kept, and so are the root's place on the ground and the direction in which a cycle goes. What coordinates and
    /// their velocities then differ by fades out within [`FADE`](super::FADE) seconds, so that a change alone moves nothing and
    /// alters no velocity.
    pub fn change(&self, state: &mut EmotionState<ROWS, KEYS>) {
        let strength = self.held(&state.strength, &state.played.unwrap_or_default());
        if state.played == Some(strength) {
            return;
        }
        let before = state.played.map(|_| (self.moving(state), self.anchor(state)));
        let (_, part) = state.phase();
        self.evaluate(&strength, &mut state.motion);
        state.into = part * state.motion.duration(state.piece);
        state.played = Some(strength);
        if let Some((moving, anchor)) = before {
            self.go_on(state, &moving, anchor);
        }
    }

    /// Plays from the first keyframe again, from where the root is; what the posture differs by fades out.
    pub fn restart(&self, state: &mut EmotionState<ROWS, KEYS>) {
        let (moving, anchor) = (self.moving(state), self.anchor(state));
        (state.piece, state.into, state.ended) = (0, 0.0, false);
        if state.played.is_some() {
            self.go_on(state, &moving, anchor);
        }
    }

    /// Puts the motion where the root was, and fades out how it differs from how it moved.
    fn go_on(&self, state: &mut EmotionState<ROWS, KEYS>, moving: &Moving<ROWS>, anchor: Place) {
        state.fade = Fade::none();
        state.place = Place::default();
        let new = self.anchor(state);
        let [sin, cos] = anchor.heading.turn_from(new.heading);
        let heading = Heading::default().turned(sin, cos);
        state.place = Place { ground: anchor.ground - heading.to_world(new.ground), heading };
        let Moving { mut rows, mut rates, heading, turning } = self.moving(state);
        let differ = |(new, old): (&mut Vector3<f32>, &Vector3<f32>)| *new = old - *new;
        rows.iter_mut().zip(&moving.rows).for_each(differ);
        rates.iter_mut().zip(&moving.rates).for_each(differ);
        let heading = [moving.heading.angle_from(heading), moving.turning - turning];
        state.fade = Fade::start(Lead { offset: rows, rate: rates, heading });
    }

    /// The point below the root, and the direction in which the motion goes.
    fn anchor(&self, state: &EmotionState<ROWS, KEYS>) -> Place {
        if !self.travels {
            return Place::default();
        }
        let taps = state.motion.taps(state.piece, state.into);
        let root = blend(&taps.value, state.motion.around(state.piece, 0));
        let heading = state.motion.course(state.motion.share(state.piece, state.into));
        state.place.then(&Place { ground: Vector3::new(root.x, 0.0, root.z), heading })
    }

    /// How the coordinates move now.
    fn moving(&self, state: &EmotionState<ROWS, KEYS>) -> Moving<ROWS> {
        let taps = self.taps(state);
        let (heading, turning) = self.facing(state, &taps);
        let mut moving = Moving { rows: [Vector3::zeros(); ROWS], rates: [Vector3::zeros(); ROWS], heading, turning };
        let to = moving.rows.iter_mut().zip(&mut moving.rates).zip(state.fade.now());
        for (row, ((value, rate), (offset, offset_rate))) in to.enumerate().take(self.rows) {
            let around = state.motion.around(state.piece, row);
            let (at, speed) = (blend(&taps.value, around), blend(&taps.rate, around));
            let (at, speed) = if self.travels && row == 0 {
                (Vector3::new(0.0, at.y, 0.0), state.place.heading.to_world(speed))
            } else {
                (at, speed)
            };
            (*value, *rate) = (at + offset, speed + offset_rate);
        }
        moving
    }

    /// Where the body faces, world, and how fast it turns, rad/s.
    fn facing(&self, state: &EmotionState<ROWS, KEYS>, taps: &Taps) -> (Heading, f32) {
        if !self.travels {
            return (Heading::default(), 0.0);
        }
        let headings = state.motion.headings(state.piece);
        let [offset, rate] = state.fade.heading();
        let (sin, cos) = sin_cos(taps.value(headings) + offset);
        (state.place.heading.turned(sin, cos), taps.rate(headings) + rate)
    }

    /// Weights of the keyframes now; a motion that has ended stands.
    fn taps(&self, state: &EmotionState<ROWS, KEYS>) -> Taps {
        let mut taps = state.motion.taps(state.piece, state.into);
        if state.ended {
            taps.rate = [0.0; 4];
        }
        taps
    }

    /// `dt` seconds pass unseen: over keyframes, and into the next round of a cycle. Nothing happens before the first frame.
    /// Cost: a few operations per keyframe that is passed.
    pub fn advance(&self, state: &mut EmotionState<ROWS, KEYS>, dt: f32) {
        if state.played.is_none() {
            return;
        }
        let mut left = if dt.is_finite() { dt.max(0.0).min(state.motion.seconds) } else { 0.0 };
        for _ in 0..=state.motion.pieces {
            let until = state.motion.duration(state.piece) - state.into;
            if left < until || state.ended {
                break;
            }
            left -= until;
            state.fade.advance(until);
            if state.piece + 1 < state.motion.pieces {
                (state.piece, state.into) = (state.piece + 1, 0.0);
            } else if let Some(round) = &state.motion.round {
                (state.piece, state.into) = (0, 0.0);
                state.place = state.place.then(round);
            } else {
                state.into = state.motion.duration(state.piece);
                let Moving { mut rows, rates, turning, .. } = self.moving(state);
                rows.iter_mut().zip(state.fade.now()).for_each(|(to, (offset, _))| *to = offset);
                let [offset, _] = state.fade.heading();
                state.fade = Fade::start(Lead { offset: rows, rate: rates, heading: [offset, turning] });
                state.ended = true;
            }
        }
        state.fade.advance(left);
        if !state.ended {
            state.into += left;
        }
    }

    /// The point on the spline.
    fn show(&self, state: &mut EmotionState<ROWS, KEYS>, frame: &mut Frame<ROWS>) {
        let taps = self.taps(state);
        let before = *frame;
        frame.rows = [[0.0; 3]; ROWS];
        let rows = frame.rows.iter_mut().zip(state.fade.now()).enumerate().take(self.rows);
        for (row, (to, (offset, _))) in rows {
            *to = (blend(&taps.value, state.motion.around(state.piece, row)) + offset).into();
        }
        if let (Some(row), true) = (frame.rows.first_mut(), self.travels) {
            let [offset, _] = state.fade.now().next().map_or([Vector3::zeros(); 2], |(offset, rate)| [offset, rate]);
            let root = state.place.apply(blend(&taps.value, state.motion.around(state.piece, 0))) + offset;
            let ground = Vector3::new(root.x, 0.0, root.z);
            (frame.heading, _) = self.facing(state, &taps);
            let travel = frame.heading.to_local(ground - state.last.unwrap_or(ground));
            *row = [travel.x, root.y, travel.z];
            (frame.ground, frame.leap) = ([root.x, root.z], [0.0; 2]);
            state.last = Some(ground);
        }
        if !frame.is_sound() {
            *frame = before;
        }
    }
}

/// The weighted sum of four keyframes.
fn blend([a, b, c, d]: &[f32; 4], [p, q, r, s]: [Vector3<f32>; 4]) -> Vector3<f32> {
    p * *a + q * *b + r * *c + s * *d
}
