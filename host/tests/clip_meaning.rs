//! What the numbers and names of a clip mean: rest pose, roots, axes, handedness, units, names, lost frames.

use kinesic_host::clip::bvh::parse;
use kinesic_host::clip::{self, Clip, Joint, JointMap, NoteLog, ReadOptions, Skeleton, Unit, UpAxis, WriteOptions};
use kinesic_host::gait;
use kinesic_host::prepare::Source;
use kinesic_host::retarget::retarget;
use kinesic_host::rig::Rig;
use nalgebra::{UnitQuaternion, Vector3};

/// Name, parent, bone in m.
const BODY: [(&str, Option<usize>, [f64; 3]); 20] = [
    ("Hips", None, [0.0, 0.0, 0.0]),
    ("LeftUpLeg", Some(0), [0.1, -0.05, 0.0]),
    ("LeftLeg", Some(1), [0.0, -0.4, 0.0]),
    ("LeftFoot", Some(2), [0.0, -0.4, 0.0]),
    ("LeftToeBase", Some(3), [0.0, -0.06, 0.15]),
    ("RightUpLeg", Some(0), [-0.1, -0.05, 0.0]),
    ("RightLeg", Some(5), [0.0, -0.4, 0.0]),
    ("RightFoot", Some(6), [0.0, -0.4, 0.0]),
    ("RightToeBase", Some(7), [0.0, -0.06, 0.15]),
    ("Spine", Some(0), [0.0, 0.15, 0.0]),
    ("Spine1", Some(9), [0.0, 0.2, 0.0]),
    ("Neck1", Some(10), [0.0, 0.2, 0.0]),
    ("Head", Some(11), [0.0, 0.1, 0.0]),
    ("LeftArm", Some(10), [0.18, 0.15, 0.0]),
    ("LeftForeArm", Some(13), [0.28, 0.0, 0.0]),
    ("LeftHand", Some(14), [0.25, 0.0, 0.0]),
    ("RightArm", Some(10), [-0.18, 0.15, 0.0]),
    ("RightForeArm", Some(16), [-0.28, 0.0, 0.0]),
    ("RightHand", Some(17), [-0.25, 0.0, 0.0]),
    ("Tail", Some(0), [0.0, 0.0, -0.1]),
];

fn person() -> Clip {
    let joints = BODY.map(|(name, parent, [x, y, z])| Joint {
        name: name.into(),
        parent,
        offset: Vector3::new(x, y, z),
        end: None,
    });
    let frames = 12;
    let turn = |i: usize| {
        UnitQuaternion::from_euler_angles(0.02 * (i % 7) as f64, 0.03 * (i % 5) as f64, 0.01 * (i % 11) as f64)
    };
    Clip {
        skeleton: Skeleton { joints: joints.to_vec() },
        frame_time: 1.0 / 30.0,
        root: (0..frames).map(|f| Vector3::new(0.01, 0.92, 0.03 * f as f64)).collect(),
        rotations: (0..frames * joints.len()).map(turn).collect(),
        coordinates: None,
        notes: vec![],
    }
}

fn text(clip: &Clip) -> String {
    clip.to_bvh(&WriteOptions { units: Unit::Centimetre }).expect("writable")
}

fn read(text: &str, options: ReadOptions) -> Clip {
    parse(text.as_bytes(), &options).unwrap_or_else(|e| panic!("{e}"))
}

