//! `kinesic blend`.

use std::path::PathBuf;

use kinesic::mechanics::{Blend, Window};
use kinesic_host::mechanics::{Overlap, blend};
use serde::Serialize;

use super::clips::Reading;
use super::expression::{Body, outputs, time, window};
use super::output::{print_json, spinner};

/// Pass from one motion to another, mechanics and expression each in a time of their own
///
/// Times are seconds of the first clip. The second clip begins with the earlier window (unless --second-start says otherwise)
/// and is moved and turned to where the first is in the middle of the mechanics window.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic blend models/mechanics.kin walk.bvh run.bvh --mechanics-window 1..1.5 --expressive-window 1..1.5 --out both.bvh
  kinesic blend models/mechanics.kin talk.bvh walk.bvh --mechanics-window 2..2.5 --expressive-window 3..4 --out talk-on.bvh")]
pub struct Args {
    /// Body-mechanics pack
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// First clip
    #[arg(value_name = "A")]
    first: PathBuf,
    /// Second clip
    #[arg(value_name = "B")]
    second: PathBuf,
    /// When the mechanics, with path and hips, pass over, s
    #[arg(long, value_name = "T0..T1", value_parser = window)]
    mechanics_window: [f32; 2],
    /// When the expression passes over, s
    #[arg(long, value_name = "T0..T1", value_parser = window)]
    expressive_window: [f32; 2],
    /// When the second clip begins, s (default: with the earlier window)
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    second_start: Option<f32>,
    /// Motion to write: .bvh, .glb, .gltf or .csv
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Random seed; blending makes no random choice
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
    bar.set_message("blending");
    let body = Body::read(&args.pack)?;
    let first = body.decouple(&args.first, &args.reading)?;
    let second = body.decouple(&args.second, &args.reading)?;
    let seconds = first.poses.len() as f32 / body.fps as f32;
    if args.mechanics_window[0] > seconds || args.expressive_window[0] > seconds {
        return Err(miette::miette!(
            help = "give windows that begin within the first clip",
            "{}: it lasts {seconds:.2} s, a window begins after its end",
            first.name
        ));
    }
    if let Some(start) = args.second_start {
        time("--second-start", f64::from(start), f64::from(seconds), &first.name)?;
    }
    let frame = |seconds: f32| seconds.max(0.0) * body.fps as f32;
    let frames = |[start, end]: [f32; 2]| Window { start: frame(start), end: frame(end) };
    let (mechanics, expressive) = (frames(args.mechanics_window), frames(args.expressive_window));
    let start = args.second_start.map_or(mechanics.start.min(expressive.start), frame);
    let overlap = Overlap {
        start: start.round() as usize,
        meet: (0.5 * (mechanics.start + mechanics.end)).max(start).round() as usize,
    };
    let blended = blend(&first.parts, &second.parts, &Blend { mechanics, expressive }, overlap);
    body.write(&blended, &args.out)?;
    bar.finish_and_clear();
    let summary = Summary { out: args.out.display().to_string(), frames: blended.len() };
    if args.json {
        return print_json(&summary);
    }
    println!("{}: {} frames", summary.out, summary.frames);
    Ok(())
}
