//! Joint maps: known layouts, map files, mirror partners.

use kinesic_host::clip::map::{MapError, mirror_partners};
use kinesic_host::clip::{Canonical, Joint, JointMap, Skeleton, SkeletonMap};
use nalgebra::Vector3;

/// A skeleton of these names; the tree does not matter here.
fn skeleton(names: &[&str]) -> Skeleton {
    let joints = names.iter().enumerate().map(|(i, name)| Joint {
        name: name.to_string(),
        parent: i.checked_sub(1),
        offset: Vector3::y(),
        end: None,
    });
    Skeleton { joints: joints.collect() }
}

const MIXAMO: [&str; 22] = [
    "Hips",
    "Spine",
    "Spine1",
    "Spine2",
    "Neck",
    "Head",
    "LeftShoulder",
    "LeftArm",
    "LeftForeArm",
    "LeftHand",
    "RightShoulder",
    "RightArm",
    "RightForeArm",
    "RightHand",
    "LeftUpLeg",
    "LeftLeg",
    "LeftFoot",
    "LeftToeBase",
    "RightUpLeg",
    "RightLeg",
    "RightFoot",
    "RightToeBase",
];

#[test]
fn mixamo_is_known_with_any_name_space() {
    for prefix in ["", "mixamorig:", "mixamorig7:", "a:b:"] {
        let names: Vec<String> = MIXAMO.iter().map(|n| format!("{prefix}{n}")).collect();
        let skeleton = skeleton(&names.iter().map(String::as_str).collect::<Vec<_>>());
        let map = JointMap::detect(&skeleton).expect("mixamo");
        assert_eq!(map.layout(), "mixamo");
        assert_eq!(map.joint(Canonical::Chest), Some(3));
        assert_eq!(map.canonical(8), Some(Canonical::LElbow));
        assert_eq!(map.mirror_partner(8), Some(12));
        assert_eq!(map.mirror_partner(0), Some(0));
        assert_eq!(map.mirror_partner(99), None);
    }
    // A leg short of a figure.
    assert_eq!(JointMap::detect(&skeleton(&MIXAMO[..17])), None);
    assert_eq!(JointMap::detect(&skeleton(&[])), None);
}

#[test]
fn canonical_joints_know_their_other_side() {
    for c in Canonical::ALL {
        assert_eq!(Canonical::from_name(c.name()), Some(c));
        assert_eq!(c.mirrored().mirrored(), c);
        assert_eq!(c.mirrored() == c, !c.is_left() && !c.is_right());
    }
    assert_eq!(Canonical::LToe.mirrored(), Canonical::RToe);
    assert_eq!(Canonical::from_name("nose"), None);
}

#[test]
fn names_give_the_partners_of_what_the_map_does_not_know() {
    let s = skeleton(&["root", "thing.L", "thing.R", "lHand", "rHand", "lLamp", "Left Wing", "LowerBack"]);
    let partners = mirror_partners(&s, None);
    // A prefix without counterpart may be chance; the word Left is not.
    assert_eq!(partners, [Some(0), Some(2), Some(1), Some(4), Some(3), Some(5), None, Some(7)]);
    let map =
        SkeletonMap::parse("[joints]\npelvis = \"root\"\nl_wrist = \"lHand\"\nr_wrist = \"lLamp\"").expect("a map");
    let map = map.resolve(&s).expect("fits");
    assert_eq!((map.mirror_partner(3), map.mirror_partner(5)), (Some(5), Some(3)));
}

#[test]
fn a_map_file_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("robot.toml");
    std::fs::write(&path, "units = \"mm\"\nup = \"Z\"\n[joints]\npelvis = \"base link\"\nl_knee = \"k:l\"\n")
        .expect("written");
    let names = SkeletonMap::read(&path).expect("a map");
    assert_eq!((names.units.map(|u| u.name()), names.layout.as_str()), (Some("mm"), "robot"));
    let map = JointMap::read(&path, &skeleton(&["world", "base link", "k:l"])).expect("fits");
    assert_eq!(
        (map.joint(Canonical::Pelvis), map.joint(Canonical::LKnee), map.joint(Canonical::Head)),
        (Some(1), Some(2), None)
    );
    assert_eq!(map.layout(), "robot");
}

#[test]
fn broken_maps_are_refused_by_key() {
    let cases: [(&str, &[&str]); 10] = [
        ("[joints", &["TOML", "line 1"]),
        ("joint = 1", &["unknown key 'joint'", "did you mean 'joints'"]),
        ("units = \"cm\"", &["[joints] is missing"]),
        ("joints = 3", &["[joints] is missing"]),
        ("[joints]\npelvs = \"Hips\"", &["'pelvs'", "did you mean 'pelvis'"]),
        ("[joints]\npelvis = 3", &["'pelvis' is of type integer", "text in quotes"]),
        ("[joints]\nhead = \"Head\"", &["no pelvis"]),
        ("units = \"yard\"\n[joints]\npelvis = \"Hips\"", &["'units'", "'yard'", "inch"]),
        ("up = \"w\"\n[joints]\npelvis = \"Hips\"", &["'up'", "'w'", "x, y, z, -x, -y or -z"]),
        ("units = 1\n[joints]\npelvis = \"Hips\"", &["'units' is of type integer"]),
    ];
    for (text, parts) in cases {
        let message = SkeletonMap::parse(text).expect_err(text).to_string();
        for part in parts {
            assert!(message.contains(part), "no '{part}' in: {message}");
        }
    }
    let map = SkeletonMap::parse("[joints]\npelvis = \"Hip\"").expect("a map");
    let error = map.resolve(&skeleton(&["Hips"])).expect_err("no such joint");
    assert!(matches!(error, MapError::MissingJoint { .. }));
    assert!(
        error.to_string().contains("pelvis = \"Hip\"") && error.to_string().contains("did you mean 'Hips'"),
        "{error}"
    );
    let error = SkeletonMap::read("no/map.toml").expect_err("no file").to_string();
    assert!(error.contains("no/map.toml") && error.contains("cannot be read"), "{error}");
}
