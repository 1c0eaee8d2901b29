//! The applications on whole clips, with smooth expression: a change composed on the clip itself, so that no change is no change.

use kinesic::mechanics::Modulation;
use nalgebra::{UnitQuaternion, Vector3};

use super::expressive::Expressive;
use crate::clip::{Canonical, Clip, JointMap};
use crate::rig::MAX_JOINTS;
use crate::steady::steady;

/// A change that comes and goes within so long to either side is a leap, s.
const LEAP: f64 = 0.05;

/// A clip on the pack's rig, at any rate, with more or less of its expression: `E*^(k - 1) O`. At 1 it is the clip, bit for bit.
pub fn modulate_clip(clip: &Clip, expressive: &Expressive, modulation: &Modulation<MAX_JOINTS>) -> Clip {
    turned(clip, expressive.width(), |frame| {
        let mut turns = expressive.at(frame as f64 * clip.frame_time);
        for (turn, weight) in turns.iter_mut().zip(&modulation.mask) {
            *turn *= finite(weight * (modulation.amount - 1.0));
        }
        turns.into_iter().map(UnitQuaternion::from_scaled_axis).collect()
    })
}

/// The mechanics of a clip on the pack's rig with another's expression: `E*_b^(k w) E*_a^(-w) O_a`. `starts` are the times, s, at which the
/// first frame of `mechanics` lies in the clips of `own` and of `other`.
pub fn mix_clip(
    mechanics: &Clip,
    [own, other]: [&Expressive; 2],
    starts: [f64; 2],
    modulation: &Modulation<MAX_JOINTS>,
) -> Clip {
    turned(mechanics, own.width().max(other.width()), |frame| {
        let time = frame as f64 * mechanics.frame_time;
        let [kept, added] = [own.at(starts[0] + time), other.at(starts[1] + time)];
        let turn = |((kept, added), weight): ((&Vector3<f64>, &Vector3<f64>), &f32)| {
            let [off, on] = [finite(-*weight) * kept, finite(weight * modulation.amount) * added];
            UnitQuaternion::from_scaled_axis(on) * UnitQuaternion::from_scaled_axis(off)
        };
        kept.iter().zip(&added).zip(&modulation.mask).map(turn).collect()
    })
}

fn finite(weight: f32) -> f64 {
    if weight.is_finite() { f64::from(weight) } else { 0.0 }
}

/// A clip with a turn of every joint, given in the parent's frame.
///
/// What the turns make of each bone in the world is smoothed once more, under a bell of `width` seconds, and laid over the bone as the clip has
/// it. So a joint that twitches carries what hangs on it as before, and does not swing the axes about which that is turned.
fn turned(clip: &Clip, width: f64, mut turns: impl FnMut(usize) -> Vec<UnitQuaternion<f64>>) -> Clip {
    let (joints, fps) = (clip.skeleton.len(), clip.fps());
    let still = UnitQuaternion::identity();
    let parents: Vec<Option<usize>> = clip.skeleton.joints.iter().map(|joint| joint.parent).collect();
    let (mut seen, mut changes) = (Vec::with_capacity(clip.rotations.len()), Vec::with_capacity(clip.rotations.len()));
    for (frame, pose) in clip.rotations.chunks_exact(joints.max(1)).enumerate() {
        let [was, is] = [seen.len(), changes.len()];
        let mut turned: Vec<UnitQuaternion<f64>> = Vec::with_capacity(joints);
        for ((parent, local), turn) in parents.iter().zip(pose).zip(turns(frame)) {
            let Some(parent) = *parent else {
                seen.push(*local);
                turned.push(*local);
                changes.push(still);
                continue;
            };
            seen.push(seen[was + parent] * local);
            turned.push(turned[parent] * turn * local);
            let moved = turn != still || changes[is + parent] != still;
            changes.push(if moved { turned[turned.len() - 1] * seen[seen.len() - 1].inverse() } else { still });
        }
    }
    let reach = (LEAP * fps).round().max(2.0) as usize;
    let column = |joint: usize| steady(changes.iter().skip(joint).step_by(joints).copied(), reach, width * fps);
    let columns: Vec<_> = (0..joints).map(column).collect();
    let mut out = clip.clone();
    for (frame, pose) in out.rotations.chunks_exact_mut(joints.max(1)).enumerate() {
        let change = |joint: usize| UnitQuaternion::from_scaled_axis(columns[joint][frame]);
        for (joint, local) in pose.iter_mut().enumerate() {
            let Some(parent) = parents[joint] else { continue };
            let [own, above] = [change(joint), change(parent)];
            if own != above {
                let [own, above] = [own * seen[frame * joints + joint], above * seen[frame * joints + parent]];
                *local = above.inverse() * own;
            }
        }
    }
    out
}

/// A motion in its two parts, on one skeleton: what it is, and what is left of it without expression.
#[derive(Clone, Copy, Debug)]
pub struct Parted<'a> {
    /// The motion.
    pub observed: &'a Clip,
    /// The same without expression, frame for frame.
    pub plain: &'a Clip,
}

