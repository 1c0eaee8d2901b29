//! Up axis, handedness and floor of a clip that was just read.

use nalgebra::Vector3;

use crate::clip::map::{Canonical, JointMap};
use crate::clip::{Clip, ReadOptions, UpAxis};

/// How many frames are looked at; more do not change the answer.
const SAMPLES: usize = 200;
/// A floor that lies further off zero is worth a note, m.
const FLOOR: f64 = 0.15;

/// Turns a clip to Y up and right-handed axes, when told so or where the evidence is certain; notes what was decided.
pub(crate) fn turn(clip: &mut Clip, map: Option<&JointMap>, options: &ReadOptions) {
    if options.left_handed {
        mirror(clip);
        clip.notes.push("Left-handed axes, as given: Z was turned round.".into());
    }
    let given = options.up.or(options.map.as_ref().and_then(|m| m.up));
    let evidence = map.and_then(|m| heads_up(clip, m));
    // The rest pose of some files stands upright in Y while their motion is in other axes: the root alone turns then.
    let upright = evidence.is_some_and(|(rest, _)| rest.y > 0.9);
    match (given, evidence) {
        (Some(up), _) => {
            let whole = !upright || up == UpAxis::Y;
            turn_by(clip, up, whole);
            if up != UpAxis::Y {
                let rest = if whole { "" } else { " (the motion; the rest pose is Y up already)" };
                clip.notes.push(format!("Up axis {up}, as given: turned to Y up{rest}."));
            }
        }
        (None, Some((rest, motion))) => decide(clip, map, rest, motion),
        (None, None) => {}
    }
    if !options.left_handed {
        note_hand(clip, map);
    }
}

/// Turns where rest pose and motion agree, or where motion and floor do; else leaves a note.
fn decide(clip: &mut Clip, map: Option<&JointMap>, rest: Vector3<f64>, motion: Vector3<f64>) {
    let percent = |v: Vector3<f64>, up: UpAxis| 100.0 * v.dot(&up.direction());
    let along = |v: &Vector3<f64>, least: f64| UpAxis::ALL.into_iter().find(|up| v.dot(&up.direction()) > least);
    let stands = |up: &UpAxis| map.is_some_and(|m| stands_on(clip, m, *up));
    let feet = UpAxis::ALL.into_iter().find(stands).filter(|_| !stands(&UpAxis::Y));
    let name = |up: UpAxis| up.to_string().to_uppercase();
    let (at_rest, moving) = (along(&rest, 0.9), along(&motion, 0.7));
    // Who bends points anywhere, and stands on the feet all the same.
    if let Some(up) = feet.filter(|up| moving != Some(*up)) {
        let whole = at_rest == Some(up);
        // Who sits with stretched legs points anywhere too, on a floor along Y.
        if !whole && (at_rest != Some(UpAxis::Y) || lies_on_y(clip)) {
            clip.notes.push(format!(
                "Y up assumed, though the feet stand at 0 along {up}: if the file is {up} up, say so: `--up {up}`."
            ));
            return;
        }
        turn_by(clip, up, whole);
        let rest = if whole { "" } else { " (the motion; the rest pose is Y up already)" };
        let up = name(up);
        clip.notes.push(format!("{up} up found (the feet stand at 0 there, the body bends): turned to Y up{rest}."));
        return;
    }
    match (at_rest, moving) {
        (Some(up), Some(other)) if up == other && up != UpAxis::Y => {
            turn_by(clip, up, true);
            clip.notes.push(format!(
                "{} up found (from ankles to head, the rest pose points {:.0} % along {up}, the motion {:.0} %): turned to Y up.",
                name(up),
                percent(rest, up),
                percent(motion, up)
            ));
        }
        (Some(UpAxis::Y), Some(up)) if up != UpAxis::Y && percent(motion, up) > 80.0 => {
            if feet == Some(up) {
                turn_by(clip, up, false);
                clip.notes.push(format!(
                    "{} up found in the motion (the body points {:.0} % along {up} and its feet stand at 0 there), Y up at rest: the \
                     motion was turned to Y up.",
                    name(up),
                    percent(motion, up)
                ));
            } else {
                clip.notes.push(unsure(up, percent(motion, up)));
            }
        }
        (_, Some(up)) if up != UpAxis::Y && percent(motion, up) > 80.0 => {
            clip.notes.push(unsure(up, percent(motion, up)))
        }
        _ => {}
    }
}

