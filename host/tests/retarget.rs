//! A person's motion on robots that we made up: directions, every limit, every refusal, the command, and training on what it writes.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use kinesic_host::clip::{Clip, JointMap, WriteOptions, read};
use kinesic_host::gait::{self, Manner, walk};
use kinesic_host::robot::retarget::{RetargetMap, Retargeted, retarget, suggest};
use kinesic_host::robot::{Machine, Motion, Robot, RobotError};
use nalgebra::{UnitQuaternion, Vector3};

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
    Clip {
        skeleton,
        frame_time: 1.0 / 60.0,
        root: vec![Vector3::y(); frames],
        rotations,
        coordinates: None,
        notes: Vec::new(),
    }
}

fn play(robot: &Robot, map: &str, clip: &Clip) -> Retargeted {
    let joints = JointMap::detect(&clip.skeleton).unwrap();
    retarget(robot, &RetargetMap::parse(map).unwrap(), clip, &joints).unwrap()
}

/// Every value in the table, and every follower of it, is within its limits, to the last bit.
fn within(robot: &Robot, moved: &Retargeted) {
    let table = moved.moves(robot).to_csv();
    let mut lines = table.lines();
    let columns: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(columns.len(), moved.joints.len() + 1);
    assert_eq!((moved.report.limits_exceeded, moved.report.speeds_exceeded), (0, 0));
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
    let head = moved.moves(&robot).to_csv();
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
            assert!((b - a).abs() <= 0.4 / 60.0, "{a} to {b}");
        }
    }
    assert!(moved.report.cannot.iter().any(|line| line.contains("speed limits")), "{:?}", moved.report.cannot);
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

fn says(error: &RobotError, words: &[&str]) {
    let text = format!("{error} {}", error.help);
    assert!(words.iter().all(|word| text.contains(word)), "{text}: expected {words:?}");
    assert!(!error.help.is_empty(), "{text}");
}

