//! Made bodies: a walk with joints put in, renamed, turned, mirrored; and what is no body.

use nalgebra::{UnitQuaternion, Vector3};

use super::{Suggestion, Sure, suggest};
use crate::clip::{Canonical, Clip, Joint, JointMap, Skeleton, SkeletonMap};
use crate::gait::{Manner, walk};

/// A walk whose names are known.
fn walking() -> Clip {
    walk(&Manner::NEUTRAL, 4.0, 30.0, 0.0, 7)
}

fn named(joint: &str, clip: &Clip) -> usize {
    clip.skeleton.find(joint).unwrap_or_else(|| panic!("no {joint}"))
}

/// A joint on another, that never turns.
fn grow(clip: &mut Clip, parent: &str, name: &str, offset: [f64; 3]) {
    let parent = named(parent, clip);
    let n = clip.skeleton.len();
    let below = |j: usize| std::iter::successors(Some(j), |&at| clip.skeleton.joints[at].parent).any(|at| at == parent);
    let at = (0..n).filter(|&j| below(j)).max().unwrap() + 1;
    for joint in &mut clip.skeleton.joints {
        joint.parent = joint.parent.map(|p| if p >= at { p + 1 } else { p });
    }
    let joint = Joint { name: name.into(), parent: Some(parent), offset: Vector3::from(offset), end: None };
    clip.skeleton.joints[parent].end = None;
    clip.skeleton.joints.insert(at, joint);
    let frames = clip.rotations.chunks(n);
    let grown = frames.flat_map(|pose| [&pose[..at], &[UnitQuaternion::identity()], &pose[at..]].concat());
    clip.rotations = grown.collect();
}

/// A joint along the bone that ends in `joint`, which keeps its place.
fn split(clip: &mut Clip, joint: &str, name: &str, share: f64) {
    let at = named(joint, clip);
    let n = clip.skeleton.len();
    for joint in &mut clip.skeleton.joints {
        joint.parent = joint.parent.map(|p| if p >= at { p + 1 } else { p });
    }
    let below = clip.skeleton.joints[at].clone();
    clip.skeleton.joints[at] = Joint { parent: Some(at), offset: below.offset * (1.0 - share), ..below.clone() };
    clip.skeleton.joints.insert(at, Joint { name: name.into(), offset: below.offset * share, end: None, ..below });
    let frames = clip.rotations.chunks(n);
    let grown = frames.flat_map(|pose| [&pose[..at], &[UnitQuaternion::identity()], &pose[at..]].concat());
    clip.rotations = grown.collect();
}

/// What the shape says of the clip with its names taken away, with the names back.
fn nameless(clip: &Clip) -> Suggestion {
    let mut bare = clip.clone();
    bare.skeleton.joints.iter_mut().enumerate().for_each(|(at, joint)| joint.name = format!("j{at}"));
    suggest(&bare).unwrap_or_else(|error| panic!("{error}"))
}

/// The canonical joints that differ from those that the names say.
fn wrong(clip: &Clip, made: &Suggestion) -> Vec<&'static str> {
    let known = JointMap::detect(&clip.skeleton).expect("the walk's names are known");
    let differ = |c: &Canonical| known.joint(*c) != made.map.joint(*c);
    Canonical::ALL.into_iter().filter(differ).map(Canonical::name).collect()
}

fn refusal(clip: &Clip) -> String {
    suggest(clip).expect_err("no body").to_string()
}

#[test]
fn a_walk_is_read_without_names() {
    let clip = walking();
    let made = nameless(&clip);
    assert_eq!((wrong(&clip, &made), made.limbs, made.sides.sure), (vec![], Sure::Certain, Sure::Certain));
    assert!(made.up[1] > 0.9 && made.uneven < 0.01, "{:?} {}", made.up, made.uneven);
    assert!((made.bones[0] - 0.42).abs() < 1e-6, "{:?}", made.bones);
    // The map is one that --map takes, and it names what it left out.
    let mut bare = clip.clone();
    bare.skeleton.joints.iter_mut().enumerate().for_each(|(at, joint)| joint.name = format!("j{at}"));
    let read = SkeletonMap::parse(&made.toml).and_then(|map| map.resolve(&bare.skeleton)).expect("a map");
    assert!(Canonical::ALL.into_iter().all(|c| read.joint(c) == made.map.joint(c)), "{}", made.toml);
    assert!(made.toml.contains("# l_collar: found no joint before the shoulder"), "{}", made.toml);
}

