//! Robots that we made up: MJCF against MuJoCo's own formula, a person's motion on them, every limit, every refusal, the commands.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use kinesic_host::clip::{Clip, JointMap, WriteOptions, read};
use kinesic_host::gait::{self, Manner, walk};
use kinesic_host::robot::retarget::{RetargetMap, Retargeted, retarget, suggest};
use kinesic_host::robot::{Motion, Robot, RobotError};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

const KINESIC: &str = env!("CARGO_BIN_EXE_kinesic");

/// Shoulders canted by 45 degrees, parallel hinges at zero (pitch and elbow), a slider in the trunk, a wrist that follows the elbow.
fn canted() -> String {
    let mut text = String::from(
        r#"<robot name="canted"><link name="base"/><link name="chest"/><link name="top"/>
<joint name="lift" type="prismatic"><parent link="base"/><child link="chest"/><axis xyz="0 0 1"/>
  <limit lower="0.01" upper="0.2" velocity="1" effort="1"/></joint>
<joint name="head_yaw" type="revolute"><parent link="chest"/><child link="top"/><origin xyz="0 0 0.6"/><axis xyz="0 0 1"/>
  <limit lower="-1" upper="1" velocity="50" effort="1"/></joint>
"#,
    );
    for (side, sign) in [("left", 1.0), ("right", -1.0)] {
        text += &format!(
            r#"<link name="{side}_a"/><link name="{side}_b"/><link name="{side}_c"/><link name="{side}_d"/><link name="{side}_e"/>
<joint name="{side}_shoulder_pitch" type="revolute"><parent link="chest"/><child link="{side}_a"/>
  <origin xyz="0 {y} 0.4" rpy="{cant} 0 0"/><axis xyz="0 1 0"/><limit lower="-3" upper="2" velocity="50" effort="1"/></joint>
<joint name="{side}_shoulder_roll" type="revolute"><parent link="{side}_a"/><child link="{side}_b"/><origin rpy="{back} 0 0"/>
  <axis xyz="1 0 0"/><limit lower="-2" upper="2" velocity="50" effort="1"/></joint>
<joint name="{side}_shoulder_yaw" type="revolute"><parent link="{side}_b"/><child link="{side}_c"/><origin xyz="0 0 -0.1"/>
  <axis xyz="0 0 1"/><limit lower="-2" upper="2" velocity="50" effort="1"/></joint>
<joint name="{side}_elbow" type="revolute"><parent link="{side}_c"/><child link="{side}_d"/><origin xyz="0 0 -0.15"/>
  <axis xyz="0 1 0"/><limit lower="-2.2" upper="0.1" velocity="50" effort="1"/></joint>
<joint name="{side}_wrist" type="revolute"><parent link="{side}_d"/><child link="{side}_e"/><origin xyz="0 0 -0.2"/>
  <axis xyz="1 0 0"/><limit lower="-0.7" upper="0.07" velocity="50" effort="1"/>
  <mimic joint="{side}_elbow" multiplier="0.3" offset="0.01"/></joint>
"#,
            y = 0.2 * sign,
            cant = std::f64::consts::FRAC_PI_4 * sign,
            back = -std::f64::consts::FRAC_PI_4 * sign,
        );
    }
    text + "</robot>"
}

fn at(robot: &Robot, name: &str) -> usize {
    robot.find(name).unwrap_or_else(|| panic!("no {name}"))
}

/// Robot to clip: x forward, y left, z up to Z, X, Y.
fn world(way: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(way.y, way.z, way.x)
}

