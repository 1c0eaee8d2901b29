//! Robots and their maps.

use std::sync::OnceLock;

use kinesic_host::clip::JointMap;
use kinesic_host::gait;
use kinesic_host::limit::onto_body::{Rates, RobotMap, import};
use kinesic_host::limit::{HostLimiter, Table};
use kinesic_host::rig::Rig;
use kinesic_host::robot::Robot;

/// The map of an input that brings none.
const MAP: &str = "acceleration = 20\n[joints]\nl_shoulder = [\"pitch\", \"roll\", \"yaw\"]\nl_elbow = \"elbow\"\n";

/// Reads the bytes as a URDF, those behind a zero byte as its map, and makes limits of both. What is taken is what a limiter takes.
pub fn urdf(data: &[u8]) {
    static RIG: OnceLock<Rig> = OnceLock::new();
    let Ok(text) = std::str::from_utf8(data) else { return };
    let (robot, map) = text.split_once('\0').unwrap_or((text, MAP));
    let (robot, map) = (Robot::parse(robot), RobotMap::parse(map));
    let (Ok(robot), Ok(map)) = (robot, map) else { return };
    let rig = RIG.get_or_init(|| {
        let skeleton = gait::skeleton();
        let map = JointMap::detect(&skeleton).expect("the gait's names are known");
        Rig::new(&skeleton, &map).expect("the gait's skeleton is a rig")
    });
    let Ok(made) = import(&robot, &map, rig, &robot.name, 60.0, Rates::default()) else { return };
    let tables = made.model.tables(rig).expect("what is imported is checked");
    let _: HostLimiter = tables.limiter().expect("what is imported is checked");
    let names: Vec<String> = rig.skeleton.joints.iter().map(|joint| joint.name.clone()).collect();
    let _ = Table::new(&made.model, &names, &made.urdf).csv();
}
