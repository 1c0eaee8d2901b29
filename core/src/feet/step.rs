//! One frame.

use nalgebra::Vector3;

use super::leg::{Bones, norm};
use super::state::Held;
use super::{Feet, FeetState};
use crate::kernel::sqrt;
use crate::mechanics::contact;
use crate::pose::{Pose, is_number};
use crate::rig::carried;

/// A root that goes farther in a frame, m, was put elsewhere.
const LEAP: f32 = 0.5;
/// Time over which a foot is taken hold of, and let go, s.
const TAKES: f32 = 0.07;
const LEAVES: f32 = 0.12;
/// Time constant with which a foot that is let go returns to where the style has it, s.
const RETURNS: f32 = 0.08;
/// Time constants of the root's speed: while a foot stands, and while none does, s.
const FOLLOWS: f32 = 0.05;
const FLIES: f32 = 0.5;
/// Part of what the legs are bent by that the root takes over, 1/s.
const RELIEVES: f32 = 2.0;
/// Greatest speed at which the root is carried, m/s of an adult.
const FASTEST: f32 = 2.0;
/// Greatest way by which a foot is moved, m of an adult.
const FARTHEST: f32 = 0.2;
/// Way of a foot that is noticed, m: less is rounding, and a straight knee would change sides for it.
const NOTICED: f32 = 5e-5;

impl Feet<'_> {
    /// One frame: `out` is what the pipeline made of `source`, or what it shows where none came. Infallible: it never fails, allocates or
    /// panics; a sound pose stays sound, and one that is not is left alone. A source that is missing or garbled changes nothing: feet
    /// are held as they were. Cost: about 3000 multiply-adds, 40 roots.
    ///
    /// It turns hips, knees and ankles and carries the root, after whatever limits did.
    pub fn step<const JOINTS: usize>(
        &self,
        state: &mut FeetState,
        source: Option<&Pose<JOINTS>>,
        out: &mut Pose<JOINTS>,
    ) {
        let joints = self.skeleton.joints();
        if JOINTS < joints || !out.is_sound(joints) {
            return;
        }
        if let Some(source) = source.filter(|source| source.is_sound(joints)) {
            self.follow(state, source, out);
        }
        let [x, z] = state.shift;
        let root = [out.root.x + x, out.root.z + z];
        if root.iter().all(|x| is_number(*x)) {
            [out.root.x, out.root.z] = root;
        }
        for (leg, held) in self.legs.iter().zip(&mut state.held) {
            let bones = Bones::of(&self.skeleton, leg, out);
            bones.learn(&mut held.axis);
            if norm(held.way) > NOTICED {
                bones.reach(&self.skeleton, leg, &held.axis, held.way, out);
            }
        }
    }

    /// Which feet stand, where the root goes, and how far each foot is moved.
    fn follow<const JOINTS: usize>(&self, state: &mut FeetState, source: &Pose<JOINTS>, out: &Pose<JOINTS>) {
        let from = self.legs.map(|leg| self.skeleton.point(source, leg.joint, leg.tip));
        let to = self.legs.map(|leg| self.skeleton.point(out, leg.joint, leg.tip));
        let points = from.map(|point| [point + source.root; 2]);
        let carried_by = out.root - source.root;
        let clearance = [[0.0; 2]; 2];
        let way = source.root - state.root;
        let leaps = !state.started || way.x * way.x + way.z * way.z > LEAP * LEAP;
        if leaps {
            contact::start(&mut state.source, &points, &clearance, &self.thresholds);
        } else {
            contact::advance(&mut state.source, &points, &clearance, &self.thresholds, self.frame_time);
        }
        (state.root, state.started) = (source.root, true);

        // Where each foot came against the source's, and what it slipped since the last frame.
        let [left, right] = [from, to];
        let mut slips = [Vector3::zeros(); 2];
        for ((slip, held), (from, to)) in slips.iter_mut().zip(&mut state.held).zip(left.iter().zip(&right)) {
            let now = to - from + carried_by;
            *slip = if leaps { Vector3::zeros() } else { now - held.before };
            held.before = now;
        }
        for (foot, held) in state.source.iter().zip(&mut state.held) {
            let time = if foot.stands() { self.frame_time / TAKES } else { -self.frame_time / LEAVES };
            held.weight = (held.weight + time).max(0.0).min(1.0);
        }
        let step = self.carry(state, &slips, [carried_by.x, carried_by.z]);
        for (((held, slip), foot), to) in state.held.iter_mut().zip(&slips).zip(&state.source).zip(&right) {
            self.hold(held, *slip, step, foot.ground() - (to.y + out.root.y));
        }
    }

    /// Carries the root as the feet that stand want it; the step, m.
    fn carry(&self, state: &mut FeetState, slips: &[Vector3<f32>; 2], by: [f32; 2]) -> [f32; 2] {
        let (mut sum, mut wanted, mut left) = (0.0, [0.0; 2], [0.0; 2]);
        for (held, slip) in state.held.iter().zip(slips) {
            let weight = smooth(held.weight);
            sum += weight;
            for ((wanted, left), (slip, way)) in
                wanted.iter_mut().zip(&mut left).zip([(slip.x, held.way.x), (slip.z, held.way.z)])
            {
                *wanted -= weight * slip;
                *left += weight * way;
            }
        }
        let share = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        let stands = sum.min(1.0);
        let follow = (self.frame_time * stands / FOLLOWS).min(1.0);
        let fade = (self.frame_time * (1.0 - stands) / FLIES).min(1.0);
        let mut speed = [0.0; 2];
        for ((speed, own), (wanted, left)) in
            speed.iter_mut().zip(&mut state.speed).zip(wanted.iter().zip(&left))
        {
            *own += (wanted * share / self.frame_time - *own) * follow - *own * fade;
            *speed = *own + RELIEVES * left * share * stands;
        }
        let [x, z] = speed;
        let (fast, most) = (sqrt(x * x + z * z), FASTEST * self.size);
        let time = self.frame_time * if fast > most { most / fast } else { 1.0 };
        let ([shift_x, shift_z], [by_x, by_z]) = (state.shift, by);
        let at = [by_x + shift_x, by_z + shift_z];
        let [to_x, to_z] = carried(at, [x * time, z * time], self.reach);
        let step = [to_x - (by_x + shift_x), to_z - (by_z + shift_z)];
        let [step_x, step_z] = step;
        state.shift = [shift_x + step_x, shift_z + step_z];
        step
    }

    /// Moves a foot by what it slips while it is held, and lets it return while it is not. `sunk` is how far it is under the ground of the
    /// source's foot.
    fn hold(&self, held: &mut Held, slip: Vector3<f32>, [step_x, step_z]: [f32; 2], sunk: f32) {
        let weight = smooth(held.weight);
        let returns = (1.0 - weight) * (self.frame_time / RETURNS).min(1.0);
        let (x, z) = (held.way.x, held.way.z);
        let [x, z] = [
            x - weight * (slip.x + step_x) - returns * x,
            z - weight * (slip.z + step_z) - returns * z,
        ];
        let (far, most) = (sqrt(x * x + z * z), FARTHEST * self.size);
        let share = if far > most { most / far } else { 1.0 };
        let height = (-weight * held.before.y).max(sunk.min(-held.before.y));
        held.way = Vector3::new(x * share, height.max(-most).min(most), z * share);
    }
}

/// From 0 to 1, smooth at both ends.
fn smooth(part: f32) -> f32 {
    part * part * (3.0 - 2.0 * part)
}
