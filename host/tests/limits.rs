//! Joint limits from robots that we made up: geometry against the robot's own kinematics, every refusal, the command.

use std::path::Path;
use std::process::{Command, Output};

use kinesic::limit::Plain;
use kinesic::rig::JointKind;
use kinesic::{Pipeline, PipelineState, Pose};
use kinesic_host::clip::{JointMap, WriteOptions};
use kinesic_host::gait::{self, Manner, walk};
use kinesic_host::limit::onto_body::{Import, Rates, RobotMap, import};
use kinesic_host::limit::{HostLimiter, JointLimit, LimitsModel};
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::rig::{MAX_JOINTS, MAX_ROWS, Rig};
use kinesic_host::robot::{Robot, RobotError};
use kinesic_host::translate::{FormChoice, HostTranslator, TrainOptions, TrainPair, train};
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

const KINESIC: &str = env!("CARGO_BIN_EXE_kinesic");

/// Two arms that hang down at zero; the left one is whole, with a gripper that follows the wrist.
const URDF: &str = r#"<?xml version="1.0"?>
<robot name="made">
  <link name="base"/><link name="torso"/><link name="l1"/><link name="l2"/><link name="l_upper"/><link name="l_fore"/>
  <link name="l_hand"/><link name="l_finger"/><link name="r1"/><link name="r2"/><link name="r_upper"/><link name="r_fore"/>
  <joint name="waist" type="revolute"><parent link="base"/><child link="torso"/><origin xyz="0 0 0.1"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="4" effort="30"/></joint>
  <joint name="l_pitch" type="revolute"><parent link="torso"/><child link="l1"/><origin xyz="0 0.2 0.4"/><axis xyz="0 1 0"/>
    <limit lower="-3.0" upper="1.5" velocity="7" effort="20"/></joint>
  <joint name="l_roll" type="revolute"><parent link="l1"/><child link="l2"/><axis xyz="1 0 0"/>
    <limit lower="-0.3" upper="2.9" velocity="7" effort="20"/></joint>
  <joint name="l_yaw" type="revolute"><parent link="l2"/><child link="l_upper"/><axis xyz="0 0 1"/>
    <limit lower="-1.5" upper="1.5" velocity="8" effort="10"/></joint>
  <joint name="l_elbow" type="revolute"><parent link="l_upper"/><child link="l_fore"/><origin xyz="0 0 -0.25"/><axis xyz="0 1 0"/>
    <limit lower="-2.4" upper="0" velocity="9" effort="10"/></joint>
  <joint name="l_wrist" type="continuous"><parent link="l_fore"/><child link="l_hand"/><origin xyz="0 0 -0.22"/><axis xyz="0 0 2"/>
    <limit velocity="10" effort="2"/></joint>
  <joint name="l_grip" type="revolute"><parent link="l_hand"/><child link="l_finger"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.5" velocity="1" effort="2"/><mimic joint="l_wrist" multiplier="-0.2" offset="0.3"/></joint>
  <joint name="r_pitch" type="revolute"><parent link="torso"/><child link="r1"/><origin xyz="0 -0.2 0.4"/><axis xyz="0 1 0"/>
    <limit lower="-3.0" upper="1.5" velocity="7" effort="20"/></joint>
  <joint name="r_roll" type="revolute"><parent link="r1"/><child link="r2"/><origin xyz="0 0 0" rpy="0 0 0.3"/><axis xyz="1 0 0"/>
    <limit lower="-2.9" upper="0.3" velocity="7" effort="20"/></joint>
  <joint name="r_weld" type="fixed"><parent link="r2"/><child link="r_upper"/></joint>
  <joint name="r_elbow" type="revolute"><parent link="r_upper"/><child link="r_fore"/><origin xyz="0 0 -0.25" rpy="0 0 1.5708"/>
    <axis xyz="-1 0 0"/><limit lower="-2.4" upper="0" velocity="9" effort="10"/>
    <safety_controller soft_lower_limit="-2" soft_upper_limit="0.5" k_velocity="10"/></joint>