/// A person whose arms point where the robot's do at known angles.
fn person(robot: &Robot, frames: usize) -> Clip {
    let skeleton = gait::skeleton();
    let n = skeleton.len();
    let index = |name: &str| skeleton.find(name).unwrap();
    let mut rotations = vec![UnitQuaternion::identity(); frames * n];
    for frame in 0..frames {
        let time = frame as f64 / 60.0;
        let mut values = vec![0.0; robot.joints.len()];
        for (side, sign) in [("left", 1.0), ("right", -1.0)] {
            let wave = |k: f64| (k * time + 0.3 * sign).sin();
            values[at(robot, &format!("{side}_shoulder_pitch"))] = -0.7 + 0.6 * wave(2.0);
            values[at(robot, &format!("{side}_shoulder_roll"))] = sign * (0.4 + 0.3 * wave(1.3));
            values[at(robot, &format!("{side}_shoulder_yaw"))] = 0.5 * wave(1.7);
            values[at(robot, &format!("{side}_elbow"))] = -1.0 + 0.7 * wave(2.3);
        }
        let placed = robot.placed(&|joint| values[joint]);
        let place = |name: String| placed[at(robot, &name)].translation.vector;
        for (side, arm) in [("left", "Left"), ("right", "Right")] {
            let points = ["shoulder_roll", "elbow", "wrist"].map(|name| place(format!("{side}_{name}")));
            let turn = |way: Vector3<f64>| UnitQuaternion::rotation_between(&-Vector3::y(), &world(way)).unwrap();
            let (upper, fore) = (turn(points[1] - points[0]), turn(points[2] - points[1]));
            rotations[frame * n + index(&format!("{arm}Arm"))] = upper;
            rotations[frame * n + index(&format!("{arm}ForeArm"))] = upper.inverse() * fore;
        }
    }
    Clip { skeleton, frame_time: 1.0 / 60.0, root: vec![Vector3::y(); frames], rotations, notes: Vec::new() }
}

fn play(robot: &Robot, map: &str, clip: &Clip) -> Retargeted {
    let joints = JointMap::detect(&clip.skeleton).unwrap();
    retarget(robot, &RetargetMap::parse(map).unwrap(), clip, &joints).unwrap()
}

/// Every value in the table, and every follower of it, is within its limits, to the last bit.
fn within(robot: &Robot, moved: &Retargeted) {
    let table = moved.csv(robot);
    let mut lines = table.lines();
    let columns: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(columns.len(), moved.joints.len() + 1);
    assert_eq!(moved.report.limits_exceeded, 0);
    let mut rows = 0;
    for line in lines {
        let row: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let mut own = vec![0.0; robot.joints.len()];
        moved.joints.iter().zip(&row[1..]).for_each(|(joint, value)| own[*joint] = *value);
        for (joint, value) in robot.joints.iter().zip(robot.followed(&own)) {
            if matches!(joint.motion, Motion::Revolute | Motion::Prismatic) {
                let bounds = joint.lower.unwrap_or(f64::NEG_INFINITY)..=joint.upper.unwrap_or(f64::INFINITY);
                assert!(bounds.contains(&value), "{} is {value}, beyond {bounds:?}", joint.name);
            }
        }
        rows += 1;
    }
    assert_eq!(rows, moved.frames());
}

const ARMS: &str = r#"[limbs]
l_upper_arm = ["left_shoulder_roll", "left_elbow"]
l_forearm = ["left_elbow", "left_wrist"]
r_upper_arm = ["right_shoulder_roll", "right_elbow"]
r_forearm = ["right_elbow", "right_wrist"]
"#;

#[test]
fn directions_of_known_angles_come_back_through_canted_shoulders() {
    let robot = Robot::parse(&canted()).unwrap();
    let clip = person(&robot, 240);
    let moved = play(&robot, ARMS, &clip);
    assert_eq!(moved.report.limbs.len(), 4);
    for limb in &moved.report.limbs {
        assert!(limb.p95 < 0.5, "{limb:?}");
        assert!(limb.zero_median > 10.0, "{limb:?}");
    }
    within(&robot, &moved);
    // The fastest joint of the source goes 0.7 * 2.3 rad/s.
    let n = moved.joints.len();
    let pairs = moved.values.chunks(n).zip(moved.values.chunks(n).skip(1));
    let fastest = pairs.flat_map(|(a, b)| a.iter().zip(b).map(|(a, b)| (b - a).abs())).fold(0.0, f64::max);
    assert!(fastest < 0.1, "{fastest} rad in a frame");
    let head = moved.csv(&robot);
    assert!(head.starts_with("time_s,lift_m,head_yaw_rad,left_shoulder_pitch_rad,"), "{}", &head[..80]);
}

#[test]
fn what_cannot_be_reached_stays_within_limits_and_is_said() {
    let text = canted().replace("lower=\"-2.2\" upper=\"0.1\"", "lower=\"-0.654321987\" upper=\"-0.1234567891\"");
    let robot =
        Robot::parse(&text.replace("lower=\"-0.7\" upper=\"0.07\"", "lower=\"-0.15\" upper=\"-0.05\"")).unwrap();
    let moved = play(&robot, ARMS, &person(&robot, 120));
    within(&robot, &moved);
    let fore = moved.report.limbs.iter().find(|limb| limb.limb == "l_forearm").unwrap();
    assert!(fore.p95 > 5.0 && fore.p95 < 90.0, "{fore:?}");
    assert!(moved.report.at_limit.iter().any(|at| at.joint == "left_elbow"), "{:?}", moved.report.at_limit);
    let idle = moved.report.notes.iter().any(|note| note.contains("lift, head_yaw"));
    assert!(idle, "{:?}", moved.report.notes);
}

