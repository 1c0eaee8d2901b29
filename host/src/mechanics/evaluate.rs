//! How near the predicted pose is, and what is left as expression, clip by clip.

use kinesic::mechanics::{FEATURES, angle};
use kinesic::{LoadError, Pack, Pose};
use nalgebra::{Quaternion, UnitQuaternion};
use serde::Serialize;

use super::linear::Linear;
use super::play::HostMechanics;
use super::train::{angle_between, mean_angle};
use crate::clip::Clip;
use crate::measure::{Distance, Measurable, compare_frames};
use crate::pack::{Baselines, Metric};
use crate::rig::{MAX_JOINTS, Rig};

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
    /// The three over all joints, with distances.
    pub distances: Distances,
}

/// Distances to the observed poses, frame for frame, over all joints of the skeleton; the root is always the observed one.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Distances {
    /// Predicted pose.
    pub predicted: Distance,
    /// Ridge regression from the features.
    pub linear: Distance,
    /// Mean pose of the training clips.
    pub mean_pose: Distance,
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
    /// Figures of this report that are the pack's own.
    pub as_the_pack_states: [&'static str; 3],
    /// The three over all joints, with distances: means of the clips.
    pub distances: Distances,
    /// Every clip, without its joints.
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
    let observed_poses: Vec<Vec<Pose<_>>> = clips.iter().map(|(_, clip, _)| rig.poses(clip)).collect();
    let moving = moving(&observed_poses, joints);
    let (mean, scale): (&[f32], &[f32]) =
        (pack.slice("mechanics/feature_mean", FEATURES)?, pack.slice("mechanics/feature_inverse_deviation", FEATURES)?);
    let normalised = |features: &[f32; FEATURES]| {
        let columns = features.iter().zip(mean).zip(scale);
        columns.map(|((x, mean), scale)| ((x - mean) * scale).clamp(-6.0, 6.0)).collect::<Vec<f32>>()
    };
    let mut reports = Vec::new();
    let (mut squares, mut count) = (0.0, 0usize);
    for ((name, clip, trained_on), poses) in clips.iter().zip(&observed_poses) {
        let mut state = Box::new(kinesic::MechanicsState::new());
        let mut parts = kinesic::mechanics::Decoupled::identity();
        let mut mechanics = Pose::identity();
        let (mut predicted, mut regressed, mut observed) = (Vec::new(), Vec::new(), Vec::new());
        let mut left = 0.0;
        let mut frames = Vec::with_capacity(clip.frames());
        for pose in poses {
            model.step(&mut state, pose, &mut parts);
            model.predict(state.features(), pose, &mut mechanics);
            frames.push(mechanics);
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
        let mean_pose = baselines.offset.repeat(clip.frames());
        let target = Measurable::of_poses(rig, poses);
        let to_target = |poses: &[_]| compare_frames(rig, &Measurable::of_poses(rig, poses), &target);
        let distances = Distances {
            predicted: to_target(&frames),
            linear: to_target(&posed(poses, &regressed, joints)),
            mean_pose: to_target(&posed(poses, &mean_pose, joints)),
        };
        reports.push(ClipReport {
            clip: name.clone(),
            frames: clip.frames(),
            trained_on: *trained_on,
            geodesic_deg: mean_angle(&predicted, &observed, &moving),
            linear_deg: mean_angle(&regressed, &observed, &moving),
            mean_pose_deg: mean_angle(&mean_pose, &observed, &moving),
            expressive_deg: left / (clip.frames() * movers) as f64,
            distances,
        });
    }
    let distance = |of: fn(&Distances) -> &Distance| Distance::mean(reports.iter().map(|r| of(&r.distances)));
    let distances = Distances {
        predicted: distance(|d| &d.predicted),
        linear: distance(|d| &d.linear),
        mean_pose: distance(|d| &d.mean_pose),
    };
    for Distances { predicted, linear, mean_pose } in reports.iter_mut().map(|report| &mut report.distances) {
        [predicted, linear, mean_pose].into_iter().for_each(|distance| distance.degrees = distance.degrees.brief());
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
        distances,
        clips: reports,
    })
}

/// The observed poses with other rotations but the root's: rows of quaternions x, y, z, w, `[frames x (joints - 1)]`.
fn posed(observed: &[Pose<MAX_JOINTS>], rows: &[f32], joints: usize) -> Vec<Pose<MAX_JOINTS>> {
    let rows = rows.chunks_exact(4 * (joints - 1).max(1));
    let pose = |(pose, row): (&Pose<MAX_JOINTS>, &[f32])| {
        let mut pose = *pose;
        for (to, [i, j, k, w]) in pose.rotations[1..].iter_mut().zip(row.as_chunks::<4>().0) {
            *to = UnitQuaternion::new_normalize(Quaternion::new(*w, *i, *j, *k));
        }
        pose
    };
    observed.iter().zip(rows).map(pose).collect()
}
