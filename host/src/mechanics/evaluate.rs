//! How near the predicted pose is, and what is left as expression, clip by clip.

use kinesic::mechanics::{FEATURES, angle};
use kinesic::{LoadError, Pack, Pose};
use serde::Serialize;

use super::linear::Linear;
use super::play::HostMechanics;
use super::train::{angle_between, mean_angle};
use crate::clip::Clip;
use crate::pack::{Baselines, Metric};
use crate::rig::Rig;

/// One clip. Angles are means over its frames and over the joints that move, degrees.
#[derive(Clone, Debug, Serialize)]
pub struct ClipReport {
    /// The clip.
    pub clip: String,
    /// Number of frames.
    pub frames: usize,
    /// Whether the pack was trained on it.
    pub trained_on: bool,
    /// Predicted pose against the observed one.
    pub geodesic_deg: f64,
    /// Ridge regression from the features.
    pub linear_deg: f64,
    /// Mean pose of the training clips.
    pub mean_pose_deg: f64,
    /// Angle of `E*`: what is left as expression.
    pub expressive_deg: f64,
}

/// Figures that are not measured here but come from the pack: whoever made it says so.
pub const STATED: [&str; 3] = ["autoencoder_mse", "linear_deg", "mean_pose_deg"];

/// Means over all frames, and every clip.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Measured in training on held-back data (from the pack: it does not hold the encoder); absent if nothing was held back.
    pub autoencoder_mse: Option<f64>,
    /// Mean squared error of quaternion components of moving joints on these clips.
    pub stacked_mse: f64,
    /// Predicted pose against the observed one.
    pub geodesic_deg: f64,
    /// Ridge regression from the features.
    pub linear_deg: f64,
    /// Mean pose of the training clips.
    pub mean_pose_deg: f64,
    /// Angle of `E*`.
    pub expressive_deg: f64,
    /// Joints that move in these clips, all but the hips: the means are over them. 0: nothing was measured.
    pub moving_joints: usize,
    /// [`STATED`].
    pub as_the_pack_states: [&'static str; 3],
    /// Every clip.
    pub clips: Vec<ClipReport>,
}

/// Degrees by which a joint turns in a clip at least to count as moving: fingers that were not recorded, and helper joints, would only
/// dilute a mean.
const MOVES: f32 = 1.0;

/// Which joints (but the hips) move in at least one of the clips. The clips say so, not the pack that is measured.
fn moving<const JOINTS: usize>(clips: &[Vec<Pose<JOINTS>>], joints: usize) -> Vec<bool> {
    let turns = |joint: usize, poses: &Vec<Pose<JOINTS>>| {
        let rotations = || poses.iter().map(|pose| pose.rotations[joint]);
        let first = rotations().next();
        first.is_some_and(|first| rotations().any(|q| angle(&(first.inverse() * q)).to_degrees() > MOVES))
    };
    (1..joints).map(|joint| clips.iter().any(|poses| turns(joint, poses))).collect()
}

/// Runs every clip `(name, clip on the rig, trained on)` through the device's code.
pub fn evaluate(
    pack: &Pack,
    rig: &Rig,
    baselines: &Baselines,
    metrics: &[Metric],
    clips: &[(String, Clip, bool)],
) -> Result<Report, LoadError> {
    let model = HostMechanics::load(pack)?;
    let linear = Linear { weights: baselines.affine.clone() };
    let joints = rig.joints();
    let outputs = 4 * joints.saturating_sub(1);
    for (found, expected) in [(baselines.affine.len(), (FEATURES + 1) * outputs), (baselines.offset.len(), outputs)] {
        if found != expected {
            return Err(LoadError::Shape { tensor: "of the baselines in the provenance", found, expected });
        }
    }
    let posed: Vec<Vec<Pose<_>>> = clips.iter().map(|(_, clip, _)| rig.poses(clip)).collect();
    let moving = moving(&posed, joints);
    let (mean, scale): (&[f32], &[f32]) =
        (pack.slice("mechanics/feature_mean", FEATURES)?, pack.slice("mechanics/feature_inverse_deviation", FEATURES)?);
    let normalised = |features: &[f32; FEATURES]| {
        let columns = features.iter().zip(mean).zip(scale);
        columns.map(|((x, mean), scale)| ((x - mean) * scale).clamp(-6.0, 6.0)).collect::<Vec<f32>>()
    };
    let mut reports = Vec::new();
    let (mut squares, mut count) = (0.0, 0usize);
    for ((name, clip, trained_on), poses) in clips.iter().zip(&posed) {
        let mut state = Box::new(kinesic::MechanicsState::new());
        let mut parts = kinesic::mechanics::Decoupled::identity();
        let mut mechanics = Pose::identity();
        let (mut predicted, mut regressed, mut observed) = (Vec::new(), Vec::new(), Vec::new());
        let mut left = 0.0;
        for pose in poses {
            model.step(&mut state, pose, &mut parts);
            model.predict(state.features(), pose, &mut mechanics);
            let row = |pose: &Pose<_>| {
                pose.rotations[1..joints].iter().flat_map(|q| q.coords.as_slice().to_vec()).collect::<Vec<f32>>()
            };
            predicted.extend(row(&mechanics));
            observed.extend(row(pose));
            regressed.extend(linear.apply(&normalised(state.features())));
            left += parts.expressive[1..joints]
                .iter()
                .zip(&moving)
                .filter(|(_, moves)| **moves)
                .map(|(e, _)| f64::from(angle(e)).to_degrees())
                .sum::<f64>();
        }
        let movers = moving.iter().filter(|m| **m).count().max(1);
        let quaternions = predicted.as_chunks::<4>().0.iter().zip(observed.as_chunks::<4>().0);
        for ((a, b), _) in quaternions.zip(moving.iter().cycle()).filter(|(_, moves)| **moves) {
            // |a - b|^2 of two unit quaternions on one side of the sphere is (2 sin(angle / 4))^2.
            squares += (2.0 * (angle_between(a, b) / 4.0).sin()).powi(2);
            count += 4;
        }
        reports.push(ClipReport {
            clip: name.clone(),
            frames: clip.frames(),
            trained_on: *trained_on,
            geodesic_deg: mean_angle(&predicted, &observed, &moving),
            linear_deg: mean_angle(&regressed, &observed, &moving),
            mean_pose_deg: mean_angle(&baselines.offset.repeat(clip.frames()), &observed, &moving),
            expressive_deg: left / (clip.frames() * movers) as f64,
        });
    }
    let frames = reports.iter().map(|r| r.frames).sum::<usize>().max(1) as f64;
    let mean = |of: fn(&ClipReport) -> f64| reports.iter().map(|r| of(r) * r.frames as f64).sum::<f64>() / frames;
    Ok(Report {
        autoencoder_mse: metrics.iter().find(|m| m.name == "held_back_autoencoder_mse").map(|m| m.value),
        stacked_mse: squares / count.max(1) as f64,
        geodesic_deg: mean(|r| r.geodesic_deg),
        linear_deg: mean(|r| r.linear_deg),
        mean_pose_deg: mean(|r| r.mean_pose_deg),
        expressive_deg: mean(|r| r.expressive_deg),
        moving_joints: moving.iter().filter(|moves| **moves).count(),
        as_the_pack_states: STATED,
        clips: reports,
    })
}
