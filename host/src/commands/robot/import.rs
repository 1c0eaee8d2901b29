//! `kinesic robot import`.

use std::path::PathBuf;

use kinesic_host::files;
use kinesic_host::moves;
use kinesic_host::pack::Provenance;
use kinesic_host::plain;
use kinesic_host::robot::{Defaults, Machine, Robot, RobotError, ServoTable};
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use super::table::{self, Coordinate};
use crate::commands::limits::{frame_rate, jerk, rate};
use crate::commands::origin::{command_line, fingerprint};
use crate::commands::output::{check_output, print_json, write_whole};

/// Make a robot's pack: every movable joint, its limits, and the numbers that its servo takes
///
/// From a description (URDF, or MJCF of MuJoCo) or, where there is none, from a table of servos (TOML) alone. The pack is what the other commands take as
/// --robot; a style trained with it holds it too. Followers (mimic) have no coordinate of their own, and fixed joints are folded away.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic robot import desk.urdf --servos desk.toml --acceleration 40 --out desk.kin
  kinesic robot import desk.toml --out desk.kin
  kinesic robot import arm.urdf --zero-from standing.csv --out arm.kin --json
  kinesic train translate --robot desk.kin --pair calm.csv lively.csv --out lively.kin

A table of servos; numbers are in the servo's own unit (rad, deg, m, mm, ticks, us):
  name = \"desk robot\"
  [[servo]]
  name = \"pan\"              # the joint's name
  id = 1
  unit = \"ticks\"
  per_turn = 4096
  zero = 2048               # its value where the joint is at 0
  sign = -1                 # it counts the other way
  min = 1024
  max = 3072
  speed = 3000              # per second
  acceleration = 20000      # per second squared
  jerk = 400000             # per second cubed; without it, or at 0, no limit
  rest = 2048               # where it rests; without it the joint's 0
  [[servo]]
  name = \"tilt\"
  unit = \"deg\"
  parent = \"pan\"            # without a description only: the servo before it that carries it,
  offset = [0, 0, 0.1]      # where it sits on that, m, Z up,
  axis = [0, 1, 0]          # and the axis about which it turns or along which it slides
  [[pose]]                  # a platform that its own firmware solves: head_x ... head_yaw
  name = \"head\"
  min = [-0.02, -0.02, -0.02, -0.7, -0.7, -3.1]    # x, y, z in m, roll, pitch, yaw in rad
  max = [0.02, 0.02, 0.02, 0.7, 0.7, 3.1]
  speed = 2                 # m and rad, per second
  acceleration = 10         # per second squared
  jerk = 100                # per second cubed; without it, or at 0, no limit
