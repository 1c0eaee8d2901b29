//! `kinesic mix`.

use std::path::PathBuf;

use kinesic_host::mechanics::mix;
use serde::Serialize;

use super::clips::Reading;
use super::expression::{Body, Motion, outputs, time};
use super::output::{print_json, spinner};

/// Perform one motion's mechanics with another's expression
///
/// Path and hips are those of the mechanics clip; the result lasts as long as the shorter of the two.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic mix models/mechanics.kin --mechanics walk.bvh --expressive angry-talk.bvh --out walk-and-talk.bvh
  kinesic mix models/mechanics.kin --mechanics jump.bvh --expressive signal.bvh --mask LHipJoint+=0 --mask RHipJoint+=0 \\
      --out jump-signal.bvh")]
pub struct Args {
    /// Body-mechanics pack
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// Clip whose mechanics are taken
    #[arg(long, value_name = "CLIP")]
    mechanics: PathBuf,
    /// Clip whose expression is taken
    #[arg(long, value_name = "CLIP")]
    expressive: PathBuf,
    /// Where the mechanics begin in their clip, s
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, allow_negative_numbers = true)]
    mechanics_start: f64,
    /// Where the expression begins in its clip, s
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, allow_negative_numbers = true)]
    expressive_start: f64,
    /// Expression: 0 = none, 1 = as it is
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    amount: f32,
    /// Weight of a joint, JOINT=WEIGHT, or of all from it downwards, JOINT+=WEIGHT: 0 leaves it as in the mechanics clip (may
    /// be repeated)
    #[arg(long, value_name = "JOINT=WEIGHT")]
    mask: Vec<String>,
    /// Motion to write: .bvh, .glb, .gltf or .csv
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Random seed; mixing makes no random choice
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object: out, frames
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

#[derive(Serialize)]
struct Summary {
    out: String,
    frames: usize,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    outputs(&[&args.out])?;
    let bar = spinner();
    bar.set_message("mixing");
    let body = Body::read(&args.pack)?;
    let modulation = body.modulation(args.amount, &args.mask)?;
    let mechanics = body.decouple(&args.mechanics, &args.reading)?;
    let expressive = body.decouple(&args.expressive, &args.reading)?;
    let rest_of = |motion: &Motion, option: &str, seconds: f64| {
        // The last frame is part of the clip.
        time(option, seconds, motion.parts.len().saturating_sub(1) as f64 / body.fps, &motion.name)?;
        let skipped = (seconds * body.fps).round() as usize;
        Ok::<_, miette::Report>(motion.parts.iter().skip(skipped).copied().collect::<Vec<_>>())
    };
    let a = rest_of(&mechanics, "--mechanics-start", args.mechanics_start)?;
    let b = rest_of(&expressive, "--expressive-start", args.expressive_start)?;
    let mixed = mix(&a, &b, &modulation);
    body.write(&mixed, &args.out)?;
    bar.finish_and_clear();
    let summary = Summary { out: args.out.display().to_string(), frames: mixed.len() };
    if args.json {
        return print_json(&summary);
    }
    println!("{}: {} frames", summary.out, summary.frames);
    Ok(())
}
