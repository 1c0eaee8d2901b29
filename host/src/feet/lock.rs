//! A styled clip whose feet stand where those of its source do.

use nalgebra::{UnitQuaternion, Vector3};

use super::contacts::{Foot, ground, runs};
use super::leg::{knee_axis, reach};
use crate::clip::{Clip, JointMap};
use crate::steady::steady;

/// Time over which a foot is let go after it stood, and caught before it stands, s.
const BLEND: f64 = 0.2;
/// Standard deviation of the smoothing of the root's corrections, s.
const SMOOTH: f64 = 0.05;
/// The ends of a contact count less over this time, s: there the foot already moves.
const RAMP: f64 = 0.06;
/// Longest time for which a styled foot is held before or after the contact of the source, s.
const GOES_ON: f64 = 0.15;
/// Way of a foot that is noticed, m: less is rounding, and a straight knee would change sides for it.
const NOTICED: f64 = 5e-5;
/// Change of a step from which a styled foot may go on standing, m.
const STYLED: f64 = 0.01;
/// Longest flight between two contacts over which the correction of the travel is carried on, s.
const FLIGHT: f64 = 0.4;
/// Part of its length to which a leg that stands is stretched at most.
const STRETCH: f64 = 0.985;
/// Standard deviation of the smoothing of what is familiar and of what is slow, s.
const SECOND: f64 = 1.0;
/// How familiar the motion must be for any of the style's travel, and for all of it: as on the device.
const TRAVEL: [f64; 2] = [0.5, 0.9];

/// How feet are held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold<'a> {
    /// Weight of the root, 0 to 1. At 0 it is left where the style has it, and feet stand on the very spots of the source.
    pub travels: f64,
    /// Standard deviation of the bell under which a foot is caught and let go, s: feet slip a little, and legs do not jerk.
    pub soft: f64,
    /// How familiar the motion is to the style, 0 to 1, evenly over the clip; empty where that is not known. Where it is not familiar the body
    /// goes where the source goes.
    pub familiar: &'a [f32],
}

impl Default for Hold<'_> {
    fn default() -> Self {
        Self { travels: 1.0, soft: 0.0, familiar: &[] }
    }
}

/// Holds feet: while a foot of `source` stands, that of `styled` moves as the source's does, at its height.
///
/// Both clips are of one skeleton, frame for frame. First the root's travel follows the feet that stand, so that the legs move the body and
/// nothing else does. Then the root is lowered where a leg is too short. Last each leg is bent so that its foot is where it stood,
/// blended in and out over .2 s. A foot in the air is kept over the ground. Where nothing was changed nothing changes.
pub fn lock(source: &Clip, styled: &Clip, map: &JointMap, hold: Hold) -> Clip {
    let Hold { travels, soft, familiar } = hold;
    let feet = Foot::of(&source.skeleton, map);
    let mut out = styled.clone();
    if feet.is_empty() || source.frames() < 2 {
        return out;
    }
    let fps = source.fps();
    let from: Vec<Vec<Vector3<f64>>> = feet.iter().map(|foot| foot.path(source)).collect();
    let stands: Vec<Vec<bool>> =
        feet.iter().zip(&from).map(|(foot, path)| Foot::stands(path, fps, foot.size(&source.skeleton))).collect();
    let to: Vec<Vec<Vector3<f64>>> = feet.iter().map(|foot| foot.path(styled)).collect();
    for (root, way) in out.root.iter_mut().zip(travel(&from, &to, &stands, fps)) {
        *root += travels * way;
    }
    let astray = unlearned(&source.root, &out.root, familiar, fps);
    for (root, way) in out.root.iter_mut().zip(astray) {
        *root -= travels * way;
    }
    let to: Vec<Vec<Vector3<f64>>> = feet.iter().map(|foot| foot.path(&out)).collect();
    let hold = |((foot, from), (to, stands)): ((&Foot, &Vec<_>), (&Vec<_>, &Vec<_>))| {
        holds([from, to], stands, &Foot::stands(to, fps, foot.size(&source.skeleton)), fps, travels)
    };
    let mut ways: Vec<Vec<Vector3<f64>>> = feet.iter().zip(&from).zip(to.iter().zip(&stands)).map(hold).collect();
    let drops = drops(&out, &feet, &ways, &stands, fps);
    for (frame, drop) in drops.iter().enumerate() {
        out.root[frame].y -= travels * drop;
        ways.iter_mut().for_each(|ways| ways[frame].y += travels * drop);
    }
    if soft > 0.0 {
        ways.iter_mut().for_each(|ways| *ways = smooth(ways, soft * fps));
    }
    let joints = out.skeleton.len();
    for (foot, ways) in feet.iter().zip(&ways) {
        let axis = knee_axis(styled, foot);
        for (frame, way) in ways.iter().enumerate().filter(|(_, way)| way.norm() > NOTICED) {
            let locals = &mut out.rotations[frame * joints..(frame + 1) * joints];
            reach(&out.skeleton, (foot, &axis), &out.root[frame], locals, *way);
        }
        if soft > 0.0 {
            soften(styled, &mut out, foot, soft * fps);
        }
    }
    out
}

