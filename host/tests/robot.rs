//! Robots of MJCF and URDF: what is read, where its links are, what is refused.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_3, FRAC_PI_4};
use std::path::Path;
use std::process::Command;

use kinesic_host::robot::{Defaults, Machine, Motion, Robot, RobotError, ServoTable};
use nalgebra::{Isometry3, Vector3};

/// A body with two arms at canted shoulders, a slider that another follows, and several joints in a body.
const MJCF: &str = r#"<mujoco model="made">
  <compiler angle="degree" eulerseq="xyz"/>
  <default>
    <joint range="-90 90"/>
    <default class="arm">
      <joint axis="0 1 0"/>
      <default class="slow"><joint range="-30 60"/></default>
    </default>
    <default class="finger"><joint type="slide" axis="1 0 0" range="0 0.04"/></default>
  </default>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="pelvis" pos="0 0 0.8">
      <freejoint name="floating"/>
      <body name="torso" pos="0 0 0.1" childclass="arm">
        <body name="shoulder" pos="0 0.2 0.3" euler="45 0 0">
          <joint name="pitch"/>
          <joint name="roll" class="slow" axis="1 0 0" pos="0 0.1 0"/>
          <body name="fore" pos="0 0.3 0" quat="1 0 0 0">
            <joint name="elbow" axis="0 0 2" ref="90" range="0 120"/>
          </body>
        </body>
      </body>
      <body name="left" pos="0 0.05 0" childclass="finger"><joint name="grip"/></body>
      <body name="right" pos="0 -0.05 0" axisangle="0 0 1 180" childclass="finger"><joint name="grip2"/></body>
    </body>
  </worldbody>
  <equality><joint joint1="grip2" joint2="grip" polycoef="0.01 0.5 0 0 0"/></equality>
</mujoco>"#;

fn near(found: Vector3<f64>, expected: [f64; 3], what: &str) {
    assert!((found - Vector3::from(expected)).norm() < 1e-9, "{what}: {found:?}, expected {expected:?}");
}

fn link(robot: &Robot, values: &[(&str, f64)], name: &str) -> Isometry3<f64> {
    let mut own = vec![0.0; robot.joints.len()];
    for (joint, value) in values {
        own[robot.find(joint).unwrap()] = *value;
    }
    let values = robot.followed(&own);
    let at = robot.joints.iter().position(|joint| joint.child == name).unwrap();
    robot.placed(&|joint| values[joint])[at]
}

fn says(error: &RobotError, words: &[&str]) {
    let text = format!("{error} {}", error.help);
    for word in words {
        assert!(text.contains(word), "no '{word}' in: {text}");
    }
}

#[test]
fn an_mjcf_has_the_joints_and_ranges_that_its_classes_say() {
    let robot = Robot::parse(MJCF).unwrap();
    let joint = |name: &str| &robot.joints[robot.find(name).unwrap()];
    assert_eq!((robot.name.as_str(), robot.root().as_deref()), ("made", Some("pelvis")));
    assert_eq!(joint("pitch").axis, Vector3::y());
    assert_eq!((joint("pitch").lower, joint("pitch").upper), (Some(-FRAC_PI_2), Some(FRAC_PI_2)));
    assert_eq!(joint("roll").axis, Vector3::x());
    assert!((joint("roll").upper.unwrap() - FRAC_PI_3).abs() < 1e-12);
    assert_eq!((joint("grip").motion, joint("grip").upper), (Motion::Prismatic, Some(0.04)));
    let mimic = joint("grip2").mimic.as_ref().unwrap();
    assert_eq!((mimic.joint.as_str(), mimic.multiplier, mimic.offset), ("grip", 0.5, 0.01));
    assert_eq!((joint("roll").base.as_str(), joint("torso").motion), ("shoulder/pitch", Motion::Fixed));
    assert!(robot.notes.iter().any(|note| note.contains("stands in the world")), "{:?}", robot.notes);
}

