//! `kinesic limits`.

use std::path::{Path, PathBuf};

use kinesic_host::files;
use kinesic_host::limit::onto_body::{Import, Rates, RobotMap, import};
use kinesic_host::limit::{LimitsModel, Table};
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::plain;
use kinesic_host::prepare::Source;
use kinesic_host::rig::Rig;
use kinesic_host::robot::{Robot, RobotError};
use miette::{IntoDiagnostic, WrapErr, miette};
use serde::Serialize;

use super::clips::Reading;
use super::inspect::is_pack;
use super::origin::{command_line, fingerprint, made_from};
use super::output::{check_output, print_json, write_whole};

/// Frames per second of limits for a clip's skeleton.
const FRAME_RATE: f64 = 60.0;

/// Make joint limits from a robot's URDF, or print those of a pack
///
/// A map says which joints of the robot are which joint of the skeleton. Bounds and speeds come from the URDF; accelerations, which a
/// URDF does not have, from the map or --acceleration. On the device the limits are the last stage: servo angles never leave them.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic limits robot.urdf --map robot.toml --skeleton style.kin --acceleration 20 --out limits.kin
  kinesic limits robot.urdf --map robot.toml --with style.kin --out robot-style.kin     # a style trained on these limits
  kinesic limits limits.kin
  kinesic limits limits.kin --out limits.csv

A map names robot joints from the trunk outwards; skeleton joints by their own or their canonical name:
  acceleration = 20.0            # rad/s^2
  [joints]
  l_shoulder = [\"l_shoulder_pitch\", \"l_shoulder_roll\", \"l_shoulder_yaw\"]
  l_elbow = \"l_elbow\"
  l_wrist = { urdf = [\"l_wrist\"], lower = -0.5, upper = 0.5, velocity = 4.0, acceleration = 60.0, jerk = 2000.0 }
More keys: jerk (rad/s^3; without it, no limit), forward, up (axes of the root link, x and z); zero = \"rest\"; unmapped = \"fixed\"; root_velocity, root_acceleration,
heading_velocity, heading_acceleration, height, hold, decay; of a joint: kind (hinge, chain, ball, free), rest, bone. The page
'A body within a robot's limits' explains them.")]
pub struct Args {
    /// A robot (.urdf), or a pack with limits (.kin)
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Map (TOML) from skeleton joints to robot joints
    #[arg(long, value_name = "FILE.toml")]
    map: Option<PathBuf>,
    /// Pack or clip whose joints are limited: that of the motions that the robot plays
    #[arg(long, value_name = "FILE", conflicts_with = "with")]
    skeleton: Option<PathBuf>,
    /// Put the limits into this pack of models: the result holds both. Its style must be trained in the coordinates of the limits
    #[arg(long, value_name = "PACK.kin")]
    with: Option<PathBuf>,
    /// Skeleton map (TOML) for a clip with unknown joint names
    #[arg(long, value_name = "FILE.toml", requires = "skeleton")]
    skeleton_map: Option<PathBuf>,
    /// Acceleration of joints for which the map has none of their own, rad/s^2
    #[arg(long, value_name = "RAD/S2", value_parser = rate, allow_negative_numbers = true)]
    acceleration: Option<f64>,
    /// Jerk of joints for which the map has none of their own, rad/s^3; without one jerk is not limited
    #[arg(long, value_name = "RAD/S3", value_parser = jerk, allow_negative_numbers = true)]
    jerk: Option<f64>,
    /// Speed of joints for which neither URDF nor map has one, rad/s
    #[arg(long, value_name = "RAD/S", value_parser = rate, allow_negative_numbers = true)]
    velocity: Option<f64>,
    /// Frames per second at which the limiter is stepped (default: the pack's; 60 for a clip)
    #[arg(long, value_name = "RATE", conflicts_with = "with", value_parser = frame_rate, allow_negative_numbers = true)]
    fps: Option<f64>,
    /// Pack to write (.kin), or table to export (.csv, .toml, .json)
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print the table as one JSON object
    #[arg(long)]
    json: bool,
}

/// A speed or an acceleration from the command line.
pub fn rate(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(rate) if (1e-3..=1e5).contains(&rate) => Ok(rate),
        _ => Err("expected a number above 0, from 0.001 to 100000".to_owned()),
    }
}

/// A jerk from the command line.
pub fn jerk(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(jerk) if jerk == 0.0 || (1e-3..=1e9).contains(&jerk) => Ok(jerk),
        _ => Err("expected a number above 0, from 0.001 to 1e9, or 0 for no limit".to_owned()),
    }
}

/// A frame rate from the command line.
pub fn frame_rate(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(rate) if (1.0..=1000.0).contains(&rate) => Ok(rate),
        _ => Err("expected 1 to 1000 frames a second".to_owned()),
    }
}