/// Lets a leg come slowly to where it is held: what was done to its joints, without leaps, under a bell of so many frames. A straight leg that is
/// bent otherwise snaps, and where it is too short its foot stops at once.
fn soften(styled: &Clip, held: &mut Clip, foot: &Foot, width: f64) {
    let joints = styled.skeleton.len();
    for joint in foot.leg {
        let pairs = held.rotations.iter().zip(&styled.rotations).skip(joint).step_by(joints);
        let turns: Vec<_> = pairs
            .map(|(held, styled)| if held == styled { UnitQuaternion::identity() } else { held * styled.inverse() })
            .collect();
        let turns = steady(turns, (1.5 * width).ceil() as usize, width);
        for (frame, turn) in turns.iter().enumerate().filter(|(_, turn)| turn.norm() > 1e-12) {
            let at = frame * joints + joint;
            held.rotations[at] = UnitQuaternion::from_scaled_axis(*turn) * styled.rotations[at];
        }
    }
}

/// How far the root must be carried so that standing feet move as in the source, horizontally, m, per frame.
fn travel(from: &[Vec<Vector3<f64>>], to: &[Vec<Vector3<f64>>], stands: &[Vec<bool>], fps: f64) -> Vec<Vector3<f64>> {
    let frames = from[0].len();
    let (mut steps, mut weights) = (vec![Vector3::zeros(); frames], vec![0.0; frames]);
    let ramp = (RAMP * fps).max(1.0);
    for ((from, to), stands) in from.iter().zip(to).zip(stands) {
        for run in runs(stands) {
            for frame in run.start + 1..run.end {
                let edge = (frame - run.start).min(run.end - frame) as f64;
                // A contact that the clip cuts has no edge there.
                let cut = (run.start == 0 && frame - run.start < run.end - frame)
                    || (run.end == frames && frame - run.start > run.end - frame);
                let weight = if cut { 1.0 } else { (edge / ramp).min(1.0) };
                let slip = (to[frame] - to[frame - 1]) - (from[frame] - from[frame - 1]);
                steps[frame] -= weight * Vector3::new(slip.x, 0.0, slip.z);
                weights[frame] += weight;
            }
        }
    }
    steps.iter_mut().zip(&weights).filter(|(_, weight)| **weight > 0.0).for_each(|(step, weight)| *step /= *weight);
    let in_flight: Vec<bool> = weights.iter().map(|weight| *weight == 0.0).collect();
    for gap in runs(&in_flight).into_iter().filter(|gap| (gap.len() as f64) < FLIGHT * fps) {
        let [before, after] = [gap.start.checked_sub(1), Some(gap.end).filter(|end| *end < frames)];
        let ends = [before.or(after), after.or(before)].map(|end| end.map_or_else(Vector3::zeros, |end| steps[end]));
        for frame in gap.clone() {
            let part = (frame + 1 - gap.start) as f64 / (gap.len() + 1) as f64;
            steps[frame] = ends[0].lerp(&ends[1], part);
        }
    }
    // Frame 0 has no step of its own.
    steps[0] = steps[1];
    let steps = smooth(&steps, SMOOTH * fps);
    let mut at = -steps[0];
    let walked = steps.into_iter().map(|step| {
        at += step;
        at
    });
    walked.collect()
}

/// How far the style has carried the root where it knows nothing, horizontally, m, per frame: the slow part of its drift there. The quick one
/// is how the feet shift the weight.
fn unlearned(source: &[Vector3<f64>], styled: &[Vector3<f64>], familiar: &[f32], fps: f64) -> Vec<Vector3<f64>> {
    if familiar.is_empty() {
        return vec![Vector3::zeros(); source.len()];
    }
    let last = (source.len() - 1).max(1);
    let spread = |frame: usize| f64::from(familiar[frame * (familiar.len() - 1) / last]);
    let familiar: Vec<_> = (0..source.len()).map(|frame| Vector3::repeat(spread(frame))).collect();
    let familiar = smooth(&familiar, SECOND * fps);
    let drift = |frame: usize| styled[frame] - source[frame];
    let steps: Vec<_> = (0..source.len()).map(|frame| drift(frame) - drift(frame.saturating_sub(1))).collect();
    let mut at = Vector3::zeros();
    let carried = smooth(&steps, 0.5 * SECOND * fps).into_iter().zip(familiar).map(|(step, familiar)| {
        at += (1.0 - ((familiar.x - TRAVEL[0]) / (TRAVEL[1] - TRAVEL[0])).clamp(0.0, 1.0))
            * Vector3::new(step.x, 0.0, step.z);
        at
    });
    carried.collect()
}

