//! Frames that were lost, and single frames that leap: found always, bridged only when asked.

use nalgebra::{UnitQuaternion, Vector3};
use rayon::prelude::*;

use crate::clip::Clip;

/// Nobody's hips move faster, m/s.
const FASTEST: f64 = 15.0;
/// A joint that turns by more within one frame, and back in the next, did not turn, rad.
const TURN: f64 = 1.0;
/// ... at this rate or above, rad/s: slow recordings have large steps.
const TURN_RATE: f64 = 40.0;
/// Frames that a note lists.
const SHOWN: usize = 5;

/// Names the frames that leap; with `repair`, lays straight lines over them.
pub(super) fn mend(clip: &mut Clip, repair: bool) {
    let roots = leaps(&clip.root, FASTEST * clip.frame_time);
    let turns = glitches(clip);
    if !roots.is_empty() {
        let far = roots.iter().map(|&f| clip.root[f].norm()).fold(0.0, f64::max);
        let done =
            if repair { "bridged by straight lines, as given" } else { "left as they are; --repair bridges them" };
        let text = format!(
            "{} the root leaps faster than {FASTEST} m/s and back (up to {far:.1} m from the origin): lost frames? They are {done}.",
            frames(&roots)
        );
        clip.notes.push(text);
    }
    if !turns.is_empty() {
        let (frame, joint) = turns[0];
        let list: Vec<usize> = turns.iter().map(|t| t.0).collect();
        let done = if repair { "bridged, as given" } else { "left as they are; --repair bridges them" };
        let text = format!(
            "{} a joint turns by more than {:.0} degrees and back ('{}' in frame {}): they are {done}.",
            frames(&list),
            TURN.to_degrees(),
            clip.skeleton.joints[joint].name,
            frame + 1
        );
        clip.notes.push(text);
    }
    let steps = jumps(clip, &roots);
    if !steps.is_empty() {
        clip.notes.push(format!(
            "{} the root jumps faster than {FASTEST} m/s and stays there: a cut, or a recording that was put together.",
            frames(&steps)
        ));
    }
    if repair {
        bridge(clip, &roots, &turns);
    }
}

fn frames(list: &[usize]) -> String {
    let mut list = list.to_vec();
    list.dedup();
    let shown = list.iter().take(SHOWN).map(|f| (f + 1).to_string()).collect::<Vec<_>>().join(", ");
    let more = if list.len() > SHOWN { format!(" and {} more", list.len() - SHOWN) } else { String::new() };
    format!("In frame {shown}{more}")
}

/// Frames that are too far from the last good one, where a later frame comes back.
fn leaps(path: &[Vector3<f64>], step: f64) -> Vec<usize> {
    let near = |a: usize, b: usize| (path[a] - path[b]).norm() <= step * (b - a) as f64;
    let Some(mut good) = (0..path.len().saturating_sub(1)).find(|&f| near(f, f + 1)) else { return Vec::new() };
    // What comes before two frames that agree is lost too.
    let mut lost: Vec<usize> = (0..good).collect();
    while good + 1 < path.len() {
        if near(good, good + 1) {
            good += 1;
            continue;
        }
        // At most a second is looked over: a path that stays away was cut.
        let limit = path.len().min(good + 1 + (FASTEST / step).ceil().min(1e6) as usize);
        let back = (good + 2..limit).find(|&f| near(good, f) && (path[good + 1] - path[f]).norm() > step);
        match back {
            Some(back) => {
                lost.extend(good + 1..back);
                good = back;
            }
            None if good + 2 == path.len() => {
                lost.push(good + 1);
                break;
            }
            None => good += 1,
        }
    }
    lost
}

/// Steps that no leap explains.
fn jumps(clip: &Clip, lost: &[usize]) -> Vec<usize> {
    let step = FASTEST * clip.frame_time;
    let far = |f: &usize| (clip.root[*f] - clip.root[f - 1]).norm() > step;
    let known = |f: usize| lost.binary_search(&f).is_ok();
    (1..clip.frames()).filter(far).filter(|&f| !known(f) && !known(f - 1)).collect()
}

/// Frames and joints that turn far within a frame and come back in the next.
fn glitches(clip: &Clip) -> Vec<(usize, usize)> {
    let n = clip.skeleton.len();
    let limit = TURN.max(TURN_RATE * clip.frame_time);
    if limit > 3.0 {
        return Vec::new();
    }
    let far = (limit / 2.0).cos();
    // Near again: within a quarter of the way out.
    let back = (limit / 8.0).cos();
    let alike = |a: &UnitQuaternion<f64>, b: &UnitQuaternion<f64>| a.coords.dot(&b.coords).abs();
    let leaps = |at: &usize| {
        let [before, here, after] = [at - n, *at, at + n].map(|i| &clip.rotations[i]);
        alike(before, here) < far && alike(here, after) < far && alike(before, after) > back
    };
    let all = (n..clip.rotations.len().saturating_sub(n)).into_par_iter().with_min_len(1 << 14);
    all.filter(leaps).map(|at| (at / n, at % n)).collect()
}

fn bridge(clip: &mut Clip, roots: &[usize], turns: &[(usize, usize)]) {
    let n = clip.skeleton.len();
    let good = |f: &usize| roots.binary_search(f).is_err();
    for &frame in roots {
        let before = (0..frame).rev().find(good);
        let after = (frame + 1..clip.frames()).find(good);
        let (Some(a), Some(b)) = (before.or(after), after.or(before)) else { continue };
        let part = if b > a { (frame - a) as f64 / (b - a) as f64 } else { 0.0 };
        clip.root[frame] = clip.root[a].lerp(&clip.root[b], part);
    }
    for &(frame, joint) in turns {
        let at = frame * n + joint;
        let (a, b) = (clip.rotations[at - n], clip.rotations[at + n]);
        clip.rotations[at] = a.try_slerp(&b, 0.5, 1e-12).unwrap_or(a);
    }
}