#[test]
fn helpers_twists_fingers_and_tips_are_skipped() {
    let mut clip = walking();
    for side in ["Left", "Right"] {
        let way = if side == "Left" { 1.0 } else { -1.0 };
        let name = |part: &str| format!("{side}{part}");
        split(&mut clip, &name("ForeArm"), &name("ArmTwist"), 0.5);
        split(&mut clip, &name("Leg"), &name("UpLegTwist"), 0.4);
        split(&mut clip, &name("Foot"), &name("LegTwist"), 0.5);
        grow(&mut clip, &name("ForeArm"), &name("ForeArmTwist"), [0.0, -0.12, 0.0]);
        split(&mut clip, &name("Arm"), &name("Shoulder"), 0.3);
        for (at, finger) in ["Thumb", "Index", "Middle", "Ring", "Pinky"].into_iter().enumerate() {
            let across = way * 0.02 * (at as f64 - 2.0);
            grow(&mut clip, &name("Hand"), &name(&format!("{finger}1")), [across, -0.08, 0.0]);
            grow(&mut clip, &name(&format!("{finger}1")), &name(&format!("{finger}2")), [0.0, -0.04, 0.0]);
            grow(&mut clip, &name(&format!("{finger}2")), &name(&format!("{finger}3")), [0.0, -0.03, 0.0]);
        }
        grow(&mut clip, &name("ToeBase"), &name("ToeEnd"), [0.0, 0.0, 0.06]);
        grow(&mut clip, "Head", &name("Eye"), [way * 0.03, 0.07, 0.08]);
        grow(&mut clip, "Hips", &name("IK"), [way * 0.1, -0.9, 0.1]);
        // A skirt: mirrored, of some length, on the hips.
        grow(&mut clip, "Hips", &name("Skirt1"), [way * 0.15, -0.1, 0.0]);
        grow(&mut clip, &name("Skirt1"), &name("Skirt2"), [way * 0.02, -0.2, 0.0]);
        grow(&mut clip, &name("Skirt2"), &name("Skirt3"), [way * 0.02, -0.2, 0.0]);
    }
    grow(&mut clip, "Head", "HeadTop", [0.0, 0.18, 0.02]);
    let made = nameless(&clip);
    assert_eq!(wrong(&clip, &made), Vec::<&str>::new(), "{}", made.toml);
    assert!(made.toml.contains("# 5 joints hang on it"), "{}", made.toml);
}

#[test]
fn doubled_legs_hair_and_a_sword_confuse_nothing() {
    let mut clip = walking();
    // As some rigs have it: each leg a second time, in the same place, that does not bend.
    for side in ["Left", "Right"] {
        let way = if side == "Left" { 1.0 } else { -1.0 };
        let name = |part: &str| format!("{side}{part}");
        grow(&mut clip, "Hips", &name("UpLegD"), [way * 0.09, -0.06, 0.0]);
        grow(&mut clip, &name("UpLegD"), &name("LegD"), [0.0, -0.42, 0.0]);
        grow(&mut clip, &name("LegD"), &name("FootD"), [0.0, -0.41, 0.0]);
    }
    grow(&mut clip, "Head", "Hair1", [0.0, 0.05, -0.1]);
    for at in 1..5 {
        grow(&mut clip, &format!("Hair{at}"), &format!("Hair{}", at + 1), [0.0, -0.12, -0.01]);
    }
    grow(&mut clip, "RightHand", "Sword", [0.0, -0.08, 0.05]);
    grow(&mut clip, "Sword", "SwordTip", [0.0, 0.0, 0.9]);
    let made = nameless(&clip);
    assert_eq!(wrong(&clip, &made), Vec::<&str>::new(), "{}", made.toml);
}