#[test]
fn speed_limits_hold_and_what_they_cost_is_said() {
    let robot = Robot::parse(&canted().replace("velocity=\"50\"", "velocity=\"0.4\"")).unwrap();
    let moved = play(&robot, ARMS, &person(&robot, 120));
    within(&robot, &moved);
    let n = moved.joints.len();
    for (a, b) in moved.values.chunks(n).zip(moved.values.chunks(n).skip(1)) {
        for (a, b) in a.iter().zip(b) {
            assert!((b - a).abs() <= 0.4 / 60.0 + 1e-12, "{a} to {b}");
        }
    }
    assert!(moved.report.notes.iter().any(|note| note.contains("speed limit")), "{:?}", moved.report.notes);
    let limb = &moved.report.limbs[0];
    assert!(limb.reachable_p95 < 0.5 && limb.p95 > limb.reachable_p95, "{limb:?}");
}

#[test]
fn a_slider_reaches() {
    let text = r#"<robot name="rail"><link name="base"/><link name="a"/><link name="b"/><link name="c"/>
<joint name="pan" type="continuous"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/></joint>
<joint name="tilt" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/></joint>
<joint name="reach" type="prismatic"><parent link="b"/><child link="c"/><origin xyz="0.1 0 0"/><axis xyz="1 0 0"/>
  <limit lower="0" upper="0.4" velocity="9" effort="1"/></joint></robot>"#;
    let robot = Robot::parse(text).unwrap();
    let mut clip = walk(&Manner::NEUTRAL, 2.0, 60.0, 0.0, 1);
    let n = clip.skeleton.len();
    let elbow = clip.skeleton.find("LeftForeArm").unwrap();
    for frame in 0..clip.frames() {
        let bend = 1.0 - (frame as f64 / 30.0).cos();
        clip.rotations[frame * n + elbow] = UnitQuaternion::new(Vector3::x() * -bend);
    }
    let moved = play(&robot, "[limbs]\nl_arm = [\"tilt\", \"reach\"]", &clip);
    within(&robot, &moved);
    assert!(moved.report.limbs[0].p95 < 0.5, "{:?}", moved.report.limbs);
    let slides: Vec<f64> = moved.values.chunks(3).map(|row| row[2]).collect();
    let positions = clip.all_positions();
    let joint = |name: &str| clip.skeleton.find(name).unwrap();
    for (frame, slide) in slides.iter().enumerate().skip(1) {
        let at = |name: &str| positions[frame * n + joint(name)];
        let share = (at("LeftHand") - at("LeftArm")).norm() / 0.53;
        assert!((0.1 + slide - 0.5 * share).abs() < 5e-3, "frame {frame}: {slide} for {share}");
    }
}

#[test]
fn a_map_is_suggested_from_names_and_geometry() {
    let robot = Robot::parse(&canted()).unwrap();
    let map = suggest(&robot).unwrap();
    assert!(map.contains("forward = \"x\"\nup = \"z\""), "{map}");
    assert!(map.contains("l_upper_arm = [\"left_shoulder_roll\", \"left_elbow\"]"), "{map}");
    assert!(map.contains("head = \"head_yaw\"") && map.contains("# l_thigh: "), "{map}");
    RetargetMap::parse(&map).unwrap();
    // A robot that faces the other way.
    let mut turned = canted();
    turned =
        turned.replace("xyz=\"0 0.2 0.4\"", "xyz=\"0 -0.3 0.4\"").replace("xyz=\"0 -0.2 0.4\"", "xyz=\"0 0.2 0.4\"");
    assert!(suggest(&Robot::parse(&turned).unwrap()).unwrap().contains("forward = \"-x\""));
    let nameless = canted().replace("shoulder", "p").replace("elbow", "q").replace("wrist", "s").replace("head", "t");
    says(&suggest(&Robot::parse(&nameless).unwrap()).unwrap_err(), &["no limb", "12 joints", "by hand"]);
}