#[test]
fn links_of_an_mjcf_are_where_a_hand_computes_them() {
    let robot = Robot::parse(MJCF).unwrap();
    let c = FRAC_1_SQRT_2;
    near(link(&robot, &[], "shoulder").translation.vector, [0.0, 0.2, 0.4], "shoulder");
    // At 45 degrees outwards and up.
    let elbow = link(&robot, &[("elbow", FRAC_PI_2)], "fore");
    near(elbow.translation.vector, [0.0, 0.2 + 0.3 * c, 0.4 + 0.3 * c], "elbow");
    near(elbow.rotation * Vector3::y(), [0.0, c, c], "at its reference the body stands as written");
    near(link(&robot, &[], "fore").rotation * Vector3::y(), [1.0, 0.0, 0.0], "90 degrees before its reference");
    // Rolled by 45 degrees about a point 0.1 m along the arm: the rest of the arm stands upright there.
    let rolled = link(&robot, &[("roll", FRAC_PI_4), ("elbow", FRAC_PI_2)], "fore");
    near(rolled.translation.vector, [0.0, 0.2 + 0.1 * c, 0.4 + 0.1 * c + 0.2], "rolled");
    // The pitch of half a turn about the arm's own axis leaves the arm, and turns the roll about.
    let pitched = link(&robot, &[("pitch", std::f64::consts::PI), ("roll", FRAC_PI_4)], "fore");
    near(pitched.translation.vector, [0.0, 0.2 + 0.1 * c + 0.2, 0.4 + 0.1 * c], "pitched");
    // The follower: half as far, and 0.01 m, in a frame that is turned about.
    near(link(&robot, &[("grip", 0.04)], "left").translation.vector, [0.04, 0.05, 0.0], "grip");
    near(link(&robot, &[("grip", 0.04)], "right").translation.vector, [-0.03, -0.05, 0.0], "grip2");
}

#[test]
fn a_urdf_and_an_mjcf_of_one_robot_agree() {
    let urdf = r#"<robot name="one"><link name="a"/><link name="b"/><link name="c"/>
      <joint name="one" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0.1 0 0.2" rpy="0.3 0.2 0.1"/>
        <axis xyz="0 1 1"/><limit lower="-1" upper="1" velocity="2"/></joint>
      <joint name="two" type="prismatic"><parent link="b"/><child link="c"/><origin xyz="0 0.1 0"/><axis xyz="0 0 1"/>
        <limit lower="0" upper="1" velocity="2"/></joint></robot>"#;
    // Roll, pitch and yaw about axes that stay.
    let mjcf = r#"<mujoco><compiler angle="radian" eulerseq="XYZ"/><worldbody><body name="a">
      <body name="b" pos="0.1 0 0.2" euler="0.3 0.2 0.1"><joint name="one" axis="0 1 1" range="-1 1"/>
        <frame pos="0 0.1 0"><body name="c"><joint name="two" type="slide" range="0 1"/></body></frame></body>
      </body></worldbody></mujoco>"#;
    let [urdf, mjcf] = [urdf, mjcf].map(|text| Robot::parse(text).unwrap());
    for values in [[0.0, 0.0], [0.7, 0.4], [-1.0, 1.0]] {
        let placed = |robot: &Robot| robot.placed(&|at| values[at]);
        for (at, (a, b)) in placed(&urdf).iter().zip(placed(&mjcf)).enumerate() {
            assert_eq!(urdf.joints[at].child, mjcf.joints[at].child);
            assert!((a.to_homogeneous() - b.to_homogeneous()).norm() < 1e-9, "{}", urdf.joints[at].child);
        }
    }
}

