//! `kinesic mix`.

use std::path::PathBuf;

use kinesic_host::feet::Hold;
use kinesic_host::mechanics::{mix, mix_clip};
use kinesic_host::prepare::Source;
use miette::IntoDiagnostic;
use serde::Serialize;

use super::clips::Reading;
use super::expression::{Body, Motion, Said, Smooth, outputs, time};
use super::land::{Feet, On};
use super::mask;
use super::output::{print_json, spinner};

/// Perform one motion's mechanics with another's expression
///
/// Path and hips are those of the mechanics clip; the result lasts as long as the shorter of the two.
///
/// The result has the mechanics clip's own skeleton, rate and detail; expression, below about 3 movements a second, is exchanged. Feet are held
/// where they stand in the mechanics clip. With --on pack the result is what the device makes, on the pack's skeleton and at its rate.
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
    /// Whose skeleton and rate the result has: the mechanics clip's, or the pack's [default: clip]
    #[arg(long, value_enum, value_name = "SKELETON")]
    on: Option<On>,
    /// Hold feet where they stand in the mechanics clip, or leave them as they come [default: lock; on the pack's skeleton free]
    #[arg(long, value_enum)]
    feet: Option<Feet>,
    /// Random seed; mixing makes no random choice
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object: out, frames, expressive_deg and new_percent of the mechanics clip, quality, jerk_ratio, notes
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

#[derive(Serialize)]
struct Summary {
    out: String,
    frames: usize,
    frame_rate: f64,
    #[serde(flatten)]
    said: Said,
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
    let check = |motion: &Motion, option: &str, seconds: f64| {
        // The last frame is part of the clip.
        time(option, seconds, motion.clip.duration(), &motion.name())
    };
    check(&mechanics, "--mechanics-start", args.mechanics_start)?;
    check(&expressive, "--expressive-start", args.expressive_start)?;
    let place = body.place(args.on, args.feet, &mechanics.source)?;
    let seconds =
        (mechanics.clip.duration() - args.mechanics_start).min(expressive.clip.duration() - args.expressive_start);
    let hold = Hold { travels: mask::travels(&modulation.mask), ..Hold::default() };
    let base = if place.is_own() { &mechanics.source.clip } else { &mechanics.clip };
    let fps = base.fps();
    let first = ((args.mechanics_start * fps).round() as usize).min(base.frames().saturating_sub(1));
    let frames = first..first + 1 + (seconds * fps).round() as usize;
    let from = &mechanics.source;
    let source = Source::new(&from.path, from.clip.slice(frames.clone()), from.map.clone());
    let mixed = (!place.is_own()).then(|| {
        let skipped = (args.expressive_start * fps).round() as usize;
        let rest = |motion: &Motion, first: usize| motion.parts.iter().skip(first).copied().collect::<Vec<_>>();
        body.clip(&mix(&rest(&mechanics, first), &rest(&expressive, skipped), &modulation))
    });
    let clip = match &mixed {
        Some(mixed) => mechanics.clip.slice(first..first + mixed.frames()),
        None => body.own_rate(from)?.slice(frames),
    };
    let pack = body.pack()?;
    let result = match &mixed {
        Some(mixed) => {
            let landed = place.land(Some(&source), (&pack, &body.rig), Some(&clip), mixed, hold);
            Smooth::not(landed.into_diagnostic()?)
        }
        None => {
            let starts = [first as f64 / fps, args.expressive_start];
            Smooth::of(&place, args.feet == Some(Feet::Lock), |place, slower, soft| {
                let [own, other] = [&mechanics, &expressive].map(|motion| motion.expressive.slower(slower));
                let after = mix_clip(&clip, [&own, &other], starts, &modulation);
                let hold = Hold { soft, ..hold };
                place.land(Some(&source), (&pack, &body.rig), Some(&clip), &after, hold).into_diagnostic()
            })?
        }
    };
    let clip = &result.landed.clip;
    clip.write(&args.out).into_diagnostic()?;
    bar.finish_and_clear();
    let summary = Summary {
        out: args.out.display().to_string(),
        frames: clip.frames(),
        frame_rate: clip.fps(),
        said: Said::of(&[&mechanics, &expressive], result),
    };
    summary.said.warn();
    if args.json {
        return print_json(&summary);
    }
    summary.said.print();
    println!("{}: {} frames", summary.out, summary.frames);
    Ok(())
}
