//! A made figure that walks in two manners.
#![allow(dead_code)]

use kinesic_host::clip::{Canonical, Clip, Joint, JointMap, Skeleton};
use kinesic_host::components::FRAME_RATE;
use kinesic_host::rig::Rig;
use nalgebra::{UnitQuaternion, Vector3};

/// Hips, two legs, a spine with a head, two arms: 13 joints.
pub fn rig() -> Rig {
    let joints: [(&str, Option<usize>, [f64; 3]); 13] = [
        ("Hips", None, [0.0; 3]),
        ("LeftUpLeg", Some(0), [0.09, -0.05, 0.0]),
        ("LeftLeg", Some(1), [0.0, -0.42, 0.01]),
        ("LeftFoot", Some(2), [0.0, -0.41, -0.01]),
        ("RightUpLeg", Some(0), [-0.09, -0.05, 0.0]),
        ("RightLeg", Some(4), [0.0, -0.42, 0.01]),
        ("RightFoot", Some(5), [0.0, -0.41, -0.01]),
        ("Spine", Some(0), [0.0, 0.25, 0.0]),
        ("Head", Some(7), [0.0, 0.35, 0.02]),
        ("LeftArm", Some(7), [0.18, 0.2, 0.0]),
        ("LeftHand", Some(9), [0.5, 0.0, 0.05]),
        ("RightArm", Some(7), [-0.18, 0.2, 0.0]),
        ("RightHand", Some(11), [-0.5, 0.0, 0.05]),
    ];
    let joint = |(name, parent, offset): (&str, Option<usize>, [f64; 3])| Joint {
        name: name.to_owned(),
        parent,
        offset: Vector3::from(offset),
        end: None,
    };
    let skeleton = Skeleton { joints: joints.map(joint).to_vec() };
    let known = Canonical::ALL.map(|c| match c {
        Canonical::Pelvis => Some(0),
        Canonical::LHip => Some(1),
        Canonical::RHip => Some(4),
        _ => None,
    });
    let map = JointMap::from_indices("made", known, &skeleton);
    Rig::new(&skeleton, &map).expect("a rig")
}

/// `frames` of a walk along a curve; `energy` scales the arms, `stoop` bends the spine, rad.
pub fn walk(rig: &Rig, frames: usize, energy: f64, stoop: f64) -> Clip {
    let joints = rig.joints();
    let mut clip = Clip {
        skeleton: rig.skeleton.clone(),
        frame_time: 1.0 / FRAME_RATE,
        root: Vec::new(),
        rotations: Vec::new(),
        coordinates: None,
        notes: Vec::new(),
    };
    let turn = |x: f64, y: f64, z: f64| UnitQuaternion::from_euler_angles(x, y, z);
    for f in 0..frames {
        let (t, phase) = (f as f64 / FRAME_RATE, f as f64 * 0.11);
        let (s, c) = phase.sin_cos();
        let mut pose = vec![UnitQuaternion::identity(); joints];
        pose[0] = turn(0.03 * c, 0.4 * t + 0.05 * s, 0.02 * (2.0 * phase).sin());
        pose[1] = turn(-0.5 * s, 0.0, 0.02 * c);
        pose[2] = turn(0.5 + 0.4 * c, 0.0, 0.0);
        pose[4] = turn(0.5 * s, 0.0, -0.02 * c);
        pose[5] = turn(0.5 - 0.4 * c, 0.0, 0.0);
        pose[7] = turn(stoop + 0.05 * (2.0 * phase).cos(), 0.1 * energy * s, 0.0);
        pose[8] = turn(-0.3 * stoop, -0.1 * s, 0.05 * (0.7 * phase).sin());
        pose[9] = turn(0.3 * s * energy, 0.6 * energy * s, -1.2 + 0.1 * energy * (2.0 * phase).sin());
        pose[11] = turn(0.3 * s * energy, 0.6 * energy * s, 1.2 - 0.1 * energy * (2.0 * phase).cos());
        // Hands twist more the livelier the walk is.
        pose[10] = turn(0.3 * energy, 0.2 * energy * c, 0.0);
        pose[12] = turn(0.3 * energy, -0.2 * energy * c, 0.0);
        clip.root.push(Vector3::new(0.3 * t.sin(), 0.88 + 0.02 * (2.0 * phase).cos(), 1.2 * t));
        clip.rotations.extend(pose);
    }
    clip
}
