//! `kinesic modulate`.

use std::path::PathBuf;

use kinesic_host::mechanics::modulate;
use serde::Serialize;

use super::clips::Reading;
use super::expression::{Body, expression_deg, outputs};
use super::output::{print_json, spinner};

/// Give a motion more or less expression
///
/// 0 leaves what the body must do, 1 returns the motion, 2 doubles the rotation that expression adds to each joint.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic modulate models/mechanics.kin dance.bvh --amount 1.5 --out dance-more.bvh
  kinesic modulate models/mechanics.kin dance.bvh --amount 0 --mask LowerBack+=0 --out dance-legs-only.bvh")]
pub struct Args {
    /// Body-mechanics pack
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// Clip to change
    #[arg(value_name = "CLIP")]
    clip: PathBuf,
    /// Expression: 0 = none, 1 = as it is, 2 = twice
    #[arg(long, allow_negative_numbers = true)]
    amount: f32,
    /// Weight of a joint, JOINT=WEIGHT, or of all from it downwards, JOINT+=WEIGHT: 0 keeps the motion (may be repeated)
    #[arg(long, value_name = "JOINT=WEIGHT")]
    mask: Vec<String>,
    /// Motion to write: .bvh, .glb, .gltf or .csv
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Random seed; modulation makes no random choice
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object: frames, expressive_deg
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

#[derive(Serialize)]
struct Summary {
    out: String,
    frames: usize,
    /// Mean angle of the clip's own E*, degrees.
    expressive_deg: f64,
    amount: f32,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    outputs(&[&args.out])?;
    let bar = spinner();
    bar.set_message("modulating");
    let body = Body::read(&args.pack)?;
    let modulation = body.modulation(args.amount, &args.mask)?;
    let motion = body.decouple(&args.clip, &args.reading)?;
    body.write(&modulate(&motion.poses, &motion.parts, &modulation), &args.out)?;
    bar.finish_and_clear();
    let summary = Summary {
        out: args.out.display().to_string(),
        frames: motion.poses.len(),
        expressive_deg: expression_deg(&motion.parts, body.rig.joints()),
        amount: args.amount,
    };
    if args.json {
        return print_json(&summary);
    }
    println!("{}: {} frames, expression x {}", summary.out, summary.frames, summary.amount);
    Ok(())
}
