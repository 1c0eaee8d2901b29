//! Robots as machines: descriptions, tables of servos, moves, maps of limbs.

use std::path::Path;
use std::sync::OnceLock;

use kinesic::Pack;
use kinesic_host::clip::{Clip, JointMap};
use kinesic_host::gait::{Manner, walk};
use kinesic_host::moves::{self, Extra, Moves, Options, Unit};
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::robot::retarget::{RetargetMap, retarget, suggest};
use kinesic_host::robot::{Defaults, Machine, Robot, ServoTable};

/// What is missing in hostile files, so that the rest is reached.
const DEFAULTS: Defaults = Defaults { velocity: Some(3.0), acceleration: Some(20.0), jerk: None };
/// Joints of a robot on which a person's motion is put: more take time, and no other path.
const JOINTS: usize = 24;

/// Reads the bytes as a URDF or an MJCF, those behind a zero byte as a table of its servos. What is taken is a tree whose frames are
/// numbers, and what a machine is made of is a pack that loads.
pub fn robot(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let (text, table) = text.split_once('\0').unwrap_or((text, ""));
    let Ok(robot) = Robot::parse(text) else { return };
    let numbers = |frame: &kinesic::nalgebra::Isometry3<f64>| frame.translation.vector.iter().all(|x| x.is_finite());
    assert!(robot.frames().iter().all(numbers));
    assert_eq!(robot.depth_first().len(), robot.joints.len());
    let values = robot.followed(&vec![0.1; robot.joints.len()]);
    assert!(values.iter().all(|value| value.is_finite()));
    let table = ServoTable::parse(table).unwrap_or_default();
    if let Ok(machine) = Machine::of_robot(&robot, &table, 50.0, DEFAULTS) {
        packed(&machine);
        let mut kept = robot.clone();
        kept.keep(&machine);
        let _ = Robot::of_machine(&machine).frames();
    }
    if let Ok(map) = suggest(&robot) {
        let map = RetargetMap::parse(&map).expect("a suggested map is one");
        follow(&robot, &map);
    }
}

/// Reads the bytes as a table of servos.
pub fn servos(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let Ok(table) = ServoTable::parse(text) else { return };
    let Ok(machine) = Machine::of_table(&table, 50.0, DEFAULTS) else { return };
    packed(&machine);
    let _ = Robot::of_machine(&machine).frames();
}

/// Reads the bytes as moves of every format that a name can say, plays them on a machine, and writes what was read.
pub fn moves(data: &[u8]) {
    static MACHINE: OnceLock<Machine> = OnceLock::new();
    let machine = MACHINE.get_or_init(|| {
        let table = ServoTable::parse(include_str!("desk.toml")).expect("ours");
        Machine::of_table(&table, 50.0, DEFAULTS).expect("ours")
    });
    for name in ["no/fuzz.csv", "no/fuzz.yaml"] {
        let _ = moves::is_moves(Path::new(name), data);
        for options in [Options::default(), Options { rate: Some(50.0), episode: Some(1) }] {
            let Ok(found) = moves::parse(data, Path::new(name), &options) else { continue };
            assert_eq!(found.values.len(), found.frames() * found.channels.len());
            assert!(found.values.iter().chain(&found.times).all(|x| x.is_finite()));
            let _ = found.summary();
            again(&found);
            if let Ok(slower) = found.resample(20.0) {
                assert_eq!(slower.values.len(), slower.frames() * slower.channels.len());
                for angles in [None, Some(Unit::Degrees)] {
                    let Ok(clip) = machine.clip(&slower, angles) else { continue };
                    assert_eq!(machine.moves(&clip, Some(&slower)).frames(), slower.frames());
                }
            }
        }
    }
}

/// What we write of moves is read again, as many frames. What is no joint stays out: a table tells it from a joint by its first cells.
fn again(found: &Moves) {
    let text = Moves { extra: Extra::default(), ..found.clone() }.to_csv();
    let read = moves::parse(text.as_bytes(), Path::new("no/again.csv"), &Options::default());
    let read = read.unwrap_or_else(|error| panic!("what we write is refused: {error}: {text}"));
    assert_eq!(read.frames(), found.frames(), "{text}");
}

/// Reads the bytes as a map of a robot's limbs, and puts three frames of a walk on an arm with it.
pub fn limbs(data: &[u8]) {
    static ROBOT: OnceLock<Robot> = OnceLock::new();
    let Ok(text) = std::str::from_utf8(data) else { return };
    let Ok(map) = RetargetMap::parse(text) else { return };
    follow(ROBOT.get_or_init(|| Robot::parse(include_str!("arm.urdf")).expect("ours")), &map);
}

fn follow(robot: &Robot, map: &RetargetMap) {
    static PERSON: OnceLock<(Clip, JointMap)> = OnceLock::new();
    if robot.joints.len() > JOINTS {
        return;
    }
    let (clip, joints) = PERSON.get_or_init(|| {
        let clip = walk(&Manner::NEUTRAL, 0.1, 30.0, 0.0, 1);
        let joints = JointMap::detect(&clip.skeleton).expect("the gait's names are known");
        (clip, joints)
    });
    let Ok(moved) = retarget(robot, map, clip, joints) else { return };
    assert_eq!(moved.values.len(), moved.joints.len() * clip.frames());
    assert!(moved.values.iter().all(|value| value.is_finite()));
}

fn packed(machine: &Machine) {
    let Ok(bytes) = machine.pack(None, &Provenance::default()) else { return };
    let file = PackFile::from_bytes(&bytes);
    let pack: Pack = file.pack().expect("what we write is a pack");
    let again = Machine::from_pack(&pack).expect("what we write is a machine").expect("with servos");
    assert_eq!(again.servos.len(), machine.servos.len());
}