</robot>
"#;

const MAP: &str = r#"acceleration = 20.0
[joints]
spine = "waist"
l_shoulder = ["l_pitch", "l_roll", "l_yaw"]
l_elbow = "l_elbow"
l_wrist = { urdf = "l_wrist", acceleration = 60 }
r_elbow = "r_elbow"
"#;

fn rig() -> Rig {
    let skeleton = gait::skeleton();
    Rig::new(&skeleton, &JointMap::detect(&skeleton).unwrap()).unwrap()
}

fn made(urdf: &str, map: &str) -> Result<Import, RobotError> {
    import(&Robot::parse(urdf)?, &RobotMap::parse(map)?, &rig(), "made", 60.0, Rates::default())
}

/// `text` with `from` replaced, which must be there.
fn swap(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "no {from}");
    text.replacen(from, to, 1)
}

fn joint(name: &str) -> usize {
    gait::skeleton().find(name).unwrap_or_else(|| panic!("no {name}"))
}

/// Orientation of the link beyond a joint, angles as given by name: the robot's own kinematics, written again.
fn link(robot: &Robot, name: &str, angle: &dyn Fn(&str) -> f64) -> UnitQuaternion<f64> {
    let at = robot.find(name).unwrap();
    robot.chain(at).fold(UnitQuaternion::identity(), |beyond, at| {
        let joint = &robot.joints[at];
        joint.origin.rotation
            * UnitQuaternion::from_axis_angle(&Unit::new_normalize(joint.axis), angle(&joint.name))
            * beyond
    })
}

/// Local rotation of a limit's coordinates.
fn local(limit: &JointLimit, angles: &[f64]) -> UnitQuaternion<f64> {
    let [i, j, k, w] = limit.coordinates.reference.map(f64::from);
    let reference = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, i, j, k));
    angles.iter().zip(limit.coordinates.axes).fold(reference, |q, (angle, axis)| {
        q * UnitQuaternion::from_scaled_axis(Vector3::from(axis).cast::<f64>() * *angle)
    })
}

#[test]
fn servo_angles_turn_the_skeleton_as_they_turn_the_robot() {
    let robot = Robot::parse(URDF).unwrap();
    let Import { model, urdf, .. } = made(URDF, MAP).unwrap();
    let skeleton = gait::skeleton();
    let arm = joint("LeftArm");
    assert_eq!(model.joints[arm].coordinates.kind, JointKind::Chain);
    assert_eq!(urdf[arm], ["l_pitch", "l_roll", "l_yaw"]);
    // Robot: x forward, y left, z up. Skeleton: z forward, x left, y up.
    let to_world = |q: UnitQuaternion<f64>| {
        let v = q.scaled_axis();
        UnitQuaternion::from_scaled_axis(Vector3::new(v.y, v.z, v.x))
    };
    // World rotation of a joint of the skeleton, all mapped joints at these angles.
    let world = |name: &str, angle: &dyn Fn(&str) -> f64| {
        let chain = std::iter::successors(Some(joint(name)), |at| skeleton.joints[*at].parent);
        chain.fold(UnitQuaternion::identity(), |beyond, at| {
            let angles: Vec<f64> = urdf[at].iter().map(|name| angle(name)).collect();
            local(&model.joints[at], &angles) * beyond
        })
    };
    let pairs = [
        ("Spine", "waist"),
        ("LeftArm", "l_yaw"),
        ("LeftForeArm", "l_elbow"),
        ("LeftHand", "l_wrist"),
        ("RightForeArm", "r_elbow"),
    ];
    for step in 0..50 {
        let angle = |name: &str| {
            let at = robot.find(name).unwrap();
            // What is not in the map stands at zero.
            if ["r_pitch", "r_roll", "r_weld", "l_grip"].contains(&name) {
                0.0
            } else {
                ((1 + step) as f64 * (at as f64 + 0.7)).sin()
            }
        };
        for (bone, last) in pairs {
            let robot_turn = link(&robot, last, &angle) * link(&robot, last, &|_| 0.0).inverse();
            let turn = world(bone, &angle) * world(bone, &|_| 0.0).inverse();
            let apart = turn.angle_to(&to_world(robot_turn));
            assert!(apart < 1e-5, "{bone}, {last}: {apart} rad apart");
        }
    }
    // The skeleton's arms are level at rest; the robot's hang.
    let fore = skeleton.joints[joint("LeftForeArm")].offset;
    let down = world("LeftArm", &|_| 0.0) * fore.normalize();
    assert!((down + Vector3::y()).norm() < 1e-5, "the upper arm points to {down}");
}

