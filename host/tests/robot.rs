//! Robots of MJCF and URDF: what is read, where its links are, what is refused.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_3, FRAC_PI_4};

use kinesic_host::robot::{Motion, Robot, RobotError};
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
