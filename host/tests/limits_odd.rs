//! What descriptions of robots leave open or write as place holders: said in a note, or refused.

use kinesic_host::clip::JointMap;
use kinesic_host::gait;
use kinesic_host::limit::JointLimit;
use kinesic_host::limit::onto_body::{Import, Rates, RobotMap, import};
use kinesic_host::rig::Rig;
use kinesic_host::robot::{Robot, RobotError};

const MAP: &str = "acceleration = 20.0\n[joints]\nl_elbow = \"elbow\"\n";

/// An elbow with such a limit, and what else the robot has.
fn robot(elbow: &str, rest: &str) -> String {
    format!(
        "<robot name='odd'><link name='base'/><link name='fore'/><link name='a'/><link name='b'/>\n\
         <joint name='elbow' type='revolute'><parent link='base'/><child link='fore'/><axis xyz='0 1 0'/>{elbow}</joint>\n{rest}</robot>"
    )
}

fn made(elbow: &str, rest: &str) -> Result<Import, RobotError> {
    let skeleton = gait::skeleton();
    let rig = Rig::new(&skeleton, &JointMap::detect(&skeleton).unwrap()).unwrap();
    import(&Robot::parse(&robot(elbow, rest))?, &RobotMap::parse(MAP)?, &rig, "odd", 60.0, Rates::default())
}

fn forearm(import: &Import) -> JointLimit {
    import.model.joints[gait::skeleton().find("LeftForeArm").unwrap()]
}

fn noted(import: &Import, words: &[&str]) {
    let found = import.notes.iter().any(|note| words.iter().all(|word| note.contains(word)));
    assert!(found, "no note with {words:?} in {:?}", import.notes);
}

fn bounds(import: &Import) -> [f64; 2] {
    let limit = forearm(import);
    [limit.lower[0], limit.upper[0]].map(|x| (f64::from(x) * 1e3).round() / 1e3)
}

const LIMIT: &str = "<limit lower='-2.4' upper='0' velocity='9' effort='10'/>";

fn follower(name: &str, [from, to]: [&str; 2], leader: &str, rest: &str) -> String {
    format!(
        "<joint name='{name}' type='revolute'><parent link='{from}'/><child link='{to}'/><axis xyz='0 1 0'/>{rest}\
         <mimic joint='{leader}' multiplier='-0.5'/></joint>\n"
    )
}

#[test]
fn soft_limits_of_0_and_0_lock_nothing() {
    let soft = format!("{LIMIT}<safety_controller soft_lower_limit='0' soft_upper_limit='0' k_velocity='1'/>");
    let import = made(&soft, "").unwrap();
    assert_eq!(bounds(&import), [-2.4, 0.0]);
    noted(&import, &["elbow", "soft limits of 0 and 0", "left out"]);
    // Those that leave nothing of the limits are a mistake of theirs.
    let soft = format!("{LIMIT}<safety_controller soft_lower_limit='1' soft_upper_limit='2' k_velocity='1'/>");
    let import = made(&soft, "").unwrap();
    assert_eq!(bounds(&import), [-2.4, 0.0]);
    noted(&import, &["elbow", "soft limits of 1 and 2", "nothing", "left out"]);
    // Others hold.
    let soft = format!("{LIMIT}<safety_controller soft_lower_limit='-2' soft_upper_limit='-0.1' k_velocity='1'/>");
    assert_eq!(bounds(&made(&soft, "").unwrap()), [-2.0, -0.1]);
}

#[test]
fn bounds_of_0_and_0_are_kept_and_said() {
    let import = made("<limit lower='0' upper='0' velocity='9'/>", "").unwrap();
    assert_eq!(bounds(&import), [0.0, 0.0]);
    noted(&import, &["elbow", "bounds of 0 and 0 lock it", "write lower and upper"]);
    noted(&made("<limit lower='-1' upper='-1' velocity='9'/>", "").unwrap(), &["bounds of -1 and -1 lock it"]);
    // A follower that cannot move locks whom it follows.
    let locked = follower("finger", ["fore", "a"], "elbow", "<limit lower='0' upper='0' velocity='9'/>");
    let import = made(LIMIT, &locked).unwrap();
    assert_eq!(bounds(&import), [0.0, 0.0]);
    noted(&import, &["finger", "bounds of 0 and 0 lock it"]);
}