/// How far a foot must be moved to stand where it should, m, per frame. `also` says when the styled foot stands by itself, `strays` how much of
/// its mean way from the source's spot it keeps.
fn holds([from, to]: [&[Vector3<f64>]; 2], stands: &[bool], also: &[bool], fps: f64, strays: f64) -> Vec<Vector3<f64>> {
    let mut ways = vec![Vector3::zeros(); from.len()];
    let contacts = runs(stands);
    for run in &contacts {
        let mean: Vector3<f64> =
            run.clone().map(|frame| to[frame] - from[frame]).sum::<Vector3<f64>>() * strays / run.len() as f64;
        for frame in run.clone() {
            ways[frame] = from[frame] + Vector3::new(mean.x, 0.0, mean.z) - to[frame];
        }
    }
    let stands = goes_on(&mut ways, [from, to], stands, also, fps);
    let in_air: Vec<bool> = stands.iter().map(|stands| !stands).collect();
    for gap in runs(&in_air) {
        let blend = (BLEND * fps).min((gap.len() + 1) as f64);
        let end = |end: Option<usize>| end.and_then(|end| ways.get(end)).copied().unwrap_or_else(Vector3::zeros);
        let ends = [end(gap.start.checked_sub(1)), end(Some(gap.end))];
        for frame in gap.clone() {
            let parts = [frame + 1 - gap.start, gap.end - frame].map(|far| let_go(far as f64 / blend));
            ways[frame] = ends[0] * parts[0] + ends[1] * parts[1];
        }
    }
    let floor = ground(from);
    for ((way, to), from) in ways.iter_mut().zip(to).zip(from) {
        way.y += (from.y.min(floor) - to.y - way.y).max(0.0);
    }
    ways
}

/// A styled foot that stands before or after a contact of the source, and without a break, stands on the same spot for that time too. Says
/// when a foot is held.
fn goes_on(
    ways: &mut [Vector3<f64>],
    [from, to]: [&[Vector3<f64>]; 2],
    stands: &[bool],
    also: &[bool],
    fps: f64,
) -> Vec<bool> {
    let (mut held, most) = (stands.to_vec(), (GOES_ON * fps) as usize);
    let mut hold = |frame: usize, at: usize| {
        let spot = to[at] + ways[at];
        // What the style does not change stays, whichever side of a threshold it is on.
        let styled = (to[frame] - from[frame]) - (to[at] - from[at]);
        let weight = (styled.norm() / STYLED).min(1.0);
        ways[frame] = Vector3::new(weight * (spot.x - to[frame].x), ways[at].y, weight * (spot.z - to[frame].z));
        held[frame] = true;
    };
    for run in runs(stands) {
        let before = (0..run.start).rev().take(most).take_while(|frame| also[*frame] && !stands[*frame]);
        before.for_each(|frame| hold(frame, run.start));
        let after = (run.end..to.len()).take(most).take_while(|frame| also[*frame] && !stands[*frame]);
        after.for_each(|frame| hold(frame, run.end - 1));
    }
    held
}

/// From 1 at 0 to 0 at 1, smooth at both ends.
fn let_go(part: f64) -> f64 {
    let part = part.clamp(0.0, 1.0);
    1.0 - part * part * (3.0 - 2.0 * part)
}

/// How far the root must sink so that standing feet are in reach, m, per frame.
fn drops(clip: &Clip, feet: &[Foot], ways: &[Vec<Vector3<f64>>], stands: &[Vec<bool>], fps: f64) -> Vec<f64> {
    let rest = clip.skeleton.rest_positions();
    let need = |frame: usize| {
        let at = clip.positions(frame);
        let of = |((foot, ways), stands): ((&Foot, &Vec<Vector3<f64>>), &Vec<bool>)| {
            if !stands[frame] || ways[frame] == Vector3::zeros() {
                return 0.0;
            }
            let [hip, knee, ankle] = foot.leg.map(|joint| rest[joint]);
            let longest = STRETCH * ((knee - hip).norm() + (ankle - knee).norm());
            let [hip, _, ankle] = foot.leg.map(|joint| at[joint]);
            let aim = ankle + ways[frame] - hip;
            // A leg that the style itself stretches so far needs no help.
            let longest = longest.max((ankle - hip).norm());
            let flat = aim.xz().norm();
            if aim.norm() <= longest || flat >= longest {
                0.0
            } else {
                -aim.y - (longest * longest - flat * flat).sqrt()
            }
        };
        feet.iter().zip(ways).zip(stands).map(of).fold(0.0, f64::max)
    };
    let needs: Vec<f64> = (0..clip.frames()).map(need).collect();
    // The most that is needed nearby, smoothed: at least what is needed now, nearly.
    let near = (2.0 * SMOOTH * fps).ceil() as usize;
    let most = |frame: usize| {
        let nearby = &needs[frame.saturating_sub(near)..(frame + near + 1).min(needs.len())];
        Vector3::new(0.0, nearby.iter().copied().fold(0.0, f64::max), 0.0)
    };
    let most: Vec<Vector3<f64>> = (0..needs.len()).map(most).collect();
    smooth(&most, SMOOTH * fps).into_iter().map(|drop| drop.y).collect()
}

