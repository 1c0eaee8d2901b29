//! `kinesic synth`.

use std::path::PathBuf;

use kinesic::emotion::EmotionState;
use kinesic::model::AttributeMeta;
use kinesic_host::emotion::HostEmotion;
use kinesic_host::emotion::evaluate::Scorer;
use kinesic_host::emotion::play::{Settings, Strengths, play};
use kinesic_host::limit::{self, Clamps};
use kinesic_host::pack::PackFile;
use kinesic_host::plain;
use kinesic_host::robot::Machine;
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use super::output::{check_motion, print_clamps, print_json, write_motion};

/// Make a motion that shows an emotion so strongly
///
/// Strengths are in units of the pack's training: `kinesic inspect` shows the range of every attribute. What is asked for beyond
/// it is held, and said so. An attribute that is not named has 0. The device's own code plays.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic synth happy.kin --strength 0.7 --out walk.bvh
  kinesic synth moods.kin --strength happy=1.2,sad=0.3 --out walk.glb --fps 30 --seconds 10
  kinesic synth happy.kin --strength -1 --to 1 --seconds 12 --out sweep.bvh --json")]
pub struct Args {
    /// Emotion pack
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// Strength, or NAME=STRENGTH,... where the pack has several attributes
    #[arg(long, value_name = "STRENGTH", allow_hyphen_values = true)]
    strength: String,
    /// Strength at the end: it changes evenly while the motion plays
    #[arg(long, value_name = "STRENGTH", allow_hyphen_values = true)]
    to: Option<String>,
    /// Motion to write, in the format that its name says: .bvh, .glb or .gltf (glTF 2.0), .csv (joint angles)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Frames a second [default: the pack's]
    #[arg(long, value_name = "RATE")]
    fps: Option<f64>,
    /// How long, s [default: the motion once; of a cycle three rounds]
    #[arg(long, value_name = "SECONDS")]
    seconds: Option<f64>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Attribute {
    name: String,
    /// At the start and at the end.
    asked: [f32; 2],
    /// What played: asked for, held inside the range.
    played: [f32; 2],
    /// What the ranking function reads from the motion that stays at these strengths.
    score: [f64; 2],
    plausible: [f32; 2],
}

#[derive(Serialize)]
struct Summary {
    out: String,
    motion: String,
    frames: usize,
    fps: f64,
    seconds: f64,
    cycle: bool,
    /// Length of the motion, or of a round of a cycle, at the start and at the end, s.
    round_s: [f32; 2],
    /// Way of the root along the ground, as the crow flies, m.
    travel_m: f64,
    attributes: Vec<Attribute>,
    /// What the pack's limits did.
    #[serde(skip_serializing_if = "Option::is_none")]
    limits: Option<Clamps>,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let file = PackFile::read(&args.pack).into_diagnostic()?;
    let pack = file.pack().into_diagnostic()?;
    let machine = Machine::from_pack(&pack).into_diagnostic()?;
    check_motion(&args.out, machine.is_some())?;
    let emotion = HostEmotion::load(&pack).into_diagnostic()?;
    let meta = *emotion.meta();
    let attributes: Vec<AttributeMeta> = meta.attributes.into_iter().flatten().collect();
    let from = strengths("--strength", &args.strength, &attributes)?;
    let to = args.to.as_ref().map_or(Ok(from), |to| strengths("--to", to, &attributes))?;
    let fps = args.fps.unwrap_or_else(|| f64::from(pack.metadata().frame_rate));
    if !(1.0..=1000.0).contains(&fps) {
        return Err(miette!("--fps {fps}: expected 1 to 1000 frames a second"));
    }
    if args.seconds.is_some_and(|seconds| !(seconds > 0.0 && seconds <= 3600.0)) {
        return Err(miette!("--seconds: expected more than 0, at most 3600"));
    }
    if args.seconds.is_none() {
        check_length(args, &emotion, &from, fps)?;
    }
    let played = play(&pack, &Settings { from, to, fps, seconds: args.seconds }).into_diagnostic()?;
    let scorer = Scorer::load(&pack).into_diagnostic()?;
    let scores = [scorer.made(&pack, &from).into_diagnostic()?, scorer.made(&pack, &to).into_diagnostic()?];
    let rig = &scorer.rig;
    let (clip, limits) = match limit::play(&pack, rig, &played.clip).into_diagnostic()? {
        Some((clip, clamps)) => (clip, Some(clamps)),
        None => (played.clip.clone(), None),
    };
    write_motion(&args.out, &clip, machine.as_ref(), None)?;

