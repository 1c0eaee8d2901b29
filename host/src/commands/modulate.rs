//! `kinesic modulate`.

use std::path::PathBuf;

use kinesic_host::feet::Hold;
use kinesic_host::mechanics::{modulate, modulate_clip};
use miette::IntoDiagnostic;
use serde::Serialize;

use super::clips::Reading;
use super::expression::{Body, Said, Smooth, outputs};
use super::land::{Feet, On};
use super::mask;
use super::output::{print_json, spinner};

/// Give a motion more or less expression
///
/// 0 leaves what the body must do, 1 returns the motion, 2 doubles the rotation that expression adds to each joint.
///
/// The result has the clip's own skeleton, rate and detail: only the smooth part of expression, below about 3 movements a second, is scaled. Feet
/// are held where they stand in the clip. With --on pack the result is what the device makes, frame by frame, on the pack's skeleton and at its
/// rate.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic modulate models/mechanics.kin dance.bvh --amount 1.5 --out dance-more.bvh
  kinesic modulate models/mechanics.kin dance.bvh --amount 0 --mask LowerBack+=0 --out dance-legs-only.bvh
  kinesic modulate models/mechanics.kin dance.bvh --amount 0.5 --mask pelvis=0 --out dance-on-the-spot.bvh
  kinesic modulate models/mechanics.kin dance.bvh --amount 1.5 --on pack --out as-on-the-device.bvh")]
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
    /// Weight of a joint, JOINT=WEIGHT, or of all from it downwards, JOINT+=WEIGHT: 0 keeps the motion (may be repeated). Expression never
    /// moves the pelvis; pelvis=0 keeps its travel and height where feet are held, too, and feet on the clip's spots
    #[arg(long, value_name = "JOINT=WEIGHT")]
    mask: Vec<String>,
    /// Motion to write: .bvh, .glb, .gltf or .csv
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Whose skeleton and rate the result has [default: clip]
    #[arg(long, value_enum, value_name = "SKELETON")]
    on: Option<On>,
    /// Hold feet where they stand in the clip, or leave them as they come [default: lock; on the pack's skeleton free, as on the device]
    #[arg(long, value_enum)]
    feet: Option<Feet>,
    /// Random seed; modulation makes no random choice
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object: frames, expressive_deg, new_percent, quality of source and result, jerk_ratio, notes
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
    amount: f32,
    #[serde(flatten)]
    said: Said,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    outputs(&[&args.out])?;
    let bar = spinner();
    bar.set_message("modulating");
    let body = Body::read(&args.pack)?;
    let modulation = body.modulation(args.amount, &args.mask)?;
    let motion = body.decouple(&args.clip, &args.reading)?;
    let place = body.place(args.on, args.feet, &motion.source)?;
    let hold = Hold { travels: mask::travels(&modulation.mask), ..Hold::default() };
    let source = Some(&motion.source);
    let own = body.own_rate(&motion.source)?;
    let pack = body.pack()?;
    let result = if place.is_own() {
        Smooth::of(&place, args.feet == Some(Feet::Lock), |place, slower, soft| {
            let after = modulate_clip(&own, &motion.expressive.slower(slower), &modulation);
            let hold = Hold { soft, ..hold };
            place.land(source, (&pack, &body.rig), Some(&own), &after, hold).into_diagnostic()
        })?
    } else {
        let after = body.clip(&modulate(&motion.poses, &motion.parts, &modulation));
        let landed = place.land(source, (&pack, &body.rig), Some(&motion.clip), &after, hold);
        Smooth::not(landed.into_diagnostic()?)
    };
    let clip = &result.landed.clip;
    clip.write(&args.out).into_diagnostic()?;
    bar.finish_and_clear();
    let summary = Summary {
        out: args.out.display().to_string(),
        frames: clip.frames(),
        frame_rate: clip.fps(),
        amount: args.amount,
        said: Said::of(&[&motion], result),
    };
    summary.said.warn();
    if args.json {
        return print_json(&summary);
    }
    summary.said.print();
    println!("{}: {} frames, expression x {}", summary.out, summary.frames, summary.amount);
    Ok(())
}