#[test]
fn no_bounds_written_as_huge_ones_are_none() {
    let thousandths = |x: f64| (x * 1e3).round() / 1e3;
    let half = thousandths(std::f64::consts::PI);
    for huge in ["lower='-1e16' upper='1e16'", "lower='-inf' upper='inf'"] {
        let import = made(&format!("<limit {huge} velocity='9'/>"), "").unwrap();
        assert_eq!(bounds(&import), [-half, half], "{huge}");
        noted(&import, &["elbow", "none", "half a turn"]);
    }
    for (one, [low, high]) in [
        ("lower='-2.4' upper='1e16'", [-2.4, half]),
        ("lower='-inf' upper='0'", [-half, 0.0]),
        ("lower='4' upper='inf'", [4.0, thousandths(4.0 + std::f64::consts::TAU)]),
    ] {
        let import = made(&format!("<limit {one} velocity='9'/>"), "").unwrap();
        assert_eq!(bounds(&import), [low, high], "{one}");
        noted(&import, &["elbow", "one bound is none"]);
    }
    // A velocity may be none as well: then one is asked for, by the joint's name.
    for huge in ["inf", "1e16"] {
        let refused = made(&format!("<limit lower='-2.4' upper='0' velocity='{huge}'/>"), "").unwrap_err();
        let text = format!("{refused} {}", refused.help);
        assert!(text.contains("elbow") && text.contains("--velocity"), "{huge}: {text}");
    }
}

#[test]
fn a_follower_of_nothing_is_said_and_one_of_a_follower_counts() {
    let lost = follower("finger", ["fore", "a"], "elbo", "<limit lower='-1' upper='1' velocity='9'/>");
    noted(&made(LIMIT, &lost).unwrap(), &["finger", "'elbo'", "did you mean 'elbow'"]);
    // The mapped joint itself may follow nothing, or a ring: it moves by itself.
    for leader in ["elbo", "elbow", "ring"] {
        let elbow = format!("{LIMIT}<mimic joint='{leader}'/>");
        let ring = follower("ring", ["fore", "a"], "elbow", "");
        let import = made(&elbow, &ring).unwrap();
        assert_eq!(bounds(&import), [-2.4, 0.0], "{leader}");
        noted(&import, &["elbow (line 2)", "follows", leader]);
    }
    // A follower that allows nothing of what its leader may do is named.
    let other = follower("finger", ["fore", "a"], "elbow", "<limit lower='2' upper='3' velocity='9'/>");
    let refused = made(LIMIT, &other).unwrap_err().to_string();
    assert!(refused.contains("'finger'") && refused.contains("-2.4 and 0"), "{refused}");
    // b = -0.5 a and a = -0.5 elbow: b in -0.4 .. 0 keeps the elbow above -1.6.
    let first = follower("first", ["fore", "a"], "elbow", "<limit lower='-3' upper='3' velocity='9'/>");
    let second = follower("second", ["a", "b"], "first", "<limit lower='-0.4' upper='0' velocity='9'/>");
    let import = made(LIMIT, &(first + &second)).unwrap();
    assert_eq!(bounds(&import), [-1.6, 0.0]);
}

#[test]
fn a_joint_type_that_no_map_uses_refuses_nothing() {
    for kind in ["floating", "planar", "spherical"] {
        let other = format!("<joint name='odd' type='{kind}'><parent link='fore'/><child link='a'/></joint>");
        assert_eq!(bounds(&made(LIMIT, &other).unwrap()), [-2.4, 0.0], "{kind}");
        let used = robot(LIMIT, &other);
        let map = RobotMap::parse("acceleration = 20.0\n[joints]\nl_elbow = \"odd\"\n").unwrap();
        let skeleton = gait::skeleton();
        let rig = Rig::new(&skeleton, &JointMap::detect(&skeleton).unwrap()).unwrap();
        let refused = import(&Robot::parse(&used).unwrap(), &map, &rig, "odd", 60.0, Rates::default()).unwrap_err();
        let text = format!("{refused} {}", refused.help);
        assert!(text.contains("odd") && text.contains(kind), "{kind}: {text}");
    }
}
