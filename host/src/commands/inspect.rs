//! `kinesic inspect`.

use std::path::{Path, PathBuf};

use kinesic::Pack;
use kinesic::model::{JointMeta, MAGIC, ModelMeta, VERSION};
use kinesic_host::clip::{self, Clip, JointMap, ReadError};
use kinesic_host::engines::known;
use kinesic_host::files;
use kinesic_host::moves::{Summary, unit_name};
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::plain::line;
use kinesic_host::rig::Rig;
use kinesic_host::robot::Machine;
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use super::clips::Reading;
use super::figure::figure;
use super::output::print_json;
use super::robot::table;
use super::suggest;

/// Say what a clip or a pack holds, and what is wrong with it
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic inspect walk.bvh
  kinesic inspect angry.kin --json
  kinesic inspect mine.bvh --suggest-map > my-skeleton.toml       # look at it, then
  kinesic inspect mine.bvh --map my-skeleton.toml
  kinesic inspect nod.csv --robot desk.kin

A skeleton map names the joints of a skeleton that is not known (canonical name = name in the file):
  units = \"cm\"
  [joints]
  pelvis = \"Root Bone\"
  l_hip = \"thigh.L\"
  r_hip = \"thigh.R\"
Canonical names: pelvis spine chest neck head, and with l_ or r_: collar shoulder elbow wrist hip knee ankle toe")]
pub struct Args {
    /// A clip (BVH, glTF, Kinect CSV), a motion of a robot (CSV, JSON, YAML) or a pack (.kin)
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    /// Print a skeleton map made from hierarchy, lengths of bones and motion, for joint names that are not known
    #[arg(long, conflicts_with_all = ["map", "strict"])]
    suggest_map: bool,
    #[command(flatten)]
    reading: Reading,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    if args.suggest_map {
        return suggest::run(&args.file, args.json, &args.reading);
    }
    if is_pack(&args.file) {
        return pack(&args.file, args.json);
    }
    let options = clip::ReadOptions { log: None, ..args.reading.options()? };
    if options.machine.is_some() {
        return moves(args, &options);
    }
    match clip::read_with(&args.file, &options) {
        Err(ReadError::Machine { .. }) => moves(args, &options),
        read => clip(args, &options, &read.into_diagnostic()?),
    }
}

/// By name, or by content: a damaged pack should be refused as a pack.
pub fn is_pack(path: &Path) -> bool {
    let starts = || {
        let mut head = [0; 4];
        let open = || files::check_regular(path).and_then(|()| std::fs::File::open(path));
        let read = open().and_then(|mut file| std::io::Read::read_exact(&mut file, &mut head));
        read.is_ok() && head == MAGIC
    };
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("kin")) || starts()
}

