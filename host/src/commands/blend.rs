//! `kinesic blend`.

use std::path::PathBuf;

use kinesic::Pose;
use kinesic::mechanics::{Blend, Modulation, Window};
use kinesic_host::clip::Clip;
use kinesic_host::mechanics::{Overlap, Parted, Passage, blend, blend_clips, modulate_clip};
use kinesic_host::own_body::OwnBody;
use kinesic_host::prepare::Source;
use kinesic_host::rig::MAX_JOINTS;
use miette::IntoDiagnostic;
use serde::Serialize;

use super::clips::Reading;
use super::expression::{Body, Motion, Said, Smooth, outputs, time, window};
use super::land::{Landed, On};
use super::output::{print_json, spinner};

/// Pass from one motion to another, mechanics and expression each in a time of their own
///
/// Times are seconds of the first clip. The second clip begins with the earlier window (unless --second-start says otherwise)
/// and is moved and turned to where the first is in the middle of the mechanics window.
///
/// The result has the first clip's own skeleton and rate; the second is put on it. With --on pack the result is what the device makes, on the pack's
/// skeleton and at its rate.
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
    /// Whose skeleton and rate the result has: the first clip's, or the pack's [default: clip]
    #[arg(long, value_enum, value_name = "SKELETON")]
    on: Option<On>,
    /// Random seed; blending makes no random choice
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object: out, frames, expressive_deg and new_percent of the first clip, quality, jerk_ratio, notes
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
    bar.set_message("blending");
    let body = Body::read(&args.pack)?;
    let first = body.decouple(&args.first, &args.reading)?;
    let second = body.decouple(&args.second, &args.reading)?;
    let seconds = first.poses.len() as f32 / body.fps as f32;
    if args.mechanics_window[0] > seconds || args.expressive_window[0] > seconds {
        return Err(miette::miette!(
            help = "give windows that begin within the first clip",
            "{}: it lasts {seconds:.2} s, a window begins after its end",
            first.name()
        ));
    }
    if let Some(start) = args.second_start {
        time("--second-start", f64::from(start), f64::from(seconds), &first.name())?;
    }
    let start = args.second_start.unwrap_or(args.mechanics_window[0].min(args.expressive_window[0])).max(0.0);
    let place = body.place(args.on, None, &first.source)?;
    let passage = passage(args, start);
    let sources = if place.is_own() {
        let rig = first.source.rig().into_diagnostic()?;
        let moved = second.source.quiet().on_rig(&rig, first.source.clip.fps()).into_diagnostic()?;
        [first.source.clip.clone(), moved]
    } else {
        [first.clip.clone(), second.clip.clone()]
    };
    let [from, moved] = &sources;
    let result = if place.is_own() {
        let parting = Parting::new(&body, [&first, &second], &sources)?;
        Smooth::of(&place, true, |_, slower, _| {
            let plains = parting.plains(slower);
            let [a, b] = [(from, &plains[0]), (moved, &plains[1])].map(|(observed, plain)| Parted { observed, plain });
            let map = &first.source.map;
            Ok(Landed::of_two(blend_clips(a, b, map, &passage), from, Some(moved), map))
        })?
    } else {
        let blended = body.clip(&on_pack(&body, [&first, &second], args, start));
        Smooth::not(Landed::of_two(blended, from, Some(moved), &body.rig.map))
    };
    let clip = &result.landed.clip;
    clip.write(&args.out).into_diagnostic()?;
    bar.finish_and_clear();
    let summary = Summary {
        out: args.out.display().to_string(),
        frames: clip.frames(),
        frame_rate: clip.fps(),
        said: Said::of(&[&first, &second], result),
    };
    summary.said.warn();
    if args.json {
        return print_json(&summary);
    }
    summary.said.print();
    println!("{}: {} frames", summary.out, summary.frames);
    Ok(())
}

fn passage(args: &Args, start: f32) -> Passage {
    let window = |window: [f32; 2]| window.map(f64::from);
    Passage {
        mechanics: window(args.mechanics_window),
        expressive: window(args.expressive_window),
        start: f64::from(start),
    }
}

/// Two motions on the first one's skeleton, to be parted there.
struct Parting<'a> {
    body: &'a Body,
    motions: [&'a Motion; 2],
    /// On their common skeleton.
    own: [Source; 2],
    /// On the pack's rig, at the rate of the result.
    on_rig: [Clip; 2],
}

impl<'a> Parting<'a> {
    fn new(body: &'a Body, motions: [&'a Motion; 2], clips: &[Clip; 2]) -> miette::Result<Self> {
        let map = &motions[0].source.map;
        let own = [0, 1].map(|of| Source::new(&motions[of].source.path, clips[of].clone(), map.clone()));
        let on_rig = |of: usize| motions[of].source.quiet().on_rig(&body.rig, clips[0].fps()).into_diagnostic();
        Ok(Self { body, motions, own, on_rig: [on_rig(0)?, on_rig(1)?] })
    }

    /// What is left of them without expression, under a bell so many times as wide.
    fn plains(&self, slower: f64) -> [Clip; 2] {
        let none = Modulation { amount: 0.0, ..Modulation::default() };
        [0, 1].map(|of| {
            let after = modulate_clip(&self.on_rig[of], &self.motions[of].expressive.slower(slower), &none);
            OwnBody::new(&self.own[of], &self.body.rig).carry(&self.on_rig[of], &after)
        })
    }
}

/// On the pack's skeleton, as on the device.
fn on_pack(body: &Body, [first, second]: [&Motion; 2], args: &Args, start: f32) -> Vec<Pose<MAX_JOINTS>> {
    let frame = |seconds: f32| seconds.max(0.0) * body.fps as f32;
    let frames = |[start, end]: [f32; 2]| Window { start: frame(start), end: frame(end) };
    let (mechanics, expressive) = (frames(args.mechanics_window), frames(args.expressive_window));
    let start = frame(start);
    let overlap = Overlap {
        start: start.round() as usize,
        meet: (0.5 * (mechanics.start + mechanics.end)).max(start).round() as usize,
    };
    blend(&first.parts, &second.parts, &Blend { mechanics, expressive }, overlap)
}