/// What is printed: the table, and how it came about.
#[derive(Serialize)]
struct Summary {
    #[serde(skip_serializing_if = "Option::is_none")]
    out: Option<String>,
    #[serde(flatten)]
    table: Table,
    recovery_frames: u32,
    notes: Vec<String>,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    if is_pack(&args.file) { show(args) } else { make(args) }
}

fn show(args: &Args) -> miette::Result<()> {
    if args.map.is_some() || args.skeleton.is_some() || args.with.is_some() {
        return Err(miette!(
            help = "name the robot: kinesic limits robot.urdf --map map.toml --skeleton style.kin --out limits.kin",
            "{}: found a pack, expected a URDF beside --map",
            args.file.display()
        ));
    }
    if let Some(out) = &args.out {
        check_table(out)?;
    }
    let file = PackFile::read(&args.file).into_diagnostic()?;
    let pack = file.pack().into_diagnostic()?;
    let model = LimitsModel::from_pack(&pack).map_err(|error| {
        miette!(
            help = "kinesic limits robot.urdf --map map.toml --with PACK.kin --out FILE.kin puts limits into it",
            "{}: {error}",
            args.file.display()
        )
    })?;
    let rig = Rig::from_pack(&pack).into_diagnostic()?;
    finish(args, &model, &rig, &[], Vec::new(), None)
}

fn make(args: &Args) -> miette::Result<()> {
    let map = args.map.as_ref().ok_or_else(|| {
        miette!(
            help = "write one, see kinesic limits --help, and give it with --map FILE.toml",
            "{}: which of the robot's joints are which of the skeleton's is not known without --map",
            args.file.display()
        )
    })?;
    let skeleton = args.with.as_ref().or(args.skeleton.as_ref()).ok_or_else(|| {
        miette!(
            help = "--skeleton style.kin (the pack that the robot plays), --skeleton walk.bvh, or --with style.kin",
            "{}: whose joints are to be limited is not known without --skeleton",
            args.file.display()
        )
    })?;
    let out = args.out.as_ref().ok_or_else(|| miette!(help = "add --out limits.kin", "there is no --out"))?;
    match out.extension().is_some_and(|found| found.eq_ignore_ascii_case("kin")) || args.with.is_some() {
        true => check_output(out, "kin")?,
        false => check_table(out)?,
    }
    let read = |path: &Path| {
        files::read_text(path).map_err(|error| {
            miette!(help = "check the path; the file is text in UTF-8", "{}: cannot be read: {error}", path.display())
        })
    };
    let within = |path: &Path| {
        let path = path.to_owned();
        move |error: RobotError| error.in_file(&path)
    };
    let robot = Robot::parse(&read(&args.file)?).map_err(within(&args.file))?;
    let known = RobotMap::parse(&read(map)?).map_err(within(map))?;
    let base = skeleton_of(args, skeleton)?;
    let rates = Rates { velocity: args.velocity, acceleration: args.acceleration, jerk: args.jerk };
    let place = |error: RobotError| {
        let path = if error.place.starts_with("joint") { &args.file } else { map };
        error.in_file(path)
    };
    let frame_rate = args.fps.unwrap_or(base.frame_rate);
    let Import { mut model, urdf, notes } =
        import(&robot, &known, &base.rig, &robot.name, frame_rate, rates).map_err(place)?;
    let mut provenance = Provenance {
        tool: format!("kinesic {}", env!("CARGO_PKG_VERSION")),
        command: command_line(),
        ..Provenance::default()
    };
    let before = args.with.as_ref().and(base.pack.as_ref());
    if before.is_some() {
        model = model.onto(&base.rig).map_err(|mismatch| {
            miette!(
                help = "train the style in the coordinates of the limits: kinesic limits without --with, then train with --limits \
                        limits.kin; or keep two packs and step two pipelines, the limits' after the style's",
                "{}: {mismatch}",
                skeleton.display()
            )
        })?;
    }
    if let Some(earlier) = before.and_then(PackFile::provenance) {
        provenance = Provenance { tool: provenance.tool, ..made_from(earlier, None) };
    }
    for path in [&args.file, map] {
        provenance.inputs.push(fingerprint(path)?);
    }
    let joints = base.rig.skeleton.joints.iter().zip(&urdf).filter(|(_, names)| !names.is_empty());
    provenance.notes.extend(joints.map(|(joint, names)| format!("limits of {}: {}", joint.name, names.join(", "))));
    provenance.notes.extend(notes.iter().cloned());
    let bytes = match before {
        Some(file) => model.pack_with(&file.pack().into_diagnostic()?, &base.rig, &provenance).into_diagnostic()?,
        None => model.pack(&base.rig, &provenance).into_diagnostic()?,
    };
    finish(args, &model, &base.rig, &urdf, notes, Some(&bytes))
}

