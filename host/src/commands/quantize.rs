//! `kinesic quantize`.

use std::path::PathBuf;

use kinesic::Pack;
use kinesic_host::pack::{Metric, PackFile};
use kinesic_host::prepare::Source;
use kinesic_host::quantise::{Difference, difference, to_int8};
use kinesic_host::rig::Rig;
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use super::clips::{Reading, clip_paths};
use super::output::{check_output, command_line, print_json, spinner, write_whole};

/// Store the weights of a body-mechanics network as int8, for parts without an FPU and with little flash
///
/// Rows get a scale each, activations are int16, sums int32. With --clips the error against the f32 pack is measured, through the
/// device's own code, and kept in the pack.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic quantize models/mechanics.kin --precision i8 --out mechanics-i8.kin
  kinesic quantize models/mechanics.kin --clips walk.bvh dances/ --out mechanics-i8.kin --json")]
pub struct Args {
    /// Body-mechanics pack in f32
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// Number type of the weights
    #[arg(long, value_enum, default_value_t = Precision::I8)]
    precision: Precision,
    /// Clips to measure the error on: files, folders, tables
    #[arg(long, value_name = "CLIPS", num_args = 1..)]
    clips: Vec<PathBuf>,
    /// Pack to write
    #[arg(long, value_name = "FILE.kin")]
    out: PathBuf,
    /// Random seed; rounding makes no random choice
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object: out, bytes, bytes_f32, clips, error
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

/// Number type of the weights.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Precision {
    /// int8 with a scale a row
    I8,
}

#[derive(Serialize)]
struct Summary {
    out: String,
    bytes: usize,
    bytes_f32: usize,
    clips: usize,
    error: Option<Difference>,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    check_output(&args.out, "kin")?;
    let Precision::I8 = args.precision;
    let file = PackFile::read(&args.pack).into_diagnostic()?;
    let mut provenance =
        file.provenance().ok_or_else(|| miette!("{}: its provenance cannot be read", args.pack.display()))?;
    provenance.notes.push(format!("int8 weights, from a pack that was made with: {}", provenance.command));
    provenance.command = command_line();
    let bar = spinner();
    let rounded = PackFile::from_bytes(&to_int8(&file, &provenance)?);
    let (before, after) = (file.pack().into_diagnostic()?, rounded.pack().into_diagnostic()?);
    let mut error = None;
    let mut count = 0;
    if !args.clips.is_empty() {
        let paths = clip_paths(&args.clips)?;
        count = paths.len();
        let found = measure(args, &paths, &before, &after, &|news| bar.set_message(news))?;
        let metric = |name: &str, value| Metric { name: name.to_owned(), value };
        provenance.metrics.push(metric("int8_mean_deg", found.mean_deg));
        provenance.metrics.push(metric("int8_p99_deg", found.p99_deg));
        provenance.metrics.push(metric("int8_worst_deg", found.worst_deg));
        provenance.metrics.push(metric("int8_frames", found.frames as f64));
        error = Some(found);
    }
    let bytes = to_int8(&file, &provenance)?;
    bar.finish_and_clear();
    write_whole(&args.out, &bytes)?;
    let summary = Summary {
        out: args.out.display().to_string(),
        bytes: bytes.len(),
        bytes_f32: file.bytes().len(),
        clips: count,
        error,
    };
    if args.json {
        return print_json(&summary);
    }
    println!("{}: {} bytes instead of {}", summary.out, summary.bytes, summary.bytes_f32);
    match &summary.error {
        Some(e) => println!(
            "against f32, degrees a joint over {} frames: mean {:.3}, 99 % below {:.3}, worst {:.3}",
            e.frames, e.mean_deg, e.p99_deg, e.worst_deg
        ),
        None => println!("the error was not measured: name clips with --clips"),
    }
    Ok(())
}

fn measure(
    args: &Args,
    paths: &[PathBuf],
    before: &Pack,
    after: &Pack,
    say: &dyn Fn(String),
) -> miette::Result<Difference> {
    let rig = Rig::from_pack(before).into_diagnostic()?;
    let fps = f64::from(before.metadata().frame_rate);
    let options = args.reading.options()?;
    let mut clips = Vec::new();
    for (index, path) in paths.iter().enumerate() {
        say(format!("clip {} of {}", index + 1, paths.len()));
        let source = Source::read(path, &options).into_diagnostic()?;
        clips.push(rig.poses(&source.on_rig(&rig, fps).into_diagnostic()?));
    }
    difference(before, after, &clips).into_diagnostic()
}
