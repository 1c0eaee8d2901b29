//! What the eye sees first in a motion, by numbers: sliding feet, its rhythm, jitter, posture.

use nalgebra::{UnitQuaternion, Vector3, Vector4};
use serde::Serialize;

use crate::clip::{Canonical, Clip, JointMap};
use crate::feet::Feet;
use crate::measure::degrees;

/// Quality of one motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quality {
    /// Mean horizontal speed of a foot while it stands, cm/s; 0 if no foot ever does.
    pub foot_slide_cm_s: f64,
    /// Part of the time for which a foot stands, percent.
    pub standing_percent: f64,
    /// How often a foot begins to stand.
    pub steps_a_minute: f64,
    /// Root mean square of the third derivative of all joint positions, m/s^3.
    pub jerk_m_s3: f64,
    /// How far the trunk leans forward from the vertical, mean, degrees; absent where hips or shoulders are not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lean_degrees: Option<f64>,
}

impl Quality {
    /// Means of several motions; a lean that some do not have is left out.
    pub fn mean<'a>(all: impl Iterator<Item = &'a Self> + Clone) -> Self {
        let count = all.clone().count().max(1) as f64;
        let mean = |of: fn(&Self) -> f64| all.clone().map(of).sum::<f64>() / count;
        Self {
            foot_slide_cm_s: mean(|q| q.foot_slide_cm_s),
            standing_percent: mean(|q| q.standing_percent),
            steps_a_minute: mean(|q| q.steps_a_minute),
            jerk_m_s3: mean(|q| q.jerk_m_s3),
            lean_degrees: all.clone().map(|q| q.lean_degrees).sum::<Option<f64>>().map(|sum| sum / count),
        }
    }
}

/// Quality of a source, of what a pack makes of it, and of what it should become, all on one skeleton.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Compared {
    /// Doing nothing.
    pub source: Quality,
    /// The pack's output, its feet as the engine makes them.
    pub result: Quality,
    /// What it should become.
    pub target: Quality,
    /// Angle between the mean rotations of source and target, mean of the joints, degrees.
    pub source_posture_degrees: f64,
    /// The same of the pack's output.
    pub result_posture_degrees: f64,
}

impl Compared {
    /// Measures three motions on one skeleton. Cost: forward kinematics of all frames.
    pub fn of(map: &JointMap, source: &Clip, result: &Clip, target: &Clip) -> Self {
        let [source_posture_degrees, result_posture_degrees] = [source, result].map(|clip| posture(clip, target));
        let [source, result, target] = [source, result, target].map(|clip| measure(clip, map));
        Self { source, result, target, source_posture_degrees, result_posture_degrees }
    }

    /// Means of several; nothing of none.
    pub fn mean<'a>(all: impl Iterator<Item = &'a Self> + Clone) -> Option<Self> {
        let count = all.clone().count();
        let mean = |of: fn(&Self) -> f64| all.clone().map(of).sum::<f64>() / count as f64;
        (count > 0).then(|| Self {
            source: Quality::mean(all.clone().map(|c| &c.source)),
            result: Quality::mean(all.clone().map(|c| &c.result)),
            target: Quality::mean(all.clone().map(|c| &c.target)),
            source_posture_degrees: mean(|c| c.source_posture_degrees),
            result_posture_degrees: mean(|c| c.result_posture_degrees),
        })
    }
}

/// Measures a clip. Cost: forward kinematics of all frames.
pub fn measure(clip: &Clip, map: &JointMap) -> Quality {
    let joints = clip.skeleton.len();
    let positions = clip.all_positions();
    let fps = clip.fps();
    let (mut square, mut count) = (0.0, 0);
    for t in 3..clip.frames() {
        for joint in 0..joints {
            let at = |back: usize| positions[(t - back) * joints + joint];
            square += ((at(0) - at(3)) - (at(1) - at(2)) * 3.0).norm_squared() * fps.powi(6);
            count += 1;
        }
    }
    let leans = positions.chunks_exact(joints.max(1)).map(|frame| lean(frame, map));
    let lean: Option<f64> = leans.sum();
    let feet = Feet::of(clip, map);
    Quality {
        foot_slide_cm_s: feet.slide_cm_s,
        standing_percent: feet.standing_percent,
        steps_a_minute: feet.steps_a_minute,
        jerk_m_s3: (square / f64::from(count.max(1))).sqrt(),
        lean_degrees: lean.map(|sum| sum / clip.frames().max(1) as f64),
    }
}