/// Gaussian smoothing with a standard deviation of so many frames. The ends are held.
fn smooth(values: &[Vector3<f64>], deviation: f64) -> Vec<Vector3<f64>> {
    let reach = (3.0 * deviation).ceil() as isize;
    let weights: Vec<f64> = (-reach..=reach).map(|at| (-0.5 * (at as f64 / deviation).powi(2)).exp()).collect();
    let sum: f64 = weights.iter().sum();
    let last = values.len() as isize - 1;
    let at = |frame: isize| {
        let near = (-reach..=reach).zip(&weights);
        near.map(|(by, weight)| values[(frame + by).clamp(0, last) as usize] * (weight / sum)).sum()
    };
    (0..=last).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feet::Feet;
    use crate::gait::{Manner, walk};

    fn map(clip: &Clip) -> JointMap {
        JointMap::choose(&clip.skeleton, None).unwrap().unwrap()
    }

    #[test]
    fn a_clip_locked_to_itself_is_itself() {
        let clip = walk(&Manner::WEARY, 3.0, 60.0, 0.2, 4);
        let out = lock(&clip, &clip, &map(&clip), Hold::default());
        assert!(out.root == clip.root && out.rotations == clip.rotations);
    }

    #[test]
    fn a_walk_that_is_carried_away_and_bent_stands_again() {
        let clip = walk(&Manner::NEUTRAL, 4.0, 60.0, 0.0, 4);
        let map = map(&clip);
        let mut styled = clip.clone();
        let joints = clip.skeleton.len();
        for frame in 0..styled.frames() {
            styled.root[frame] += Vector3::new(0.0, -0.02, 0.004 * frame as f64);
            for thigh in [1, 5] {
                let turn = &mut styled.rotations[frame * joints + thigh];
                *turn = UnitQuaternion::identity().slerp(turn, 0.8);
            }
        }
        let out = lock(&clip, &styled, &map, Hold::default());
        let [was, free, held] = [&clip, &styled, &out].map(|clip| Feet::of(clip, &map).slide_cm_s);
        assert!(free > 2.0 * was, "{was} {free}");
        assert!(held < 1.2 * was + 0.5, "{was} {held}");
        // Shorter steps make less way, and what was carried on besides is gone.
        let way = |clip: &Clip| (clip.root[clip.frames() - 1] - clip.root[0]).xz().norm();
        assert!((0.6..0.9).contains(&(way(&out) / way(&clip))), "{} of {}", way(&out), way(&clip));
    }

    #[test]
    fn where_the_style_knows_nothing_the_body_goes_where_the_source_goes() {
        let clip = walk(&Manner::NEUTRAL, 4.0, 60.0, 0.0, 4);
        let map = map(&clip);
        let mut shorter = clip.clone();
        let joints = clip.skeleton.len();
        for (at, turn) in shorter.rotations.iter_mut().enumerate().filter(|(at, _)| [1, 5].contains(&(at % joints))) {
            *turn = clip.rotations[at].powf(0.8);
        }
        let held = |familiar| lock(&clip, &shorter, &map, Hold { familiar, ..Hold::default() });
        let [known, all, none] = [held(&[]), held(&[1.0]), held(&[0.0])];
        assert!(known.root == all.root && known.rotations == all.rotations);
        let far = |out: &Clip| out.root.iter().zip(&clip.root).map(|(a, b)| (a - b).xz().norm()).fold(0.0, f64::max);
        assert!(far(&known) > 0.5 && far(&none) < 0.1, "{} {}", far(&known), far(&none));
    }

    #[test]
    fn where_the_source_stands_no_travel_is_invented() {
        let clip = walk(&Manner::NEUTRAL, 2.0, 60.0, 0.0, 4);
        let mut still = clip.clone();
        let (pose, root) = (clip.pose(0).to_vec(), clip.root[0]);
        still.rotations = pose.iter().cycle().take(clip.rotations.len()).copied().collect();
        still.root.fill(root);
        let mut styled = still.clone();
        styled.root.iter_mut().enumerate().for_each(|(frame, root)| root.z += 0.01 * frame as f64);
        let out = lock(&still, &styled, &map(&clip), Hold::default());
        assert!(out.root.iter().all(|at| (at - root).norm() < 0.01));
    }
}