/// How one motion passes into another: seconds of the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// When the mechanics pass over.
    pub mechanics: [f64; 2],
    /// When the expression passes over.
    pub expressive: [f64; 2],
    /// When the second motion begins.
    pub start: f64,
}

impl Passage {
    /// When the second motion is moved and turned to where the first is.
    fn meet(&self) -> f64 {
        (0.5 * (self.mechanics[0] + self.mechanics[1])).max(self.start)
    }

    /// How far a window has passed, 0..1, with no jump in speed or acceleration at either end.
    fn weight([start, end]: [f64; 2], time: f64) -> f64 {
        let x = if end > start { ((time - start) / (end - start)).clamp(0.0, 1.0) } else { f64::from(time >= start) };
        x * x * x * (10.0 + x * (6.0 * x - 15.0))
    }
}

/// Two motions on one skeleton, whose joints `map` names, and at one rate, the first passing into the second. Before the second begins its
/// first frame is held, after the first has ended its last. Both have frames.
pub fn blend_clips(first: Parted<'_>, second: Parted<'_>, map: &JointMap, passage: &Passage) -> Clip {
    let (joints, fps) = (first.observed.skeleton.len(), first.observed.fps());
    let frame = |seconds: f64| (seconds * fps).round() as usize;
    let (start, meet) = (frame(passage.start), frame(passage.meet()));
    let [last_a, last_b] = [first, second].map(|split| split.observed.frames() - 1);
    let of_second = |frame: usize| frame.saturating_sub(start).min(last_b);
    let (a, b) = (meet.min(last_a), of_second(meet));
    let turn = yaw(first.observed, map, a) * yaw(second.observed, map, b).inverse();
    let shift = level(first.observed.root[a]) - turn * level(second.observed.root[b]);
    let frames = (last_a + 1).max(start + last_b + 1);

    let mut out = first.observed.slice(0..0);
    let mut sides = vec![[Side::default(); 2]; joints];
    for frame in 0..frames {
        let [a, b] = [frame.min(last_a), of_second(frame)];
        let time = frame as f64 / fps;
        let body = Passage::weight(passage.mechanics, time);
        let expression = Passage::weight(passage.expressive, time);
        let root = turn * second.observed.root[b] + shift;
        out.root.push(first.observed.root[a].lerp(&root, body));
        for (joint, [of_body, of_expression]) in sides.iter_mut().enumerate() {
            let turn = if joint == 0 { turn } else { UnitQuaternion::identity() };
            let of = |split: &Parted, frame: usize, turn: UnitQuaternion<f64>| {
                let [observed, plain] =
                    [split.observed, split.plain].map(|clip| turn * clip.rotations[frame * joints + joint]);
                (plain, observed * plain.inverse())
            };
            let (plain_a, own_a) = of(&first, a, UnitQuaternion::identity());
            let (plain_b, own_b) = of(&second, b, turn);
            out.rotations
                .push(of_expression.between(own_a, own_b, expression) * of_body.between(plain_a, plain_b, body));
        }
    }
    out
}

/// Two rotations that are followed through a blend, so that no pass of half a turn between them makes it jump.
#[derive(Clone, Copy, Default)]
struct Side {
    last: Option<[UnitQuaternion<f64>; 2]>,
}

impl Side {
    fn between(&mut self, a: UnitQuaternion<f64>, b: UnitQuaternion<f64>, weight: f64) -> UnitQuaternion<f64> {
        if weight <= 0.0 || weight >= 1.0 {
            self.last = None;
            return if weight <= 0.0 { a } else { b };
        }
        let near = |q: UnitQuaternion<f64>, to: &UnitQuaternion<f64>| {
            if q.coords.dot(&to.coords) < 0.0 { UnitQuaternion::new_unchecked(-q.into_inner()) } else { q }
        };
        // Where they meet the shorter way is chosen, and kept.
        let [a, b] = match self.last {
            Some([last_a, last_b]) => [near(a, &last_a), near(b, &last_b)],
            None => [a, near(b, &a)],
        };
        self.last = Some([a, b]);
        UnitQuaternion::try_new(a.into_inner() * (1.0 - weight) + b.into_inner() * weight, 1e-9).unwrap_or(a)
    }
}

fn level(v: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(v.x, 0.0, v.z)
}

/// The turn of the hips' line about the vertical.
fn yaw(clip: &Clip, map: &JointMap, frame: usize) -> UnitQuaternion<f64> {
    let at = clip.positions(frame);
    let hips = map.joint(Canonical::LHip).zip(map.joint(Canonical::RHip));
    let across = hips.map_or_else(Vector3::x, |(left, right)| at[left] - at[right]);
    UnitQuaternion::from_axis_angle(&Vector3::y_axis(), (-across.z).atan2(across.x))
}
