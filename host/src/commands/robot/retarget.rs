//! `kinesic robot retarget`: a person's motion on a robot.

use std::path::{Path, PathBuf};

use kinesic_host::clip::{JointMap, read_with};
use kinesic_host::robot::retarget::{Report, RetargetMap, retarget, suggest};
use kinesic_host::robot::{Robot, RobotError};
use kinesic_host::{files, plain};
use miette::{IntoDiagnostic, WrapErr, miette};
use serde::Serialize;

use crate::commands::clips::Reading;
use crate::commands::output::{check_output, print_json, write_whole};
use crate::commands::print::raw;

/// Put a person's motion on a robot, within its limits
///
/// Every limb of the robot points where the person's does, as far as its joints let it. The map says which parts are which limbs:
///   forward = "x"
///   up = "z"
///   [limbs]
///   torso = "waist_yaw_joint"
///   head = "head_pitch_joint"
///   l_upper_arm = ["left_shoulder_roll_joint", "left_elbow_joint"]
///   l_forearm = { from = "left_elbow_joint", bone = [0, 0, -1] }
///
/// Examples:
///   kinesic robot retarget robot.urdf --suggest-map > map.toml
///   kinesic robot retarget robot.urdf walk.bvh --map map.toml --out moves.csv
#[derive(clap::Args, Debug)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// URDF or MJCF
    #[arg(value_name = "ROBOT")]
    robot: PathBuf,
    /// Clip with the person's motion
    #[arg(value_name = "CLIP", required_unless_present = "suggest_map")]
    clip: Option<PathBuf>,
    /// Map (TOML) of limbs (default: the one that --suggest-map prints)
    #[arg(long, value_name = "FILE.toml")]
    map: Option<PathBuf>,
    /// Print a map made from the robot's names and geometry
    #[arg(long, conflicts_with_all = ["clip", "map", "out", "json"])]
    suggest_map: bool,
    /// Skeleton map (TOML) for a clip with unknown joint names
    #[arg(long, value_name = "FILE.toml")]
    skeleton_map: Option<PathBuf>,
    /// Frames per second (default: the clip's)
    #[arg(long, value_name = "RATE", allow_negative_numbers = true)]
    fps: Option<f64>,
    /// Table to write: time_s, then NAME_rad or NAME_m of every joint that leads
    #[arg(long, value_name = "FILE.csv")]
    out: Option<PathBuf>,
    /// Print the report as one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Summary {
    #[serde(skip_serializing_if = "Option::is_none")]
    out: Option<String>,
    #[serde(flatten)]
    report: Report,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    if let Some(out) = &args.out {
        check_output(out, "csv")?;
    }
    let robot = Robot::read(&args.robot)?;
    let within = |path: &Path| {
        let path = path.to_owned();
        move |error: RobotError| error.in_file(&path)
    };
    let Some(path) = args.clip.as_ref().filter(|_| !args.suggest_map) else {
        raw(&plain::text(&suggest(&robot).map_err(within(&args.robot))?));
        return Ok(());
    };
    let mut assumed = Vec::new();
    let (text, from) = match &args.map {
        Some(map) => {
            let text = files::read_text(map).into_diagnostic().wrap_err_with(|| map.display().to_string())?;
            (text, map)
        }
        None => {
            assumed.push("the map is the one that --suggest-map prints".to_owned());
            (suggest(&robot).map_err(within(&args.robot))?, &args.robot)
        }
    };
    let map = RetargetMap::parse(&text).map_err(within(from))?;
    let reading = Reading { map: args.skeleton_map.clone(), ..Reading::default() };
    let options = reading.options()?;
    let mut clip = read_with(path, &options).into_diagnostic()?;
    if let Some(fps) = args.fps {
        clip = clip.resample(fps).into_diagnostic().wrap_err_with(|| path.display().to_string())?;
    }
    let joints = JointMap::choose(&clip.skeleton, options.map.as_ref()).into_diagnostic()?.ok_or_else(|| {
        miette!(
            help = "--skeleton-map FILE.toml names them; kinesic inspect lists the clip's joints",
            "{}: which joint is which is not known",
            path.display()
        )
    })?;
    let place = |error: RobotError| {
        let path = if error.place.starts_with("line") { &args.robot } else { from };
        error.in_file(path)
    };
    let mut moved = retarget(&robot, &map, &clip, &joints).map_err(place)?;
    moved.report.notes.extend(assumed);
    if let Some(out) = &args.out {
        write_whole(out, moved.csv(&robot).as_bytes())?;
    }
    let out = args.out.as_ref().map(|out| out.display().to_string());
    let summary = Summary { out, report: moved.report };
    if args.json {
        return print_json(&summary);
    }
    print(&summary, moved.joints.len());
    Ok(())
}

fn print(summary: &Summary, joints: usize) {
    let report = &summary.report;
    println!(
        "{:<14} {:>8} {:>8} {:>11} {:>11} {:>8}",
        "degrees", "median", "95 %", "reach: med.", "reach: 95 %", "zero"
    );
    for limb in &report.limbs {
        println!(
            "{:<14} {:>8.2} {:>8.2} {:>11.2} {:>11.2} {:>8.1}",
            limb.limb, limb.median, limb.p95, limb.reachable_median, limb.reachable_p95, limb.zero_median
        );
    }
    for at in &report.at_limit {
        println!("at its {} limit in {:.0} % of the frames: {}", at.limit, 100.0 * at.share, plain::line(&at.joint));
    }
    for note in &report.notes {
        println!("note: {}", plain::line(note));
    }
    let out = summary.out.as_ref().map_or(String::new(), |out| format!("{out}: "));
    println!(
        "{}{} frames, {joints} joints, {} values beyond a limit",
        plain::line(&out),
        report.frames,
        report.limits_exceeded
    );
}