#[test]
fn joints_in_one_place_are_told_apart_by_what_hangs_on_them() {
    let mut clip = walking();
    // As the CMU database has it: a joint on the hips for each leg, one on the chest for each arm and the neck.
    for (joint, name) in [
        ("LeftUpLeg", "LHipJoint"),
        ("RightUpLeg", "RHipJoint"),
        ("Spine", "LowerBack"),
        ("Neck1", "Neck"),
        ("LeftArm", "LeftShoulder"),
        ("RightArm", "RightShoulder"),
    ] {
        split(&mut clip, joint, name, 0.0);
    }
    let made = nameless(&clip);
    assert_eq!(wrong(&clip, &made), Vec::<&str>::new(), "{}", made.toml);
}

#[test]
fn axes_units_and_scene_roots_do_not_matter() {
    let mut clip = walking();
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::FRAC_PI_2);
    let n = clip.skeleton.len();
    clip.rotations.iter_mut().step_by(n).for_each(|r| *r = turn * *r);
    clip.root.iter_mut().for_each(|p| *p = turn * *p * 250.0);
    clip.skeleton.joints.iter_mut().for_each(|joint| {
        joint.offset *= 250.0;
        joint.end = joint.end.map(|end| end * 250.0);
    });
    split(&mut clip, "Hips", "Scene", 0.0);
    let made = nameless(&clip);
    assert_eq!(wrong(&clip, &made), Vec::<&str>::new(), "{}", made.toml);
    assert!(made.up[2] > 0.9, "{:?}", made.up);
}

#[test]
fn one_frame_is_enough_for_the_limbs() {
    let clip = walking();
    let made = nameless(&clip.slice(0..1));
    assert_eq!(wrong(&clip, &made), Vec::<&str>::new(), "{}", made.toml);
    // Without feet, at rest, nothing says where front is.
    let mut still = clip.slice(0..1);
    still.rotations.iter_mut().for_each(|r| *r = UnitQuaternion::identity());
    for toe in ["LeftToeBase", "RightToeBase"] {
        let at = named(toe, &still);
        still.skeleton.joints[at].offset = Vector3::new(0.0, -0.15, 0.0);
        still.skeleton.joints[at].end = None;
    }
    let made = nameless(&still);
    assert_eq!(made.sides.sure, Sure::Open, "{:?}", made.sides);
    assert!(made.toml.contains("OPEN, they may be exchanged"), "{}", made.toml);
}

#[test]
fn a_mirrored_file_has_its_sides_exchanged_unless_its_names_say_them() {
    let mut clip = walking();
    let mirror = |v: Vector3<f64>| Vector3::new(v.x, v.y, -v.z);
    clip.root.iter_mut().for_each(|p| *p = mirror(*p));
    clip.skeleton.joints.iter_mut().for_each(|joint| {
        joint.offset = mirror(joint.offset);
        joint.end = joint.end.map(mirror);
    });
    clip.rotations.iter_mut().for_each(|r| {
        *r = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(r.w, -r.i, -r.j, r.k));
    });
    let made = nameless(&clip);
    assert_eq!(made.map.joint(Canonical::LKnee), Some(named("RightLeg", &clip)));
    assert!(made.toml.contains("--handed left"), "{}", made.toml);
    let made = suggest(&clip).expect("a body");
    assert_eq!((wrong(&clip, &made), made.sides.by_names()), (vec![], Some(true)));
    assert!(made.sides.sure < Sure::Certain && made.toml.contains("--handed left"), "{}", made.toml);
    // The signs for left and right do as well as the words.
    for joint in &mut clip.skeleton.joints {
        joint.name = joint.name.replace("Left", "\u{5de6}").replace("Right", "\u{53f3}");
    }
    let made = suggest(&clip).expect("a body");
    assert_eq!(made.map.joint(Canonical::LKnee), clip.skeleton.find("\u{5de6}Leg"));
}

#[test]
fn odd_names_are_escaped_and_shared_ones_refused() {
    let mut clip = walking();
    let n = clip.skeleton.len();
    for (at, joint) in clip.skeleton.joints.iter_mut().enumerate() {
        joint.name = format!("a \"{at}\" \\ \u{1b}[2J\n\u{202e}{}", n - at);
    }
    let made = suggest(&clip).expect("a body");
    assert!(!made.toml.contains(['\u{1b}', '\u{202e}']), "{}", made.toml);
    clip.skeleton.joints[6].name = clip.skeleton.joints[2].name.clone();
    assert!(refusal(&clip).contains("share a name"), "{}", refusal(&clip));
}