#[test]
fn on_the_device_every_angle_is_reached_and_none_passed() {
    let Import { model, urdf, .. } = made(URDF, MAP).unwrap();
    let tables = model.tables(&rig()).unwrap();
    let pipeline = Pipeline::new(tables.rig().frames(), tables.limiter::<MAX_ROWS, Plain>().unwrap()).unwrap();
    let mut state = PipelineState::new();
    let (mut pose, mut out) = (Pose::<MAX_JOINTS>::identity(), Pose::identity());
    let first = |name: &str| tables.rig().frames().places().nth(joint(name)).unwrap().1;
    for (wanted, expected) in [([-2.0, 1.0, 0.5], [-2.0, 1.0, 0.5]), ([0.5, -1.0, 0.5], [0.5, -0.3, 0.5])] {
        for (at, names) in urdf.iter().enumerate() {
            let angles = if names.len() == 3 { wanted.to_vec() } else { vec![-0.4; names.len()] };
            pose.rotations[at] = local(&model.joints[at], &angles).cast();
        }
        for _ in 0..pipeline.engine.recovery_frames() {
            pipeline.step(&mut state, Some(&pose), &mut out);
        }
        let found = &state.shown().coordinates()[first("LeftArm")..][..3];
        assert!(found.iter().zip(expected).all(|(x, y): (_, f32)| (x - y).abs() < 1e-4), "{found:?}, {expected:?}");
        assert!((state.shown().coordinates()[first("LeftForeArm")] + 0.4).abs() < 1e-4);
    }
}

#[test]
fn bounds_and_rates_are_the_urdf_s_and_the_tighter_wins() {
    let Import { model, notes, .. } = made(URDF, MAP).unwrap();
    let of = |name: &str| model.joints[joint(name)];
    let near = |a: f32, b: f64| (f64::from(a) - b).abs() < 1e-6;
    let arm = of("LeftArm");
    assert_eq!((arm.lower, arm.upper, arm.velocity), ([-3.0, -0.3, -1.5], [1.5, 2.9, 1.5], [7.0, 7.0, 8.0]));
    assert_eq!(arm.acceleration, [20.0; 3]);
    assert_eq!(arm.coordinates.middle.map(|x| (x * 1e4).round()), [-7.5e3, 1.3e4, 0.0]);
    // The gripper is 0.3 - 0.2 x, within 0 .. 0.5, at 1 rad/s.
    let wrist = of("LeftHand");
    assert!(near(wrist.lower[0], -1.0) && near(wrist.upper[0], 1.5) && near(wrist.velocity[0], 5.0), "{wrist:?}");
    assert_eq!(wrist.acceleration[0], 60.0);
    assert!(notes.iter().any(|note| note.contains("continuous")) && notes.iter().any(|note| note.contains("l_grip")));
    // The soft limit is the tighter one below, the hard one above.
    assert!(near(of("RightForeArm").lower[0], -2.0) && near(of("RightForeArm").upper[0], 0.0));
    // What is not in the map is free, at the rate of the fastest servo.
    assert!(of("Head").is_free());
    assert_eq!(of("Head").velocity, [9.0; 3]);
    let fixed = made(URDF, &format!("unmapped = \"fixed\"\n{MAP}")).unwrap().model;
    assert_eq!(fixed.joints[joint("Head")].coordinates.kind, JointKind::Fixed);
    assert!(fixed.joints[0].is_free());
    // The root stands between the ground and twice its height, unless the map says otherwise.
    let height = model.height;
    assert_eq!((height.lower, height.upper, height.velocity), (0.0, 2.0 * height.rest, model.meta.root_velocity));
    assert!((0.7..1.2).contains(&height.rest), "{height:?}");
    let map = format!("height = [0.2, 0.5]\nheading_velocity = 3.0\n{MAP}");
    let low = made(URDF, &map).unwrap().model;
    assert_eq!((low.height.lower, low.height.upper, low.height.rest), (0.2, 0.5, 0.5));
    assert_eq!(low.meta.heading_velocity, 3.0);
}

