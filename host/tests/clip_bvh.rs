//! BVH dialects: what they mean, and that writing and reading gives the same clip.

use kinesic_host::clip::{self, Clip, JointMap, ReadOptions, SkeletonMap, Unit, UpAxis, WriteError, WriteOptions};
use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

fn parse_with(text: &str, options: ReadOptions) -> Clip {
    clip::bvh::parse(text.as_bytes(), &options).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn parse(text: &str) -> Clip {
    parse_with(text, ReadOptions { units: Some(Unit::Metre), ..Default::default() })
}

fn close(a: Vector3<f64>, b: [f64; 3]) {
    assert!((a - Vector3::from(b)).norm() < 1e-9, "{a:?} is not {b:?}");
}

/// Writes and reads; rotations within 1e-4 degrees, positions within a micrometre.
fn round_trip(clip: &Clip) {
    let text = clip.to_bvh(&WriteOptions { units: Unit::Metre }).expect("writable");
    let again = parse(&text);
    assert_eq!(again.frames(), clip.frames());
    assert!((again.frame_time - clip.frame_time).abs() < 1e-12);
    for (a, b) in clip.rotations.iter().zip(&again.rotations) {
        assert!(a.angle_to(b).to_degrees() < 1e-4, "{a} {b}");
    }
    for (a, b) in clip.all_positions().iter().zip(again.all_positions()) {
        assert!((a - b).norm() < 1e-5, "{a} {b}");
    }
    for (a, b) in clip.skeleton.joints.iter().zip(&again.skeleton.joints) {
        assert_eq!((&a.name, a.parent), (&b.name, b.parent));
        let tip = a.end.or(b.end.filter(|e| *e == Vector3::zeros()));
        assert!((a.offset - b.offset).norm() < 1e-6 && tip.is_some() == b.end.is_some());
    }
}

#[test]
fn rotations_multiply_in_the_order_of_the_channels() {
    // Rz(90) Rx(90): the child's bone along Y first stays at Y -> Z (about X), and Z stays under Rz.
    let clip = parse(
        "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n\
         JOINT b\n{\nOFFSET 0 1 0\nCHANNELS 0\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n}\nMOTION\nFrames: 2\nFrame Time: 0.1\n\
         1 2 3 90 90 0\n1 2 3 0 90 90\n",
    );
    close(clip.positions(0)[1], [1.0, 2.0, 4.0]);
    // Rx(90) Ry(90): Y -> Y -> Z.
    close(clip.positions(1)[1], [1.0, 2.0, 4.0]);
    assert_eq!(clip.skeleton.joints[1].end, Some(Vector3::y()));
    round_trip(&clip);
}

#[test]
fn loose_spelling_is_read() {
    let text = "\u{feff}hierarchy\r\nRoot  mixamorig:Hips {\r\n\toffset\t0 0\t0\r\n\tChannels 6 zrotation xrotation yrotation \
                ZPOSITION XPOSITION YPOSITION\r\n\tJoint Left Arm (old)\r\n\t{\r\n\t\tOFFSET 1e-1 +2.5E-1 -.5\r\n\t\tCHANNELS 1 \
                Yrotation\r\n\t\tend  site\r\n\t\t{\r\n\t\t\tOFFSET 0 0 1.\r\n\t\t}\r\n\t}\r\n}\r\nMotion\r\n  FRAMES :\t1 \
                \r\nFrame  Time:3.33e-2\r\n 0 0 0 3 1 2 9.0e+1\t\r\n\r\n \r\n";
    let clip = parse(text);
    assert_eq!(clip.skeleton.joints[0].name, "mixamorig:Hips");
    assert_eq!(clip.skeleton.joints[1].name, "Left Arm (old)");
    assert_eq!(clip.frame_time, 0.0333);
    close(clip.root[0], [1.0, 2.0, 3.0]);
    close(clip.skeleton.joints[1].offset, [0.1, 0.25, -0.5]);
    close(clip.rotations[1] * Vector3::z(), [1.0, 0.0, 0.0]);
    round_trip(&clip);
    // No line end at the end.
    assert_eq!(parse(text.trim_end()).frames(), 1);
}

/// A root that rests above hips that move, six channels everywhere.
fn scene_root(root_track: [&str; 2], bone_track: [&str; 2]) -> String {
    let six = "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation";
    format!(
        "HIERARCHY\nROOT scene\n{{\nOFFSET 0 0 0\n{six}\nJOINT Hips\n{{\nOFFSET 9 9 9\n{six}\nJOINT Chest\n{{\nOFFSET 0 5 0\n{six}\n}}\n}}\n}}\n\
         MOTION\nFrames: 2\nFrame Time: 0.1\n{} 1 1 0 0 0 0 {} 0 0 90\n{} 2 1 0 0 0 0 {} 0 0 90\n",
        root_track[0], bone_track[0], root_track[1], bone_track[1]
    )
}

#[test]
fn positions_replace_offsets_and_resting_roots_are_folded() {
    let clip = parse(&scene_root(["0 0 10 90 0 0"; 2], ["0 0.5 0"; 2]));
    assert_eq!(clip.skeleton.len(), 2);
    assert_eq!((clip.skeleton.joints[0].name.as_str(), clip.skeleton.joints[0].parent), ("Hips", None));
    assert_eq!(clip.skeleton.joints[1].parent, Some(0));
    // Turned about Z by the scene root: x becomes y.
    close(clip.root[0], [-1.0, 1.0, 10.0]);
    close(clip.root[1], [-1.0, 2.0, 10.0]);
    close(clip.skeleton.joints[1].offset, [0.0, 0.5, 0.0]);
    close(clip.positions(0)[1], [-1.5, 1.0, 10.0]);
    let notes = clip.notes.join("\n");
    assert!(notes.contains("'Hips' became the root; 'scene' above it stays still"), "{notes}");
    assert!(notes.contains("1 joint(s) replace an OFFSET") && notes.contains("450.00 cm ('Chest')"), "{notes}");
    round_trip(&clip);
}

#[test]
fn bones_that_stretch_become_their_mean() {
    let clip = parse(&scene_root(["0 0 0 0 0 0"; 2], ["0 0.4 0", "0 0.6 0"]));
    close(clip.skeleton.joints[1].offset, [0.0, 0.5, 0.0]);
    let notes = clip.notes.join("\n");
    assert!(notes.contains("1 joint(s) below the root vary, by up to 10.00 cm ('Chest')"), "{notes}");
    // A millimetre is noise of the file, not worth a note.
    let still = parse(&scene_root(["0 0 0 0 0 0"; 2], ["0 0.4999 0", "0 0.5001 0"]));
    assert!(!still.notes.join("\n").contains("vary"));
}

#[test]
fn a_map_names_the_pelvis_below_a_moving_root() {
    let text = scene_root(["0 0 10 90 0 0", "0 0 11 90 0 0"], ["0 0.5 0"; 2]);
    assert_eq!(parse(&text).skeleton.len(), 3, "without a map, a moving root is the root");
    let map = SkeletonMap::parse("units = \"m\"\n[joints]\npelvis = \"Hips\"").expect("a map");
    let clip = parse_with(&text, ReadOptions { map: Some(map), ..Default::default() });
    assert_eq!(clip.skeleton.joints[0].name, "Hips");
    close(clip.root[1], [-1.0, 2.0, 11.0]);
    assert!(clip.notes.iter().any(|n| n.contains("both motions were composed")), "{:?}", clip.notes);
}

/// A figure with the joint names of m21, its bones scaled, standing along an axis.
fn person(scale: f64, z_up: bool) -> String {
    let bones: [(&str, Option<usize>, [f64; 3]); 17] = [
        ("Hips", None, [0.0, 0.0, 0.0]),
        ("Spine", Some(0), [0.0, 0.2, 0.0]),
        ("Neck1", Some(1), [0.0, 0.3, 0.0]),
        ("Head", Some(2), [0.0, 0.15, 0.0]),
        ("LeftArm", Some(1), [0.2, 0.25, 0.0]),
        ("LeftForeArm", Some(4), [0.3, 0.0, 0.0]),
        ("LeftHand", Some(5), [0.25, 0.0, 0.0]),
        ("RightArm", Some(1), [-0.2, 0.25, 0.0]),
        ("RightForeArm", Some(7), [-0.3, 0.0, 0.0]),
        ("RightHand", Some(8), [-0.25, 0.0, 0.0]),
        ("LeftUpLeg", Some(0), [0.1, -0.05, 0.0]),
        ("LeftLeg", Some(10), [0.0, -0.4, 0.0]),
        ("LeftFoot", Some(11), [0.0, -0.42, 0.0]),
        ("RightUpLeg", Some(0), [-0.1, -0.05, 0.0]),
        ("RightLeg", Some(13), [0.0, -0.4, 0.0]),
        ("RightFoot", Some(14), [0.0, -0.42, 0.0]),
        ("RightToeBase", Some(15), [0.0, 0.0, 0.1]),
    ];
    let joints = bones.map(|(name, parent, [x, y, z])| clip::Joint {
        name: name.into(),
        parent,
        offset: scale * if z_up { Vector3::new(x, -z, y) } else { Vector3::new(x, y, z) },
        end: None,
    });
    let rotations = (0..34).map(|i| UnitQuaternion::from_euler_angles(0.01 * i as f64, -0.2 + 0.01 * i as f64, 0.05));
    let hips = if z_up { Vector3::new(0.5, -1.0, 0.9) } else { Vector3::new(0.5, 0.9, 1.0) };
    let clip = Clip {
        skeleton: clip::Skeleton { joints: joints.to_vec() },
        frame_time: 1.0 / 60.0,
        root: vec![scale * hips; 2],
        rotations: rotations.collect(),
        coordinates: None,
        notes: vec![],
    };
    clip.to_bvh(&WriteOptions { units: Unit::Metre }).expect("writable")
}

#[test]
fn units_are_found_from_the_leg() {
    // A figure of MikuMikuDance has the size of a child of the CMU database: --units says it.
    for unit in Unit::ALL.into_iter().filter(|unit| *unit != Unit::Mmd) {
        let clip = parse_with(&person(1.0 / unit.metres(), false), ReadOptions::default());
        assert!((clip.skeleton.joints[11].offset.y + 0.4).abs() < 1e-6, "{unit}: {:?}", clip.notes);
        assert!(clip.notes[0].starts_with(&format!("Units: {unit} assumed")), "{:?}", clip.notes);
        assert_eq!(JointMap::detect(&clip.skeleton).expect("m21").layout(), "m21");
        assert!((1.3..1.6).contains(&clip.summary().height_m));
        round_trip(&clip);
    }
}

#[test]
fn z_up_is_turned_when_rest_pose_and_motion_agree() {
    let found = parse_with(&person(100.0, true), ReadOptions::default());
    assert!(found.notes.iter().any(|n| n.contains("Z up found")), "{:?}", found.notes);
    close(found.root[0], [0.5, 0.9, 1.0]);
    close(found.skeleton.joints[11].offset, [0.0, -0.4, 0.0]);
    let given = parse_with(&person(100.0, true), ReadOptions { up: Some(UpAxis::Z), ..Default::default() });
    assert_eq!(given.root, found.root);
    let kept = parse_with(&person(100.0, true), ReadOptions { up: Some(UpAxis::Y), ..Default::default() });
    close(kept.root[0], [0.5, -1.0, 0.9]);
    // The same figure, seen turned: every point of the turned clip is the turned point of the kept one.
    for (a, b) in found.positions(1).iter().zip(kept.positions(1)) {
        close(*a, [b.x, b.z, -b.y]);
    }
    let upright = parse_with(&person(100.0, false), ReadOptions::default());
    assert!(!upright.notes.iter().any(|n| n.contains("Z up")), "{:?}", upright.notes);
}

#[test]
fn what_is_written_is_whole_and_plain() {
    let clip = parse_with(&person(100.0, false), ReadOptions::default());
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("out.bvh");
    clip.write_bvh(&path).expect("written");
    let text = std::fs::read_to_string(&path).expect("readable");
    assert!(text.starts_with("HIERARCHY\nROOT Hips\n{\n\tOFFSET 0.000000 0.000000 0.000000\n\tCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n\tJOINT Spine\n"));
    assert_eq!(text.matches("End Site").count(), 5, "one a leaf");
    assert_eq!(text.matches('{').count(), text.matches('}').count());
    assert!(!text.contains("-0.000000"));
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1, "no temporary file stays");

    let mut broken = clip.clone();
    broken.root[1].x = f64::NAN;
    let error = broken.write_bvh(&path).expect_err("not finite").to_string();
    assert!(error.contains("frame 2") && error.contains("Hips"), "{error}");
    assert_eq!(std::fs::read_to_string(&path).expect("readable"), text, "the old file is untouched");
    broken = clip.clone();
    broken.skeleton.joints[3].name = "Hips".into();
    assert!(matches!(broken.write_bvh(&path), Err(WriteError::Name { .. })));
    broken.rotations.pop();
    assert!(matches!(broken.write_bvh(&path), Err(WriteError::Shape { .. })));
    let error = clip.write_bvh(folder.path().join("no/folder/x.bvh")).expect_err("no folder").to_string();
    assert!(error.contains("no/folder") && error.contains("Check"), "{error}");
}

