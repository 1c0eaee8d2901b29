//! Made skeletons: the same walk in other axes, with other joints, on other legs.

use nalgebra::{UnitQuaternion, Vector3};

use super::retarget;
use crate::clip::{Canonical, Clip, Joint, JointMap, Skeleton};
use crate::gait::{Manner, walk};
use crate::rig::Rig;

fn person() -> (Clip, JointMap) {
    let clip = walk(&Manner::NEUTRAL, 3.0, 30.0, 0.0, 1);
    let map = JointMap::detect(&clip.skeleton).unwrap();
    (clip, map)
}

/// The same motion, with every joint's axes turned about: a rest pose that is no stance.
fn other_axes(clip: &Clip) -> Clip {
    let n = clip.skeleton.len();
    let axes: Vec<_> = (0..n)
        .map(|j| UnitQuaternion::from_euler_angles(1.3 + 0.7 * j as f64, 0.4 * j as f64, 2.0 - 0.3 * j as f64))
        .collect();
    let mut moved = clip.clone();
    for (index, joint) in moved.skeleton.joints.iter_mut().enumerate() {
        joint.name = format!("{}_", joint.name);
        joint.offset = joint.parent.map_or(joint.offset, |p| axes[p].inverse() * joint.offset);
        joint.end = joint.end.map(|end| axes[index].inverse() * end);
    }
    for frame in 0..clip.frames() {
        for (index, joint) in clip.skeleton.joints.iter().enumerate() {
            let local = &mut moved.rotations[frame * n + index];
            *local = joint.parent.map_or(*local, |p| axes[p].inverse() * *local) * axes[index];
        }
    }
    moved
}

/// The map of a skeleton with the same joints in the same order.
fn same_map(map: &JointMap, skeleton: &Skeleton) -> JointMap {
    let mut joints = [None; crate::clip::map::CANONICAL];
    Canonical::ALL.iter().for_each(|c| joints[*c as usize] = map.joint(*c));
    JointMap::from_indices("made", joints, skeleton)
}

const BONES: [(Canonical, Canonical); 12] = [
    (Canonical::LShoulder, Canonical::LElbow),
    (Canonical::LElbow, Canonical::LWrist),
    (Canonical::RShoulder, Canonical::RElbow),
    (Canonical::RElbow, Canonical::RWrist),
    (Canonical::LHip, Canonical::LKnee),
    (Canonical::LKnee, Canonical::LAnkle),
    (Canonical::RHip, Canonical::RKnee),
    (Canonical::RKnee, Canonical::RAnkle),
    (Canonical::Spine, Canonical::Chest),
    (Canonical::Neck, Canonical::Head),
    (Canonical::LAnkle, Canonical::LToe),
    (Canonical::RAnkle, Canonical::RToe),
];

/// The greatest angle between limbs that both have, rad.
fn off(a: (&Clip, &JointMap), b: (&Clip, &JointMap)) -> f64 {
    let mut worst: f64 = 0.0;
    for frame in 0..a.0.frames() {
        let (p, q) = (a.0.positions(frame), b.0.positions(frame));
        for (from, to) in BONES {
            let bone = |map: &JointMap, p: &[Vector3<f64>]| Some(p[map.joint(to)?] - p[map.joint(from)?]);
            if let Some((a, b)) = bone(a.1, &p).zip(bone(b.1, &q)) {
                worst = worst.max(a.angle(&b));
            }
        }
    }
    worst
}

/// The greatest angle between the world rotations of two clips of one skeleton, rad.
fn turned(a: &Clip, b: &Clip) -> f64 {
    let worlds = |clip: &Clip, frame: usize| clip.skeleton.world_rotations(clip.pose(frame));
    let pairs = (0..a.frames()).flat_map(|f| worlds(a, f).into_iter().zip(worlds(b, f)));
    pairs.map(|(a, b)| a.angle_to(&b)).fold(0.0, f64::max)
}

#[test]
fn axes_do_not_matter() {
    let (clip, map) = person();
    let other = other_axes(&clip);
    let other_map = same_map(&map, &other.skeleton);
    let rig = Rig::new(&other.skeleton, &other_map).unwrap();
    let there = retarget(&clip, &map, &rig).unwrap();
    assert!(off((&clip, &map), (&there, &other_map)) < 1e-6);
    let shoulders = |clip: &Clip, map: &JointMap, f: usize| {
        let p = clip.positions(f);
        (p[map.joint(Canonical::LShoulder).unwrap()] - p[map.joint(Canonical::RShoulder).unwrap()]).norm()
    };
    assert!((shoulders(&there, &other_map, 9) - shoulders(&clip, &map, 9)).abs() < 0.01);
    let back = retarget(&other, &other_map, &Rig::new(&clip.skeleton, &map).unwrap()).unwrap();
    assert!(off((&other, &other_map), (&back, &map)) < 1e-6);
}

