//! A small parametric gait of our own: made-up walks for the demo, for tests and for firmware workloads.
//!
//! It looks like walking and has exactly known timing; it is no model of human locomotion.

use std::f64::consts::TAU;

use nalgebra::{UnitQuaternion, Vector3};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use crate::clip::{Clip, Joint, Skeleton};

/// How somebody walks. Angles in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manner {
    /// Strides (two steps) a second.
    pub cadence: f64,
    /// Swing of the thighs to either side of the vertical.
    pub stride: f64,
    /// Bend of the knee in the swing phase.
    pub knee: f64,
    /// Swing of the arms.
    pub arms: f64,
    /// Bend of the elbows.
    pub elbows: f64,
    /// Forward bend of the trunk.
    pub stoop: f64,
    /// Bend of the neck, forward.
    pub nod: f64,
    /// Sway of the trunk from side to side.
    pub sway: f64,
}

impl Manner {
    /// Upright, even, unremarkable.
    pub const NEUTRAL: Self =
        Self { cadence: 0.9, stride: 0.42, knee: 0.9, arms: 0.45, elbows: 0.35, stoop: 0.03, nod: 0.05, sway: 0.03 };

    /// Bent, slow, with short steps and hanging arms.
    pub const WEARY: Self =
        Self { cadence: 0.68, stride: 0.30, knee: 0.6, arms: 0.18, elbows: 0.15, stoop: 0.35, nod: 0.45, sway: 0.09 };
}

/// Names in the CMU order, so that the joint map is known.
const JOINTS: [(&str, Option<usize>, [f64; 3]); 19] = [
    ("Hips", None, [0.0, 0.0, 0.0]),
    ("LeftUpLeg", Some(0), [0.09, -0.06, 0.0]),
    ("LeftLeg", Some(1), [0.0, -0.42, 0.0]),
    ("LeftFoot", Some(2), [0.0, -0.41, 0.0]),
    ("LeftToeBase", Some(3), [0.0, -0.06, 0.14]),
    ("RightUpLeg", Some(0), [-0.09, -0.06, 0.0]),
    ("RightLeg", Some(5), [0.0, -0.42, 0.0]),
    ("RightFoot", Some(6), [0.0, -0.41, 0.0]),
    ("RightToeBase", Some(7), [0.0, -0.06, 0.14]),
    ("Spine", Some(0), [0.0, 0.11, 0.0]),
    ("Spine1", Some(9), [0.0, 0.20, 0.0]),
    ("Neck1", Some(10), [0.0, 0.22, 0.0]),
    ("Head", Some(11), [0.0, 0.10, 0.02]),
    ("LeftArm", Some(10), [0.18, 0.16, 0.0]),
    ("LeftForeArm", Some(13), [0.0, -0.28, 0.0]),
    ("LeftHand", Some(14), [0.0, -0.25, 0.0]),
    ("RightArm", Some(10), [-0.18, 0.16, 0.0]),
    ("RightForeArm", Some(16), [0.0, -0.28, 0.0]),
    ("RightHand", Some(17), [0.0, -0.25, 0.0]),
];

/// Height of an ankle above the ground, m.
const ANKLE: f64 = 0.08;

/// The gait's skeleton, 19 joints, about 1.7 m tall.
pub fn skeleton() -> Skeleton {
    let joint = |(name, parent, offset): (&str, Option<usize>, [f64; 3])| {
        let end = match name {
            "Head" => Some(Vector3::new(0.0, 0.18, 0.0)),
            "LeftHand" | "RightHand" => Some(Vector3::new(0.0, -0.16, 0.0)),
            "LeftToeBase" | "RightToeBase" => Some(Vector3::new(0.0, 0.0, 0.06)),
            _ => None,
        };
        Joint { name: name.to_owned(), parent, offset: Vector3::from(offset), end }
    };
    Skeleton { joints: JOINTS.into_iter().map(joint).collect() }
}

