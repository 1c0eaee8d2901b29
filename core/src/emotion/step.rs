//! One frame of playback, and a change of strength.

use nalgebra::{Quaternion, Vector3};

use super::model::Emotion;
use super::place::Place;
use super::spline::Taps;
use super::state::{EmotionState, Fade};
use crate::pose::{Heading, Pose, World, forward, solve, unit};

/// Joints as they move: relative to the point below the root, along the world's axes.
struct Moving<const JOINTS: usize> {
    positions: [Vector3<f32>; JOINTS],
    rates: [Vector3<f32>; JOINTS],
}

impl<const JOINTS: usize, const KEYS: usize, const WIDTH: usize> Emotion<'_, JOINTS, KEYS, WIDTH> {
    /// The pose now to `pose`; then `dt` seconds pass. Infallible; every loop has a length fixed at load time.
    ///
    /// `dt` may differ from frame to frame: 30, 60 and 120 frames a second show the same poses at the same times. It is held
    /// between 0 and the length of one round; one that is not finite counts as 0. Where `state.strength` is not what plays,
    /// [`change`](Self::change) comes first.
    /// Joint positions and their velocities have no jump; a bone keeps its length, its twist comes from the reference poses.
    /// Cost: about 60 multiply-adds a joint for the spline, 250 for kinematics.
    pub fn step(&self, state: &mut EmotionState<JOINTS, KEYS>, dt: f32, pose: &mut Pose<JOINTS>) {
        self.change(state);
        self.show(state, pose);
        self.advance(state, dt);
    }

    /// Evaluates the network where `state.strength` is not what plays, and does nothing otherwise. [`step`](Self::step) does it
    /// too: call it before where a frame has no time for it. Cost: [`multiply_adds`](Self::multiply_adds), a few hundred a joint.
    ///
    /// The phase is kept, and so are the root's place on the ground and the direction in which a cycle goes. What position and velocity of the joints then differ by fades out
    /// within [`FADE`](super::FADE) seconds, so that a change alone moves nothing and alters no velocity.
    pub fn change(&self, state: &mut EmotionState<JOINTS, KEYS>) {
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
    pub fn restart(&self, state: &mut EmotionState<JOINTS, KEYS>) {
        let (moving, anchor) = (self.moving(state), self.anchor(state));
        (state.piece, state.into, state.ended) = (0, 0.0, false);
        if state.played.is_some() {
            self.go_on(state, &moving, anchor);
        }
    }

    /// Puts the motion where the root was, and fades out how it differs from how it moved.
    fn go_on(&self, state: &mut EmotionState<JOINTS, KEYS>, moving: &Moving<JOINTS>, anchor: Place) {
        state.fade = Fade::none();
        state.place = Place::default();
        let new = self.anchor(state);
        let [sin, cos] = anchor.heading.turn_from(new.heading);
        let heading = Heading::default().turned(sin, cos);
        state.place = Place { ground: anchor.ground - heading.to_world(new.ground), heading };
        let mut change = self.moving(state);
        let differ = |new: &mut Vector3<f32>, old: &Vector3<f32>| *new = old - *new;
        change.positions.iter_mut().zip(&moving.positions).for_each(|(new, old)| differ(new, old));
        change.rates.iter_mut().zip(&moving.rates).for_each(|(new, old)| differ(new, old));
        state.fade = Fade::start(change.positions, change.rates);
    }

    /// The point below the root, and the direction in which the motion goes.
    fn anchor(&self, state: &EmotionState<JOINTS, KEYS>) -> Place {
        let taps = state.motion.taps(state.piece, state.into);
        let root = blend(&taps.value, state.motion.around(state.piece, 0));
        let heading = state.motion.course(state.motion.share(state.piece, state.into));
        state.place.then(&Place { ground: Vector3::new(root.x, 0.0, root.z), heading })
    }

    /// How the joints move now.
    fn moving(&self, state: &EmotionState<JOINTS, KEYS>) -> Moving<JOINTS> {
        let taps = self.taps(state);
        let root = blend(&taps.value, state.motion.around(state.piece, 0));
        let ground = Vector3::new(root.x, 0.0, root.z);
        let mut moving = Moving { positions: [Vector3::zeros(); JOINTS], rates: [Vector3::zeros(); JOINTS] };
        let to = moving.positions.iter_mut().zip(&mut moving.rates).zip(state.fade.now());
        for (joint, ((position, rate), (offset, offset_rate))) in to.enumerate().take(self.skeleton.joints()) {
            let around = state.motion.around(state.piece, joint);
            *position = state.place.heading.to_world(blend(&taps.value, around) - ground) + offset;
            *rate = state.place.heading.to_world(blend(&taps.rate, around)) + offset_rate;
        }
        moving
    }

    /// Weights of the keyframes now; a motion that has ended stands.
    fn taps(&self, state: &EmotionState<JOINTS, KEYS>) -> Taps {
        let mut taps = state.motion.taps(state.piece, state.into);
        if state.ended {
            taps.rate = [0.0; 4];
        }
        taps
    }

    /// `dt` seconds pass unseen: over keyframes, and into the next round of a cycle. Nothing happens before the first frame.
    /// Cost: a few operations a keyframe that is passed.
    pub fn advance(&self, state: &mut EmotionState<JOINTS, KEYS>, dt: f32) {
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
                let mut moving = self.moving(state);
                moving.positions.iter_mut().zip(state.fade.now()).for_each(|(to, (offset, _))| *to = offset);
                state.fade = Fade::start(moving.positions, moving.rates);
                state.ended = true;
            }
        }
        state.fade.advance(left);
        if !state.ended {
            state.into += left;
        }
    }

    /// Positions on the spline, turned into rotations.
    fn show(&self, state: &EmotionState<JOINTS, KEYS>, pose: &mut Pose<JOINTS>) {
        let taps = self.taps(state);
        let mut world = World::identity();
        let joints = world.positions.iter_mut().zip(state.fade.now()).enumerate().take(self.skeleton.joints());
        for (joint, (target, (offset, _))) in joints {
            *target = state.place.apply(blend(&taps.value, state.motion.around(state.piece, joint))) + offset;
        }
        let targets = world.positions;
        let heading = state.place.heading.follow(&self.skeleton, &world);
        let mut reference = self.reference(state);
        if let (Some(root), Some(target)) = (reference.rotations.first_mut(), targets.first()) {
            *root = unit((heading.rotation() * *root).into_inner());
            reference.root = *target;
        }
        forward(&self.skeleton, &reference, &mut world);
        solve(&self.skeleton, &reference, &world, &targets, pose);
    }

    /// Rotations that twists come from: the same spline, keyframes evenly spaced, so that a change of strength leaves it alone.
    /// Cost: 24 multiply-adds and a root a joint.
    fn reference(&self, state: &EmotionState<JOINTS, KEYS>) -> Pose<JOINTS> {
        let (pieces, joints) = (state.motion.pieces, self.skeleton.joints());
        let (piece, part) = state.phase();
        let cycle = self.meta.cycle;
        let edge = |inside: bool| if inside || cycle { 1.0 } else { 0.0 };
        let taps = Taps::new([edge(piece > 0), 1.0, edge(piece + 1 < pieces)], part);
        // The last keyframe of a cycle is the first one.
        let wrap = |key: usize| if cycle && key >= pieces { key - pieces } else { key.min(pieces) };
        let before = if piece > 0 { piece - 1 } else { wrap(pieces.saturating_sub(1)) };
        let keys = [before, wrap(piece), wrap(piece + 1), wrap(piece + 2)];
        let mut pose = Pose::identity();
        for (joint, rotation) in pose.rotations.iter_mut().enumerate().take(joints) {
            let at = |key: usize| self.reference.get(key * joints + joint).copied().unwrap_or([0.0, 0.0, 0.0, 1.0]);
            let middle = at(wrap(piece));
            let mut sum = [0.0; 4];
            for (key, weight) in keys.iter().zip(taps.value) {
                let q = at(*key);
                let along: f32 = crate::kernel::dot(&q, &middle);
                let weight = if along < 0.0 { -weight } else { weight };
                sum.iter_mut().zip(q).for_each(|(sum, q)| *sum += weight * q);
            }
            let [i, j, k, w] = sum;
            *rotation = unit(Quaternion::new(w, i, j, k));
        }
        pose
    }
}

/// The weighted sum of four keyframes.
fn blend([a, b, c, d]: &[f32; 4], [p, q, r, s]: [Vector3<f32>; 4]) -> Vector3<f32> {
    p * *a + q * *b + r * *c + s * *d
}