fn apart(a: &Clip, b: &Clip) -> f64 {
    assert_eq!(a.frames(), b.frames());
    a.all_positions().iter().zip(b.all_positions()).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

fn noted(clip: &Clip, word: &str) -> bool {
    clip.notes.iter().any(|n| n.contains(word))
}

#[test]
fn another_rest_pose_gives_the_same_motion() {
    let clip = person();
    let map = JointMap::detect(&clip.skeleton).expect("m21");
    let rig = Rig::new(&clip.skeleton, &map).expect("a rig");
    let equal = retarget(&clip, &map, &rig).expect("moved");
    assert_eq!(equal.rotations, clip.rotations, "equal skeletons copy");
    // The arms rest hanging: the same world motion has other rotations.
    let mut other = clip.clone();
    let hang = [(13, -1.1), (16, 1.1)];
    let n = clip.skeleton.len();
    for (shoulder, angle) in hang {
        let by = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        for joint in [shoulder + 1, shoulder + 2] {
            other.skeleton.joints[joint].offset = by * clip.skeleton.joints[joint].offset;
        }
        for frame in 0..clip.frames() {
            let at = |joint: usize| frame * n + joint;
            other.rotations[at(shoulder)] = clip.rotations[at(shoulder)] * by.inverse();
            for joint in [shoulder + 1, shoulder + 2] {
                other.rotations[at(joint)] = by * clip.rotations[at(joint)] * by.inverse();
            }
        }
    }
    assert!(apart(&clip, &other) < 1e-9, "the same motion");
    let moved = retarget(&other, &map, &rig).expect("moved");
    assert!(apart(&moved, &clip) < 1e-6, "{}", apart(&moved, &clip));
    assert!(noted(&moved, "rest pose differs"), "{:?}", moved.notes);
}

#[test]
fn joints_beside_a_travelling_pelvis_are_left_out() {
    let clip = person();
    let plain = text(&clip);
    let body = plain.strip_prefix("HIERARCHY\nROOT").expect("a root");
    let (body, motion) = body.split_once("MOTION\n").expect("a motion");
    let channels = "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation";
    let wrapped = format!(
        "HIERARCHY\nROOT root\n{{\nOFFSET 0 0 0\n{channels}\nJOINT{body}JOINT IK\n{{\nOFFSET 0 0 0\nCHANNELS 0\nEnd Site\n{{\nOFFSET 0 0 1\n}}\n}}\n}}\nMOTION\n"
    );
    let lines =
        motion.lines().enumerate().map(|(i, l)| if i < 2 { format!("{l}\n") } else { format!("0 0 0 0 0 0 {l}\n") });
    let found = read(&(wrapped + &lines.collect::<String>()), ReadOptions::default());
    assert!(noted(&found, "beside the pelvis"), "{:?}", found.notes);
    assert!(apart(&found, &read(&plain, ReadOptions::default())) < 1e-9);
}

#[test]
fn six_up_axes_are_found_and_given() {
    let upright = read(&text(&person()), ReadOptions::default());
    for up in UpAxis::ALL.into_iter().filter(|up| *up != UpAxis::Y) {
        let mut clip = person();
        let back = up.to_y().inverse();
        clip.root.iter_mut().for_each(|p| *p = back * *p);
        clip.skeleton.joints.iter_mut().for_each(|j| j.offset = back * j.offset);
        clip.rotations.iter_mut().for_each(|r| *r = back * *r * back.inverse());
        let file = text(&clip);
        let found = read(&file, ReadOptions::default());
        assert!(noted(&found, "up found") && apart(&found, &upright) < 1e-5, "{up}: {:?}", found.notes);
        let given = read(&file, ReadOptions { up: Some(up), ..Default::default() });
        assert!(noted(&given, "as given") && apart(&given, &upright) < 1e-5, "{up}");
        // The rest pose stays upright, the motion alone is in other axes.
        let mut clip = person();
        let n = clip.skeleton.len();
        clip.root.iter_mut().for_each(|p| *p = back * *p);
        clip.rotations.iter_mut().step_by(n).for_each(|r| *r = back * *r);
        let found = read(&text(&clip), ReadOptions::default());
        assert!(noted(&found, "found in the motion") && apart(&found, &upright) < 1e-5, "{up}: {:?}", found.notes);
    }
}

#[test]
fn who_bends_stands_on_the_feet_all_the_same() {
    // Bent by 150 degrees at the spine, on a torso that is longer than the legs are.
    let mut clip = person();
    let n = clip.skeleton.len();
    let spine = clip.skeleton.find("Spine").expect("a spine");
    clip.skeleton.joints[spine + 1].offset *= 3.0;
    clip.rotations.iter_mut().for_each(|r| *r = UnitQuaternion::identity());
    clip.rotations
        .iter_mut()
        .skip(spine)
        .step_by(n)
        .for_each(|r| *r = UnitQuaternion::from_euler_angles(2.2, 0.0, 0.0));
    let upright = read(&text(&clip), ReadOptions::default());
    assert!(!noted(&upright, "up found"), "{:?}", upright.notes);
    let back = UpAxis::Z.to_y().inverse();
    clip.root.iter_mut().for_each(|p| *p = back * *p);
    let mut whole = clip.clone();
    whole.skeleton.joints.iter_mut().for_each(|j| j.offset = back * j.offset);
    whole.rotations.iter_mut().for_each(|r| *r = back * *r * back.inverse());
    clip.rotations.iter_mut().step_by(n).for_each(|r| *r = back * *r);
    for clip in [whole, clip] {
        let found = read(&text(&clip), ReadOptions::default());
        assert!(noted(&found, "Z up found (the feet") && apart(&found, &upright) < 1e-5, "{:?}", found.notes);
    }
}

#[test]
fn who_sits_is_not_turned_upright() {
    // On the floor, legs stretched along Z to where Z is 0, with a long back.
    let mut clip = person();
    let n = clip.skeleton.len();
    let joint = |name: &str| BODY.iter().position(|b| b.0 == name).expect("a joint");
    clip.skeleton.joints[joint("Spine1")].offset *= 2.0;
    clip.rotations.iter_mut().for_each(|r| *r = UnitQuaternion::identity());
    for leg in ["LeftUpLeg", "RightUpLeg"].map(joint) {
        let stretched = UnitQuaternion::from_euler_angles(-1.57, 0.0, 0.0);
        clip.rotations.iter_mut().skip(leg).step_by(n).for_each(|r| *r = stretched);
    }
    clip.root.iter_mut().for_each(|p| *p = Vector3::new(0.0, 0.05, -0.8));
    let found = read(&text(&clip), ReadOptions::default());
    assert!(!noted(&found, "up found") && noted(&found, "--up -z"), "{:?}", found.notes);
}

#[test]
fn a_body_of_unknown_names_travels_with_the_joint_that_carries_it() {
    let mut clip = person();
    clip.skeleton.joints.iter_mut().enumerate().for_each(|(i, j)| j.name = format!("joint {i}"));
    let plain = text(&clip);
    let (body, motion) = plain.strip_prefix("HIERARCHY\nROOT").and_then(|t| t.split_once("MOTION\n")).expect("both");
    let channels = "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation";
    let target = format!("JOINT target\n{{\nOFFSET 0 0 0\n{channels}\nEnd Site\n{{\nOFFSET 0 0 1\n}}\n}}\n");
    let scene = format!("HIERARCHY\nROOT scene\n{{\nOFFSET 0 0 0\n{channels}\n{target}JOINT{body}}}\nMOTION\n");
    let line = |(i, l): (usize, &str)| {
        if i < 2 { format!("{l}\n") } else { format!("0 0 0 0 0 0 20 0 {} 0 0 0 {l}\n", 5 * i) }
    };
    let found = read(&(scene + &motion.lines().enumerate().map(line).collect::<String>()), ReadOptions::default());
    assert!(
        noted(&found, "beside 'joint 0', which carries the body") && noted(&found, "'target'"),
        "{:?}",
        found.notes
    );
    assert!(apart(&found, &read(&plain, ReadOptions::default())) < 1e-9);
}

#[test]
fn the_other_hand_is_noted_and_turned_round() {
    let upright = read(&text(&person()), ReadOptions::default());
    assert!(!noted(&upright, "exchanged"), "{:?}", upright.notes);
    let mut clip = person();
    clip.root.iter_mut().for_each(|p| p.z = -p.z);
    clip.skeleton.joints.iter_mut().for_each(|j| j.offset.z = -j.offset.z);
    for r in &mut clip.rotations {
        *r = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(r.w, -r.i, -r.j, r.k));
    }
    let file = text(&clip);
    assert!(noted(&read(&file, ReadOptions::default()), "--handed left"));
    let turned = read(&file, ReadOptions { left_handed: true, ..Default::default() });
    assert!(apart(&turned, &upright) < 1e-5);
}