A slider with ticks or us takes per_turn as those of a metre. The page 'Describe a robot' explains all keys.")]
pub struct Args {
    /// A robot: .urdf, .xml (MJCF), or a table of servos .toml
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Table of servos of a robot with a description
    #[arg(long, value_name = "FILE.toml")]
    servos: Option<PathBuf>,
    /// Motion whose first frame is every servo's zero: the robot stood at its description's zero
    #[arg(long, value_name = "MOVES")]
    zero_from: Option<PathBuf>,
    /// Acceleration of joints for which the table has none, rad/s^2 and m/s^2 (default: full speed in 0.2 s)
    #[arg(long, value_name = "RAD/S2", value_parser = rate, allow_negative_numbers = true)]
    acceleration: Option<f64>,
    /// Jerk of joints for which the table has none, rad/s^3 and m/s^3 (default: no limit)
    #[arg(long, value_name = "RAD/S3", value_parser = jerk, allow_negative_numbers = true)]
    jerk: Option<f64>,
    /// Speed of joints for which neither description nor table has one, rad/s and m/s (default: 6.28 and 0.5)
    #[arg(long, value_name = "RAD/S", value_parser = rate, allow_negative_numbers = true)]
    velocity: Option<f64>,
    /// Frames per second at which the robot is told where to go
    #[arg(long, value_name = "RATE", default_value_t = 50.0, value_parser = frame_rate, allow_negative_numbers = true)]
    fps: f64,
    /// Pack to write
    #[arg(long, value_name = "ROBOT.kin")]
    out: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Summary {
    out: String,
    robot: String,
    bytes: usize,
    frame_rate: f64,
    /// Joints of the description, fixed ones and followers among them.
    described_joints: usize,
    /// Servos of the table.
    servos: usize,
    /// Poses of the table.
    poses: usize,
    #[serde(skip)]
    is_table: bool,
    coordinates: Vec<Coordinate>,
    notes: Vec<String>,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    check_output(&args.out, "kin")?;
    let defaults = Defaults { velocity: args.velocity, acceleration: args.acceleration, jerk: args.jerk };
    let is_table = super::is_table(&args.file);
    let mut table = match (is_table, &args.servos) {
        (true, Some(other)) => {
            return Err(miette!(
                help = "write one table, or give the description first: kinesic robot import robot.urdf --servos servos.toml",
                "{}: found two tables of servos, the other is {}",
                args.file.display(),
                other.display()
            ));
        }
        (true, None) => read_table(&args.file)?,
        (false, Some(path)) => read_table(path)?,
        (false, None) => ServoTable::default(),
    };
    let in_file = |error: RobotError| {
        let table = args.servos.as_ref().filter(|_| error.place.starts_with("[["));
        error.in_file(table.unwrap_or(&args.file))
    };
    let mut inputs = vec![fingerprint(&args.file)?];
    inputs.extend(args.servos.as_ref().map(|path| fingerprint(path)).transpose()?);
    let robot = match is_table {
        true => None,
        false => Some(Robot::read(&args.file)?),
    };
    if let Some(path) = &args.zero_from {
        let moves = moves::read(path, &moves::Options { rate: Some(args.fps), episode: None }).into_diagnostic()?;
        let own: Vec<String> = table.servos.iter().map(|servo| servo.name.clone()).collect();
        let described = robot.iter().flat_map(|robot| &robot.joints).map(|joint| joint.name.as_str());
        let joints: Vec<&str> = own.iter().map(String::as_str).chain(described).collect();
        table.zero_from(&moves, &joints).map_err(|error| miette!("{}: {error}", path.display()))?;
        inputs.push(fingerprint(path)?);
    }
    let (machine, described) = match &robot {
        Some(robot) => (Machine::of_robot(robot, &table, args.fps, defaults), robot.joints.len()),
        None => (Machine::of_table(&table, args.fps, defaults), table.servos.len()),
    };
    let machine = machine.map_err(in_file)?;
    let provenance = Provenance {
        tool: format!("kinesic {}", env!("CARGO_PKG_VERSION")),
        command: command_line(),
        inputs,
        notes: machine.notes.clone(),
        ..Provenance::default()
    };
    let bytes = machine.pack(None, &provenance).into_diagnostic()?;
    write_whole(&args.out, &bytes)?;
    let summary = Summary {
        out: args.out.display().to_string(),
        robot: machine.name.clone(),
        bytes: bytes.len(),
        frame_rate: args.fps,
        described_joints: described,
        servos: table.servos.len(),
        poses: table.poses.len(),
        is_table,
        coordinates: table::coordinates(&machine),
        notes: machine.notes.clone(),
    };
    if args.json {
        return print_json(&summary);
    }
    print(&summary);
    Ok(())
}

fn text(path: &std::path::Path) -> miette::Result<String> {
    files::read_text(path).map_err(|error| {
        miette!(help = "check the path; the file is text in UTF-8", "{}: cannot be read: {error}", path.display())
    })
}

fn read_table(path: &std::path::Path) -> miette::Result<ServoTable> {
    Ok(ServoTable::parse(&text(path)?).map_err(|error| error.in_file(path))?)
}

fn print(summary: &Summary) {
    table::print(&summary.coordinates);
    for note in &summary.notes {
        println!("note: {}", plain::line(note));
    }
    let count = |count: usize, one: &str| match count {
        0 => None,
        1 => Some(format!("1 {one}")),
        many => Some(format!("{many} {one}s")),
    };
    let (servos, joints, poses) =
        (count(summary.servos, "servo"), count(summary.described_joints, "joint"), count(summary.poses, "pose"));
    let from = match summary.is_table {
        true => format!(": {}", [servos, poses].into_iter().flatten().collect::<Vec<_>>().join(", ")),
        false => format!(" of {}", [joints, poses].into_iter().flatten().collect::<Vec<_>>().join(" and ")),
    };
    println!(
        "{}: {}, {}{from}, {} frames per second, {} bytes",
        summary.out,
        plain::line(&summary.robot),
        count(summary.coordinates.len(), "coordinate").unwrap_or_default(),
        summary.frame_rate,
        summary.bytes
    );
}