/// How far forward the line from the middle of the hips to that of the shoulders leans, degrees.
fn lean(positions: &[Vector3<f64>], map: &JointMap) -> Option<f64> {
    use Canonical::{LHip, LShoulder, RHip, RShoulder};
    let [left_hip, right_hip, left, right] =
        [map.joint(LHip)?, map.joint(RHip)?, map.joint(LShoulder)?, map.joint(RShoulder)?].map(|at| positions[at]);
    let across = left_hip - right_hip;
    let forward = Vector3::new(-across.z, 0.0, across.x).try_normalize(1e-9)?;
    let trunk = left + right - left_hip - right_hip;
    Some(trunk.dot(&forward).atan2(trunk.y).to_degrees())
}

/// Angle between the mean rotations of two motions on one skeleton, mean of the joints, degrees. Headings do not count.
pub fn posture(a: &Clip, b: &Clip) -> f64 {
    degrees(&a.skeleton, &mean_pose(a), &mean_pose(b), std::iter::once((0, 0))).all
}

/// The mean rotation of every joint; roots are turned to face one way first.
fn mean_pose(clip: &Clip) -> Vec<UnitQuaternion<f64>> {
    let joints = clip.skeleton.len();
    let mean = |joint: usize| {
        let root = clip.skeleton.joints[joint].parent.is_none();
        let turns = (0..clip.frames()).map(|frame| clip.pose(frame)[joint]);
        let sum = turns.map(|turn| if root { level(&turn) } else { turn }).fold(Vector4::zeros(), |sum, turn| {
            // A rotation has two quaternions: take the one on the side of the others.
            if turn.coords.dot(&sum) < 0.0 { sum - turn.coords } else { sum + turn.coords }
        });
        UnitQuaternion::try_new(sum.into(), 1e-9).unwrap_or_default()
    };
    (0..joints).map(mean).collect()
}

/// A rotation without its turn about the vertical.
fn level(turn: &UnitQuaternion<f64>) -> UnitQuaternion<f64> {
    let about = nalgebra::Quaternion::new(turn.w, 0.0, turn.j, 0.0);
    UnitQuaternion::try_new(about, 1e-9).map_or(*turn, |about| about.inverse() * turn)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::{Manner, walk};

    #[test]
    fn a_weary_walk_leans_and_where_a_body_faces_is_no_posture() {
        let [neutral, weary] = [Manner::NEUTRAL, Manner::WEARY].map(|manner| walk(&manner, 4.0, 60.0, 0.0, 5));
        let map = JointMap::choose(&neutral.skeleton, None).unwrap().unwrap();
        let compared = Compared::of(&map, &neutral, &weary, &weary);
        assert!(compared.target.lean_degrees > compared.source.lean_degrees.map(|lean| lean + 5.0), "{compared:?}");
        assert!(compared.source_posture_degrees > 3.0 && compared.result_posture_degrees < 1e-6, "{compared:?}");
        let mut turned = neutral.clone();
        let about = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 2.0);
        turned.rotations.iter_mut().step_by(neutral.skeleton.len()).for_each(|root| *root = about * *root);
        turned.root.iter_mut().for_each(|root| *root = about * *root);
        let (a, b) = (measure(&neutral, &map), measure(&turned, &map));
        assert!(posture(&neutral, &turned) < 1e-5, "{}", posture(&neutral, &turned));
        assert!((a.lean_degrees.unwrap() - b.lean_degrees.unwrap()).abs() < 1e-9);
        let mean = Quality::mean([a, compared.target].iter());
        assert!((mean.jerk_m_s3 - (a.jerk_m_s3 + compared.target.jerk_m_s3) / 2.0).abs() < 1e-9);
    }

    #[test]
    fn a_clip_of_one_frame_has_numbers() {
        let clip = walk(&Manner::NEUTRAL, 1.0, 60.0, 0.0, 1).slice(0..1);
        let map = JointMap::choose(&clip.skeleton, None).unwrap().unwrap();
        let Quality { foot_slide_cm_s, standing_percent, steps_a_minute, jerk_m_s3, lean_degrees } =
            measure(&clip, &map);
        let numbers = [foot_slide_cm_s, standing_percent, steps_a_minute, jerk_m_s3, lean_degrees.unwrap()];
        assert!(numbers.iter().all(|x| x.is_finite()), "{numbers:?}");
    }
}
