//! `kinesic robot show`: joints of a description, and where its links are.

use std::collections::BTreeMap;
use std::path::PathBuf;

use kinesic_host::plain;
use kinesic_host::robot::{Motion, Robot};
use miette::{IntoDiagnostic, WrapErr, miette};
use serde::Serialize;

use crate::commands::output::print_json;

/// Show the joints of a robot and where they put its links
///
/// Reads URDF and MJCF, told by the content. Frames are those of the links in the root link's frame: metres, and quaternions w x y z.
///
/// Examples:
///   kinesic robot show robot.urdf
///   kinesic robot show robot.xml --at left_elbow=0.5,waist=-0.2 --json
#[derive(clap::Args, Debug)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// URDF or MJCF
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Values of joints, rad or m: NAME=VALUE,NAME=VALUE (the others are 0)
    #[arg(long, value_name = "NAME=VALUE", value_delimiter = ',', value_parser = pair)]
    at: Vec<(String, f64)>,
    /// File with poses: a JSON list of objects from joint name to value; --json prints the frames at each
    #[arg(long, value_name = "FILE.json", conflicts_with = "at")]
    poses: Option<PathBuf>,
    /// Print joints and frames as one JSON object
    #[arg(long)]
    json: bool,
}

fn pair(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE, as in elbow=0.5")?;
    match value.trim().parse::<f64>() {
        Ok(value) if value.abs() < 1e6 => Ok((name.trim().to_owned(), value)),
        _ => Err("expected a number behind =, as in elbow=0.5".to_owned()),
    }
}

#[derive(Serialize)]
struct Shown<'r> {
    name: &'r str,
    root: &'r str,
    joints: Vec<JointShown<'r>>,
    /// One a pose.
    frames: Vec<BTreeMap<&'r str, [f64; 7]>>,
    notes: Vec<String>,
}

#[derive(Serialize)]
struct JointShown<'r> {
    name: &'r str,
    kind: &'r str,
    line: u32,
    parent: &'r str,
    child: &'r str,
    axis: [f64; 3],
    lower: Option<f64>,
    upper: Option<f64>,
    velocity: Option<f64>,
    mimic: Option<String>,
    depth: usize,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let robot = Robot::read(&args.file)?;
    let index: BTreeMap<&str, usize> =
        robot.joints.iter().zip(0..).map(|(joint, at)| (joint.name.as_str(), at)).collect();
    let poses: Vec<BTreeMap<String, f64>> = match &args.poses {
        None => vec![args.at.iter().cloned().collect()],
        Some(path) => serde_json::from_slice(
            &kinesic_host::files::read(path).into_diagnostic().wrap_err_with(|| path.display().to_string())?,
        )
        .map_err(|error| {
            miette!(
                help = "as in [{{\"elbow\": 0.5}}, {{\"elbow\": 1.0}}]",
                "{}: no list of poses: {error}",
                path.display()
            )
        })?,
    };
    let mut frames = Vec::new();
    for pose in &poses {
        let mut own = vec![0.0; robot.joints.len()];
        for (name, value) in pose {
            let at = index.get(name.as_str()).ok_or_else(|| {
                miette!(
                    help = "kinesic robot show FILE lists the joints",
                    "{}: there is no joint '{name}'",
                    args.file.display()
                )
            })?;
            own[*at] = *value;
        }
        let values = robot.followed(&own);
        let placed = robot.placed(&|joint| values[joint]);
        let frame = |(joint, frame): (usize, &nalgebra::Isometry3<f64>)| {
            let (at, q) = (frame.translation, frame.rotation);
            (robot.joints[joint].child.as_str(), [at.x, at.y, at.z, q.w, q.i, q.j, q.k])
        };
        frames.push((0..).zip(&placed).map(frame).collect());
    }
    let joints = robot.joints.iter().zip(0..).map(|(joint, at)| JointShown {
        name: &joint.name,
        kind: &joint.kind,
        line: joint.line,
        parent: joint.parent.map_or(robot.root.as_str(), |parent| &robot.joints[parent].child),
        child: &joint.child,
        axis: joint.axis.into(),
        lower: joint.lower.filter(|x| x.is_finite()),
        upper: joint.upper.filter(|x| x.is_finite()),
        velocity: joint.velocity.filter(|x| x.is_finite()),
        mimic: joint.mimic.as_ref().map(|mimic| format!("{} x {} + {}", mimic.multiplier, mimic.joint, mimic.offset)),
        depth: robot.chain(at).count() - 1,
    });
    let notes = robot.notes.iter().chain(robot.joints.iter().flat_map(|joint| &joint.notes)).cloned().collect();
    let shown = Shown { name: &robot.name, root: &robot.root, joints: joints.collect(), frames, notes };
    if args.json {
        return print_json(&shown);
    }
    print(&shown, &robot, !args.at.is_empty());
    Ok(())
}

fn print(shown: &Shown, robot: &Robot, with_frames: bool) {
    println!("{}: root link {}", plain::line(shown.name), plain::line(shown.root));
    for joint in &shown.joints {
        let bound = |x: Option<f64>| x.map_or("-".to_owned(), |x| format!("{x:.3}"));
        let mimic = joint.mimic.as_ref().map_or(String::new(), |mimic| format!(", follows {mimic}"));
        let [x, y, z] = joint.axis;
        // Deep chains would push the names out of sight.
        let line = format!(
            "{}{} [{}] {} .. {} about {x:.2} {y:.2} {z:.2} -> {}{mimic}",
            "  ".repeat(joint.depth.min(20)),
            joint.name,
            joint.kind,
            bound(joint.lower),
            bound(joint.upper),
            joint.child
        );
        println!("{}", plain::line(&line));
    }
    if with_frames {
        for (link, [x, y, z, w, i, j, k]) in shown.frames.iter().flatten() {
            println!("{} at {x:.4} {y:.4} {z:.4} m, {w:.4} {i:.4} {j:.4} {k:.4}", plain::line(link));
        }
    }
    let moving = robot.joints.iter().filter(|joint| !matches!(joint.motion, Motion::Fixed | Motion::Other(_)));
    println!("{} joints, of which {} move", robot.joints.len(), moving.count());
    for note in &shown.notes {
        println!("note: {}", plain::line(note));
    }
}