/// Whose joints are limited.
struct Base {
    rig: Rig,
    frame_rate: f64,
    pack: Option<PackFile>,
}

fn skeleton_of(args: &Args, path: &Path) -> miette::Result<Base> {
    if args.with.is_some() || is_pack(path) {
        let file = PackFile::read(path).into_diagnostic()?;
        let pack = file.pack().into_diagnostic()?;
        let rig = Rig::from_pack(&pack).into_diagnostic().wrap_err_with(|| path.display().to_string())?;
        let frame_rate = f64::from(pack.metadata().frame_rate);
        return Ok(Base { rig, frame_rate, pack: Some(file) });
    }
    let reading = Reading { map: args.skeleton_map.clone(), ..Reading::default() };
    let source = Source::read(path, &reading.options()?).into_diagnostic()?;
    Ok(Base { rig: source.rig().into_diagnostic()?, frame_rate: FRAME_RATE, pack: None })
}

/// Refuses the path of a table before long work.
fn check_table(path: &Path) -> miette::Result<()> {
    let known = ["csv", "toml", "json"];
    match path.extension().and_then(|found| found.to_str()).map(str::to_lowercase) {
        Some(found) if known.contains(&found.as_str()) => check_output(path, &found),
        _ => Err(miette!(
            help = format!("name it {}", path.with_extension("csv").display()),
            "{}: found another extension, expected .kin (from a URDF), .csv, .toml or .json",
            path.display()
        )),
    }
}

fn finish(
    args: &Args,
    model: &LimitsModel,
    rig: &Rig,
    urdf: &[Vec<String>],
    notes: Vec<String>,
    pack: Option<&[u8]>,
) -> miette::Result<()> {
    let names: Vec<String> = rig.skeleton.joints.iter().map(|joint| joint.name.clone()).collect();
    let table = Table::new(model, &names, urdf);
    let recovery_frames = model.recovery_frames(rig).into_diagnostic()?;
    if let Some(out) = &args.out {
        let extension = out.extension().map(|found| found.to_ascii_lowercase());
        let text = match extension.as_ref().and_then(|found| found.to_str()) {
            Some("csv") => table.csv(),
            Some("toml") => toml::to_string(&table).into_diagnostic()?,
            Some("json") => serde_json::to_string_pretty(&table).into_diagnostic()? + "\n",
            _ => String::new(),
        };
        write_whole(out, if text.is_empty() { pack.unwrap_or_default() } else { text.as_bytes() })?;
    }
    let out = args.out.as_ref().map(|out| out.display().to_string());
    let summary = Summary { out, table, recovery_frames, notes };
    if args.json {
        return print_json(&summary);
    }
    print(&summary);
    Ok(())
}

fn print(summary: &Summary) {
    let table = &summary.table;
    println!(
        "{:<16} {:<6} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8}",
        "joint", "kind", "lower", "upper", "rest", "rad/s", "rad/s^2", "rad/s^3"
    );
    for joint in &table.joints {
        for (at, (velocity, acceleration)) in joint.velocity.iter().zip(&joint.acceleration).enumerate() {
            let (name, kind) = if at == 0 { (joint.joint.as_str(), joint.kind) } else { ("", "") };
            let cell = |list: &[f64]| list.get(at).map_or("-".to_owned(), |x| format!("{x:.3}"));
            let jerk = joint.jerk.get(at).filter(|jerk| **jerk > 0.0).map_or("-".to_owned(), |x| format!("{x:.0}"));
            let urdf = joint.urdf.get(at).map_or("", |name| name);
            let line = format!(
                "{name:<16} {kind:<6} {:>8} {:>8} {:>8} {velocity:>8.2} {acceleration:>8.1} {jerk:>8}  {urdf}",
                cell(&joint.lower),
                cell(&joint.upper),
                cell(&joint.rest)
            );
            println!("{}", plain::line(line.trim_end()));
        }
    }
    let height = &table.height;
    println!(
        "root             {} m/s, {} m/s^2; height {:.3} .. {:.3} m, at rest {:.3} m, {} m/s, {} m/s^2",
        table.root_velocity,
        table.root_acceleration,
        height.lower,
        height.upper,
        height.rest,
        height.velocity,
        height.acceleration
    );
    println!("heading          {} rad/s, {} rad/s^2", table.heading_velocity, table.heading_acceleration);
    println!(
        "faults           held for {} s, to rest in about {} s; back within {} frames",
        table.hold, table.decay, summary.recovery_frames
    );
    for note in &summary.notes {
        println!("note: {}", plain::line(note));
    }
    if let Some(out) = &summary.out {
        let limited = table.joints.iter().filter(|joint| !joint.lower.is_empty()).count();
        println!("{out}: {limited} of {} joints limited, {} frames per second", table.joints.len(), table.frame_rate);
    }
}