#[test]
fn every_way_to_write_a_rotation_is_read() {
    let with = |rotation: &str, compiler: &str| {
        let text = format!(
            "<mujoco><compiler {compiler}/><worldbody><body name='a'><body name='b' {rotation}><joint name='j'/></body></body>\
             </worldbody></mujoco>"
        );
        link(&Robot::parse(&text).unwrap(), &[], "b").rotation
    };
    let quarter = with("quat='1 0 0 1'", "");
    near(quarter * Vector3::x(), [0.0, 1.0, 0.0], "quat");
    for (rotation, compiler) in [
        ("axisangle='0 0 3 90'", ""),
        ("euler='0 0 90'", ""),
        ("euler='1.5707963267948966 0 0'", "angle='radian' eulerseq='zxy'"),
        ("xyaxes='0 2 0 -1 1 0'", ""),
    ] {
        assert!(with(rotation, compiler).angle_to(&quarter) < 1e-9, "{rotation}");
    }
    near(with("zaxis='1 0 0'", "") * Vector3::z(), [1.0, 0.0, 0.0], "zaxis");
    near(with("zaxis='0 0 -1'", "") * Vector3::z(), [0.0, 0.0, -1.0], "zaxis down");
    // Turning along: x, then the new y.
    near(with("euler='90 90 0'", "") * Vector3::z(), [1.0, 0.0, 0.0], "intrinsic");
    near(with("euler='90 90 0'", "eulerseq='XYZ'") * Vector3::z(), [0.0, -1.0, 0.0], "extrinsic");
}

#[test]
fn included_files_are_followed_beside_the_description_only() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("defaults.xml", "<mujocoinclude>\n<default><joint range='-10 20'/></default></mujocoinclude>");
    let body = "<worldbody><body name='a'><body name='b'><joint name='j'/></body></body></worldbody>";
    write("robot.xml", &format!("<mujoco><include file='defaults.xml'/>{body}</mujoco>"));
    let robot = Robot::read(&folder.path().join("robot.xml")).unwrap();
    assert!((robot.joints[0].upper.unwrap() - 20f64.to_radians()).abs() < 1e-12);
    write("defaults.xml", "<mujocoinclude>\n<default><joint range='-10 x'/></default></mujocoinclude>");
    says(&Robot::read(&folder.path().join("robot.xml")).unwrap_err(), &["robot.xml", "defaults.xml, line 2", "-10 x"]);
    for (file, words) in [
        ("none.xml", &["line 1", "none.xml", "cannot be read"][..]),
        ("../robot.xml", &["beside this one"]),
        ("/etc/passwd", &["beside this one"]),
        ("robot2.xml", &["twice"]),
    ] {
        write("robot2.xml", &format!("<mujoco><include file='{file}'/>{body}</mujoco>"));
        says(&Robot::read(&folder.path().join("robot2.xml")).unwrap_err(), words);
    }
    says(&Robot::parse("<mujoco><include file='a.xml'/></mujoco>").unwrap_err(), &["no folder"]);
}

