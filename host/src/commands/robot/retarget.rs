//! `kinesic robot retarget`: a person's motion on a robot.

use std::path::{Path, PathBuf};

use kinesic_host::clip::{JointMap, ReadError, UpAxis, read_with};
use kinesic_host::robot::retarget::{Report, RetargetMap, retarget, suggest};
use kinesic_host::robot::{Robot, RobotError};
use kinesic_host::{files, plain};
use miette::{IntoDiagnostic, WrapErr, miette};
use serde::Serialize;

use super::is_table;
use crate::commands::clips::{self, Reading};
use crate::commands::inspect::is_pack;
use crate::commands::limits::frame_rate;
use crate::commands::output::{check_moves, print_json, spinner};
use crate::commands::print::raw;

/// Put a person's motion on a robot, within its limits
///
/// Every limb of the robot points where the person's does, as far as its joints let it. The result is a motion of the robot, as the other
/// commands take it. What the robot cannot do is said.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  kinesic robot retarget robot.urdf --suggest-map > map.toml
  kinesic robot retarget robot.urdf walk.bvh --map map.toml          # how well it goes, nothing is written
  kinesic robot retarget robot.urdf walk.bvh --map map.toml --out walk.csv
  kinesic robot retarget robot.urdf weary.bvh --map map.toml --robot robot.kin --fps 50 --out weary.csv --json
  kinesic train translate --robot robot.kin --pair walk.csv weary.csv --out weary.kin

A map says which joints or links of the robot are which limbs:
  forward = \"x\"              # axes of the root link
  up = \"z\"
  [limbs]
  torso = \"waist_yaw_joint\"  # a part that faces somewhere: torso, head, l_foot, r_foot
  head = \"head_pitch_joint\"
  l_upper_arm = [\"left_shoulder_roll_joint\", \"left_elbow_joint\"]
  l_forearm = { from = \"left_elbow_joint\", bone = [0, 0, -1] }
  [hold]
  jaw = 0.1                  # stays there, rad or m
Limbs: torso, head; with l_ or r_: upper_arm, forearm, hand, thigh, shin, foot; arm (shoulder to wrist) and leg (hip to ankle), whose length
counts too. The page 'From a person to a robot' explains them.")]
pub struct Args {
    /// A robot: .urdf, .xml (MJCF), or a pack that `kinesic robot import` made
    #[arg(value_name = "ROBOT")]
    file: PathBuf,
    /// Clip with the person's motion
    #[arg(value_name = "CLIP", required_unless_present = "suggest_map")]
    clip: Option<PathBuf>,
    /// Map (TOML) of limbs (default: the one that --suggest-map prints)
    #[arg(long, value_name = "FILE.toml")]
    map: Option<PathBuf>,
    /// Print a map made from the robot's names and geometry
    #[arg(long, conflicts_with_all = ["clip", "map", "out", "json"])]
    suggest_map: bool,
    /// Pack of the same robot: its bounds and speeds are kept beside the description's
    #[arg(long, value_name = "ROBOT.kin")]
    robot: Option<PathBuf>,
    /// Skeleton map (TOML) for a clip with unknown joint names
    #[arg(long, value_name = "FILE.toml")]
    skeleton_map: Option<PathBuf>,
    /// Up axis of the clip: x, y, z, -x, -y or -z (default: found from rest pose and motion)
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true)]
    up: Option<UpAxis>,
    /// Frames per second (default: the clip's)
    #[arg(long, value_name = "RATE", value_parser = frame_rate, allow_negative_numbers = true)]
    fps: Option<f64>,
    /// Motion to write: .csv, .json, .jsonl or .yaml; a column for every joint that leads, in rad or m (default: the report alone)
    #[arg(long, value_name = "MOVES")]
    out: Option<PathBuf>,
    /// Print the report as one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Summary {
    #[serde(skip_serializing_if = "Option::is_none")]
    out: Option<String>,
    robot: String,
    /// Joints with a value of their own.
    joints: usize,
    frame_rate: f64,
    #[serde(flatten)]
    report: Report,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    args.out.as_deref().map_or(Ok(()), check_moves)?;
    if is_table(&args.file) {
        let (file, pack) = (args.file.display(), args.file.with_extension("kin"));
        return Err(miette!(
            help = format!(
                "make a pack of it: kinesic robot import {file} --out {0}; then kinesic robot retarget {0}",
                pack.display()
            ),
            "{file}: found a table of servos, expected a robot's description (.urdf, .xml) or its pack (.kin)"
        ));
    }
    let mut robot = match is_pack(&args.file) {
        true => Robot::of_machine(&clips::robot(&args.file)?),
        false => Robot::read(&args.file)?,
    };
    if let Some(pack) = &args.robot {
        let machine = clips::robot(pack)?;
        if machine.servos.iter().all(|servo| robot.find(&servo.name).is_none()) {
            return Err(miette!(
                help = format!(
                    "make its pack: kinesic robot import {} --out robot.kin; or leave --robot out",
                    args.file.display()
                ),
                "{}: found no joint of {} in it, expected a pack of the same robot",
                pack.display(),
                args.file.display()
            ));
        }
        robot.keep(&machine);
    }
    let Some(path) = args.clip.as_ref().filter(|_| !args.suggest_map) else {
        raw(&plain::text(&suggest(&robot).map_err(|error| error.in_file(&args.file))?));
        return Ok(());
    };
    let mut assumed = Vec::new();
    if is_pack(&args.file) {
        assumed.push("a pack has joints that lead, and no others: followers stand still".to_owned());
    }
    let (text, from) = match &args.map {
        Some(map) => (read(map)?, map),
        None => {
            assumed.push("the map is the one that --suggest-map prints".to_owned());
            (suggest(&robot).map_err(|error| error.in_file(&args.file))?, &args.file)
        }
    };
    let map = RetargetMap::parse(&text).map_err(|error| error.in_file(from))?;
    let reading = Reading { map: args.skeleton_map.clone(), up: args.up, ..Reading::default() };
    let options = reading.options()?;
    let mut clip = match read_with(path, &options) {
        Err(ReadError::Machine { .. }) => {
            return Err(miette!(
                help = "give a clip of a person, as in walk.bvh",
                "{}: found a motion in the joints of a robot, expected a person's",
                path.display()
            ));
        }
        read => read.into_diagnostic()?,
    };
    if let Some(fps) = args.fps {
        clip = clip.resample(fps).into_diagnostic().wrap_err_with(|| path.display().to_string())?;
    }
    let joints = JointMap::choose(&clip.skeleton, options.map.as_ref()).into_diagnostic()?.ok_or_else(|| {
        miette!(
            help = format!(
                "--skeleton-map FILE.toml names them; kinesic inspect --suggest-map '{}' > FILE.toml makes one to look at",
                path.display()
            ),
            "{}: which joint is which is not known",
            path.display()
        )
    })?;
    let place = |error: RobotError| {
        let of_robot = ["line", "joint", "the robot"].iter().any(|word| error.place.starts_with(word));
        error.in_file(if of_robot { &args.file } else { from })
    };
    let bar = spinner();
    bar.set_message(format!("{} frames", clip.frames()));
    let mut moved = retarget(&robot, &map, &clip, &joints).map_err(place)?;
    bar.finish_and_clear();
    moved.report.notes.extend(assumed);
    if let Some(out) = &args.out {
        moved.moves(&robot).write(out)?;
    }
    let summary = Summary {
        out: args.out.as_ref().map(|out| out.display().to_string()),
        robot: robot.name.clone(),
        joints: moved.joints.len(),
        frame_rate: 1.0 / clip.frame_time,
        report: moved.report,
    };
    if args.json {
        return print_json(&summary);
    }
    print(&summary);
    Ok(())
}