#[test]
fn two_hinges_odd_angles_and_whole_turns_are_taken() {
    let two = made(URDF, &swap(MAP, "r_elbow =", "r_shoulder = [\"r_pitch\", \"r_roll\"]\nr_elbow =")).unwrap_err();
    // The roll stands 0.3 rad off: not at right angles.
    assert!(two.to_string().contains("72.8 degrees apart, expected 90"), "{two}");
    let straight = swap(URDF, "rpy=\"0 0 0.3\"", "rpy=\"0 0 0.003\"");
    let two = made(&straight, &swap(MAP, "r_elbow =", "r_shoulder = [\"r_pitch\", \"r_roll\"]\nr_elbow =")).unwrap();
    let arm = two.model.joints[joint("RightArm")];
    assert_eq!((arm.coordinates.kind, arm.lower[2], arm.upper[2]), (JointKind::Chain, 0.0, 0.0));
    assert!(two.notes.iter().any(|note| note.contains("axis turned by 0.17 degrees")), "{:?}", two.notes);
    let ball = swap(MAP, "l_shoulder = [", "l_shoulder = { kind = \"ball\", urdf = [");
    let ball = made(URDF, &swap(&ball, "\"l_yaw\"]", "\"l_yaw\"] }")).unwrap();
    // Pitch is about the skeleton's x, roll about z, yaw about y; at zero the arm hangs, a quarter turn from rest.
    let arm = ball.model.joints[joint("LeftArm")];
    assert_eq!((arm.coordinates.kind, arm.is_free()), (JointKind::Ball, false));
    let rows: Vec<[f32; 2]> = arm.lower.into_iter().zip(arm.upper).map(<[f32; 2]>::from).collect();
    let named = |name: &str| rows[ball.urdf[joint("LeftArm")].iter().position(|found| found == name).unwrap()];
    let either = |found: [f32; 2], [lower, upper]: [f32; 2]| found == [lower, upper] || found == [-upper, -lower];
    assert!(either(named("l_pitch"), [-3.0, 1.5]) && either(named("l_roll"), [-0.3, 2.9]), "{rows:?}");
    assert_eq!(named("l_yaw"), [-1.5, 1.5]);
    one_turn_of_a_ball(&ball, "l_pitch");
    let skew = swap(
        &swap(URDF, "<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0.8 0.6\"/>"),
        "<axis xyz=\"0 0 1\"/>\n    <limit lower=\"-1.5\"",
        "<axis xyz=\"0 -0.6 0.8\"/>\n    <limit lower=\"-1.5\"",
    );
    let map =
        swap(&swap(MAP, "l_shoulder = [", "l_shoulder = { kind = \"ball\", urdf = ["), "\"l_yaw\"]", "\"l_yaw\"] }");
    says(&made(&skew, &map).unwrap_err(), &["l_shoulder", "own axes", "chain"], "skew");
    let turns = made(&swap(URDF, "lower=\"-1\" upper=\"1\"", "lower=\"-6.28\" upper=\"6.28\""), MAP).unwrap();
    let waist = turns.model.joints[joint("Spine")];
    assert!(waist.upper[0] - waist.lower[0] <= std::f32::consts::TAU && waist.lower[0] < -3.1, "{waist:?}");
    assert!(turns.notes.iter().any(|note| note.contains("more than a turn")), "{:?}", turns.notes);
}