#[test]
fn broken_descriptions_are_refused_with_line_and_joint() {
    let swaps: [(&str, &str, &[&str]); 14] = [
        ("range=\"0 120\"", "range=\"120 0\"", &["line 20", "'elbow'", "lower bound first"]),
        ("range=\"0 120\"", "range=\"0\"", &["line 20", "'elbow'", "1 numbers, expected 2"]),
        ("ref=\"90\"", "ref=\"nan\"", &["line 20", "'elbow'", "ref=\"nan\""]),
        ("axis=\"0 0 2\"", "axis=\"0 0 0\"", &["line 20", "'elbow'", "length zero"]),
        ("class=\"slow\" axis", "class=\"fast\" axis", &["line 18", "'roll'", "class 'fast'"]),
        (
            "<joint name=\"pitch\"/>",
            "<joint name=\"pitch\" type=\"ball\"/>",
            &["line 17", "'pitch'", "ball", "three hinges"],
        ),
        ("<joint name=\"pitch\"/>", "<joint name=\"pitch\" type=\"bend\"/>", &["line 17", "'pitch'", "bend"]),
        ("<joint name=\"pitch\"/>", "<joint name=\"roll\"/>", &["line 18", "'roll'", "taken"]),
        ("quat=\"1 0 0 0\"", "quat=\"0 0 0 0\"", &["line 19", "'fore'", "length zero"]),
        ("quat=\"1 0 0 0\"", "quat=\"1 0 0 0\" euler=\"0 0 0\"", &["line 19", "both quat and euler"]),
        ("joint2=\"grip\"", "joint2=\"grap\"", &["line 28", "'grap'"]),
        ("eulerseq=\"xyz\"", "eulerseq=\"xy\"", &["line 2", "eulerseq"]),
        ("angle=\"degree\"", "angle=\"grad\"", &["line 2", "grad"]),
        (
            "</worldbody>",
            "<replicate count=\"2\"><body name=\"x\"/></replicate></worldbody>",
            &["line 27", "replicate"],
        ),
    ];
    for (from, to, words) in swaps {
        assert!(MJCF.contains(from), "{from}");
        says(&Robot::parse(&MJCF.replacen(from, to, 1)).unwrap_err(), words);
    }
    says(&Robot::parse("<sdf/>").unwrap_err(), &["<sdf>", "<robot>", "<mujoco>"]);
    says(&Robot::parse("<mujoco/>").unwrap_err(), &["no joint"]);
    // Bytes left out anywhere never panic.
    for end in 0..MJCF.len() {
        let _ = Robot::parse(&MJCF[..end]);
        let _ = Robot::parse(&format!("{}{}", &MJCF[..end], &MJCF[(end + 7).min(MJCF.len())..]));
    }
}

/// A robot of one hinge `neck_yaw` and one slider `lift`.
fn neck(bounds: &str) -> Robot {
    Robot::parse(&format!(
        r#"<robot name="neck"><link name="a"/><link name="b"/><link name="c"/>
        <joint name="neck_yaw" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><limit {bounds} velocity="2"/></joint>
        <joint name="lift" type="prismatic"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/><limit lower="0" upper="0.3" velocity="1"/></joint>
        </robot>"#
    ))
    .unwrap()
}

const DEG: &str = "[[servo]]\nname = \"pan\"\nunit = \"deg\"\nmin = -90\nmax = 90\n";
const HEAD: &str = "[[pose]]\nname = \"head\"\nmin = [-0.1, -0.1, -0.1, -1, -1, -1]\nmax = [0.1, 0.1, 0.1, 1, 1, 1]\n";

fn table(text: &str, defaults: Defaults) -> Result<Machine, RobotError> {
    Machine::of_table(&ServoTable::parse(text)?, 50.0, defaults)
}

#[test]
fn names_of_coordinates_are_told_apart() {
    let twice = |text: &str| table(text, Defaults::default()).unwrap_err();
    says(
        &twice(&format!("{}{HEAD}", DEG.replace("pan", "head_x"))),
        &["[[pose]] 'head'", "'head_x'", "name of a joint"],
    );
    says(&twice(&format!("{HEAD}{HEAD}")), &["[[pose]] 'head'", "another [[pose]] 'head'"]);
    let pose = ServoTable::parse(&HEAD.replace("head", "neck")).unwrap();
    let robot = neck("lower=\"-1\" upper=\"1\"");
    let error = Machine::of_robot(&robot, &pose, 50.0, Defaults::default()).unwrap_err();
    says(&error, &["[[pose]] 'neck'", "'neck_yaw'", "name of a joint", "another name"]);
    table(&format!("{DEG}{HEAD}"), Defaults::default()).unwrap();
}