#[test]
fn broken_maps_are_refused() {
    let robot = Robot::parse(&canted()).unwrap();
    for (map, words) in [
        ("[limbs]\nl_uper_arm = \"x\"", ["l_uper_arm", "did you mean 'l_upper_arm'"]),
        ("[limbs]\nhead = 3", ["[limbs] head", "found 3"]),
        ("[limbs]\nhead = { from = \"top\", length = 1 }", ["head, length", "only of arms and legs"]),
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

#[test]
fn what_is_no_robot_is_refused_soon() {
    let mut text = String::from("<robot name='r'><link name='l0'/>");
    for at in 1..=30_000 {
        let _ = write!(
            text,
            "<link name='l{at}'/><joint name='knee{at}' type='fixed'><parent link='l{}'/><child link='l{at}'/></joint>",
            at - 1
        );
    }
    let long = Robot::parse(&(text + "</robot>")).unwrap();
    let map = RetargetMap::parse("[limbs]\nhead = \"l9\"").unwrap();
    let clip = walk(&Manner::NEUTRAL, 1.0, 30.0, 0.0, 1);
    let joints = JointMap::detect(&clip.skeleton).unwrap();
    says(&suggest(&long).unwrap_err(), &["30000 joints", "at most 2000"]);
    says(&retarget(&long, &map, &clip, &joints).unwrap_err(), &["30000 joints", "at most 2000"]);
}

/// Every number of the description in turn is one that no robot has: refused, or moved within limits.
#[test]
fn odd_numbers_do_no_harm() {
    let text = canted();
    let clip = person(&Robot::parse(&text).unwrap(), 8);
    let map = RetargetMap::parse(ARMS).unwrap();
    let joints = JointMap::detect(&clip.skeleton).unwrap();
    let number = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
    let starts: Vec<usize> = text.match_indices(number).map(|(at, _)| at).collect();
    let (mut moved, mut refused) = (0, 0);
    for at in starts.into_iter().filter(|at| !text[..*at].ends_with(number)) {
        let end = at + text[at..].find(|c| !number(c)).unwrap();
        for odd in ["1e300", "-1e300", "999999", "1e-300", "0", "inf", "-inf"] {
            let Ok(robot) = Robot::parse(&format!("{}{odd}{}", &text[..at], &text[end..])) else {
                refused += 1;
                continue;
            };
            match retarget(&robot, &map, &clip, &joints) {
                Err(_) => refused += 1,
                Ok(done) => {
                    moved += 1;
                    assert!(done.values.iter().all(|value| value.is_finite()), "{odd} at {at}");
                    assert_eq!((done.report.limits_exceeded, done.report.speeds_exceeded), (0, 0), "{odd} at {at}");
                }
            }
        }
    }
    assert!(moved > 100 && refused > 100, "{moved} {refused}");
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(KINESIC).args(arguments).current_dir(folder).output().unwrap()
}

/// What the command prints; it must succeed.
fn done(folder: &Path, line: &str) -> String {
    let arguments: Vec<&str> = line.split_whitespace().collect();
    let output = run(folder, &arguments);
    assert!(output.status.success(), "kinesic {line}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn json(text: &str) -> serde_json::Value {
    serde_json::from_str(text).unwrap()
}

/// A folder with the robot, and two walks of one gait: as it is, and weary.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("r.urdf"), canted()).unwrap();
    let weary = Manner { arms: 0.3, ..Manner::NEUTRAL };
    for (name, manner, seed) in [("a", Manner::NEUTRAL, 1), ("b", weary, 1), ("c", Manner::NEUTRAL, 2)] {
        let clip = walk(&manner, 6.0, 60.0, 0.0, seed);
        let text = clip.to_bvh(&WriteOptions::default()).unwrap();
        std::fs::write(folder.path().join(format!("{name}.bvh")), text).unwrap();
    }
    folder
}

#[test]
fn the_command_writes_moves_that_train_a_style() {
    let folder = folder();
    let at = folder.path();
    std::fs::write(at.join("map.toml"), done(at, "robot retarget r.urdf --suggest-map")).unwrap();
    done(at, "robot import r.urdf --out r.kin");
    for name in ["a", "b", "c"] {
        let line =
            format!("robot retarget r.urdf {name}.bvh --map map.toml --robot r.kin --fps 50 --out {name}.csv --json");
        let report = json(&done(at, &line));
        assert_eq!((report["frames"].as_u64(), report["limits_exceeded"].as_u64()), (Some(300), Some(0)), "{report}");
        assert_eq!(report["speeds_exceeded"].as_u64(), Some(0));
        // Read back with the robot: every joint, its unit, the rate, and nothing outside its range.
        let read = json(&done(at, &format!("inspect {name}.csv --robot r.kin --json")));
        let text = read.to_string();
        assert!(!text.contains("outside its range") && !text.contains("assumed"), "{text}");
        let moves = kinesic_host::moves::read(&at.join(format!("{name}.csv")), &Default::default()).unwrap();
        assert!(moves.is_even() && moves.fps() == 50.0 && moves.frames() == 300);
        assert!(moves.channels.iter().all(|channel| channel.unit.is_some()));
        assert_eq!(moves.channels.len(), 10);
    }
    // The same values from JSON and a trajectory.
    for other in ["json", "yaml"] {
        done(at, &format!("robot retarget r.urdf a.bvh --map map.toml --robot r.kin --fps 50 --out a.{other}"));
        let read = |name: &str| kinesic_host::moves::read(&at.join(name), &Default::default()).unwrap();
        let (table, other) = (read("a.csv"), read(&format!("a.{other}")));
        for (at, channel) in table.channels.iter().enumerate() {
            let to = other.find(&channel.name).unwrap();
            let apart =
                (0..300).map(|frame| (table.frame(frame)[at] - other.frame(frame)[to]).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-9, "{}: {apart}", channel.name);
        }
    }
    done(at, "train translate --robot r.kin --pair a.csv b.csv --out style.kin");
    done(at, "apply style.kin c.csv --out out.csv");
    let robot = Robot::parse(&canted()).unwrap();
    let out = kinesic_host::moves::read(&at.join("out.csv"), &Default::default()).unwrap();
    for (index, channel) in out.channels.iter().enumerate() {
        let joint = &robot.joints[self::at(&robot, &channel.name)];
        let range = joint.lower.unwrap() - 1e-6..=joint.upper.unwrap() + 1e-6;
        assert!((0..out.frames()).all(|frame| range.contains(&out.frame(frame)[index])), "{}", channel.name);
    }
    // The weary arms swing less: the style has learned it.
    let swing = |name: &str| {
        let moves = kinesic_host::moves::read(&at.join(name), &Default::default()).unwrap();
        let pitch = moves.find("left_shoulder_pitch").unwrap();
        let values: Vec<f64> = (100..moves.frames()).map(|frame| moves.frame(frame)[pitch]).collect();
        values.iter().fold(f64::MIN, |a, b| a.max(*b)) - values.iter().fold(f64::MAX, |a, b| a.min(*b))
    };
    assert!(swing("b.csv") < 0.7 * swing("a.csv"), "{} of {}", swing("b.csv"), swing("a.csv"));
    assert!(swing("out.csv") < 0.8 * swing("c.csv"), "{} of {}", swing("out.csv"), swing("c.csv"));
}

#[test]
fn what_the_command_prints_is_said_in_both_ways() {
    let folder = folder();
    let at = folder.path();
    let text = done(at, "robot retarget r.urdf a.bvh");
    for part in ["l_upper_arm", "0 values and 0 speeds beyond a limit", "% of a speed limit", "the map is the one"] {
        assert!(text.contains(part), "no '{part}': {text}");
    }
    std::fs::write(at.join("map.toml"), format!("{ARMS}[hold]\nleft_elbow = -2.0\n")).unwrap();
    let report = json(&done(at, "robot retarget r.urdf a.bvh --map map.toml --json"));
    let cannot = report["cannot"].to_string();
    assert!(cannot.contains("l_forearm: more than 10 degrees off in 100 % of the frames"), "{cannot}");
    std::fs::write(at.join("m.csv"), "time_s,left_elbow_rad\n0,0\n0.1,0.1\n").unwrap();
    let moves = run(at, &["robot", "retarget", "r.urdf", "m.csv"]);
    assert!(String::from_utf8_lossy(&moves.stderr).contains("expected a person's"), "{moves:?}");
}

#[test]
fn a_pack_is_a_robot_and_keeps_its_table() {
    let folder = folder();
    let at = folder.path();
    let table = "[[servo]]\nname = \"left_elbow\"\nunit = \"deg\"\nmin = -40\nmax = 0\nspeed = 30\n";
    std::fs::write(at.join("servos.toml"), table).unwrap();
    // A pack has no wrist: it follows.
    let map = "[limbs]\nl_upper_arm = [\"left_shoulder_roll\", \"left_elbow\"]\nl_forearm = { from = \"left_elbow\", bone = [0, 0, -1] }";
    std::fs::write(at.join("map.toml"), map).unwrap();
    done(at, "robot import r.urdf --servos servos.toml --out r.kin");
    let file = kinesic_host::pack::PackFile::read(&at.join("r.kin")).unwrap();
    let machine = Machine::from_pack(&file.pack().unwrap()).unwrap().unwrap();
    let (described, packed) = (Robot::parse(&canted()).unwrap(), Robot::of_machine(&machine));
    // The pack puts its joints where the description does.
    let value = |name: &str| 0.1 * name.len() as f64 - 1.5;
    let frames = |robot: &Robot| {
        let placed = robot.placed(&|joint| value(&robot.joints[joint].name));
        ["left_elbow", "right_elbow", "head_yaw"].map(|name| placed[self::at(robot, name)])
    };
    for (a, b) in frames(&described).iter().zip(frames(&packed)) {
        assert!((a.to_homogeneous() - b.to_homogeneous()).norm() < 1e-5, "{a} {b}");
    }
    for robot in ["r.kin", "r.urdf --robot r.kin"] {
        let report = json(&done(at, &format!("robot retarget {robot} a.bvh --map map.toml --out m.csv --json")));
        assert_eq!((report["limits_exceeded"].as_u64(), report["speeds_exceeded"].as_u64()), (Some(0), Some(0)));
        let moves = kinesic_host::moves::read(&at.join("m.csv"), &Default::default()).unwrap();
        let elbow = moves.find("left_elbow").unwrap();
        let values: Vec<f64> = (0..moves.frames()).map(|frame| moves.frame(frame)[elbow]).collect();
        let bounds = f64::from((-40f64).to_radians() as f32)..=0.0;
        assert!(values.iter().all(|value| bounds.contains(value)), "{robot}: {values:?}");
        let steps = values.iter().zip(&values[1..]).zip(moves.times.iter().zip(&moves.times[1..]));
        let speed = steps.map(|((a, b), (t, u))| (b - a).abs() / (u - t)).fold(0.0, f64::max);
        assert!(speed <= 30f64.to_radians() * (1.0 + 1e-6), "{robot}: {speed}");
        done(at, "inspect m.csv --robot r.kin");
    }
}

#[test]
fn a_head_that_is_a_pose_looks_where_the_person_looks() {
    let folder = folder();
    let at = folder.path();
    let table = "name = \"mini\"\n[[servo]]\nname = \"antenna\"\nunit = \"rad\"\nmin = -3\nmax = 3\n[[pose]]\nname = \"head\"\n\
                 min = [-0.02, -0.02, -0.02, -0.7, -0.7, -3.1]\nmax = [0.02, 0.02, 0.02, 0.7, 0.7, 3.1]\n";
    std::fs::write(at.join("mini.toml"), table).unwrap();
    std::fs::write(at.join("map.toml"), "[limbs]\nhead = \"head_roll\"\n").unwrap();
    done(at, "robot import mini.toml --out mini.kin");
    // A head that turns by a known angle.
    let mut clip = walk(&Manner::NEUTRAL, 2.0, 60.0, 0.0, 1);
    let (n, head) = (clip.skeleton.len(), clip.skeleton.find("Head").unwrap());
    let hips = clip.skeleton.find("Hips").unwrap();
    for frame in 0..clip.frames() {
        for joint in 0..n {
            clip.rotations[frame * n + joint] = UnitQuaternion::identity();
        }
        clip.rotations[frame * n + hips] = UnitQuaternion::new(Vector3::y() * 0.01 * frame as f64);
        let yaw = 0.5 * (frame as f64 / 40.0).sin();
        clip.rotations[frame * n + head] = UnitQuaternion::new(Vector3::y() * yaw);
    }
    std::fs::write(at.join("look.bvh"), clip.to_bvh(&WriteOptions::default()).unwrap()).unwrap();
    let report = json(&done(at, "robot retarget mini.kin look.bvh --map map.toml --out look.csv --json"));
    assert!(report["limbs"][0]["p95"].as_f64().unwrap() < 0.1, "{report}");
    let moves = kinesic_host::moves::read(&at.join("look.csv"), &Default::default()).unwrap();
    let yaw = moves.find("head_yaw").unwrap();
    for frame in 0..moves.frames() {
        let expected = 0.5 * (frame as f64 / 40.0).sin();
        assert!((moves.frame(frame)[yaw] - expected).abs() < 5e-3, "frame {frame}");
    }
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