    let both = |of: [Strengths; 2], at: usize| of.map(|strengths| strengths[at]);
    let travel = match (played.clip.root.first(), played.clip.root.last()) {
        (Some(first), Some(last)) => (last - first).xz().norm(),
        _ => 0.0,
    };
    let summary = Summary {
        out: args.out.display().to_string(),
        motion: meta.motion.to_owned(),
        frames: played.clip.frames(),
        fps,
        seconds: (played.clip.frames() - 1) as f64 / fps,
        cycle: meta.cycle,
        round_s: played.round,
        travel_m: travel,
        attributes: attributes
            .iter()
            .enumerate()
            .map(|(at, attribute)| Attribute {
                name: attribute.name.to_owned(),
                asked: both([from, to], at),
                played: both(played.strength, at),
                score: scores.each_ref().map(|scores| scores[at]),
                plausible: attribute.strength,
            })
            .collect(),
        limits,
    };
    if args.json {
        return print_json(&summary);
    }
    print(&summary);
    Ok(())
}

/// Frames that are made at most where the pack alone says how long: 200 MB of them.
const MOST_FRAMES: f64 = 40_000.0;

/// Refuses a motion that lasts longer than anybody may have wanted, unless it is asked for.
fn check_length(args: &Args, emotion: &HostEmotion, from: &Strengths, fps: f64) -> miette::Result<()> {
    let mut state = Box::new(EmotionState::new());
    state.strength = *from;
    emotion.change(&mut state);
    let rounds = if emotion.meta().cycle { 3.0 } else { 1.0 };
    let seconds = rounds * f64::from(state.seconds());
    if seconds * fps <= MOST_FRAMES {
        return Ok(());
    }
    Err(miette!(
        help = "say how long with --seconds, or ask for fewer frames a second with --fps",
        "{}: the motion takes {seconds:.0} s, {:.0} frames; at most {MOST_FRAMES} are made without --seconds",
        args.pack.display(),
        seconds * fps
    ))
}

fn print(summary: &Summary) {
    let what = if summary.cycle { "a round takes" } else { "it takes" };
    let [first, last] = summary.round_s;
    println!(
        "{}: {}, {} frames at {} a second, {:.2} s; {what} {first:.2} s at the start, {last:.2} s at the end; {:.2} m of way",
        summary.out,
        plain::line(&summary.motion),
        summary.frames,
        summary.fps,
        summary.seconds,
        summary.travel_m
    );
    summary.limits.iter().for_each(print_clamps);
    println!("attribute            asked             played             scores     of plausible");
    let two = |[a, b]: [f32; 2]| format!("{a:.3} .. {b:.3}");
    let scores = |[a, b]: [f64; 2]| format!("{a:.3} .. {b:.3}");
    for attribute in &summary.attributes {
        println!(
            "{:<12} {:>16}   {:>16}   {:>16}   {:>14}",
            plain::line(&attribute.name),
            two(attribute.asked),
            two(attribute.played),
            scores(attribute.score),
            two(attribute.plausible)
        );
        if attribute.asked != attribute.played {
            println!(
                "note: {}: asked for more than nearly all training motions show; held",
                plain::line(&attribute.name)
            );
        }
    }
}

/// `STRENGTH` of the only attribute, or `NAME=STRENGTH,...`.
fn strengths(option: &str, text: &str, attributes: &[AttributeMeta]) -> miette::Result<Strengths> {
    let names = attributes.iter().map(|a| a.name).collect::<Vec<_>>().join(", ");
    let number = |text: &str| {
        text.trim().parse().ok().filter(|x: &f32| x.is_finite()).ok_or_else(|| {
            miette!(
                help = format!("give a finite number, or NAME=NUMBER,...; the pack's attributes are: {names}"),
                "{option} {text}: not a strength"
            )
        })
    };
    let mut strengths = Strengths::default();
    if !text.contains('=') {
        if attributes.len() > 1 {
            return Err(miette!(
                help = format!("write NAME=NUMBER,...; the attributes are: {names}"),
                "{option} {text}: the pack has {} attributes",
                attributes.len()
            ));
        }
        strengths[0] = number(text)?;
        return Ok(strengths);
    }
    for entry in text.split(',') {
        let (name, value) = entry.split_once('=').ok_or_else(|| miette!("{option} {entry}: expected NAME=STRENGTH"))?;
        let at = attributes.iter().position(|a| a.name.eq_ignore_ascii_case(name.trim())).ok_or_else(|| {
            miette!(
                help = format!("the attributes are: {names}"),
                "{option} {}: there is no such attribute",
                name.trim()
            )
        })?;
        strengths[at] = number(value)?;
    }
    Ok(strengths)
}
