//! A made walk: seeded sums of sines on a body of 25 joints, or on another one. No data set is needed to check a budget, and the same seed
//! gives the same bits on every machine (`libm`, not the system's sine).

use kinesic_host::clip::{Clip, Joint, JointMap, Skeleton};
use kinesic_host::rig::Rig;
use nalgebra::{UnitQuaternion, Vector3};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Frames per second of the made walk.
pub const FRAME_RATE: f64 = 60.0;

/// Name, parent, rest offset in m, swing of the joint in rad.
const BODY: [(&str, &str, [f64; 3], f64); 25] = [
    ("Hips", "", [0.0, 0.0, 0.0], 0.08),
    ("Spine", "Hips", [0.0, 0.10, -0.01], 0.05),
    ("Spine1", "Spine", [0.0, 0.12, 0.0], 0.05),
    ("Spine2", "Spine1", [0.0, 0.14, 0.01], 0.05),
    ("Neck", "Spine2", [0.0, 0.16, 0.01], 0.06),
    ("Head", "Neck", [0.0, 0.09, 0.02], 0.08),
    ("HeadTop_End", "Head", [0.0, 0.18, 0.02], 0.0),
    ("LeftShoulder", "Spine2", [0.05, 0.12, 0.0], 0.05),
    ("LeftArm", "LeftShoulder", [0.13, 0.0, -0.01], 0.5),
    ("LeftForeArm", "LeftArm", [0.27, 0.0, 0.0], 0.4),
    ("LeftHand", "LeftForeArm", [0.25, 0.0, 0.0], 0.2),
    ("RightShoulder", "Spine2", [-0.05, 0.12, 0.0], 0.05),
    ("RightArm", "RightShoulder", [-0.13, 0.0, -0.01], 0.5),
    ("RightForeArm", "RightArm", [-0.27, 0.0, 0.0], 0.4),
    ("RightHand", "RightForeArm", [-0.25, 0.0, 0.0], 0.2),
    ("LeftUpLeg", "Hips", [0.09, -0.06, 0.0], 0.5),
    ("LeftLeg", "LeftUpLeg", [0.0, -0.42, 0.01], 0.6),
    ("LeftFoot", "LeftLeg", [0.0, -0.41, -0.02], 0.3),
    ("LeftToeBase", "LeftFoot", [0.0, -0.05, 0.13], 0.2),
    ("LeftToe_End", "LeftToeBase", [0.0, -0.01, 0.07], 0.0),
    ("RightUpLeg", "Hips", [-0.09, -0.06, 0.0], 0.5),
    ("RightLeg", "RightUpLeg", [0.0, -0.42, 0.01], 0.6),
    ("RightFoot", "RightLeg", [0.0, -0.41, -0.02], 0.3),
    ("RightToeBase", "RightFoot", [0.0, -0.05, 0.13], 0.2),
    ("RightToe_End", "RightToeBase", [0.0, -0.01, 0.07], 0.0),
];

/// Swing of joints that the made body does not have, rad.
const OTHER_SWING: f64 = 0.05;

fn skeleton() -> Skeleton {
    let index = |name: &str| BODY.iter().position(|(other, ..)| *other == name);
    let joint = |(name, parent, offset, _): &(&str, &str, [f64; 3], f64)| Joint {
        name: (*name).to_owned(),
        parent: index(parent),
        offset: Vector3::from(*offset),
        end: None,
    };
    Skeleton { joints: BODY.iter().map(joint).collect() }
}

/// The walker's rig.
pub fn rig() -> Rig {
    rig_of(&skeleton())
}

/// The walker without the ends of its toes: 23 joints, as many as a common inertial suit has.
pub fn short_rig() -> Rig {
    let mut skeleton = skeleton();
    let kept: Vec<usize> = (0..BODY.len()).filter(|joint| !BODY[*joint].0.ends_with("Toe_End")).collect();
    let parent = |joint: &Joint| joint.parent.and_then(|parent| kept.iter().position(|other| *other == parent));
    let joint = |at: &usize| Joint { parent: parent(&skeleton.joints[*at]), ..skeleton.joints[*at].clone() };
    skeleton.joints = kept.iter().map(joint).collect();
    rig_of(&skeleton)
}

fn rig_of(skeleton: &Skeleton) -> Rig {
    let map = JointMap::detect(skeleton).expect("the made body has Mixamo's names");
    Rig::new(skeleton, &map).expect("the made body has hips")
}

/// A walk of about two steps a second that slowly turns.
pub fn walk(frames: usize, seed: u64) -> Clip {
    walk_on(&skeleton(), frames, seed)
}

/// The same walk on a skeleton whose joints have the made body's names; joints of other names move a little.
#[expect(clippy::approx_constant, reason = "any phase will do, and the limits were measured with this one")]
pub fn walk_on(skeleton: &Skeleton, frames: usize, seed: u64) -> Clip {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let waves: Vec<[f64; 6]> =
        skeleton.joints.iter().map(|_| std::array::from_fn(|_| random.random_range(-1.0..1.0f64))).collect();
    let swing = |joint: &Joint| BODY.iter().find(|(name, ..)| *name == joint.name).map_or(OTHER_SWING, |body| body.3);
    let swings: Vec<f64> = skeleton.joints.iter().map(swing).collect();
    let mut clip = Clip {
        skeleton: skeleton.clone(),
        frame_time: 1.0 / FRAME_RATE,
        root: Vec::new(),
        rotations: Vec::new(),
        coordinates: None,
        notes: Vec::new(),
    };
    for frame in 0..frames {
        let time = frame as f64 / FRAME_RATE;
        let (step, turn) = (6.3 * time, 0.1 * time);
        let (sway, bob) = (0.02 * libm::sin(step), 0.03 * libm::sin(2.0 * step));
        clip.root.push(Vector3::new(sway + 6.0 * (1.0 - libm::cos(turn)), 0.92 + bob, 6.0 * libm::sin(turn)));
        for (joint, (swing, wave)) in swings.iter().zip(&waves).enumerate() {
            let axis = |at: usize| {
                let phase = 3.14 * wave[at];
                swing * wave[at + 1] * (libm::sin(step + phase) + 0.3 * libm::sin(2.0 * step + 2.0 * phase))
            };
            let swung = scaled_axis(axis(0), 0.4 * axis(2), 0.4 * axis(4));
            clip.rotations.push(if joint == 0 { scaled_axis(0.0, turn, 0.0) * swung } else { swung });
        }
    }
    clip
}

/// The rotation by `|v|` rad about `v`.
fn scaled_axis(x: f64, y: f64, z: f64) -> UnitQuaternion<f64> {
    let angle = libm::sqrt(x * x + y * y + z * z);
    let scale = if angle > 1e-12 { libm::sin(angle / 2.0) / angle } else { 0.5 };
    UnitQuaternion::new_normalize(nalgebra::Quaternion::new(libm::cos(angle / 2.0), x * scale, y * scale, z * scale))
}
