//! How far two motions on one rig are apart: positions in centimetres, rotations in degrees, at one alignment in time.
//!
//! Centimetres see where joints are. Degrees see how they turn: a head that looks elsewhere, a hand or a bone that twists.
//!
//! | file | holds |
//! |---|---|
//! | `degrees` | angles between matched frames: over all joints, over leaves, by joint as swing and twist |
//! | [`turns`] | what simpler models do to rotations: mean offset, affine map of each joint |

mod degrees;
pub mod turns;

use kinesic::Pose;
use nalgebra::UnitQuaternion;
use serde::Serialize;

pub use degrees::{Degrees, JointDegrees, degrees};

use kinesic::rig::JointKind;

use crate::align::{AlignError, Ends, Series, aligned};
use crate::clip::Clip;
use crate::rig::{MAX_JOINTS, Rig};

/// A motion as it is measured.
#[derive(Clone, Debug)]
pub struct Measurable {
    /// Heading-local positions, m, `[frames x 3 joints]`.
    pub positions: Vec<f64>,
    /// Local rotations, `[frames x joints]`.
    pub rotations: Vec<UnitQuaternion<f64>>,
}

impl Measurable {
    /// A clip on the rig.
    pub fn new(rig: &Rig, clip: &Clip) -> Self {
        Self { positions: rig.locals_of(clip).positions, rotations: clip.rotations.clone() }
    }

    /// Poses on the rig.
    pub fn of_poses(rig: &Rig, poses: &[Pose<MAX_JOINTS>]) -> Self {
        Self { positions: rig.locals(poses).positions, rotations: rig.clip(poses, 1.0).rotations }
    }
}

/// How far two motions are apart.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Distance {
    /// Aligned RMS joint distance, cm.
    pub cm: f64,
    /// Mean angles along the same path.
    pub degrees: Degrees,
}

/// Distance of two motions on the rig along the path of [`aligned_distance`](crate::align::aligned_distance).
///
/// # Errors
/// As [`aligned`].
pub fn compare(rig: &Rig, a: &Measurable, b: &Measurable, ends: Ends) -> Result<Distance, AlignError> {
    let channels = 3 * rig.joints();
    let (found, path) = aligned(Series::new(&a.positions, channels)?, Series::new(&b.positions, channels)?, ends)?;
    let mut degrees = degrees(&rig.skeleton, &a.rotations, &b.rotations, path.iter().copied());
    slide(rig, a, b, &path, &mut degrees);
    Ok(Distance { cm: 100.0 * found.rms, degrees })
}

/// How far apart the lengths of a machine's sliders are: rotations do not see them, and positions hold them times their levers.
fn slide(rig: &Rig, a: &Measurable, b: &Measurable, path: &[(usize, usize)], degrees: &mut Degrees) {
    if rig.frames().travels() {
        return;
    }
    let (levers, channels) = (rig.levers(), 3 * rig.joints());
    for (joint, (kind, first)) in rig.frames().places().enumerate() {
        if let (JointKind::Slider, Some(found)) = (kind, degrees.joints.get_mut(joint)) {
            let length = |of: &Measurable, frame: usize| of.positions[frame * channels + 3 * joint] / levers[first];
            let sum: f64 = path.iter().map(|(i, j)| (length(a, *i) - length(b, *j)).abs()).sum();
            found.millimetres = Some(1000.0 * sum / path.len().max(1) as f64);
        }
    }
}

/// Distance of two motions frame for frame, as long as both last: RMS joint distance and mean angles.
pub fn compare_frames(rig: &Rig, a: &Measurable, b: &Measurable) -> Distance {
    let joints = rig.joints();
    let frames = (a.rotations.len() / joints).min(b.rotations.len() / joints);
    let pairs = a.positions.iter().zip(&b.positions).take(3 * joints * frames);
    let squares: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
    let path: Vec<(usize, usize)> = (0..frames).map(|frame| (frame, frame)).collect();
    let mut degrees = degrees(&rig.skeleton, &a.rotations, &b.rotations, path.iter().copied());
    slide(rig, a, b, &path, &mut degrees);
    Distance { cm: 100.0 * (squares / (joints * frames).max(1) as f64).sqrt(), degrees }
}

impl Distance {
    /// Means of the figures of several motions on one rig; joints are taken in order.
    pub fn mean<'a>(distances: impl Iterator<Item = &'a Self> + Clone) -> Self {
        let count = distances.clone().count().max(1) as f64;
        let cm = distances.clone().map(|distance| distance.cm).sum::<f64>() / count;
        Self { cm, degrees: Degrees::mean(distances.map(|distance| &distance.degrees)) }
    }
}