const MJCF: &str = r#"<mujoco model="made">
  <compiler eulerseq="zyx"/>
  <default>
    <joint axis="0 1 0"/>
    <default class="arm"><joint range="-90 45"/><default class="slow"><joint type="slide" range="0 0.2" axis="1 0 0"/></default></default>
  </default>
  <worldbody>
    <body name="trunk" pos="0 0 1" childclass="arm">
      <freejoint/>
      <body name="shoulder" pos="0 0.2 0.4" euler="30 -20 10">
        <joint name="pitch" pos="0.01 0.02 0.03" ref="15"/>
        <joint name="roll" axis="1 0 0" pos="0 0 -0.05" range="-30 30"/>
        <body name="fore" pos="0 0 -0.3" quat="0.5 0.5 0.5 0.5">
          <joint name="rail" class="slow"/>
          <body name="hand" pos="0 0.1 0" axisangle="0 0 1 90"><joint name="grip" class="main" axis="0 0 1"/></body>
          <body name="fixed" pos="0 0 0.5"/>
        </body>
      </body>
    </body>
  </worldbody>
  <equality><joint joint1="grip" joint2="pitch" polycoef="0.1 -0.5 0 0 0"/></equality>
  <actuator><position joint="pitch" kp="20"/></actuator>
</mujoco>"#;

#[test]
fn mjcf_is_placed_as_mujoco_places_it() {
    let robot = Robot::parse(MJCF).unwrap();
    assert_eq!((robot.name.as_str(), robot.root.as_str()), ("made", "trunk"));
    let joint = |name: &str| &robot.joints[at(&robot, name)];
    let near =
        |a: Option<f64>, degrees: f64| assert!((a.unwrap().to_degrees() - degrees).abs() < 1e-9, "{a:?} {degrees}");
    near(joint("pitch").lower, -90.0);
    near(joint("roll").upper, 30.0);
    assert_eq!((joint("rail").motion, joint("rail").upper), (Motion::Prismatic, Some(0.2)));
    assert_eq!((joint("grip").motion, joint("grip").lower), (Motion::Continuous, None));
    assert!(robot.notes.iter().any(|note| note.contains("freely")), "{:?}", robot.notes);

    let (pitch, roll, rail) = (-0.4, 0.3, 0.15);
    let mut own = vec![0.0; robot.joints.len()];
    for (name, value) in [("pitch", pitch), ("roll", roll), ("rail", rail)] {
        own[at(&robot, name)] = value;
    }
    let values = robot.followed(&own);
    let rest = 15f64.to_radians();
    assert!((values[at(&robot, "grip")] - (0.1 - 0.5 * (pitch - rest))).abs() < 1e-12);
    let placed = robot.placed(&|joint| values[joint]);
    let link = |name: &str| placed[robot.joints.iter().position(|joint| joint.child == name).unwrap()];

    // mj_kinematics: the body turns about the anchor of every joint in turn.
    let mut frame = Isometry3::from_parts(
        Translation3::new(0.0, 0.2, 0.4),
        UnitQuaternion::new(Vector3::z() * 30f64.to_radians())
            * UnitQuaternion::new(Vector3::y() * -20f64.to_radians())
            * UnitQuaternion::new(Vector3::x() * 10f64.to_radians()),
    );
    for (anchor, axis, angle) in [
        (Vector3::new(0.01, 0.02, 0.03), Vector3::y(), pitch - rest),
        (Vector3::new(0.0, 0.0, -0.05), Vector3::x(), roll),
    ] {
        let held = frame.translation.vector + frame.rotation * anchor;
        frame.rotation *= UnitQuaternion::new(axis * angle);
        frame.translation.vector = held - frame.rotation * anchor;
    }
    let same = |a: Isometry3<f64>, b: Isometry3<f64>| {
        let far = (a.translation.vector - b.translation.vector).norm();
        assert!(far < 1e-12 && a.rotation.angle_to(&b.rotation) < 1e-7, "{a} {b}");
    };
    same(link("shoulder"), frame);
    let turn = UnitQuaternion::new(Vector3::new(1.0, 1.0, 1.0).normalize() * 120f64.to_radians());
    let fore =
        frame * Isometry3::from_parts(Translation3::new(0.0, 0.0, -0.3), turn) * Translation3::new(rail, 0.0, 0.0);
    same(link("fore"), fore);
    same(link("fixed"), fore * Translation3::new(0.0, 0.0, 0.5));
    let grip = UnitQuaternion::new(Vector3::z() * (std::f64::consts::FRAC_PI_2 + values[at(&robot, "grip")]));
    same(link("hand"), fore * Isometry3::from_parts(Translation3::new(0.0, 0.1, 0.0), grip));
}