#[test]
fn any_factor_is_a_unit_and_odd_sizes_are_said() {
    assert_eq!("0.08".parse(), Ok(Unit::Factor(0.08)));
    assert!("-1".parse::<Unit>().is_err() && "nan".parse::<Unit>().is_err() && "0".parse::<Unit>().is_err());
    let file = text(&person());
    let giant = read(&file, ReadOptions { units: Some(Unit::Factor(0.08)), ..Default::default() });
    assert!(noted(&giant, "expected 0.4 to 2.5 m"), "{:?}", giant.notes);
    let usual = read(&file, ReadOptions::default());
    assert!(!noted(&usual, "Size") && !noted(&usual, "not certain"), "{:?}", usual.notes);
    // A leg of 37 units: an adult in inches, or a toddler in cm.
    let mut child = person();
    child.skeleton.joints.iter_mut().for_each(|j| j.offset *= 37.0 / 80.0);
    assert!(noted(&read(&text(&child), ReadOptions::default()), "not certain"));
    // Of 39 units: an avatar in inches, as those of virtual worlds are.
    child.skeleton.joints.iter_mut().for_each(|j| j.offset *= 39.4 / 37.0);
    let avatar = read(&text(&child), ReadOptions::default());
    assert!(noted(&avatar, "Units: inch assumed") && noted(&avatar, "could be cm"), "{:?}", avatar.notes);
}

