//! Up axis and floor of a clip that was just read.

use nalgebra::{UnitQuaternion, Vector3};

use crate::clip::map::{Canonical, JointMap};
use crate::clip::{Clip, UpAxis};

/// How many frames are looked at; more do not change the answer.
const SAMPLES: usize = 200;
/// A floor that lies further off zero is worth a note, m.
const FLOOR: f64 = 0.15;

/// Turns a Z-up clip to Y up, when told so or when rest pose and motion both say so; notes what was decided.
pub(super) fn turn_up(clip: &mut Clip, map: Option<&JointMap>, given: Option<UpAxis>) {
    let evidence = map.and_then(|m| heads_up(clip, m));
    match (given, evidence) {
        (Some(UpAxis::Y), _) => {}
        (Some(UpAxis::Z), _) => {
            turn(clip);
            clip.notes.push("Z up, as given: turned to Y up.".into());
        }
        (None, Some((rest, motion))) if rest.z > 0.9 && motion.z > 0.7 => {
            turn(clip);
            clip.notes.push(format!(
                "Z up found (from ankles to head, the rest pose points {:.0} % along Z, the motion {:.0} %): turned to Y up.",
                100.0 * rest.z,
                100.0 * motion.z
            ));
        }
        (None, Some((_, motion))) if motion.z.abs() > 0.8 => clip.notes.push(format!(
            "Y up assumed, though the body points {:.0} % along Z on the average: somebody lies, or the file is Z up (then \
             say so: `--up z`).",
            100.0 * motion.z
        )),
        (None, _) => {}
    }
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

/// The same motion, seen in a frame turned by a quarter about X: (x, y, z) becomes (x, z, -y).
fn turn(clip: &mut Clip) {
    let quarter = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -std::f64::consts::FRAC_PI_2);
    let turned = |v: Vector3<f64>| Vector3::new(v.x, v.z, -v.y);
    for joint in &mut clip.skeleton.joints {
        joint.offset = turned(joint.offset);
        joint.end = joint.end.map(turned);
    }
    clip.root.iter_mut().for_each(|p| *p = turned(*p));
    // Rest offsets turn too, so every local rotation is conjugated.
    clip.rotations.iter_mut().for_each(|r| *r = quarter * *r * quarter.inverse());
}

/// Notes when the lowest joint is far from zero; the heights are left as they are.
pub(super) fn note_floor(clip: &mut Clip) {
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