fn says(error: &RobotError, words: &[&str]) {
    let text = format!("{error} {}", error.help);
    assert!(words.iter().all(|word| text.contains(word)), "{text}: expected {words:?}");
    assert!(!error.help.is_empty(), "{text}");
}

#[test]
fn broken_descriptions_are_refused_with_line_and_joint() {
    let cases: [(&str, &str, &[&str]); 14] = [
        ("class=\"slow\"/>", "class=\"fast\"/>", &["line 14", "rail", "'fast'"]),
        ("axis=\"1 0 0\" pos", "axis=\"0 0 0\" pos", &["line 12", "roll", "length zero"]),
        ("name=\"roll\"", "name=\"pitch\"", &["line 12", "'pitch'", "rename"]),
        ("ref=\"15\"", "ref=\"much\"", &["line 11", "pitch", "ref=\"much\"", "1 finite"]),
        ("range=\"-30 30\"", "range=\"30 -30\"", &["line 12", "roll", "exchange"]),
        ("ref=\"15\"", "type=\"screw\"", &["line 11", "pitch", "hinge, slide, ball or free"]),
        ("eulerseq=\"zyx\"", "eulerseq=\"abc\"", &["line 2", "eulerseq", "x, y, z"]),
        ("eulerseq=\"zyx\"", "angle=\"turns\"", &["line 2", "degree or radian"]),
        ("<freejoint/>", "<replicate count=\"3\"/>", &["line 9", "<replicate>", "mj_saveLastXML"]),
        ("<freejoint/>", "<include file=\"a.xml\"/>", &["line 9", "<include>", "mj_saveLastXML"]),
        ("quat=\"0.5 0.5 0.5 0.5\"", "quat=\"0 0 0 0\"", &["line 13", "fore", "w x y z"]),
        ("ref=\"15\"", "type=\"free\"", &["line 11", "free joint", "move the body"]),
        ("joint2=\"pitch\"", "joint2=\"gone\"", &["line 21", "gone", "correct the name"]),
        ("</worldbody>", "", &["line", "not XML"]),
    ];
    for (from, to, words) in cases {
        assert!(MJCF.contains(from), "{from}");
        says(&Robot::parse(&MJCF.replacen(from, to, 1)).unwrap_err(), words);
    }
    says(&Robot::parse("<mujoco/>").unwrap_err(), &["no joint"]);
    says(&Robot::parse("<sdf version='1.6'/>").unwrap_err(), &["<sdf>", "<robot> or <mujoco>"]);
    // Nothing of it panics, however it is cut.
    for end in (0..MJCF.len()).filter(|end| MJCF.is_char_boundary(*end)) {
        let _ = Robot::parse(&MJCF[..end]);
        let _ = Robot::parse(&format!("{}{}", &MJCF[..end], &MJCF[(end + 7).min(MJCF.len())..]));
    }
}

#[test]
fn includes_beside_the_model_are_followed_and_others_refused() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let model = folder.path().join("model.xml");
    let defaults = MJCF[MJCF.find("<default>").unwrap()..MJCF.find("<worldbody>").unwrap()].trim_end();
    write("defaults.xml", &format!("<mujocoinclude>\n{defaults}\n</mujocoinclude>"));
    write("model.xml", &MJCF.replace(defaults, "<include file=\"defaults.xml\"/>"));
    let whole = Robot::parse(MJCF).unwrap();
    let read = Robot::read(&model).unwrap();
    assert_eq!(read.joints.len(), whole.joints.len());
    assert_eq!(read.frames(), whole.frames());
    for (file, words) in [
        ("../x.xml", ["line 3", "beside the model"]),
        ("gone.xml", ["gone.xml", "cannot be read"]),
        ("model.xml", ["every file once", "flat"]),
    ] {
        write("model.xml", &MJCF.replace(defaults, &format!("<include file=\"{file}\"/>")));
        says(&Robot::read(&model).unwrap_err(), &words);
    }
}

