//! Frames that were lost, and single frames that leap: found always, bridged only when asked.

use nalgebra::{UnitQuaternion, Vector3};
use rayon::prelude::*;

use crate::clip::Clip;

/// Nobody's hips move faster, m/s.
const FASTEST: f64 = 15.0;
/// No root is further from the middle of its path than this, m, unless it was given the time to go there.
const ABSURD: f64 = 500.0;
/// A joint that turns by more within one frame, and back in the next, did not turn, rad; it is less where the limb would be faster
/// than [`FASTEST`].
const TURN: f64 = 1.0;
/// ... at this rate or above, rad/s: slow recordings have large steps.
const TURN_RATE: f64 = 40.0;
/// Frames that a note lists.
const SHOWN: usize = 5;

/// Names the frames that leap; with `repair`, lays straight lines over them.
pub(in crate::clip) fn mend(clip: &mut Clip, repair: bool) {
    let roots = leaps(&clip.root, &Leap::of_root(clip));
    let limits = limits(clip);
    let turns = glitches(clip, &limits);
    let done = if repair { "bridged, as given" } else { "left as they are; --repair bridges them" };
    if !roots.is_empty() {
        let far = roots.iter().map(|&f| clip.root[f].norm()).fold(0.0, f64::max);
        let text = format!(
            "{} the root leaps faster than {FASTEST} m/s and back (up to {far:.1} m from the origin): lost frames? They are {done}.",
            in_frames(&roots)
        );
        clip.notes.push(text);
    }
    if let Some(&(frame, joint)) = turns.first() {
        let list: Vec<usize> = turns.iter().map(|t| t.0).collect();
        let text = format!(
            "{} a joint turns by more than {:.0} degrees and back ('{}' in frame {}): they are {done}.",
            in_frames(&list),
            limits.get(joint).copied().unwrap_or(TURN).to_degrees(),
            clip.skeleton.joints[joint].name,
            frame + 1
        );
        clip.notes.push(text);
    }
    let steps = jumps(clip, &roots);
    if !steps.is_empty() {
        clip.notes.push(format!(
            "{} the root jumps faster than {FASTEST} m/s and stays there: a cut, or a recording that was put together.",
            in_frames(&steps)
        ));
    }
    if repair {
        bridge(clip, &roots, &turns, &limits);
    }
}

/// The first of the frames, for a note.
pub(in crate::clip) fn in_frames(list: &[usize]) -> String {
    let mut list = list.to_vec();
    list.dedup();
    let shown = list.iter().take(SHOWN).map(|f| (f + 1).to_string()).collect::<Vec<_>>().join(", ");
    let more = if list.len() > SHOWN { format!(" and {} more", list.len() - SHOWN) } else { String::new() };
    format!("In frame {shown}{more}")
}

/// What a path cannot do.
pub(in crate::clip) struct Leap {
    /// Longest step within a frame.
    pub step: f64,
    /// Nothing is as far from the middle of the path.
    pub absurd: f64,
    /// Frames over which is looked: a path that stays away for longer was cut.
    pub second: usize,
}

impl Leap {
    /// What nobody's hips or hands do, in metres.
    pub fn of(frame_time: f64, frames: usize) -> Leap {
        let reach = FASTEST * frame_time * frames as f64;
        let second = (1.0 / frame_time).ceil().min(1e6) as usize;
        Leap { step: FASTEST * frame_time, absurd: reach.max(ABSURD), second }
    }

    fn of_root(clip: &Clip) -> Leap {
        Leap::of(clip.frame_time, clip.frames())
    }
}

/// Frames that are absurdly far away, or too far from the last good one where a later frame comes back.
pub(in crate::clip) fn leaps(path: &[Vector3<f64>], leap: &Leap) -> Vec<usize> {
    let middle = middle(path.iter());
    let is_absurd = |f: &usize| (path[*f] - middle).norm() > leap.absurd;
    let sane: Vec<usize> = (0..path.len()).filter(|f| !is_absurd(f)).collect();
    let mut lost: Vec<usize> = (0..path.len()).filter(is_absurd).collect();
    let near = |a: usize, b: usize| {
        let (a, b) = (sane[a], sane[b]);
        (path[a] - path[b]).norm() <= leap.step * (b - a) as f64
    };
    let Some(mut good) = (0..sane.len().saturating_sub(1)).find(|&at| near(at, at + 1)) else { return lost };
    // What comes before two frames that agree is lost too.
    lost.extend(&sane[..good]);
    while good + 1 < sane.len() {
        if near(good, good + 1) {
            good += 1;
            continue;
        }
        let soon = |at: &usize| sane[*at] <= sane[good] + leap.second;
        // It leaps back as it leapt away: who wanders back was there.
        let leapt = |from: usize, to: usize| (path[sane[from]] - path[sane[to]]).norm() > leap.step;
        let apart = |at: usize| leapt(good + 1, at) && leapt(at - 1, at);
        match (good + 2..sane.len()).take_while(soon).find(|&at| near(good, at) && apart(at)) {
            Some(back) => {
                lost.extend(&sane[good + 1..back]);
                good = back;
            }
            None if good + 2 == sane.len() => {
                lost.push(sane[good + 1]);
                break;
            }
            None => good += 1,
        }
    }
    lost.sort_unstable();
    lost
}

