//! What is done with clips in memory: kinematics, resampling, mirroring, positions to rotations.

use kinesic_host::clip::{Clip, Joint, MirrorError, Skeleton, solve};
use nalgebra::{UnitQuaternion, Vector3};
use proptest::prelude::*;

/// Two like sides of three joints, a trunk of two and a chest child at no distance.
fn skeleton(lengths: &[f64]) -> Skeleton {
    let tree: [(&str, Option<usize>, [f64; 3]); 9] = [
        ("Hips", None, [0.0, 0.0, 0.0]),
        ("Spine", Some(0), [0.0, 1.0, 0.1]),
        ("LeftShoulder", Some(1), [0.0, 0.0, 0.0]),
        ("LeftArm", Some(2), [1.0, 0.3, 0.0]),
        ("LeftHand", Some(3), [0.2, -1.0, 0.0]),
        ("RightShoulder", Some(1), [0.0, 0.0, 0.0]),
        ("RightArm", Some(5), [-1.0, 0.3, 0.0]),
        ("RightHand", Some(6), [-0.2, -1.0, 0.0]),
        ("Head", Some(1), [0.0, 0.6, 0.0]),
    ];
    let joints = tree.iter().zip(lengths).map(|(&(name, parent, offset), length)| Joint {
        name: name.into(),
        parent,
        offset: Vector3::from(offset) * *length,
        end: (name == "Head").then_some(Vector3::new(0.1, 0.2, 0.3)),
    });
    Skeleton { joints: joints.collect() }
}

fn quaternion() -> impl Strategy<Value = UnitQuaternion<f64>> {
    prop::array::uniform4(-1.0..1.0f64).prop_filter_map("no direction", |[w, i, j, k]| {
        let q = nalgebra::Quaternion::new(w, i, j, k);
        (q.norm() > 0.1).then(|| UnitQuaternion::from_quaternion(q))
    })
}

/// Clips of a few frames with bones of different lengths.
fn clip() -> impl Strategy<Value = Clip> {
    let lengths = prop::collection::vec(0.2..1.0f64, 9);
    let root = prop::collection::vec(prop::array::uniform3(-3.0..3.0f64), 2..6);
    let rotations = prop::collection::vec(quaternion(), 9 * 6);
    (lengths, root, rotations).prop_map(|(lengths, root, rotations)| Clip {
        skeleton: skeleton(&lengths),
        frame_time: 1.0 / 60.0,
        rotations: rotations[..9 * root.len()].to_vec(),
        root: root.into_iter().map(Vector3::from).collect(),
        coordinates: None,
        notes: vec![],
    })
}

proptest! {
    #[test]
    fn mirroring_reflects_positions_and_twice_is_nothing(clip in clip()) {
        let mirrored = clip.mirrored().expect("two like sides");
        let partner = [0, 1, 5, 6, 7, 2, 3, 4, 8];
        for frame in 0..clip.frames() {
            let (a, b) = (clip.positions(frame), mirrored.positions(frame));
            for (joint, p) in b.iter().enumerate() {
                let q = a[partner[joint]];
                prop_assert!((p - Vector3::new(-q.x, q.y, q.z)).norm() < 1e-12);
            }
        }
        let twice = mirrored.mirrored().expect("two like sides");
        prop_assert_eq!(&twice.skeleton, &clip.skeleton);
        prop_assert_eq!(&twice.root, &clip.root);
        prop_assert_eq!(&twice.rotations, &clip.rotations);
    }

    /// Kinematics by quaternions agrees with the product of 4 x 4 matrices.
    #[test]
    fn kinematics_agrees_with_matrices(clip in clip()) {
        for frame in 0..clip.frames() {
            let mut worlds: Vec<nalgebra::Isometry3<f64>> = Vec::new();
            for (joint, local) in clip.skeleton.joints.iter().zip(clip.pose(frame)) {
                let local = match joint.parent {
                    Some(p) => worlds[p] * nalgebra::Isometry3::from_parts(joint.offset.into(), *local),
                    None => nalgebra::Isometry3::from_parts(clip.root[frame].into(), *local),
                };
                worlds.push(local);
            }
            for (a, b) in clip.positions(frame).iter().zip(&worlds) {
                prop_assert!((a - b.translation.vector).norm() < 1e-12);
            }
            for (a, b) in clip.skeleton.world_rotations(clip.pose(frame)).iter().zip(&worlds) {
                prop_assert!(a.angle_to(&b.rotation) < 1e-12);
            }
        }
        prop_assert_eq!(clip.all_positions().len(), clip.frames() * clip.skeleton.len());
    }

    /// Positions that a skeleton can take are reached exactly, whatever the reference.
    #[test]
    fn solved_rotations_reach_the_positions(clip in clip(), reference in prop::collection::vec(quaternion(), 9)) {
        // The chest is rigid with its children at no distance, so these keep still.
        let mut clip = clip;
        for frame in 0..clip.frames() {
            clip.rotations[frame * 9 + 2] = UnitQuaternion::identity();
            clip.rotations[frame * 9 + 5] = UnitQuaternion::identity();
        }
        let target = clip.positions(0);
        let mut resting = reference.clone();
        (resting[2], resting[5]) = (UnitQuaternion::identity(), UnitQuaternion::identity());
        for reference in [None, Some(&resting[..]), Some(clip.pose(0))] {
            let solved = solve::rotations(&clip.skeleton, &target, reference);
            for (a, b) in clip.skeleton.pose_positions(&clip.root[0], &solved).iter().zip(&target) {
                prop_assert!((a - b).norm() < 1e-9, "{} {}", a, b);
            }
        }
        // Positions of the reference itself ask for no change.
        let same = solve::rotations(&clip.skeleton, &target, Some(clip.pose(0)));
        for (a, b) in same.iter().zip(clip.pose(0)) {
            prop_assert!(a.angle_to(b) < 1e-6);
        }
    }

    #[test]
    fn sign_continuity_changes_no_rotation(clip in clip()) {
        let mut even = clip.clone();
        even.make_signs_continuous();
        for (a, b) in even.rotations.iter().zip(&clip.rotations) {
            prop_assert!(a.coords == b.coords || a.coords == -b.coords);
        }
        for joint in 0..9 {
            prop_assert!(even.rotations[joint].w >= 0.0);
            for frame in 1..even.frames() {
                prop_assert!(even.pose(frame)[joint].coords.dot(&even.pose(frame - 1)[joint].coords) >= 0.0);
            }
        }
    }
}

