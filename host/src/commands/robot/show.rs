//! `kinesic robot show`.

use std::path::PathBuf;

use kinesic_host::robot::{Motion, Robot, RobotJoint};
use miette::miette;
use serde::Serialize;

use crate::commands::output::print_json;

/// Print a robot's joints as a tree, and where its links are
///
/// Reads a URDF or an MJCF. Frames are in the root link's frame; joints that follow others (mimic) follow.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic robot show robot.urdf
  kinesic robot show robot.xml --at left_elbow=1.2,lift=0.3 --json")]
pub struct Args {
    /// A robot (.urdf or .xml)
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Values of joints, rad or m; those not named are at 0
    #[arg(long, value_name = "JOINT=VALUE", value_delimiter = ',', value_parser = value, allow_hyphen_values = true)]
    at: Vec<(String, f64)>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

fn value(text: &str) -> Result<(String, f64), String> {
    let split = text.rsplit_once('=').and_then(|(name, value)| Some((name.trim(), value.trim().parse::<f64>().ok()?)));
    match split.filter(|(_, value)| value.abs() < 1e6) {
        Some((name, value)) => Ok((name.to_owned(), value)),
        None => Err("expected JOINT=VALUE, the value in rad or m, as in elbow=1.2".to_owned()),
    }
}

/// What is printed.
#[derive(Serialize)]
struct Shown {
    robot: String,
    root: String,
    coordinates: usize,
    joints: Vec<JointShown>,
    links: Vec<LinkShown>,
    notes: Vec<String>,
}

#[derive(Serialize)]
struct JointShown {
    name: String,
    #[serde(rename = "type")]
    kind: String,
    parent_link: String,
    child_link: String,
    /// Joints that carry it.
    depth: usize,
    axis: [f64; 3],
    unit: &'static str,
    lower: Option<f64>,
    upper: Option<f64>,
    velocity: Option<f64>,
    follows: Option<String>,
    value: f64,
}

#[derive(Serialize)]
struct LinkShown {
    link: String,
    /// Metres.
    position: [f64; 3],
    /// w, x, y, z.
    quaternion: [f64; 4],
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let robot = Robot::read(&args.file)?;
    let mut values = vec![0.0; robot.joints.len()];
    for (name, value) in &args.at {
        let at = robot.find(name).filter(|at| robot.leads(*at)).ok_or_else(|| unknown(args, &robot, name))?;
        values[at] = *value;
    }
    let values = robot.followed(&values);
    let shown = shown(&robot, &values);
    if args.json {
        return print_json(&shown);
    }
    println!("robot   {}", shown.robot);
    println!("root    {}", shown.root);
    println!("joints  {}, of them {} coordinates", shown.joints.len(), shown.coordinates);
    println!();
    println!("{}", shown.root);
    for joint in &shown.joints {
        let indent = "  ".repeat(joint.depth + 1);
        println!("{indent}{}: {} -> {}", joint.name, told(joint), joint.child_link);
    }
    println!();
    println!("link, position in m, quaternion w x y z");
    for link in &shown.links {
        let [x, y, z] = link.position.map(shortly);
        let [a, b, c, d] = link.quaternion.map(shortly);
        println!("{}  {x} {y} {z}  {a} {b} {c} {d}", link.link);
    }
    for note in &shown.notes {
        eprintln!("note: {note}");
    }
    Ok(())
}

fn unknown(args: &Args, robot: &Robot, name: &str) -> miette::Report {
    let place = args.file.display();
    if let Some(at) = robot.find(name) {
        let joint = &robot.joints[at];
        let why = joint.mimic.as_ref().map_or_else(
            || format!("it does not move: it is of type {}", joint.kind),
            |mimic| format!("it follows '{}'", mimic.joint),
        );
        return miette!(help = "name a joint with a value of its own", "{place}: joint '{name}': {why}");
    }
    let near = robot.nearest(name).map_or(String::new(), |near| format!("; did you mean '{near}'?"));
    miette!(help = format!("kinesic robot show {place} lists them"), "{place}: there is no joint '{name}'{near}")
}

fn shown(robot: &Robot, values: &[f64]) -> Shown {
    let joints = robot.depth_first();
    // A joint comes after those that carry it.
    let mut depths = vec![0; robot.joints.len()];
    for &at in &joints {
        depths[at] = robot.joints[at].parent.map_or(0, |parent| depths[parent] + 1);
    }
    let one = |at: usize| {
        let RobotJoint { name, kind, base, child, axis, lower, upper, velocity, mimic, motion, .. } = &robot.joints[at];
        let follows =
            mimic.as_ref().map(|m| format!("{} x {} + {}", shortly(m.multiplier), m.joint, shortly(m.offset)));
        JointShown {
            name: name.clone(),
            kind: kind.clone(),
            parent_link: base.clone(),
            child_link: child.clone(),
            depth: depths[at],
            axis: [axis.x, axis.y, axis.z],
            unit: if *motion == Motion::Prismatic { "m" } else { "rad" },
            lower: lower.filter(|x| x.is_finite()),
            upper: upper.filter(|x| x.is_finite()),
            velocity: *velocity,
            follows,
            value: values[at],
        }
    };
    let link = |(link, frame): (String, nalgebra::Isometry3<f64>)| {
        let (p, q) = (frame.translation.vector, frame.rotation);
        LinkShown { link, position: [p.x, p.y, p.z], quaternion: [q.w, q.i, q.j, q.k] }
    };
    let notes = robot.joints.iter().flat_map(|joint| &joint.notes).chain(&robot.notes).cloned().collect();
    Shown {
        robot: robot.name.clone(),
        root: robot.root().unwrap_or_else(|| "root".to_owned()),
        coordinates: joints.iter().filter(|at| robot.leads(**at)).count(),
        joints: joints.into_iter().map(one).collect(),
        links: robot.link_frames(values).into_iter().map(link).collect(),
        notes,
    }
}

/// Type, axis and range.
fn told(joint: &JointShown) -> String {
    let [x, y, z] = joint.axis.map(shortly);
    let mut text = joint.kind.clone();
    if joint.kind != "fixed" {
        text.push_str(&format!(", axis {x} {y} {z}"));
        let bound = |x: Option<f64>| x.map_or("free".to_owned(), shortly);
        text.push_str(&format!(", {} to {} {}", bound(joint.lower), bound(joint.upper), joint.unit));
    }
    if let Some(velocity) = joint.velocity {
        text.push_str(&format!(", at most {} {}/s", shortly(velocity), joint.unit));
    }
    if let Some(follows) = &joint.follows {
        text.push_str(&format!(", follows {follows}"));
    }
    if joint.value != 0.0 {
        text.push_str(&format!(", at {}", shortly(joint.value)));
    }
    text
}

/// Six decimals at most, no negative zero.
fn shortly(value: f64) -> String {
    let text = format!("{:.6}", (value * 1e6).round() / 1e6 + 0.0);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
