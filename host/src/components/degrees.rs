//! How far two motions are apart in rotations.

use kinesic::Pose;
use nalgebra::Vector3;
use serde::Serialize;

use crate::align::{AlignError, Series, aligned_path};
use crate::rig::{MAX_JOINTS, Rig};

/// Mean geodesic angles between local rotations, degrees. The root counts with its tilt alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Degrees {
    /// Over all joints.
    pub all: f64,
    /// Over the joints from which no other joint hangs: head, hands, feet.
    pub leaves: f64,
}

/// Angles over the frames of two motions that dynamic time warping of their positions matches.
pub fn aligned_degrees(rig: &Rig, a: &[Pose<MAX_JOINTS>], b: &[Pose<MAX_JOINTS>]) -> Result<Degrees, AlignError> {
    let [p, q] = [a, b].map(|poses| rig.locals(poses).positions);
    let path = aligned_path(Series::new(&p, 3 * rig.joints())?, Series::new(&q, 3 * rig.joints())?)?;
    let pairs: Vec<_> = path.into_iter().map(|(i, j)| (&a[i], &b[j])).collect();
    Ok(degrees(rig, &pairs))
}

/// Angles over pairs of poses.
pub fn degrees(rig: &Rig, pairs: &[(&Pose<MAX_JOINTS>, &Pose<MAX_JOINTS>)]) -> Degrees {
    let joints = &rig.skeleton.joints;
    let angle = |joint: usize| {
        let sum: f64 = pairs
            .iter()
            .map(|(a, b)| {
                let [a, b] = [a, b].map(|pose| pose.rotations[joint]);
                let up = |q: &nalgebra::UnitQuaternion<f32>| q.inverse() * Vector3::y();
                f64::from(if joint == 0 { up(&a).angle(&up(&b)) } else { a.angle_to(&b) })
            })
            .sum();
        sum.to_degrees() / pairs.len().max(1) as f64
    };
    let angles: Vec<f64> = (0..rig.joints()).map(angle).collect();
    let is_leaf = |joint: usize| joints.iter().all(|other| other.parent != Some(joint));
    let leaves: Vec<f64> = (0..rig.joints()).filter(|joint| is_leaf(*joint)).map(|joint| angles[joint]).collect();
    let mean = |angles: &[f64]| angles.iter().sum::<f64>() / angles.len().max(1) as f64;
    Degrees { all: mean(&angles), leaves: mean(&leaves) }
}