/// Four equal legs under a flat trunk, with head and tail.
fn animal() -> Clip {
    let mut joints = vec![Joint { name: "b0".into(), parent: None, offset: Vector3::zeros(), end: None }];
    let mut add = |parent: usize, offset: [f64; 3], end: Option<[f64; 3]>| {
        let name = format!("b{}", joints.len());
        joints.push(Joint { name, parent: Some(parent), offset: offset.into(), end: end.map(Vector3::from) });
        joints.len() - 1
    };
    let tail = add(0, [0.0, 0.05, -0.1], None);
    add(tail, [0.0, -0.1, -0.2], Some([0.0, -0.2, 0.0]));
    let back = add(0, [0.0, 0.0, 0.3], None);
    let chest = add(back, [0.0, 0.0, 0.3], None);
    for (on, way) in [(0, 1.0), (0, -1.0), (chest, 1.0), (chest, -1.0)] {
        let hip = add(on, [way * 0.1, -0.05, 0.0], None);
        let knee = add(hip, [0.0, -0.3, 0.05], None);
        let foot = add(knee, [0.0, -0.28, -0.04], None);
        add(foot, [0.0, -0.08, 0.06], Some([0.0, 0.0, 0.05]));
    }
    let neck = add(chest, [0.0, 0.15, 0.15], None);
    add(neck, [0.0, 0.1, 0.15], Some([0.0, 0.0, 0.2]));
    let skeleton = Skeleton { joints };
    let n = skeleton.len();
    Clip {
        skeleton,
        frame_time: 1.0 / 30.0,
        root: vec![Vector3::new(0.0, 0.7, 0.0); 20],
        rotations: vec![UnitQuaternion::identity(); 20 * n],
        coordinates: None,
        notes: Vec::new(),
    }
}

#[test]
fn what_has_no_two_legs_and_two_arms_is_refused() {
    let four = refusal(&animal());
    assert!(four.contains("four legs") && four.contains("by hand"), "{four}");
    let chain = |count: usize| {
        let joint = |at: usize| Joint {
            name: format!("c{at}"),
            parent: at.checked_sub(1),
            offset: Vector3::new(0.0, if at == 0 { 0.0 } else { 0.3 }, 0.0),
            end: None,
        };
        let skeleton = Skeleton { joints: (0..count).map(joint).collect() };
        let rotations = vec![UnitQuaternion::identity(); 2 * count];
        let root = vec![Vector3::zeros(); 2];
        Clip { skeleton, frame_time: 0.1, root, rotations, coordinates: None, notes: Vec::new() }
    };
    let arm = refusal(&chain(7));
    assert!(arm.contains("no mirrored pair of chains") && arm.contains("two legs, two arms"), "{arm}");
    refusal(&chain(1));
    refusal(&walking().slice(0..0));
    // Legs alone.
    let mut legs = walking();
    let keep: Vec<bool> =
        legs.skeleton.joints.iter().map(|j| !j.name.contains("Arm") && !j.name.contains("Hand")).collect();
    legs = legs.with_joints(&mut keep.clone());
    assert!(refusal(&legs).contains("that could be arms"), "{}", refusal(&legs));
}

#[test]
fn a_wide_and_deep_tree_is_searched_in_bounded_time() {
    let joint = |at: usize| Joint {
        name: format!("w{at}"),
        parent: at.checked_sub(1).map(|before| before / 2),
        offset: Vector3::new(if at.is_multiple_of(2) { 0.3 } else { -0.3 }, 0.3, 0.0),
        end: None,
    };
    let skeleton = Skeleton { joints: (0..1024).map(joint).collect() };
    let rotations = vec![UnitQuaternion::identity(); 60 * 1024];
    let root = vec![Vector3::zeros(); 60];
    let wide = Clip { skeleton, frame_time: 0.1, root, rotations, coordinates: None, notes: Vec::new() };
    let before = std::time::Instant::now();
    let _ = suggest(&wide);
    assert!(cfg!(debug_assertions) || before.elapsed().as_secs_f64() < 2.0, "{:?}", before.elapsed());
}