/// A root that goes straight and a head that turns evenly, at 60 fps.
fn steady(frames: usize) -> Clip {
    let mut rotations = vec![UnitQuaternion::identity(); 9 * frames];
    for f in 0..frames {
        rotations[f * 9 + 8] = UnitQuaternion::from_euler_angles(0.0, 0.03 * f as f64, 0.0);
    }
    Clip {
        skeleton: skeleton(&[1.0; 9]),
        frame_time: 0.0166667,
        root: (0..frames).map(|f| Vector3::new(0.01 * f as f64, 1.0, 0.0)).collect(),
        rotations,
        coordinates: None,
        notes: vec!["kept".into()],
    }
}

#[test]
fn whole_ratios_pick_frames() {
    let clip = steady(121);
    let half = clip.resample(30.0).expect("a rate");
    assert_eq!((half.frames(), half.frame_time), (61, 1.0 / 30.0));
    assert_eq!((half.root[17], half.pose(17)), (clip.root[34], clip.pose(34)), "to the bit");
    let same = clip.resample(60.0).expect("a rate");
    assert_eq!((same.rotations == clip.rotations, same.root == clip.root), (true, true));
    assert_eq!(same.notes, ["kept"]);
}

#[test]
fn other_ratios_interpolate_by_time() {
    let clip = steady(121);
    for fps in [24.0, 25.0, 50.0, 100.0, 144.0] {
        let other = clip.resample(fps).expect("a rate");
        assert_eq!(other.frames(), 1 + (clip.duration() * fps + 1e-6) as usize);
        for f in 0..other.frames() {
            let source = f as f64 / fps / clip.frame_time;
            assert!((other.root[f].x - 0.01 * source).abs() < 1e-9);
            let turned = UnitQuaternion::from_euler_angles(0.0, 0.03 * source, 0.0);
            assert!(other.pose(f)[8].angle_to(&turned) < 1e-6, "{fps} fps frame {f}");
        }
    }
    let one = steady(1).resample(100.0).expect("a rate");
    assert_eq!(one.frames(), 1);
    for fps in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = clip.resample(fps).expect_err("no rate").to_string();
        assert!(error.contains("frame rate") && error.contains("expected"), "{error}");
    }
}

#[test]
fn slices_and_frames_beyond_the_end() {
    let clip = steady(10);
    assert_eq!(clip.slice(3..5).root, clip.root[3..5]);
    assert_eq!(clip.slice(3..5).pose(1), clip.pose(4));
    assert_eq!((clip.slice(8..99).frames(), clip.slice(99..120).frames()), (2, 0));
    assert!(clip.positions(10).is_empty() && clip.pose(10).is_empty());
}

#[test]
fn a_lopsided_figure_is_not_mirrored() {
    let mut clip = steady(2);
    clip.skeleton.joints[7].name = "RightHook".into();
    assert_eq!(clip.mirrored().expect_err("no partner"), MirrorError::NoPartner { joint: "LeftHand".into() });
    let mut clip = steady(2);
    clip.skeleton.joints[7].parent = Some(5);
    assert!(matches!(clip.mirrored(), Err(MirrorError::Tree { .. })));
}
