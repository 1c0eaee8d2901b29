//! One frame.

use nalgebra::Vector3;

use super::leg::{Bones, norm};
use super::state::Held;
use super::{Feet, FeetState};
use crate::kernel::sqrt;
use crate::mechanics::contact;
use crate::pose::{Pose, is_number};
use crate::rig::carried;

/// Both points of a foot are one, which touches the ground.
const CLEARANCE: [[f32; 2]; 2] = [[0.0; 2]; 2];
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
/// Time constant of the slow way of a foot that stands, s: a source that slides takes the result along, one that shakes does not.
const SLOWLY: f32 = 0.2;
/// Time constant of the height at which a foot is held, s.
const SETTLES: f32 = 0.03;
/// Greatest speed at which the root is carried, m/s of an adult.
const FASTEST: f32 = 2.0;
/// Greatest speed at which the way of a foot changes, m/s of an adult: a source that jumps is not followed.
const HASTY: f32 = 1.0;
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
        } else {
            state.gap = state.gap.saturating_add(1);
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
        let from = self.legs.map(|leg| source.root + self.skeleton.point(source, leg.joint, leg.tip));
        let to = self.legs.map(|leg| out.root + self.skeleton.point(out, leg.joint, leg.tip));
        let by = [out.root.x - source.root.x, out.root.z - source.root.z];
        let gap = state.gap > 0;
        let leaps = self.watch(state, &source.root, &from);
        // Nothing is known of how a foot came here.
        let new = leaps || gap;
        let mut slips = [Vector3::zeros(); 2];
        let feet = state.held.iter_mut().zip(&state.source).zip(from.into_iter().zip(to));
        for (slip, ((held, foot), (from, to))) in slips.iter_mut().zip(feet) {
            let [from_before, to_before] = core::mem::replace(&mut held.before, [from, to]);
            // What the style leaves alone is the source's, bit for bit.
            let stands = foot.stands() && (to != from || by != [0.0; 2]);
            if stands {
                // The observer's ground is another one as soon as the foot lifts.
                held.ground += (foot.ground() - held.ground) * if held.weight > 0.0 { self.part(SETTLES) } else { 1.0 };
            }
            if new || !stands {
                held.slow = Vector3::zeros();
            } else {
                held.slow += (from - from_before - held.slow) * self.part(SLOWLY);
            }
            if !new {
                *slip = to - to_before - held.slow;
            }
            let time = if stands { self.part(TAKES) } else { -self.part(LEAVES) };
            held.weight = (held.weight + time).clamp(0.0, 1.0);
        }
        let step = self.carry(state, &slips, by, leaps);
        let [left, right] = &state.source;
        let floor = left.ground().min(right.ground());
        for (held, slip) in state.held.iter_mut().zip(&slips) {
            self.hold(held, *slip, step, floor);
        }
    }

    /// Which feet of the source stand. True where it was put elsewhere.
    fn watch(&self, state: &mut FeetState, root: &Vector3<f32>, from: &[Vector3<f32>; 2]) -> bool {
        let points = from.map(|point| [point; 2]);
        let way = root - state.root;
        let leaps = !state.started || way.x * way.x + way.z * way.z > LEAP * LEAP;
        if leaps {
            contact::start(&mut state.source, &points, &CLEARANCE, &self.thresholds);
        } else {
            let elapsed = self.frame_time * (1.0 + f32::from(state.gap));
            contact::advance(&mut state.source, &points, &CLEARANCE, &self.thresholds, elapsed);
        }
        (state.root, state.started, state.gap) = (*root, true, 0);
        leaps
    }

    /// Part of a change that a frame makes, with a time constant in s.
    fn part(&self, time: f32) -> f32 {
        (self.frame_time / time).min(1.0)
    }

    /// Carries the root as the feet that stand want it; the step, m.
    fn carry(&self, state: &mut FeetState, slips: &[Vector3<f32>; 2], by: [f32; 2], leaps: bool) -> [f32; 2] {
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
        let (follow, fade) = (self.part(FOLLOWS) * stands, self.part(FLIES) * (1.0 - stands));
        let mut speed = [0.0; 2];
        for ((speed, own), (wanted, left)) in speed.iter_mut().zip(&mut state.speed).zip(wanted.iter().zip(&left)) {
            *own += (wanted * share / self.frame_time - *own) * follow - *own * fade;
            *speed = *own + RELIEVES * left * share * stands;
        }
        let [x, z] = speed;
        let (fast, most) = (sqrt(x * x + z * z), FASTEST * self.size);
        let time = self.frame_time * if fast > most { most / fast } else { 1.0 };
        let at = self.within(state, by, leaps);
        let [to_x, to_z] = carried(at, [x * time, z * time], self.reach);
        let ([by_x, by_z], [shift_x, shift_z]) = (by, state.shift);
        let shift = [to_x - by_x, to_z - by_z];
        (state.by, state.shift) = (by, shift);
        let [x, z] = shift;
        [x - shift_x, z - shift_z]
    }

    /// Where the root is against the source's once the pipeline has put it elsewhere: within the reach, or not farther than there.
    fn within(&self, state: &FeetState, by: [f32; 2], leaps: bool) -> [f32; 2] {
        let ([x, z], [before_x, before_z], [shift_x, shift_z]) = (by, state.by, state.shift);
        if leaps {
            return [x + shift_x, z + shift_z];
        }
        let before = [before_x + shift_x, before_z + shift_z];
        carried(before, [x - before_x, z - before_z], self.reach.max(sqrt(x * x + z * z)))
    }

    /// Moves a foot by what it slips while it is held, and lets it return while it is not. It is held on the ground, and never under both the
    /// floor and the foot of the source.
    fn hold(&self, held: &mut Held, slip: Vector3<f32>, [step_x, step_z]: [f32; 2], floor: f32) {
        let weight = smooth(held.weight);
        let returns = (1.0 - weight) * self.part(RETURNS);
        let (x, z) = (held.way.x, held.way.z);
        let [x, z] = [x - weight * (slip.x + step_x) - returns * x, z - weight * (slip.z + step_z) - returns * z];
        let (far, most) = (sqrt(x * x + z * z), FARTHEST * self.size);
        let share = if far > most { most / far } else { 1.0 };
        let [from, to] = held.before.map(|foot| foot.y);
        let height = (weight * (held.ground - to)).max(floor.min(from) - to);
        let way = Vector3::new(x * share, height.max(-most).min(most), z * share);
        let (change, most) = (way - held.way, HASTY * self.size * self.frame_time);
        let fast = norm(change);
        held.way += if fast > most { change * (most / fast) } else { change };
    }
}

/// From 0 to 1, smooth at both ends.
fn smooth(part: f32) -> f32 {
    part * part * (3.0 - 2.0 * part)
}
