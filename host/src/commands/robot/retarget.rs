//! `kinesic robot retarget`.

use std::path::PathBuf;

use kinesic_host::files;
use kinesic_host::prepare::Source;
use kinesic_host::robot::Robot;
use kinesic_host::robot::retarget::{LimbFigures, LimbMap, Moves, retarget};
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use crate::commands::clips::Reading;
use crate::commands::output::{check_output, print_json, spinner, write_whole};

/// Lay a robot's limbs along a person's: a clip becomes values of the robot's joints
///
/// Limbs are compared by direction, so that sizes do not matter. Joints stay within the bounds and speeds of the description.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic robot retarget robot.urdf --suggest-map > robot.toml
  kinesic robot retarget robot.urdf walk.bvh --map robot.toml --out moves.csv

A map names, for each limb, the joint or link where it begins and the one where it ends, or an axis of the first:
  forward = \"x\"                  # axes of the root link
  up = \"z\"
  base = \"pelvis\"                # what the root link goes with: pelvis, heading (level) or chest
  [limbs]
  l_upper_arm = [\"left_shoulder_roll\", \"left_elbow\"]
  l_forearm = [\"left_elbow\", \"left_hand\"]
  gaze = [\"head_link\", \"x\"]
Limbs: trunk (up), shoulders (to the left), gaze (forward), crown (up), and with l_ or r_: upper_arm, forearm, hand, thigh, shin, foot.")]
pub struct Args {
    /// A robot (.urdf or .xml)
    #[arg(value_name = "ROBOT")]
    robot: PathBuf,
    /// A clip of a person
    #[arg(value_name = "CLIP", required_unless_present = "suggest_map")]
    clip: Option<PathBuf>,
    /// Map (TOML) from limbs to joints or links (default: suggested by names)
    #[arg(long, value_name = "FILE.toml")]
    map: Option<PathBuf>,
    /// Print the map that the robot's names suggest, and stop
    #[arg(long, conflicts_with_all = ["map", "out", "clip"])]
    suggest_map: bool,
    /// Skeleton map (TOML) for a clip with unknown joint names
    #[arg(long, value_name = "FILE.toml")]
    skeleton_map: Option<PathBuf>,
    /// Table to write (.csv): time_s, then each joint in rad, sliders in m
    #[arg(long, value_name = "FILE.csv", required_unless_present = "suggest_map")]
    out: Option<PathBuf>,
    /// Frames per second (default: the clip's)
    #[arg(long, value_name = "RATE", value_parser = frame_rate, allow_negative_numbers = true)]
    fps: Option<f64>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

fn frame_rate(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(rate) if (1.0..=1000.0).contains(&rate) => Ok(rate),
        _ => Err("expected 1 to 1000 frames a second".to_owned()),
    }
}

/// What is printed.
#[derive(Serialize)]
struct Summary<'a> {
    out: String,
    frames: usize,
    joints: usize,
    /// Degrees.
    limbs: &'a [LimbFigures],
    /// Joints at a bound in more than a tenth of the frames, and that part of them.
    at_bounds: &'a [(String, f64)],
    bounds_exceeded: usize,
    map: String,
    notes: &'a [String],
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let robot = Robot::read(&args.robot)?;
    let (map, mut notes) = match &args.map {
        None => LimbMap::suggest(&robot).map_err(|error| error.in_file(&args.robot))?,
        Some(path) => {
            let text = files::read_text(path).map_err(|error| {
                let help = "check the path; the file is text in UTF-8";
                miette!(help = help, "{}: cannot be read: {error}", path.display())
            })?;
            (LimbMap::parse(&text, &robot).map_err(|error| error.in_file(path))?, Vec::new())
        }
    };
    if args.suggest_map {
        for line in map.to_toml().lines() {
            println!("{line}");
        }
        notes.iter().for_each(|note| eprintln!("note: {note}"));
        return Ok(());
    }
    let (Some(clip), Some(out)) = (&args.clip, &args.out) else { return Ok(()) };
    check_output(out, "csv")?;
    let reading = Reading { map: args.skeleton_map.clone(), ..Reading::default() };
    let source = Source::read(clip, &reading.options()?).into_diagnostic()?;
    let resampled = args.fps.map(|fps| source.clip.resample(fps)).transpose().into_diagnostic()?;
    let bar = spinner();
    bar.set_message("solving");
    let place = |error: kinesic_host::robot::RobotError| {
        let path = if error.place.starts_with("the clip") { clip } else { args.map.as_ref().unwrap_or(&args.robot) };
        error.in_file(path)
    };
    let mut moves = retarget(&robot, resampled.as_ref().unwrap_or(&source.clip), &source.map, &map).map_err(place)?;
    bar.finish_and_clear();
    notes.append(&mut moves.notes);
    moves.notes =
        robot.joints.iter().flat_map(|joint| &joint.notes).chain(&robot.notes).cloned().chain(notes).collect();
    write_whole(out, moves.to_csv().as_bytes())?;
    print(args, &map, &moves, &out.display().to_string())
}

fn print(args: &Args, map: &LimbMap, moves: &Moves, out: &str) -> miette::Result<()> {
    if args.json {
        return print_json(&Summary {
            out: out.to_owned(),
            frames: moves.frames(),
            joints: moves.joints.len(),
            limbs: &moves.limbs,
            at_bounds: &moves.at_bounds,
            bounds_exceeded: moves.exceeded,
            map: map.to_toml(),
            notes: &moves.notes,
        });
    }
    println!("{out}: {} frames of {} joints", moves.frames(), moves.joints.len());
    println!();
    println!("limb         joints  median  95th percentile  at zero   (degrees off the person's)");
    for limb in &moves.limbs {
        let LimbFigures { limb: name, joints, median, percentile_95, zero_median } = limb;
        println!("{name:12} {joints:6} {median:7.1} {percentile_95:16.1} {zero_median:8.1}");
    }
    println!();
    println!("{} values beyond a bound", moves.exceeded);
    for (joint, part) in &moves.at_bounds {
        println!("{joint} is at a bound in {:.0} % of the frames", 100.0 * part);
    }
    for limb in moves.limbs.iter().filter(|limb| limb.joints == 0) {
        println!("{}: no joint turns it", limb.limb);
    }
    moves.notes.iter().for_each(|note| eprintln!("note: {note}"));
    Ok(())
}
