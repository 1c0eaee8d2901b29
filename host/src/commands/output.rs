//! What the commands share on the way out: whole files, JSON, progress.

use std::io::IsTerminal;
use std::path::Path;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use kinesic_host::clip::{Clip, Format};
use kinesic_host::limit::{Clamps, JointClamps};
use kinesic_host::moves::Moves;
use kinesic_host::robot::Machine;
use kinesic_host::{files, plain};
use miette::{IntoDiagnostic, WrapErr, miette};
use serde::Serialize;
use serde_json::Value;

use super::clips::NOTES;
use super::print;

/// Writes a file whole or not at all.
pub fn write_whole(path: &Path, bytes: &[u8]) -> miette::Result<()> {
    files::write_whole(path, bytes).map_err(|error| {
        miette!(
            help = "check that the folder exists and may be written to",
            "{}: cannot be written: {error}",
            path.display()
        )
    })
}

/// Refuses an output path before long work: wrong extension, or a folder that is not there.
pub fn check_output(path: &Path, extension: &str) -> miette::Result<()> {
    if path.extension().is_none_or(|found| !found.eq_ignore_ascii_case(extension)) {
        return Err(miette!(
            help = format!("name it {}", path.with_extension(extension).display()),
            "{}: the output is a .{extension} file",
            path.display()
        ));
    }
    check_folder(path)
}

/// Formats of a robot's motions.
pub const MOVES: [&str; 5] = ["csv", "json", "jsonl", "yaml", "yml"];

/// Whether the name is that of a robot's motion.
pub fn is_moves(path: &Path) -> bool {
    path.extension().is_some_and(|found| MOVES.iter().any(|own| found.eq_ignore_ascii_case(own)))
}

/// As [`check_output`], for a motion in a robot's joints.
pub fn check_moves(path: &Path) -> miette::Result<()> {
    if !is_moves(path) {
        return Err(miette!(
            help = format!("name it {}", path.with_extension("csv").display()),
            "{}: the output is a .csv, .json, .jsonl or .yaml file",
            path.display()
        ));
    }
    if Format::of(path) == Some(Format::Positions) {
        return Err(miette!(
            help = "write the moves first, then: kinesic export MOVES.csv --robot ROBOT.kin --out x.positions.csv",
            "{}: the output is a move in the robot's joints, expected another name than .positions.csv",
            path.display()
        ));
    }
    check_folder(path)
}

/// As [`check_output`], for a motion of a body or, with `machine`, of a robot: its extension says the format.
pub fn check_motion(path: &Path, machine: bool) -> miette::Result<()> {
    if machine && !is_moves(path) && Format::of(path).is_none() {
        return Err(miette!(
            help = format!("name it {}", path.with_extension("csv").display()),
            "{}: the output is a .csv, .json, .jsonl or .yaml file with what the servos take, or .bvh, .glb, .gltf for pictures",
            path.display()
        ));
    }
    if !machine && Format::of(path).is_none() {
        return Err(miette!(
            help = format!("name it {}", path.with_extension("bvh").display()),
            "{}: the output is a .bvh, .glb, .gltf, .csv (angles) or .positions.csv file",
            path.display()
        ));
    }
    check_folder(path)
}

/// Refuses a path whose folder is not there.
pub fn check_folder(path: &Path) -> miette::Result<()> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(miette!(
            help = format!("create it: mkdir -p {}", folder.display()),
            "{}: the folder {} does not exist",
            path.display(),
            folder.display()
        ));
    }
    Ok(())
}

/// Writes a motion in the format that its name says: a robot's in the numbers that its servos take, with what else was in the file that it
/// comes from.
pub fn write_motion(path: &Path, clip: &Clip, machine: Option<&Machine>, from: Option<&Moves>) -> miette::Result<()> {
    let format = Format::of(path);
    let picture = format.is_some_and(|format| format != Format::Csv);
    match machine {
        Some(machine) if format == Some(Format::Positions) => write_whole(path, machine.positions(clip).as_bytes()),
        Some(machine) if !picture => Ok(machine.moves(clip, from).write(path)?),
        _ => clip.write(path).into_diagnostic(),
    }
}

/// Prints what limits did to a motion.
pub fn print_clamps(clamps: &Clamps) {
    if clamps.joints.is_empty() {
        println!("limits     kept in all {} frames", clamps.frames);
        return;
    }
    let joint = |joint: &JointClamps| {
        let parts = [("range", joint.position), ("rate", joint.rate)];
        let parts: Vec<String> =
            parts.iter().filter(|(_, count)| *count > 0).map(|(what, count)| format!("{what} {count}")).collect();
        format!("{} ({})", plain::line(&joint.joint), parts.join(", "))
    };
    let joints: Vec<String> = clamps.joints.iter().map(joint).collect();
    println!("limits     clamped in {} of {} frames: {}", clamps.clamped_frames, clamps.frames, joints.join(", "));
}

/// Prints one JSON object, with what was assumed about the clips in `reading`.
pub fn print_json(value: &impl Serialize) -> miette::Result<()> {
    let mut value = serde_json::to_value(value).into_diagnostic().wrap_err("cannot write JSON")?;
    let notes = NOTES.take();
    if let Some(object) = value.as_object_mut()
        && !notes.is_empty()
    {
        object.insert("reading".into(), notes.into());
    }
    no_minus_zero(&mut value);
    let text = serde_json::to_string_pretty(&value).into_diagnostic().wrap_err("cannot write JSON")?;
    print::raw(&format!("{}\n", plain::json(&text)));
    Ok(())
}

/// Nothing is minus zero.
fn no_minus_zero(value: &mut Value) {
    match value {
        Value::Number(number) if number.as_f64() == Some(0.0) && number.is_f64() => *value = 0.0.into(),
        Value::Array(list) => list.iter_mut().for_each(no_minus_zero),
        Value::Object(object) => object.values_mut().for_each(no_minus_zero),
        _ => {}
    }
}

/// A spinner on standard error, silent where nobody watches.
pub fn spinner() -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new_spinner();
    bar.set_style(
        ProgressStyle::with_template("{spinner} {msg} ({elapsed})")
            .unwrap_or_else(|_| ProgressStyle::default_spinner()),
    );
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}