#[test]
fn bounds_are_not_cut_without_a_word() {
    let refused = |text: &str| table(text, Defaults::default()).unwrap_err();
    let rad = DEG.replace("deg", "rad").replace("90", "160");
    says(&refused(&rad), &["[[servo]] 'pan', min", "found -160 rad", "at most 100 rad", "unit = \"deg\""]);
    let mm = DEG.replace("deg", "m").replace("-90", "0").replace("90", "200");
    says(&refused(&mm), &["[[servo]] 'pan', max", "found 200 m", "at most 100 m", "unit = \"mm\""]);
    says(&refused(&format!("{DEG}rest = 120\n")), &["[[servo]] 'pan', rest", "found 120 deg", "expected -90 to 90"]);
    says(&refused(&HEAD.replace("[0.1, 0.1", "[20, 0.1")), &["'head', max", "found 20 for x", "at most 10 m"]);
    says(&refused(&HEAD.replace("-1, -1]", "-40, -1]")), &["'head', min", "found -40 for pitch", "angles in rad"]);
    let notes = table(&format!("{DEG}zero = 200\n"), Defaults::default()).unwrap().notes.join(". ");
    assert!(notes.contains("pan: its 0 is out of reach, zero = 200, min = -90, max = 90"), "{notes}");
    // Of a description: refused, unless its table says better; bounds that stand for none are none.
    let of = |bounds: &str, text: &str| {
        let table = if text.is_empty() { ServoTable::default() } else { ServoTable::parse(text).unwrap() };
        Machine::of_robot(&neck(bounds), &table, 50.0, Defaults::default())
    };
    let degrees = "lower=\"-137\" upper=\"1\"";
    says(&of(degrees, "").unwrap_err(), &["joint 'neck_yaw'", "-137 rad", "at most 100 rad", "degrees"]);
    let known = of(degrees, &DEG.replace("pan", "neck_yaw")).unwrap();
    assert!((known.ranges()[0][0] + FRAC_PI_2).abs() < 1e-6);
    assert_eq!(of("lower=\"-1e9\" upper=\"inf\"", "").unwrap().ranges()[0], [-100.0, 100.0]);
}

#[test]
fn what_the_limiter_cannot_do_is_said_with_servo_value_and_range() {
    let refused = |text: &str, defaults: Defaults| table(text, defaults).unwrap_err();
    let none = Defaults::default();
    says(
        &refused(&format!("{DEG}speed = 1e-4\n"), none),
        &["'pan', speed", "found 0.0001 deg/s", "50 frames a second"],
    );
    says(&refused(&format!("{DEG}acceleration = 1e-2\n"), none), &["'pan', acceleration", "found 0.01 deg/s^2"]);
    says(
        &refused(&format!("{DEG}jerk = 1\n"), none),
        &["'pan', jerk", "found 1 deg/s^3", "expected 7.169 to", "0 for no limit"],
    );
    let jerk = Defaults { jerk: Some(0.1), ..none };
    says(
        &refused(DEG, jerk),
        &["joint 'pan', jerk", "found 0.1 rad/s^3", "expected 0.1251 to 1e9 rad", "--jerk", "--fps"],
    );
    let slow = Defaults { velocity: Some(1000.0), acceleration: Some(1e4), jerk: Some(0.2) };
    says(&refused(DEG, slow), &["joint 'pan', jerk", "a stop from full speed takes", "fewer than 10000"]);
    says(&refused(&format!("{DEG}jerk = 1e12\n"), none), &["'pan', jerk", "at most 1e9", "0 for no limit"]);
    says(&refused(&format!("{DEG}jerk = -1\n"), none), &["found -1", "0 for no limit"]);
    // 0 is no limit, whatever the default.
    let jerk = Defaults { jerk: Some(1000.0), ..none };
    let machine = table(&format!("{DEG}jerk = 0\n{HEAD}jerk = 0.0\n"), jerk).unwrap();
    assert!(machine.limits.joints.iter().all(|joint| joint.jerk == [0.0; 3]));
}