/// A walk of `seconds` at `fps` frames a second, starting at `phase` of the stride (0 to 1).
///
/// The seed varies cadence and amplitudes slowly by a few percent, as no two strides are the same, and bends the path.
pub fn walk(manner: &Manner, seconds: f64, fps: f64, phase: f64, seed: u64) -> Clip {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let wobble: [[f64; 2]; 4] =
        std::array::from_fn(|_| [random.random_range(0.05..0.25), random.random_range(0.0..TAU)]);
    let turn = random.random_range(-0.15..0.15);
    let skeleton = skeleton();
    let frames = (seconds * fps).round().max(2.0) as usize;
    let mut clip = Clip {
        skeleton: skeleton.clone(),
        frame_time: 1.0 / fps,
        root: Vec::with_capacity(frames),
        rotations: Vec::with_capacity(frames * JOINTS.len()),
        coordinates: None,
        notes: Vec::new(),
    };
    let mut angle = TAU * phase;
    let (mut x, mut z) = (0.0, 0.0);
    let mut last: Option<[Vector3<f64>; 2]> = None;
    for frame in 0..frames {
        let time = frame as f64 / fps;
        let vary = |k: usize| 1.0 + 0.05 * (TAU * wobble[k][0] * time + wobble[k][1]).sin();
        let yaw = turn * time;
        let rotations = pose(manner, angle, yaw, [vary(0), vary(1), vary(2)]);
        let positions = skeleton.pose_positions(&Vector3::zeros(), &rotations);
        let feet = [positions[3], positions[7]];
        let height = ANKLE - feet[0].y.min(feet[1].y);
        if let Some(last) = last {
            // The lower foot stands still, so the body moves.
            let standing = usize::from(feet[1].y < feet[0].y);
            x += last[standing].x - feet[standing].x;
            z += last[standing].z - feet[standing].z;
        }
        last = Some(feet);
        clip.root.push(Vector3::new(x, height, z));
        clip.rotations.extend(rotations);
        angle += TAU * manner.cadence * vary(3) / fps;
    }
    clip
}

fn pose(manner: &Manner, angle: f64, yaw: f64, [legs, arms, trunk]: [f64; 3]) -> Vec<UnitQuaternion<f64>> {
    let about = |axis: Vector3<f64>, angle: f64| UnitQuaternion::new(axis * angle);
    let (pitch, turn, roll) = (Vector3::x(), Vector3::y(), Vector3::z());
    let sway = manner.sway * trunk * angle.sin();
    let leg = |side: f64| {
        let phase = angle + if side > 0.0 { 0.0 } else { TAU / 2.0 };
        let thigh = -manner.stride * legs * phase.sin();
        // The knee bends while the thigh swings forward.
        let knee = 0.08 + manner.knee * legs * (0.5 + 0.5 * (phase + 0.6).cos()).powi(2);
        [thigh - 0.3 * knee, knee, -0.35 * knee - 0.5 * thigh, 0.0]
    };
    let arm = |side: f64| {
        let swing = manner.arms * arms * (side * angle.sin());
        [swing - 0.5 * manner.stoop, -(manner.elbows * arms + 0.3 * (-swing).max(0.0)), 0.0]
    };
    let mut rotations = vec![about(turn, yaw) * about(roll, 0.4 * sway) * about(turn, 0.12 * legs * angle.sin())];
    for side in [1.0, -1.0] {
        rotations.extend(leg(side).map(|a| about(pitch, a)));
    }
    rotations.push(about(pitch, 0.5 * manner.stoop * trunk) * about(roll, -sway));
    rotations.push(about(pitch, 0.5 * manner.stoop * trunk) * about(turn, -0.2 * legs * angle.sin()));
    rotations.push(about(pitch, manner.nod * trunk));
    rotations.push(about(pitch, -0.3 * manner.nod));
    for side in [1.0, -1.0] {
        let [shoulder, elbow, wrist] = arm(side);
        rotations.push(about(roll, 0.08 * side) * about(pitch, shoulder));
        rotations.push(about(pitch, elbow));
        rotations.push(about(pitch, wrist));
    }
    rotations
}