fn unsure(up: UpAxis, percent: f64) -> String {
    format!(
        "Y up assumed, though the body points {percent:.0} % along {up} on the average: somebody lies, or the file is {up} up (then \
         say so: `--up {up}`)."
    )
}

/// Whether the lower foot is near zero along an axis, and the pelvis at the height of legs, in most frames.
fn stands_on(clip: &Clip, map: &JointMap, up: UpAxis) -> bool {
    let feet = [Canonical::LAnkle, Canonical::RAnkle].map(|c| map.joint(c));
    let ([Some(left), Some(right)], Some(pelvis)) = (feet, map.joint(Canonical::Pelvis)) else { return false };
    let rest = clip.skeleton.rest_positions();
    let leg = (rest[pelvis] - rest[left]).norm().max((rest[pelvis] - rest[right]).norm());
    let frames: Vec<usize> = (0..clip.frames()).step_by(clip.frames().div_ceil(SAMPLES).max(1)).collect();
    let stands = |f: &&usize| {
        let p = clip.positions(**f);
        let height = |j: usize| p[j].dot(&up.direction());
        let low = height(left).min(height(right));
        (-0.1 * leg..0.35 * leg).contains(&low) && (0.6 * leg..1.5 * leg).contains(&height(pelvis))
    };
    10 * frames.iter().filter(stands).count() >= 9 * frames.len()
}

/// Whether the lowest joint is at a height near zero in most frames.
fn lies_on_y(clip: &Clip) -> bool {
    let frames: Vec<usize> = (0..clip.frames()).step_by(clip.frames().div_ceil(SAMPLES).max(1)).collect();
    let low = |f: usize| clip.positions(f).iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    10 * frames.iter().filter(|f| low(**f).abs() < FLOOR).count() >= 9 * frames.len()
}

/// Mean direction from the ankles to the head: in the rest pose, and over the motion.
fn heads_up(clip: &Clip, map: &JointMap) -> Option<(Vector3<f64>, Vector3<f64>)> {
    let head = map.joint(Canonical::Head)?;
    let (left, right) = (map.joint(Canonical::LAnkle)?, map.joint(Canonical::RAnkle)?);
    let upward = |p: &[Vector3<f64>]| {
        let up = *p.get(head)? - (p.get(left)? + p.get(right)?) / 2.0;
        up.try_normalize(1e-6)
    };
    let rest = upward(&clip.skeleton.rest_positions())?;
    let step = clip.frames().div_ceil(SAMPLES).max(1);
    let frames = (0..clip.frames()).step_by(step);
    let (sum, count) =
        frames.filter_map(|f| upward(&clip.positions(f))).fold((Vector3::zeros(), 0), |s, u| (s.0 + u, s.1 + 1));
    (count > 0).then(|| (rest, sum / count as f64))
}

/// The same motion in a frame in which `up` is Y: of the whole clip, or of the root's path alone.
fn turn_by(clip: &mut Clip, up: UpAxis, whole: bool) {
    if up == UpAxis::Y {
        return;
    }
    let turn = up.to_y();
    clip.root.iter_mut().for_each(|p| *p = up.turn(*p));
    if !whole {
        let n = clip.skeleton.len();
        clip.rotations.iter_mut().step_by(n).for_each(|r| *r = turn * *r);
        return;
    }
    for joint in &mut clip.skeleton.joints {
        joint.offset = up.turn(joint.offset);
        joint.end = joint.end.map(|end| up.turn(end));
    }
    // Rest offsets turn too, so every local rotation is conjugated.
    clip.rotations.iter_mut().for_each(|r| *r = turn * *r * turn.inverse());
}

/// The same numbers in axes of the other hand: Z turned round.
fn mirror(clip: &mut Clip) {
    let turned = |v: Vector3<f64>| Vector3::new(v.x, v.y, -v.z);
    for joint in &mut clip.skeleton.joints {
        joint.offset = turned(joint.offset);
        joint.end = joint.end.map(turned);
    }
    clip.root.iter_mut().for_each(|p| *p = turned(*p));
    for r in &mut clip.rotations {
        let q = nalgebra::Quaternion::new(r.w, -r.i, -r.j, r.k);
        *r = nalgebra::UnitQuaternion::new_unchecked(q);
    }
}