#[test]
fn a_trained_rig_knows_how_its_limbs_are_twisted() {
    let (clip, map) = person();
    let other = other_axes(&clip);
    let rig = Rig::new(&other.skeleton, &same_map(&map, &other.skeleton)).unwrap();
    let trained = rig.centred(&[&rig.poses(&other)]);
    let moved = retarget(&clip, &map, &trained).unwrap();
    assert!(turned(&moved, &other) < 0.25, "{}", turned(&moved, &other));
}

#[test]
fn there_and_back_is_the_same_where_both_rest_upright() {
    let (clip, map) = person();
    // Arms held out, no toes, one more joint in the spine.
    let mut joints: Vec<Joint> = clip.skeleton.joints.clone();
    for joint in &mut joints {
        joint.name = joint.name.replace("ToeBase", "Sole");
        let side = if joint.name.starts_with("Left") { 1.0 } else { -1.0 };
        if joint.name.ends_with("ForeArm") || joint.name.ends_with("Hand") {
            joint.offset = Vector3::new(side * joint.offset.norm(), 0.0, 0.0);
            joint.end = joint.end.map(|end| Vector3::new(side * end.norm(), 0.0, 0.0));
        }
    }
    let chest = joints.iter().position(|j| j.name == "Spine1").unwrap();
    let middle =
        Joint { name: "Middle".into(), offset: joints[chest].offset * 0.5, end: None, ..joints[chest].clone() };
    joints.insert(chest, middle);
    for joint in &mut joints[chest + 1..] {
        joint.parent = joint.parent.map(|p| if p >= chest { p + 1 } else { p });
    }
    joints[chest + 1].parent = Some(chest);
    let offset = joints[chest].offset;
    joints[chest + 1].offset = offset;
    let rig = Skeleton { joints };
    let rig_map = JointMap::detect(&rig).unwrap();
    let there = retarget(&clip, &map, &Rig::new(&rig, &rig_map).unwrap()).unwrap();
    assert!(off((&clip, &map), (&there, &rig_map)) < 1e-6);
    let back = retarget(&there, &rig_map, &Rig::new(&clip.skeleton, &map).unwrap()).unwrap();
    assert!(off((&clip, &map), (&back, &map)) < 1e-6);
    let toes = |index: usize| clip.skeleton.joints[index].name.ends_with("ToeBase");
    for frame in 0..clip.frames() {
        let (a, b) = (clip.skeleton.world_rotations(clip.pose(frame)), clip.skeleton.world_rotations(back.pose(frame)));
        for (index, (a, b)) in a.iter().zip(&b).enumerate().filter(|(index, _)| !toes(*index)) {
            assert!(a.angle_to(b) < 0.03, "{}: {}", clip.skeleton.joints[index].name, a.angle_to(b));
        }
    }
}

#[test]
fn feet_stand_on_the_floor_of_the_clip() {
    let (mut clip, map) = person();
    clip.root.iter_mut().for_each(|p| p.y += 0.3);
    let mut longer = clip.skeleton.clone();
    for joint in &mut longer.joints {
        joint.name = format!("{}_", joint.name);
        let leg = joint.name.contains("Leg") || joint.name.contains("Foot");
        joint.offset *= if leg { 1.3 } else { 1.1 };
        joint.end = joint.end.map(|end| end * 1.2);
    }
    let rig = Rig::new(&longer, &same_map(&map, &longer)).unwrap();
    let moved = retarget(&clip, &map, &rig).unwrap();
    let lowest = |clip: &Clip| -> Vec<f64> {
        let frame = |f: usize| {
            let (p, worlds) = (clip.positions(f), clip.skeleton.world_rotations(clip.pose(f)));
            let end = |j: usize| worlds[j] * clip.skeleton.joints[j].end.unwrap_or_else(Vector3::zeros);
            (1..9).map(|j| p[j].y.min((p[j] + end(j)).y)).fold(f64::MAX, f64::min)
        };
        (0..clip.frames()).map(frame).collect()
    };
    let (before, after) = (lowest(&clip), lowest(&moved));
    let least = |all: &[f64]| all.iter().copied().fold(f64::MAX, f64::min);
    assert!(least(&after) > least(&before) - 0.01, "{} {}", least(&after), least(&before));
    let middle = |mut all: Vec<f64>| {
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    let (floor, stands) = (least(&before), middle(before.clone()));
    let found = middle(after) - floor - 1.3 * (stands - floor);
    assert!(found.abs() < 0.02, "{found}");
    // The path is as much longer as the legs are.
    let far = |clip: &Clip| (clip.root[80] - clip.root[0]).xz().norm();
    assert!((far(&moved) / far(&clip) - 1.3).abs() < 0.05, "{}", far(&moved) / far(&clip));
}

#[test]
fn equal_skeletons_keep_every_rotation() {
    let (clip, map) = person();
    let moved = retarget(&clip, &map, &Rig::new(&clip.skeleton, &map).unwrap()).unwrap();
    assert_eq!((moved.rotations, moved.root), (clip.rotations, clip.root));
}
