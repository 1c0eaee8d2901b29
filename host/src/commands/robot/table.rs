//! The coordinates of a robot as a table.

use kinesic_host::limit::{Entry, Table};
use kinesic_host::moves::unit_name;
use kinesic_host::plain;
use kinesic_host::robot::{Machine, Servo};
use serde::Serialize;

/// One coordinate: what it may do, rad or m, and what its servo takes.
#[derive(Serialize)]
pub struct Coordinate {
    joint: String,
    kind: &'static str,
    lower: f64,
    upper: f64,
    velocity: f64,
    acceleration: f64,
    /// 0 for no limit.
    jerk: f64,
    rest: f64,
    /// None for a virtual joint.
    #[serde(skip_serializing_if = "Option::is_none")]
    id: Option<u16>,
    unit: &'static str,
    /// The servo takes `zero + scale x`.
    scale: f32,
    zero: f32,
}

/// All of a machine, in order.
pub fn coordinates(machine: &Machine) -> Vec<Coordinate> {
    let names: Vec<String> = machine.rig.skeleton.joints.iter().map(|joint| joint.name.clone()).collect();
    let table = Table::new(&machine.limits, &names, &[]);
    let one = |(joint, servo): (Entry, &Servo)| Coordinate {
        joint: joint.joint,
        kind: joint.kind,
        lower: joint.lower[0],
        upper: joint.upper[0],
        velocity: joint.velocity[0],
        acceleration: joint.acceleration[0],
        jerk: joint.jerk.first().copied().unwrap_or(0.0),
        rest: joint.rest[0],
        id: servo.id,
        unit: unit_name(servo.unit),
        scale: servo.scale,
        zero: servo.zero,
    };
    table.joints.into_iter().filter(|joint| joint.lower.len() == 1).zip(&machine.servos).map(one).collect()
}

/// Prints them.
pub fn print(coordinates: &[Coordinate]) {
    println!(
        "{:<24} {:<6} {:>8} {:>8} {:>8} {:>8} {:>9} {:>9}   servo",
        "joint", "kind", "lower", "upper", "rest", "per s", "per s^2", "per s^3"
    );
    for c in coordinates {
        let servo = match c.id {
            Some(id) => format!("{id}: {} = {} {:+} x", c.unit, c.zero, c.scale),
            None => "none".to_owned(),
        };
        let jerk = if c.jerk > 0.0 { format!("{:.0}", c.jerk) } else { "-".to_owned() };
        let line = format!(
            "{:<24} {:<6} {:>8.3} {:>8.3} {:>8.3} {:>8.2} {:>9.1} {jerk:>9}   {servo}",
            c.joint, c.kind, c.lower, c.upper, c.rest, c.velocity, c.acceleration
        );
        println!("{}", plain::line(&line));
    }
}