#[test]
fn other_conventions_of_axes_give_the_same_table() {
    // The same robot with z forward, x left, y up: v' = (v.y, v.z, v.x).
    let turn = Isometry3::from_parts(Translation3::identity(), {
        let columns: [Vector3<f64>; 3] = [Vector3::z(), Vector3::x(), Vector3::y()];
        UnitQuaternion::from_basis_unchecked(&columns)
    });
    let (roll, pitch, yaw) = turn.rotation.euler_angles();
    let world = format!(
        "<link name=\"world\"/><joint name=\"up\" type=\"fixed\"><parent link=\"world\"/><child link=\"base\"/>\
         <origin rpy=\"{roll} {pitch} {yaw}\"/></joint><joint name=\"waist\""
    );
    let other = swap(URDF, "<joint name=\"waist\"", &world);
    let map = format!("forward = \"z\"\nup = \"y\"\n{MAP}");
    let (a, b) = (made(URDF, MAP).unwrap().model, made(&other, &map).unwrap().model);
    for (a, b) in a.joints.iter().zip(&b.joints) {
        let apart = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        let (to, from) = (a.coordinates, b.coordinates);
        assert!(apart(to.axes.as_flattened(), from.axes.as_flattened()) < 1e-5);
        assert!(apart(&to.reference, &from.reference) < 1e-5);
        assert_eq!((a.lower, a.upper), (b.lower, b.upper));
    }
}