#[test]
fn curves_do_not_jump_by_whole_turns() {
    let mut clip = parse_with(&person(100.0, false), ReadOptions::default());
    let n = clip.skeleton.len();
    clip.root = vec![Vector3::zeros(); 200];
    clip.rotations = vec![UnitQuaternion::identity(); 200 * n];
    for f in 0..200 {
        // Two turns about Y, the middle angle swinging past straight up.
        let (y, x) = (f as f64 * 0.0628, 1.7 * (f as f64 * 0.05).sin());
        clip.rotations[f * n] =
            UnitQuaternion::from_euler_angles(x, 0.0, 0.0) * UnitQuaternion::from_euler_angles(0.0, y, 0.0);
    }
    round_trip(&clip);
    let text = clip.to_bvh(&WriteOptions::default()).expect("writable");
    let rows = text.lines().skip_while(|l| !l.starts_with("Frame Time")).skip(1);
    let rows: Vec<Vec<f64>> = rows.map(|l| l.split(' ').map(|v| v.parse().expect("a number")).collect()).collect();
    let jump = rows.windows(2).flat_map(|w| (3..6).map(|c| (w[1][c] - w[0][c]).abs())).fold(0.0, f64::max);
    assert!(jump < 10.0, "a curve jumps by {jump} degrees");
}