#[test]
fn broken_maps_are_refused() {
    let robot = Robot::parse(&canted()).unwrap();
    for (map, words) in [
        ("[limbs]\nl_uper_arm = \"x\"", ["l_uper_arm", "did you mean 'l_upper_arm'"]),
        ("[limbs]\nhead = 3", ["[limbs] head", "found 3"]),
        ("limb = 1", ["limb", "did you mean 'limbs'"]),
        ("[limbs]", ["no limb", "--suggest-map"]),
        ("forward = \"up\"\n[limbs]\nhead = \"top\"", ["forward", "-x"]),
        ("forward = \"z\"\n[limbs]\nhead = \"top\"", ["forward", "square"]),
    ] {
        says(&RetargetMap::parse(map).unwrap_err(), &words);
    }
    let clip = walk(&Manner::NEUTRAL, 1.0, 30.0, 0.0, 1);
    let joints = JointMap::detect(&clip.skeleton).unwrap();
    for (map, words) in [
        ("[limbs]\nhead = \"tip\"", ["'tip'", "did you mean 'top'"]),
        ("[limbs]\nl_forearm = \"left_elbow\"", ["l_forearm", "two names"]),
        ("[limbs]\nl_upper_arm = [\"left_shoulder_pitch\", \"left_shoulder_roll\"]", ["m apart", "further out"]),
        ("[limbs]\nhead = \"top\"\n[hold]\nlift = 3", ["[hold] lift", "found 3"]),
        ("[limbs]\nhead = \"top\"\n[hold]\nleft_wrist = 0", ["left_wrist", "leads"]),
    ] {
        let map = RetargetMap::parse(map).unwrap();
        says(&retarget(&robot, &map, &clip, &joints).unwrap_err(), &words);
    }
    let ring = canted().replace("<limit lower=\"-2.2\"", "<mimic joint=\"left_wrist\"/><limit lower=\"-2.2\"");
    let map = RetargetMap::parse(ARMS).unwrap();
    says(&retarget(&Robot::parse(&ring).unwrap(), &map, &clip, &joints).unwrap_err(), &["line", "left_elbow", "ring"]);
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(KINESIC).args(arguments).current_dir(folder).output().unwrap()
}

#[test]
fn the_commands_show_and_retarget() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("r.urdf"), canted()).unwrap();
    let walk = walk(&Manner::NEUTRAL, 2.0, 60.0, 0.0, 1);
    std::fs::write(folder.path().join("walk.bvh"), walk.to_bvh(&WriteOptions::default()).unwrap()).unwrap();
    let shown = run(folder.path(), &["robot", "show", "r.urdf", "--at", "left_elbow=-1", "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&shown.stdout).unwrap();
    assert_eq!(json["joints"].as_array().unwrap().len(), 12);
    let q = &json["frames"][0]["left_d"];
    assert!((q[5].as_f64().unwrap() - (-0.5f64).sin()).abs() < 1e-9, "{q}");
    let text = run(folder.path(), &["robot", "show", "r.urdf"]);
    assert!(String::from_utf8_lossy(&text.stdout).contains("12 joints, of which 12 move"));
    let wrong = run(folder.path(), &["robot", "show", "r.urdf", "--at", "elbow=1"]);
    assert!(!wrong.status.success() && String::from_utf8_lossy(&wrong.stderr).contains("no joint 'elbow'"));

    let map = run(folder.path(), &["robot", "retarget", "r.urdf", "--suggest-map"]);
    std::fs::write(folder.path().join("map.toml"), &map.stdout).unwrap();
    let arguments =
        ["robot", "retarget", "r.urdf", "walk.bvh", "--map", "map.toml", "--out", "m.csv", "--fps", "30", "--json"];
    let done = run(folder.path(), &arguments);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let json: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!((json["frames"].as_u64(), json["limits_exceeded"].as_u64()), (Some(60), Some(0)));
    let table = std::fs::read_to_string(folder.path().join("m.csv")).unwrap();
    assert_eq!(table.lines().count(), 61);
    let late = run(folder.path(), &["robot", "retarget", "r.urdf", "walk.bvh", "--out", "m.txt"]);
    assert!(!late.status.success());
}

/// A real walk on the made robot, where the clips are.
#[test]
fn a_real_walk_stays_within_limits() {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let folder = std::env::var_os("KINESIC_DATA").map_or(default, PathBuf::from);
    if !folder.join("pairs.tsv").is_file() {
        assert!(std::env::var("CI").as_deref() != Ok("true"), "no data in {}: set KINESIC_DATA", folder.display());
        eprintln!("skipped: the clips in {} are needed", folder.display());
        return;
    }
    let robot = Robot::parse(&canted()).unwrap();
    let clip = read(folder.join("xia/neutral_01_000.bvh")).unwrap();
    let moved = play(&robot, &suggest(&robot).unwrap(), &clip);
    within(&robot, &moved);
    for limb in moved.report.limbs.iter().filter(|limb| limb.limb.contains("arm")) {
        assert!(limb.median < 1.0 && limb.p95 < limb.zero_p95, "{limb:?}");
    }
}