#[derive(Serialize)]
struct ClipReport {
    file: String,
    #[serde(flatten)]
    summary: clip::Summary,
    joint_names: Vec<String>,
    canonical: Vec<(&'static str, String)>,
}

#[derive(Serialize)]
struct MovesReport {
    file: String,
    #[serde(flatten)]
    summary: Summary,
    /// What the robot makes of it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    robot: Vec<String>,
}

/// A motion in the joints of a robot: as the file has it, and with a robot what was assumed on the way to its coordinates.
fn moves(args: &Args, options: &clip::ReadOptions) -> miette::Result<()> {
    let found = kinesic_host::moves::read(&args.file, &options.moves)?;
    let mut robot = Vec::new();
    let mut summary = found.summary();
    if let Some(machine) = &options.machine {
        let refuse = |error| miette!("{}: {error}", args.file.display());
        let clip = machine.clip(&found, options.angles).map_err(refuse)?;
        for (channel, unit) in summary.channels.iter_mut().zip(machine.units(&found, options.angles).map_err(refuse)?) {
            channel.unit = unit.map(unit_name);
        }
        robot.push(format!("Fits the robot '{}': {} coordinates.", machine.name, machine.servos.len()));
        robot.extend(clip.notes.iter().skip(found.notes.len()).cloned());
    }
    let report = MovesReport { file: args.file.display().to_string(), summary, robot };
    if args.json {
        return print_json(&report);
    }
    let s = &report.summary;
    let clock = if s.even { "" } else { ", uneven" };
    println!("{}: {} frames at {:.2} a second{clock}, {:.2} s", report.file, s.frames, s.fps, s.duration_s);
    println!("{:<24} {:<8} {:>12} {:>12} {:>14}", "joint", "unit", "least", "greatest", "fastest, 1/s");
    for c in &s.channels {
        let unit = c.unit.unwrap_or("?");
        println!("{}", line(&format!("{:<24} {unit:<8} {:>12.4} {:>12.4} {:>14.3}", c.name, c.min, c.max, c.speed)));
    }
    if !s.extra.is_empty() {
        println!("beside     {}", line(&s.extra.join(", ")));
    }
    for note in s.notes.iter().chain(&report.robot) {
        println!("note: {}", line(note));
    }
    if s.channels.iter().any(|c| c.unit.is_none()) && report.robot.is_empty() {
        println!("note: the file names no unit for some joints; with a robot its own are assumed (--robot, --angles)");
    }
    Ok(())
}

fn clip(args: &Args, options: &clip::ReadOptions, clip: &Clip) -> miette::Result<()> {
    let map = JointMap::choose(&clip.skeleton, options.map.as_ref()).into_diagnostic()?;
    let name = |joint: usize| clip.skeleton.joints[joint].name.clone();
    let known = |map: &JointMap| {
        let joint = |c: clip::Canonical| Some((c.name(), name(map.joint(c)?)));
        clip::Canonical::ALL.into_iter().filter_map(joint).collect()
    };
    let report = ClipReport {
        file: args.file.display().to_string(),
        summary: clip.summary(),
        joint_names: (0..clip.skeleton.len()).map(name).collect(),
        canonical: map.as_ref().map(known).unwrap_or_default(),
    };
    if args.json {
        return print_json(&report);
    }
    let s = &report.summary;
    println!("{}: {} frames at {:.4} a second, {:.2} s", report.file, s.frames, s.fps, s.duration_s);
    let layout =
        map.as_ref().map_or("unknown names: --suggest-map makes a skeleton map, --map takes it", JointMap::layout);
    println!("skeleton   {} joints, {layout}, about {:.2} m from pelvis chain and legs", s.joints, s.height_m);
    println!("height     joints between {} m and {} m", figure(s.vertical_m[0], 2), figure(s.vertical_m[1], 2));
    println!("joints     {}", line(&report.joint_names.join(", ")));
    for note in &s.notes {
        println!("note: {}", line(note));
    }
    Ok(())
}

#[derive(Serialize)]
struct PackReport {
    file: String,
    kind: String,
    name: String,
    frame_rate: f32,
    bytes: usize,
    tensor_bytes: usize,
    joints: Vec<String>,
    models: Vec<ModelReport>,
    tensors: Vec<(String, String, [u32; 2])>,
    /// Of a robot: its coordinates and what their servos take.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    coordinates: Vec<table::Coordinate>,
    provenance: Option<Provenance>,
}

/// A model, checked by loading it as the device would, and its figures by name.
#[derive(Serialize)]
pub struct ModelReport {
    /// Name of the engine.
    pub engine: &'static str,
    /// Shape, capacity, cost.
    #[serde(flatten)]
    pub figures: serde_json::Map<String, serde_json::Value>,
}

fn model(pack: &Pack, meta: &ModelMeta, rows: usize) -> miette::Result<ModelReport> {
    let engine = known(meta);
    let figures = engine.figures(pack, rows).into_diagnostic()?;
    let serde_json::Value::Object(figures) = figures else { unreachable!("figures are an object") };
    Ok(ModelReport { engine: engine.name(), figures })
}

/// What every model in a pack needs and does, by name.
pub fn models(pack: &Pack) -> miette::Result<Vec<ModelReport>> {
    let metadata = pack.metadata();
    // A face has no joints, and no rig.
    let rows = kinesic::Rig::load(pack).map_or(0, |rig| rig.rows());
    metadata.models.iter().map(|meta| model(pack, &meta, rows)).collect()
}

fn pack(path: &Path, json: bool) -> miette::Result<()> {
    let file = PackFile::read(path).into_diagnostic()?;
    let pack = file.pack().into_diagnostic()?;
    let metadata = pack.metadata();
    // A face has no joints.
    if metadata.models.iter().any(|model| model.face().is_none()) {
        Rig::from_pack(&pack).into_diagnostic()?;
    }
    let joints: Vec<JointMeta> = metadata.joints.iter().collect();
    let report = PackReport {
        file: path.display().to_string(),
        kind: format!("{:?}", pack.kind()),
        name: metadata.name.to_owned(),
        frame_rate: metadata.frame_rate,
        bytes: file.bytes().len(),
        tensor_bytes: pack.payload_len(),
        joints: joints.iter().map(|joint| joint.name.to_owned()).collect(),
        models: models(&pack)?,
        tensors: metadata.tensors.iter().map(|t| (t.name.to_owned(), format!("{:?}", t.kind), t.shape)).collect(),
        coordinates: Machine::from_pack(&pack).into_diagnostic()?.map_or_else(Vec::new, |m| table::coordinates(&m)),
        provenance: file.provenance(),
    };
    if json {
        return print_json(&report);
    }
    println!("{}: {} pack {:?}, format {}, checksum correct", report.file, report.kind, report.name, VERSION);
    println!("rate       {} frames a second", report.frame_rate);
    println!("size       {} bytes, of which {} are tensors, used in place", report.bytes, report.tensor_bytes);
    println!("joints     {}: {}", joints.len(), line(&report.joints.join(", ")));
    for m in &report.models {
        println!("model      {}", m.engine);
        for (name, value) in &m.figures {
            println!(
                "           {:<42} {}",
                name.replace('_', " "),
                line(&value.as_str().map_or(value.to_string(), str::to_owned))
            );
        }
    }
    if !report.coordinates.is_empty() {
        table::print(&report.coordinates);
    }
    println!("tensors");
    for (name, kind, [rows, columns]) in &report.tensors {
        println!("           {:<28} {kind} {rows} x {columns}", line(name));
    }
    if let Some(provenance) = &report.provenance {
        println!("made by    {} with: {}", line(&provenance.tool), line(&provenance.command));
        for input in &provenance.inputs {
            let digest: String = input.sha256.chars().take(16).collect();
            println!("trained on {} (sha256 {})", line(&input.path), line(&digest));
        }
        for metric in &provenance.metrics {
            println!("           {:<24} {}", line(&metric.name), figure(metric.value, 2));
        }
        for note in &provenance.notes {
            println!("note: {}", line(note));
        }
    }
    Ok(())
}