#[test]
fn every_refusal_names_place_cause_and_next_step() {
    let limit = "<limit lower=\"-1\" upper=\"1\" velocity=\"4\" effort=\"30\"/>";
    let loops = "<joint name=\"bad\" type=\"fixed\"><parent link=\"r_fore\"/><child link=\"base\"/></joint></robot>";
    let two = "<joint name=\"bad\" type=\"fixed\"><parent link=\"base\"/><child link=\"l_fore\"/></joint></robot>";
    let island = "<link name=\"i1\"/><link name=\"i2\"/><joint name=\"a\" type=\"fixed\"><parent link=\"i1\"/><child link=\"i2\"/></joint>\
                  <joint name=\"b\" type=\"fixed\"><parent link=\"i2\"/><child link=\"i1\"/></joint></robot>";
    let urdfs: [(&str, &str, &[&str]); 22] = [
        ("</robot>", "", &["not XML", "line"]),
        ("<robot name=\"made\">", "<robot name=\"&lol;\">", &["not XML", "lol"]),
        ("<robot name=\"made\">", "<robot xmlns:xacro=\"http://ros.org/xacro\"><xacro:arm/>", &["xacro", "line 2"]),
        ("</robot>", loops, &["loop of joints", "bad", "waist"]),
        ("</robot>", island, &["loop of joints", "a", "b"]),
        ("</robot>", two, &["'l_elbow'", "one parent"]),
        ("link name=\"l_fore\"", "link name=\"l_for\"", &["l_elbow", "child link 'l_fore' is not in the file"]),
        ("<parent link=\"base\"/>", "", &["waist", "<parent link"]),
        ("name=\"l_roll\"", "name=\"l_pitch\"", &["line 9", "l_pitch", "line 7", "rename"]),
        ("name=\"waist\" ", "", &["without a name"]),
        ("name=\"waist\" type=\"revolute\"", "name=\"waist\" type=\"hinge\"", &["waist", "'hinge'", "revolute"]),
        (limit, "", &["waist", "no bounds", "lower and upper"]),
        (limit, "<limit velocity=\"4\"/>", &["waist", "no bounds"]),
        (limit, "<limit lower=\"-1\" upper=\"1\"/>", &["waist", "no velocity", "--velocity"]),
        (limit, "<limit lower=\"-1\" upper=\"1\" velocity=\"0\"/>", &["waist", "velocity=\"0\"", "above 0"]),
        (limit, "<limit lower=\"1\" upper=\"-1\" velocity=\"4\"/>", &["waist", "lower 1 above upper -1"]),
        (limit, "<limit lower=\"-90\" upper=\"90\" velocity=\"4\"/>", &["waist", "radians", "degrees"]),
        (limit, "<limit lower=\"nan\" upper=\"1\" velocity=\"4\"/>", &["waist", "lower=\"nan\"", "finite"]),
        ("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 0\"/>", &["waist", "length zero"]),
        ("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 1\"/>", &["waist", "three numbers"]),
        ("name=\"waist\" type=\"revolute\"", "name=\"waist\" type=\"prismatic\"", &["spine", "'waist'", "prismatic"]),
        ("name=\"waist\" type=\"revolute\"", "name=\"waist\" type=\"fixed\"", &["spine", "'waist'", "type 'fixed'"]),
    ];
    for (from, to, words) in urdfs {
        let error = made(&swap(URDF, from, to), MAP).unwrap_err();
        says(&error, words, to);
    }
    let error = Robot::parse("<sdf version=\"1.6\"/>").unwrap_err();
    says(&error, &["<sdf>", "expected <robot>"], "sdf");
    says(&Robot::parse("").unwrap_err(), &["not XML"], "nothing");
    says(&Robot::parse("<robot name='x'/>").unwrap_err(), &["no joint"], "no joint");
    let maps: [(&str, &str, &[&str]); 23] = [
        ("acceleration = 20.0", "acceleration = 20.0\nheight = 1", &["height", "found 1", "[0.3, 0.8]"]),
        ("acceleration = 20.0", "acceleration = 20.0\nheight = [0, 500]", &["height", "refused"]),
        ("acceleration = 20.0", "acceleration = 20.0\nfrozen = 1", &["frozen", "expected: acceleration"]),
        ("spine =", "Hips =", &["Hips", "root", "next joint"]),
        ("acceleration = 20.0", "", &["waist", "no acceleration", "--acceleration"]),
        ("acceleration = 20.0", "acceleration = -1", &["acceleration", "-1", "from 0 up"]),
        ("acceleration = 20.0", "acceleration = 0", &["Hips", "acceleration"]),
        ("acceleration = 20.0", "accelaration = 20.0", &["accelaration", "did you mean 'acceleration'"]),
        ("acceleration = 20.0", "up = \"w\"", &["up", "\"w\"", "expected one of"]),
        ("acceleration = 20.0", "forward = \"z\"", &["forward", "square"]),
        ("acceleration = 20.0", "acceleration 20", &["not TOML"]),
        ("[joints]", "[joint]", &["'joint'", "did you mean 'joints'"]),
        ("\"waist\"", "3", &["spine", "found 3", "name of a robot joint"]),
        ("\"waist\"", "\"wais\"", &["spine", "no joint 'wais'", "did you mean 'waist'"]),
        ("\"waist\"", "\"l_grip\"", &["spine", "l_grip", "follows 'l_wrist'", "map 'l_wrist' instead"]),
        ("\"l_roll\", \"l_yaw\"", "\"l_roll\", \"l_roll\"", &["l_roll", "belongs to 'l_shoulder'"]),
        ("\"waist\"", "[]", &["spine", "no robot joint"]),
        ("spine =", "spin =", &["spin", "did you mean 'Spine'"]),
        ("spine =", "LeftArm =", &["LeftArm", "already"]),
        ("[\"l_pitch\", \"l_roll\", \"l_yaw\"]", "[\"l_roll\", \"l_pitch\"]", &["not carried by 'l_roll'", "outwards"]),
        ("l_wrist = {", "l_wrist = { speed = 3,", &["l_wrist", "'speed'", "expected: urdf"]),
        ("l_wrist = {", "l_wrist = { lower = [1, 2],", &["l_wrist, lower", "[1, 2]", "one a robot joint"]),
        ("l_wrist = {", "l_wrist = { kind = \"chain\",", &["l_wrist", "found 1 robot joints", "chain"]),
    ];
    for (from, to, words) in maps {
        let error = made(URDF, &swap(MAP, from, to)).unwrap_err();
        says(&error, words, to);
    }
    says(&made(URDF, "[joints]\n").unwrap_err(), &["no joint"], "empty");
    says(&made(URDF, "hold = 1\n").unwrap_err(), &["no table [joints]"], "no table");
}