#[test]
fn names_of_many_producers_are_known() {
    let biovision = |n: &str| {
        let bones = [
            ("UpLeg", "Hip"),
            ("Leg", "Knee"),
            ("Foot", "Ankle"),
            ("ToeBase", "Toe"),
            ("ForeArm", "Elbow"),
            ("Arm", "Shoulder"),
            ("Hand", "Wrist"),
        ];
        let bone = bones.into_iter().find(|(old, _)| n.ends_with(old));
        bone.map_or(n.replace("Spine", "Chest"), |(old, new)| n.replace(old, new))
    };
    let side = |n: &str, before: &str, after: &str| match (n.strip_prefix("Left"), n.strip_prefix("Right")) {
        (Some(bone), _) => format!("{before}{bone}{after}").replace('?', "L"),
        (_, Some(bone)) => format!("{before}{bone}{after}").replace('?', "R"),
        _ => n.to_owned(),
    };
    let unity = |n: &str| {
        n.replace("UpLeg", "UpperLeg")
            .replace("tLeg", "tLowerLeg")
            .replace("ForeArm", "LowerArm")
            .replace("tArm", "tUpperArm")
    };
    type Rename<'a> = &'a dyn Fn(&str) -> String;
    let styles: [(&str, Rename); 8] = [
        ("biovision", &biovision),
        ("unity", &unity),
        ("underscore", &|n| format!("mixamorig_{n}")),
        ("prefix", &|n| format!("Actor7:{}", biovision(n))),
        ("an actor's name", &|n| format!("Bob_{}", unity(n))),
        ("suffix", &|n| side(n, "", ".?")),
        ("biped", &|n| {
            side(
                &n.replace("UpLeg", "Thigh")
                    .replace("tLeg", "tCalf")
                    .replace("Arm", "UpperArm")
                    .replace("ForeUpperArm", "Forearm"),
                "Bip01 ? ",
                "",
            )
        }),
        ("lower", &|n| n.to_lowercase()),
    ];
    for (style, rename) in styles {
        let mut clip = person();
        let known = JointMap::detect(&clip.skeleton).expect("m21");
        clip.skeleton.joints.iter_mut().for_each(|j| j.name = rename(&j.name));
        let names: Vec<&str> = clip.skeleton.joints.iter().map(|j| j.name.as_str()).collect();
        let map = JointMap::detect(&clip.skeleton).unwrap_or_else(|| panic!("{style}: {names:?}"));
        for canonical in kinesic_host::clip::Canonical::ALL {
            let neck = canonical == kinesic_host::clip::Canonical::Neck;
            assert!(neck || map.joint(canonical) == known.joint(canonical), "{style}, {}: {names:?}", canonical.name());
        }
    }
}

#[test]
fn lost_frames_are_named_and_bridged_when_asked() {
    let mut clip = person();
    clip.root[5] = Vector3::repeat(9_999_999.0);
    let file = text(&clip);
    let found = read(&file, ReadOptions::default());
    assert!(noted(&found, "In frame 6 the root leaps"), "{:?}", found.notes);
    assert!(found.root[5].x > 1e4, "left as it is");
    let mended = read(&file, ReadOptions { repair: true, ..Default::default() });
    assert!(apart(&mended, &read(&text(&person()), ReadOptions::default())) < 1e-5);
}

#[test]
fn gltf_that_is_written_is_read_again() {
    let clip = person();
    let again = kinesic_host::clip::gltf::parse(&clip.to_glb().expect("written"), None).expect("read");
    assert_eq!(again.skeleton.joints[3].name, "LeftFoot");
    assert_eq!((again.frames(), again.fps()), (12, 30.0));
    assert!(apart(&again, &clip) < 1e-5, "{}", apart(&again, &clip));
    let text = kinesic_host::clip::gltf::parse(clip.to_gltf().expect("written").as_bytes(), None).expect("read");
    assert!(apart(&text, &clip) < 1e-5);
    assert!(
        kinesic_host::clip::gltf::parse(b"{\"asset\":{\"version\":\"2.0\"}}", None)
            .expect_err("empty")
            .contains("animation")
    );
}

#[test]
fn of_too_many_joints_those_that_no_limb_needs_are_left_out() {
    let mut clip = gait::walk(&gait::Manner::NEUTRAL, 1.0, 30.0, 0.0, 1);
    let (frames, body) = (clip.frames(), clip.skeleton.len());
    let hand = clip.skeleton.find("RightHand").expect("a hand");
    assert_eq!(hand, body - 1);
    clip.skeleton.joints[hand].end = None;
    for at in 0..120 {
        let offset = Vector3::new(0.01, -0.02, 0.001 * f64::from(at));
        clip.skeleton.joints.push(Joint { name: format!("hair{at}"), parent: Some(hand), offset, end: None });
    }
    let still = vec![UnitQuaternion::identity(); 120];
    clip.rotations = (0..frames).flat_map(|f| [&clip.rotations[f * body..(f + 1) * body], &still].concat()).collect();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("hair.bvh");
    clip.write_bvh(&path).expect("writable");
    static LOG: NoteLog = NoteLog::new();
    let options = ReadOptions { log: Some(&LOG), ..ReadOptions::default() };
    let source = Source::read(&path, &options).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(source.clip.skeleton.len(), body);
    source.rig().expect("a rig");
    let notes = LOG.take().join("\n");
    assert!(notes.contains("139 joints are more than the 128 of a rig: 120 that"), "{notes}");
    // What only turns a clip about keeps all of them.
    assert_eq!(clip::read(&path).expect("read").skeleton.len(), body + 120);
}
