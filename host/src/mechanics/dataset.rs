//! One row a frame: the features and the pose, computed by the device's own code.

use kinesic::Pose;
use kinesic::mechanics::{Body, DynamicFeatures, FEATURES, FeatureState};
use kinesic::model::LoadError;

use crate::clip::Clip;
use crate::rig::{MAX_JOINTS, Rig};

/// Frames of memory that the host allows: a third of a second at 360 frames per second.
pub(super) const MAX_WINDOW: usize = 120;

/// Features and poses of a clip, row-major.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    /// `[frames x FEATURES]`.
    pub features: Vec<f32>,
    /// `[frames x 4 (joints - 1)]`: quaternions x, y, z, w of all joints but the hips.
    pub poses: Vec<f32>,
}

impl Rows {
    /// Rows of a clip on the rig. Quaternions have the sign of `signs`.
    pub fn of(rig: &Rig, body: &Body, clip: &Clip, signs: &[f32]) -> Result<Self, LoadError> {
        let features = DynamicFeatures::new(rig.device(), body, clip.fps() as f32)?;
        let mut state = Box::new(FeatureState::<MAX_JOINTS, MAX_WINDOW>::new());
        let mut rows = Self::default();
        for pose in rig.poses(clip) {
            features.step(&mut state, &pose);
            rows.features.extend(state.features());
            rows.poses.extend(signed(&pose, rig.joints(), signs));
        }
        Ok(rows)
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.features.len() / FEATURES
    }
}

/// Quaternions of all joints but the hips, each on the side of the sphere on which `signs` is.
///
/// The side is that of the joint's mean over the training clips: no joint turns by more than half a circle away from it, so
/// the sign neither jumps within a clip nor differs between clips (the paper's continuity in time allows the latter).
pub fn signed(pose: &Pose<MAX_JOINTS>, joints: usize, signs: &[f32]) -> Vec<f32> {
    let mut row = Vec::with_capacity(4 * joints.saturating_sub(1));
    let sides = signs.chunks_exact(4);
    for (rotation, side) in pose.rotations.iter().take(joints).skip(1).zip(sides) {
        let same: f32 = rotation.coords.iter().zip(side).map(|(a, b)| a * b).sum();
        let sign = if same < 0.0 { -1.0 } else { 1.0 };
        row.extend(rotation.coords.iter().map(|x| sign * x));
    }
    row
}

/// The mean quaternion of each joint but the hips over all clips.
pub fn signs(rig: &Rig, clips: &[&Clip]) -> Vec<f32> {
    let joints = rig.joints();
    let mut side = [0.0, 0.0, 0.0, 1.0f32].repeat(joints.saturating_sub(1));
    for _ in 0..3 {
        let mut sum = vec![0.0f64; side.len()];
        for pose in clips.iter().flat_map(|clip| rig.poses(clip)) {
            sum.iter_mut().zip(signed(&pose, joints, &side)).for_each(|(sum, x)| *sum += f64::from(x));
        }
        for (side, sum) in side.chunks_exact_mut(4).zip(sum.chunks_exact(4)) {
            let norm = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
            if norm > 0.0 {
                side.iter_mut().zip(sum).for_each(|(side, x)| *side = (x / norm) as f32);
            }
        }
    }
    side
}