fn says(error: &RobotError, words: &[&str], what: &str) {
    let text = format!("{error} {}", error.help);
    for word in words {
        assert!(text.contains(word), "{what}: no '{word}' in: {text}");
    }
    assert!(!error.help.is_empty());
}

/// A pitch of the ball `l_shoulder` is that of the chain.
fn one_turn_of_a_ball(ball: &Import, name: &str) {
    let (arm, angle) = (joint("LeftArm"), 0.4);
    let at = ball.urdf[arm].iter().position(|found| found == name).unwrap();
    let ball = ball.model.joints[arm];
    let sign = if ball.lower[at] == -3.0 { 1.0 } else { -1.0 };
    let mut vector = Vector3::zeros();
    vector[at] = sign * angle;
    let turned = local(&ball, &[]) * UnitQuaternion::from_scaled_axis(vector);
    let chain = made(URDF, MAP).unwrap().model.joints[arm];
    assert!(turned.angle_to(&local(&chain, &[angle])) < 1e-5);
}

/// A style pack on a rig.
fn style(rig: &Rig) -> Vec<u8> {
    let locals = |manner| rig.locals(&rig.poses(&walk(manner, 3.0, 60.0, 0.0, 1)));
    let pair = TrainPair {
        source_name: "neutral".into(),
        target_name: "weary".into(),
        source: locals(&Manner::NEUTRAL),
        target: locals(&Manner::WEARY),
    };
    let options =
        TrainOptions { form: FormChoice::PerJoint, order: Some(2), mirror: Some(false), ..TrainOptions::default() };
    let trained = train(rig, &[pair], "weary", 60.0, &options, &|_| {}).unwrap();
    trained.model.pack(rig, &Provenance::default())
}

