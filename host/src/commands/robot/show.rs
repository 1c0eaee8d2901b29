//! `kinesic robot show`.

use std::path::PathBuf;

use kinesic_host::clip::map::nearest;
use kinesic_host::plain;
use kinesic_host::robot::{Mimic, Motion, Robot};
use miette::miette;
use serde::Serialize;

use super::is_table;
use crate::commands::inspect::is_pack;
use crate::commands::output::print_json;

/// Show the joints of a robot's description, and where its links are
///
/// Angles in rad, lengths in m. The frame of every link is that of the root link, by the description's own axes.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic robot show arm.urdf
  kinesic robot show arm.xml --at elbow=0.5,wrist=-0.2 --json")]
pub struct Args {
    /// A robot: .urdf or .xml (MJCF)
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Values of joints; the others are at 0, followers follow
    #[arg(long, value_name = "JOINT=X,...", value_delimiter = ',', allow_hyphen_values = true)]
    at: Vec<String>,
    /// Print one JSON object, with position and quaternion (x, y, z, w) of every link
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    robot: String,
    root: Option<String>,
    joints: Vec<Joint>,
    notes: Vec<String>,
}

#[derive(Serialize)]
struct Joint {
    name: String,
    kind: String,
    parent_link: String,
    link: String,
    axis: [f64; 3],
    #[serde(skip_serializing_if = "Option::is_none")]
    lower: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    upper: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    velocity: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    follows: Option<String>,
    /// Value at which the links are shown.
    value: f64,
    position: [f64; 3],
    rotation: [f64; 4],
    #[serde(skip)]
    depth: usize,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let file = args.file.display();
    if is_pack(&args.file) {
        return Err(miette!(
            help = format!("kinesic inspect {file} shows the joints of a pack"),
            "{file}: found a pack, expected a robot's description, .urdf or .xml (MJCF)"
        ));
    }
    if is_table(&args.file) {
        let pack = args.file.with_extension("kin");
        let pack = pack.display();
        return Err(miette!(
            help = format!(
                "make a pack of it, and look at that: kinesic robot import {file} --out {pack}; kinesic inspect {pack}"
            ),
            "{file}: found a table of servos, expected a robot's description, .urdf or .xml (MJCF)"
        ));
    }
    let robot = Robot::read(&args.file)?;
    let mut own = vec![0.0; robot.joints.len()];
    let mut notes = robot.notes.clone();
    for entry in &args.at {
        let (name, value) = entry
            .split_once('=')
            .and_then(|(name, value)| Some((name.trim(), value.trim().parse::<f64>().ok().filter(|x| x.is_finite())?)))
            .ok_or_else(|| miette!(help = "as in --at elbow=0.5,wrist=-0.2", "--at {entry}: expected JOINT=NUMBER"))?;
        let at = robot.find(name).ok_or_else(|| {
            let names = robot.joints.iter().map(|joint| joint.name.as_str());
            let near = nearest(name, names).map_or(String::new(), |near| format!("; did you mean '{near}'?"));
            miette!("--at {name}: the robot has no such joint{near}")
        })?;
        let joint = &robot.joints[at];
        let leader = joint.mimic.as_ref().filter(|mimic| robot.find(&mimic.joint).is_some());
        if let Some(Mimic { joint: leader, multiplier, offset }) = leader {
            return Err(miette!(
                help =
                    format!("give the one that leads: --at {leader}=X; this one is then at {multiplier} X + {offset}"),
                "--at {name}: it follows '{leader}', and has no value of its own"
            ));
        }
        if matches!(joint.motion, Motion::Fixed | Motion::Other(_)) {
            let help = "name a joint that turns or slides; kinesic robot show lists their kinds";
            return Err(miette!(
                help = help,
                "--at {name}: found a joint of the kind '{}', which has no value",
                joint.kind
            ));
        }
        let [lower, upper] = [joint.lower.unwrap_or(f64::NEG_INFINITY), joint.upper.unwrap_or(f64::INFINITY)];
        if joint.motion != Motion::Continuous && !(lower..=upper).contains(&value) {
            notes.push(format!("{name} = {value} is outside its bounds, {lower:.3} to {upper:.3}"));
        }
        own[at] = value;
    }
    let values = robot.followed(&own);
    let frames = robot.placed(&|joint| values[joint]);
    let joint = |at: usize| {
        let joint = &robot.joints[at];
        Joint {
            name: joint.name.clone(),
            kind: joint.kind.clone(),
            parent_link: joint.base.clone(),
            link: joint.child.clone(),
            axis: joint.axis.into(),
            lower: joint.lower,
            upper: joint.upper,
            velocity: joint.velocity,
            follows: joint.mimic.as_ref().map(|mimic| mimic.joint.clone()),
            value: values[at],
            position: frames[at].translation.vector.into(),
            rotation: frames[at].rotation.coords.into(),
            depth: robot.chain(at).count() - 1,
        }
    };
    let joints = robot.depth_first().into_iter().map(joint).collect();
    let report = Report { robot: robot.name.clone(), root: robot.root(), joints, notes };
    if args.json {
        return print_json(&report);
    }
    println!("{}: {} joints", plain::line(&report.robot), report.joints.len());
    for joint in &report.joints {
        let name = format!("{}{}", "  ".repeat(joint.depth.min(20)), joint.name);
        let range = match (joint.lower, joint.upper) {
            (Some(lower), Some(upper)) => format!("{lower:.3} .. {upper:.3}"),
            _ => "-".to_owned(),
        };
        let [x, y, z] = joint.position;
        let follows = joint.follows.as_ref().map_or(String::new(), |leader| format!(", follows {leader}"));
        let line = format!("{name:<40} {:<10} {range:<18} at {x:.4} {y:.4} {z:.4}{follows}", joint.kind);
        println!("{}", plain::line(&line));
    }
    for note in &report.notes {
        println!("note: {}", plain::line(note));
    }
    Ok(())
}