/// Notes when the toes point against the side that left and right say, at rest and in the motion.
fn note_hand(clip: &mut Clip, map: Option<&JointMap>) {
    let Some(map) = map else { return };
    let joint = |c| map.joint(c);
    let (Some(left), Some(right)) = (joint(Canonical::LHip), joint(Canonical::RHip)) else { return };
    let feet: Vec<(usize, usize, Option<Vector3<f64>>)> =
        [(Canonical::LAnkle, Canonical::LToe), (Canonical::RAnkle, Canonical::RToe)]
            .into_iter()
            .filter_map(|(ankle, toe)| {
                let (ankle, toe) = (joint(ankle)?, joint(toe));
                // Without toes the foot's own tip says it.
                let tip = clip.skeleton.joints[ankle].end;
                (toe.is_some() || tip.is_some()).then_some((ankle, toe.unwrap_or(ankle), tip.filter(|_| toe.is_none())))
            })
            .collect();
    if feet.is_empty() {
        return;
    }
    let rest = clip.skeleton.rest_positions();
    let against_at = |p: &[Vector3<f64>], turns: Option<&[nalgebra::UnitQuaternion<f64>]>| {
        let forward = (p[left] - p[right]).cross(&Vector3::y());
        let toes: Vector3<f64> = feet
            .iter()
            .map(|&(ankle, toe, tip)| match tip {
                Some(tip) => turns.map_or(tip, |t| t[ankle] * tip),
                None => p[toe] - p[ankle],
            })
            .sum();
        // Feet that point down say nothing.
        let toes = Vector3::new(toes.x, 0.0, toes.z);
        toes.norm() > 0.05 && forward.dot(&toes) < -0.3 * forward.norm() * toes.norm()
    };
    if !against_at(&rest, None) {
        return;
    }
    let frames: Vec<usize> = (0..clip.frames()).step_by(clip.frames().div_ceil(SAMPLES).max(1)).collect();
    let against = |f: &&usize| {
        let turns = clip.skeleton.world_rotations(clip.pose(**f));
        against_at(&clip.positions(**f), Some(&turns))
    };
    let count = frames.iter().filter(against).count();
    if 10 * count > 8 * frames.len() {
        clip.notes.push(format!(
            "Left and right may be exchanged: the toes point backwards in {} % of the frames. The axes are left-handed (then say so: \
             `--handed left`), or the names of the sides are.",
            100 * count / frames.len()
        ));
    }
}

/// Notes when the lowest joint is far from zero; the heights are left as they are.
pub(crate) fn note_floor(clip: &mut Clip) {
    let step = clip.frames().div_ceil(SAMPLES).max(1);
    let lowest_of = |f: usize| clip.positions(f).iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let mut lows: Vec<f64> = (0..clip.frames()).step_by(step).map(lowest_of).collect();
    lows.sort_by(f64::total_cmp);
    // A tenth of the frames may be lower: single frames are often broken.
    let lowest = lows.get(lows.len() / 10).copied().unwrap_or(f64::NAN);
    if lowest.is_finite() && lowest.abs() > FLOOR {
        let hint = if lowest < 0.0 { " (heights may be relative to the first pose)" } else { "" };
        clip.notes.push(format!(
            "The floor is not at height 0: the lowest joint is at {lowest:.2} m or higher in nine tenths of the frames{hint}."
        ));
    }
}

/// Notes when the first frame is the rest pose and the second is not: a calibration pose left at the start.
pub(super) fn note_rest_frame(clip: &mut Clip) {
    // Mean angle off the rest pose; the root's heading does not count.
    let bent = |frame| {
        let pose = clip.pose(frame).get(1..).unwrap_or(&[]);
        pose.iter().map(|r| r.angle()).sum::<f64>().to_degrees() / pose.len().max(1) as f64
    };
    let (first, second) = (bent(0), bent(1));
    if first < 2.0 && second > 3.0 && second > 2.5 * first {
        clip.notes.push(format!(
            "Frame 1 looks like a calibration pose: its joints are bent by {first:.1} degrees on the average, those of frame 2 \
             by {second:.1}. Cut it off where it disturbs."
        ));
    }
}