proptest! {
    /// Every order of one to three different rotation channels means the product of rotations about the axes.
    #[test]
    fn any_rotation_order(order in Just([0usize, 1, 2]).prop_shuffle(), used in 1usize..=3, angles in prop::array::uniform3(-400.0..400.0f64)) {
        let names = ["Xrotation", "Yrotation", "Zrotation"];
        let axes = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
        let channels: Vec<_> = order[..used].iter().map(|&a| names[a]).collect();
        let values: Vec<_> = angles[..used].iter().map(|a| a.to_string()).collect();
        let text = format!(
            "HIERARCHY\nROOT a\n{{\nOFFSET 1 2 3\nCHANNELS {used} {}\n}}\nMOTION\nFrames: 1\nFrame Time: 0.1\n{}\n",
            channels.join(" "), values.join(" ")
        );
        let clip = parse(&text);
        let expected = order[..used].iter().zip(angles).fold(Rotation3::identity(), |r, (&a, angle)| {
            r * Rotation3::from_axis_angle(&axes[a], f64::to_radians(angle))
        });
        prop_assert!((clip.rotations[0].to_rotation_matrix().matrix() - expected.matrix()).norm() < 1e-12);
        prop_assert_eq!(clip.root[0], Vector3::new(1.0, 2.0, 3.0));
        round_trip(&clip);
    }

    /// The writer's angles, near and at gimbal lock too (the middle angle within 1e-12 to 1 of a right angle).
    #[test]
    fn written_angles_are_exact(
        z in -3.2..3.2f64, y in -3.2..3.2f64, sign in prop::bool::ANY, exponent in -13.0..0.5f64,
        near in prop::array::uniform3(-10.0..10.0f64),
    ) {
        let x = (std::f64::consts::FRAC_PI_2 - 10f64.powf(exponent)) * if sign { 1.0 } else { -1.0 };
        let about = |axis, angle| UnitQuaternion::from_axis_angle(&axis, angle);
        let product = |a: [f64; 3]| about(Vector3::z_axis(), a[0]) * about(Vector3::x_axis(), a[1]) * about(Vector3::y_axis(), a[2]);
        let rotation = product([z, x, y]);
        let angles = clip::bvh::euler::zxy(&rotation, near);
        let rounded = angles.map(|a| ((a.to_degrees() * 1e6).round() / 1e6).to_radians());
        prop_assert!(product(rounded).angle_to(&rotation).to_degrees() < 1e-5, "{:?}", angles);
    }

    /// No text made of BVH's own words makes the reader panic.
    #[test]
    fn word_salad_does_not_panic(words in prop::collection::vec(prop::sample::select(vec![
        "HIERARCHY", "ROOT", "JOINT", "a", "b", "{", "}", "OFFSET", "CHANNELS", "3", "6", "0", "Xposition", "Zrotation",
        "End", "Site", "MOTION", "Frames:", "Frame", "Time:", "1", "-1", "nan", "\n", "\n", "é"]), 0..80)) {
        let _ = clip::bvh::parse(words.join(" ").as_bytes(), &ReadOptions::default());
        let _ = clip::bvh::parse(format!("HIERARCHY\nROOT a\n{{\nOFFSET 0 0 0\nCHANNELS 1 Xposition\n{}", words.join(" ")).as_bytes(), &ReadOptions::default());
    }
}