#[test]
fn what_a_table_says_in_vain_is_said() {
    let lift =
        "[[servo]]\nname = \"lift\"\nunit = \"ticks\"\nper_turn = 4096\nparent = \"neck_yaw\"\naxis = [0, 0, 1]\n";
    let robot = neck("lower=\"-1\" upper=\"1\"");
    let machine = Machine::of_robot(&robot, &ServoTable::parse(lift).unwrap(), 50.0, Defaults::default()).unwrap();
    let notes = machine.notes.join(". ");
    for note in
        ["lift: a slider; per_turn = 4096 is taken as 4096 ticks a metre", "lift: parent, axis of its servo: not used"]
    {
        assert!(notes.contains(note), "{notes}");
    }
    let error = ServoTable::parse(&format!("{DEG}per_turn = 4096\n")).unwrap_err();
    says(&error, &["[[servo]] 'pan', per_turn", "found 4096", "ticks", "unit = \"deg\""]);
    let error = ServoTable::parse(&DEG.replace("unit = \"deg\"", "per_turn = 4096")).unwrap_err();
    says(&error, &["per_turn", "no unit"]);
}

#[test]
fn help_shows_the_key_in_question() {
    for (text, words) in [
        (format!("{DEG}rest = \"up\"\n"), &["'pan', rest", "rest = 0"][..]),
        (format!("{DEG}sign = 2\n"), &["sign = -1"]),
        (format!("{DEG}axis = [0, 0]\n"), &["axis = [0, 1, 0]"]),
        (HEAD.replace("max", "most"), &["'most'", "max"]),
        (HEAD.replace("1, 1, 1]", "1, 1]"), &["[[pose]] 'head'", "six numbers", "as in  [[pose]]"]),
        (HEAD.replace("name = \"head\"", "name = 3"), &["[[pose]]  name = \"head\""]),
    ] {
        says(&ServoTable::parse(&text).unwrap_err(), words);
    }
}

/// What the command prints, its message where it fails.
fn kinesic(folder: &Path, line: &str) -> Result<String, String> {
    let output =
        Command::new(env!("CARGO_BIN_EXE_kinesic")).args(line.split_whitespace()).current_dir(folder).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).replace('\u{2502}', " ");
    let words = |text: String| text.split_whitespace().collect::<Vec<_>>().join(" ");
    if output.status.success() { Ok(words(text(&output.stdout))) } else { Err(words(text(&output.stderr))) }
}