/// The median of each coordinate.
pub(in crate::clip) fn middle<'p>(points: impl Iterator<Item = &'p Vector3<f64>>) -> Vector3<f64> {
    let mut axes: [Vec<f64>; 3] = Default::default();
    for point in points {
        axes.iter_mut().zip(point.iter()).for_each(|(axis, x)| axis.push(*x));
    }
    let median = |axis: &mut Vec<f64>| {
        let half = axis.len() / 2;
        if axis.is_empty() { 0.0 } else { *axis.select_nth_unstable_by(half, f64::total_cmp).1 }
    };
    Vector3::from_iterator(axes.iter_mut().map(median))
}

/// Steps that no leap explains.
fn jumps(clip: &Clip, lost: &[usize]) -> Vec<usize> {
    let step = FASTEST * clip.frame_time;
    let far = |f: &usize| (clip.root[*f] - clip.root[f - 1]).norm() > step;
    let known = |f: usize| lost.binary_search(&f).is_ok();
    (1..clip.frames()).filter(far).filter(|&f| !known(f) && !known(f - 1)).collect()
}

/// By how much each joint may turn within a frame, and back: no further than what hangs on it can move, rad.
fn limits(clip: &Clip) -> Vec<f64> {
    let joints = &clip.skeleton.joints;
    let mut reach: Vec<f64> = joints.iter().map(|j| j.end.map_or(0.0, |end| end.norm())).collect();
    for (at, joint) in joints.iter().enumerate().rev() {
        if let Some(parent) = joint.parent {
            reach[parent] = reach[parent].max(reach[at] + joint.offset.norm());
        }
    }
    let most = TURN.max(TURN_RATE * clip.frame_time);
    reach.into_iter().map(|reach| (FASTEST * clip.frame_time / reach.max(1e-3)).min(most)).collect()
}

/// The cosine of half an angle between two rotations, whatever their signs.
fn alike(a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>) -> f64 {
    a.coords.dot(&b.coords).abs()
}

/// Frames and joints that turn far within a frame and come back in the next.
fn glitches(clip: &Clip, limits: &[f64]) -> Vec<(usize, usize)> {
    let n = clip.skeleton.len();
    // What may turn by half a turn is not looked at.
    let far: Vec<f64> = limits.iter().map(|limit| if *limit > 3.0 { -1.0 } else { (limit / 2.0).cos() }).collect();
    let leaps = |at: &usize| {
        let [before, here, after] = [at - n, *at, at + n].map(|i| &clip.rotations[i]);
        let out = alike(before, here).max(alike(here, after));
        // Near again: within a quarter of the way out.
        out < far[at % n] && alike(before, after).min(1.0).acos() < out.min(1.0).acos() / 4.0
    };
    let all = (n..clip.rotations.len().saturating_sub(n)).into_par_iter().with_min_len(1 << 14);
    all.filter(leaps).map(|at| (at / n, at % n)).collect()
}

fn bridge(clip: &mut Clip, roots: &[usize], turns: &[(usize, usize)], limits: &[f64]) {
    let n = clip.skeleton.len();
    for run in roots.chunk_by(|a, b| a + 1 == *b) {
        let (Some(&first), Some(&last)) = (run.first(), run.last()) else { continue };
        let (before, after) = (first.checked_sub(1), Some(last + 1).filter(|f| *f < clip.frames()));
        let (Some(a), Some(b)) = (before.or(after), after.or(before)) else { continue };
        // A recorder that loses the root loses the pose too, unless the pose goes on.
        let leapt = |from: Option<usize>, to: usize| {
            let turned = |(joint, limit): (usize, &f64)| {
                from.is_none_or(|from| clip.pose(from)[joint].angle_to(&clip.pose(to)[joint]) > *limit)
            };
            limits.iter().enumerate().any(turned)
        };
        let whole = leapt(before, first) && leapt(after, last);
        for &frame in run {
            let part = if b > a { (frame - a) as f64 / (b - a) as f64 } else { 0.0 };
            clip.root[frame] = clip.root[a].lerp(&clip.root[b], part);
            for joint in (0..n).filter(|_| whole) {
                let [from, to] = [a, b].map(|f| clip.rotations[f * n + joint]);
                clip.rotations[frame * n + joint] = from.try_slerp(&to, part, 1e-12).unwrap_or(from);
            }
        }
    }
    let good = |f: usize| roots.binary_search(&f).is_err();
    for &(frame, joint) in turns.iter().filter(|(frame, _)| good(*frame)) {
        let at = frame * n + joint;
        let (a, b) = (clip.rotations[at - n], clip.rotations[at + n]);
        clip.rotations[at] = a.try_slerp(&b, 0.5, 1e-12).unwrap_or(a);
    }
}