fn read(path: &Path) -> miette::Result<String> {
    files::read_text(path).map_err(|error| {
        miette!(help = "check the path; the file is text in UTF-8", "{}: cannot be read: {error}", path.display())
    })
}

fn print(summary: &Summary) {
    let report = &summary.report;
    println!(
        "{:<14} {:>8} {:>8} {:>11} {:>11} {:>8}",
        "degrees off", "median", "95 %", "reach: med.", "reach: 95 %", "at zero"
    );
    for limb in &report.limbs {
        let length =
            limb.length_p95.map_or(String::new(), |off| format!("   length off by {:.0} % (95 %)", 100.0 * off));
        println!(
            "{:<14} {:>8.2} {:>8.2} {:>11.2} {:>11.2} {:>8.1}{length}",
            limb.limb, limb.median, limb.p95, limb.reachable_median, limb.reachable_p95, limb.zero_median
        );
    }
    for at in &report.at_limit {
        println!("at its {} limit in {:.0} % of the frames: {}", at.limit, 100.0 * at.share, plain::line(&at.joint));
    }
    for line in &report.cannot {
        println!("cannot: {}", plain::line(line));
    }
    for note in &report.notes {
        println!("note: {}", plain::line(note));
    }
    let quickest = report.quickest.as_ref().map_or(String::new(), |quickest| {
        format!("; at most {:.0} % of a speed limit ({})", 100.0 * quickest.share, quickest.joint)
    });
    let out = summary.out.as_ref().map_or(String::new(), |out| format!("{out}: "));
    let line = format!(
        "{out}{} frames of {} joints, {} values and {} speeds beyond a limit{quickest}",
        report.frames, summary.joints, report.limits_exceeded, report.speeds_exceeded
    );
    println!("{}", plain::line(&line));
}