fn run(folder: &Path, line: &str) -> Output {
    let output = Command::new(KINESIC).args(line.split(' ')).current_dir(folder).output().unwrap();
    assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

#[test]
fn the_command_makes_packs_and_tables() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("robot.urdf"), URDF).unwrap();
    std::fs::write(at.join("map.toml"), MAP).unwrap();
    let bvh = walk(&Manner::NEUTRAL, 2.0, 60.0, 0.0, 1).to_bvh(&WriteOptions::default()).unwrap();
    std::fs::write(at.join("walk.bvh"), bvh).unwrap();
    // A style that knows nothing of the robot.
    std::fs::write(at.join("weary.kin"), style(&rig())).unwrap();

    let expected = made(URDF, MAP).unwrap().model;
    let load = |name: &str| PackFile::read(&at.join(name)).unwrap();
    let made = |line: &str| run(at, &format!("limits robot.urdf --map map.toml {line}"));
    made("--skeleton weary.kin --out a.kin");
    let file = load("a.kin");
    assert_eq!(LimitsModel::from_pack(&file.pack().unwrap()).unwrap(), expected);
    made("--skeleton walk.bvh --out b.kin --fps 50 --json");
    let file = load("b.kin");
    let from_clip = LimitsModel::from_pack(&file.pack().unwrap()).unwrap();
    // The bones of a clip are written in text.
    assert_eq!((from_clip.frame_rate, from_clip.joints[10].upper), (50.0, expected.joints[10].upper));

    // Engines keep the coordinates on which they were trained: a style of balls is not limited as hinges.
    let line = "limits robot.urdf --map map.toml --with weary.kin --out c.kin";
    let output = Command::new(KINESIC).args(line.split(' ')).current_dir(at).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr).replace("\n", " ");
    assert!(!output.status.success() && !at.join("c.kin").exists());
    for word in ["weary.kin", "'Spine'", "ball", "hinge", "--limits", "two pipelines"] {
        assert!(text.contains(word), "no '{word}' in: {text}");
    }

    // Style and limits in one pack: the device takes it whole. Limits put in twice are there once.
    std::fs::write(at.join("limited.kin"), style(&expected.rig(&rig()).unwrap())).unwrap();
    made("--with limited.kin --out c.kin");
    made("--with c.kin --out d.kin --acceleration 10");
    let file = load("d.kin");
    let pack = file.pack().unwrap();
    let models = pack.metadata().models;
    assert_eq!(models.iter().filter(|model| model.limits().is_some()).count(), 1);
    let tensors: Vec<&str> = pack.metadata().tensors.iter().map(|tensor| tensor.name).collect();
    let once = tensors.iter().collect::<std::collections::HashSet<_>>().len();
    assert_eq!(once, tensors.len(), "{tensors:?}");
    let pipeline = Pipeline::<(HostTranslator, HostLimiter), MAX_ROWS>::load(&pack).unwrap();
    let mut state = PipelineState::new();
    let (mut out, source) = (Pose::<19>::identity(), Pose::identity());
    pipeline.step(&mut state, Some(&source), &mut out);
    let first = pipeline.rig().places().nth(joint("LeftArm")).unwrap().1;
    assert_eq!(pipeline.engine.1.table().acceleration[first / 3], [10.0; 3]);
    assert!(file.provenance().unwrap().notes.contains(&"limits of LeftArm: l_pitch, l_roll, l_yaw".to_owned()));
    assert!(out.is_sound(19));

    // Tables in three formats, of a pack and of a robot, say the same.
    let shown = String::from_utf8(run(at, "limits a.kin").stdout).unwrap();
    assert!(shown.contains("LeftArm          chain    -3.000    1.500"), "{shown}");
    let printed: serde_json::Value =
        serde_json::from_slice(&run(at, "limits a.kin --out t.json --json").stdout).unwrap();
    let table: serde_json::Value = serde_json::from_slice(&std::fs::read(at.join("t.json")).unwrap()).unwrap();
    assert_eq!(table["joints"], printed["joints"]);
    let arm = &table["joints"][joint("LeftArm")];
    assert_eq!((arm["kind"].as_str(), arm["upper"][1].as_f64()), (Some("chain"), Some(2.9)));
    run(at, "limits a.kin --out t.toml");
    let toml: toml::Table = std::fs::read_to_string(at.join("t.toml")).unwrap().parse().unwrap();
    assert_eq!(toml["joints"].as_array().unwrap().len(), 19);
    made("--skeleton weary.kin --out t.csv");
    let text = std::fs::read_to_string(at.join("t.csv")).unwrap();
    let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
    assert!(lines.iter().all(|line| line.len() == lines[0].len()));
    assert!(lines.iter().any(|line| line[..4] == ["LeftArm", "chain", "2", "l_yaw"]), "{text}");
    // The same command writes the same bytes.
    let first = std::fs::read(at.join("a.kin")).unwrap();
    made("--skeleton weary.kin --out a.kin");
    assert_eq!(std::fs::read(at.join("a.kin")).unwrap(), first);
}
