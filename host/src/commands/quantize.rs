//! `kinesic quantize`.

use std::path::PathBuf;

use kinesic::Pack;
use kinesic_host::pack::{Metric, PackFile};
use kinesic_host::prepare::Source;
use kinesic_host::quantise::{Difference, difference, translated_difference};
use kinesic_host::rig::Rig;
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use super::clips::{Reading, clip_paths};
use super::origin::made_from;
use super::output::{check_output, print_json, spinner, write_whole};
use super::precision::Precision;

/// Store a body-mechanics network as int8 or a translator as int16, for parts without an FPU and with little flash
///
/// Networks: int8 weights with a scale a row, int16 activations, int32 sums. Translators: int16 coefficients, int32 states,
/// scaled so that no input can overflow. With --clips the error against the f32 pack is measured, through the device's own
/// code, and kept in the pack.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic quantize models/mechanics.kin --precision i8 --out mechanics-i8.kin
  kinesic quantize models/weary.kin --precision i16 --clips walk.bvh --out weary-i16.kin
  kinesic quantize models/mechanics.kin --clips walk.bvh dances/ --out mechanics-i8.kin --json")]
pub struct Args {
    /// Pack in f32: body mechanics or a translator
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// Number type; by default what the pack's model has: i8 for body mechanics, i16 for a translator
    #[arg(long, value_enum)]
    precision: Option<Precision>,
    /// Clips to measure the error on, best none that the pack was trained on: files, folders, tables
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
    let file = PackFile::read(&args.pack).into_diagnostic()?;
    let earlier = file.provenance().ok_or_else(|| miette!("{}: its provenance cannot be read", args.pack.display()))?;
    let has_translator =
        file.pack().into_diagnostic()?.metadata().models.iter().any(|model| model.translator().is_some());
    let precision = args.precision.unwrap_or(if has_translator { Precision::I16 } else { Precision::I8 });
    if precision == Precision::F32 {
        return Err(miette!(
            help = "expected i16 for a translator, i8 for body mechanics",
            "--precision f32: the pack is f32"
        ));
    }
    let name = precision.name();
    let mut provenance = made_from(earlier, Some(name));
    let bar = spinner();
    let rounded = PackFile::from_bytes(&precision.of(file.bytes().to_vec(), &provenance)?);
    let (before, after) = (file.pack().into_diagnostic()?, rounded.pack().into_diagnostic()?);
    let mut error = None;
    let mut count = 0;
    if !args.clips.is_empty() {
        let paths = clip_paths(&args.clips)?;
        count = paths.len();
        let found = measure(args, precision, &paths, &before, &after, &|news| bar.set_message(news))?;
        let metric = |what: &str, value| Metric { name: format!("{name}_{what}"), value };
        provenance.metrics.push(metric("mean_deg", found.mean_deg));
        provenance.metrics.push(metric("p99_deg", found.p99_deg));
        provenance.metrics.push(metric("worst_deg", found.worst_deg));
        provenance.metrics.push(metric("frames", found.frames as f64));
        error = Some(found);
    }
    let bytes = precision.of(file.bytes().to_vec(), &provenance)?;
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
        Some(e) => {
            println!(
                "against f32, degrees a joint over {} frames: mean {:.3}, 99 % below {:.3}, worst {:.3}",
                e.frames, e.mean_deg, e.p99_deg, e.worst_deg
            );
            if e.mean_deg > FAR {
                println!("note: far apart. {}", far(precision));
            }
        }
        None => println!("the error was not measured: name clips with --clips"),
    }
    Ok(())
}

/// Mean angle to f32 from which the command says so, degrees.
const FAR: f64 = 0.5;

fn far(precision: Precision) -> &'static str {
    match precision {
        Precision::I16 => {
            "Poses more than 16 deviations from those of the training are held there, f32 extrapolates them: measure on \
             clips of the motion that it was trained on, or keep the f32 pack"
        }
        _ => "Keep the f32 pack, or train with more units",
    }
}

fn measure(
    args: &Args,
    precision: Precision,
    paths: &[PathBuf],
    before: &Pack,
    after: &Pack,
    say: &dyn Fn(String),
) -> miette::Result<Difference> {
    let rig = Rig::from_pack(before).into_diagnostic()?;
    let fps = f64::from(before.metadata().frame_rate);
    let options = args.reading.options_for(before)?;
    let mut clips = Vec::new();
    for (index, path) in paths.iter().enumerate() {
        say(format!("clip {} of {}", index + 1, paths.len()));
        let source = Source::read(path, &options).into_diagnostic()?;
        clips.push(source.on_rig(&rig, fps).into_diagnostic()?);
    }
    let found = match precision {
        Precision::I8 => difference(before, after, &rig, &clips),
        _ => translated_difference(before, after, &rig, &clips),
    };
    found.into_diagnostic()
}