/// A folder with a description of four hinges, of which the last follows, and a table of a head and two servos.
fn made() -> tempfile::TempDir {
    let joint = |name: &str, from: &str, to: &str, kind: &str, more: &str| {
        format!(
            r#"<link name="{to}"/><joint name="{name}" type="{kind}"><parent link="{from}"/><child link="{to}"/><axis xyz="0 0 1"/>{more}</joint>"#
        )
    };
    let limit = r#"<limit lower="-1" upper="1" velocity="2"/>"#;
    let urdf = [
        joint("pan", "base", "a", "revolute", limit),
        joint("tilt", "a", "b", "revolute", r#"<limit lower="-1" upper="1"/>"#),
        joint("spin", "b", "c", "continuous", ""),
        joint("plate", "c", "d", "fixed", ""),
        joint("follower", "d", "e", "revolute", &format!(r#"{limit}<mimic joint="pan" multiplier="2"/>"#)),
    ];
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("plain.urdf", &format!(r#"<robot name="plain"><link name="base"/>{}</robot>"#, urdf.concat()));
    write("desk.toml", &format!("{DEG}{}{HEAD}", DEG.replace("pan", "lamp")));
    write("arm.toml", &DEG.replace("pan", "shoulder"));
    folder
}

#[test]
fn an_import_says_what_it_counts_and_gathers_its_notes() {
    let folder = made();
    let at = folder.path();
    let text = kinesic(at, "robot import desk.toml --out desk.kin").unwrap();
    assert!(text.contains("8 coordinates: 2 servos, 1 pose, 50 frames"), "{text}");
    let text = kinesic(at, "robot import plain.urdf --out plain.kin").unwrap();
    assert!(text.contains("3 coordinates of 5 joints, 50 frames"), "{text}");
    for note in [
        "no speed is known for tilt, spin; 6.28 rad/s is assumed (--velocity)",
        "no acceleration is known for pan, tilt, spin; full speed in 0.2 s is assumed (--acceleration)",
        "no bounds are known for spin; it is kept within 100 rad",
    ] {
        assert!(text.contains(note), "{text}");
    }
}

#[test]
fn a_pack_of_another_robot_is_refused() {
    let folder = made();
    let at = folder.path();
    kinesic(at, "robot import arm.toml --out arm.kin").unwrap();
    let refused = kinesic(at, "robot retarget plain.urdf walk.bvh --robot arm.kin").unwrap_err();
    for words in ["arm.kin: found no joint of plain.urdf in it", "expected a pack of the same robot"] {
        assert!(refused.contains(words), "{refused}");
    }
    let refused = kinesic(at, "robot retarget arm.toml walk.bvh").unwrap_err();
    assert!(refused.contains("kinesic robot import arm.toml --out arm.kin"), "{refused}");
}

#[test]
fn values_that_do_nothing_are_refused_and_those_beyond_bounds_said() {
    let folder = made();
    let at = folder.path();
    let refused = kinesic(at, "robot show plain.urdf --at follower=0.3").unwrap_err();
    assert!(refused.contains("--at follower: it follows 'pan'") && refused.contains("--at pan=X"), "{refused}");
    let refused = kinesic(at, "robot show plain.urdf --at plate=0.3").unwrap_err();
    assert!(refused.contains("'fixed'"), "{refused}");
    let text = kinesic(at, "robot show plain.urdf --at pan=9,spin=9").unwrap();
    assert!(text.contains("note: pan = 9 is outside its bounds, -1.000 to 1.000"), "{text}");
    assert!(!text.contains("spin = 9"), "{text}");
}

#[test]
fn an_inspected_motion_shows_the_units_that_are_taken() {
    let folder = made();
    let at = folder.path();
    std::fs::write(at.join("nounit.csv"), "t,shoulder,other\n0,10,1\n0.02,11,1\n").unwrap();
    kinesic(at, "robot import arm.toml --out arm.kin").unwrap();
    for options in ["", "--angles deg"] {
        let text = kinesic(at, &format!("inspect nounit.csv --robot arm.kin {options}")).unwrap();
        assert!(text.contains("shoulder deg") && text.contains("other ?"), "{text}");
    }
}

#[test]
fn a_zero_comes_from_one_column() {
    let folder = made();
    let at = folder.path();
    std::fs::write(at.join("two.csv"), "t,shoulder_deg,Shoulder_deg\n0,10,1\n0.02,11,1\n").unwrap();
    let refused = kinesic(at, "robot import arm.toml --zero-from two.csv --out arm.kin").unwrap_err();
    assert!(refused.contains("two.csv: joint 'shoulder': found two columns"), "{refused}");
    std::fs::write(at.join("one.csv"), "t,Shoulder_deg\n0,10\n0.02,11\n").unwrap();
    let text = kinesic(at, "robot import arm.toml --zero-from one.csv --out arm.kin").unwrap();
    assert!(text.contains("deg = 10 "), "{text}");
    // Without a table servos take rad, whatever the columns are in.
    std::fs::write(at.join("one.csv"), "t,pan_deg\n0,90\n0.02,91\n").unwrap();
    let text = kinesic(at, "robot import plain.urdf --zero-from one.csv --out plain.kin").unwrap();
    assert!(text.contains("rad = 1.5707964 "), "{text}");
    std::fs::write(at.join("one.csv"), "t,pan_ticks\n0,90\n0.02,91\n").unwrap();
    let refused = kinesic(at, "robot import plain.urdf --zero-from one.csv --out plain.kin").unwrap_err();
    assert!(refused.contains("joint 'pan': found ticks, expected rad"), "{refused}");
}
