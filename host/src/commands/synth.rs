//! `kinesic synth`.

use std::path::PathBuf;
use std::str::FromStr;

use kinesic::emotion::EmotionState;
use kinesic::model::{ATTRIBUTES, AttributeMeta};
use kinesic_host::emotion::HostEmotion;
use kinesic_host::emotion::evaluate::Scorer;
use kinesic_host::emotion::play::{Strengths, play_at};
use kinesic_host::limit::{self, Clamps};
use kinesic_host::pack::PackFile;
use kinesic_host::plain;
use kinesic_host::robot::Machine;
use kinesic_host::strength::Curve;
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use super::figure::figure;
use super::output::{check_motion, print_clamps, print_json, write_motion};

/// Make a motion that shows an emotion so strongly
///
/// Strengths are in units of the pack's training: `kinesic inspect` shows the range of every attribute. What is asked for beyond
/// it is held, and said so. An attribute that is not named has 0. A strength may change while the motion plays: keys STRENGTH@SECONDS with
/// straight lines between them, or a table of times and strengths. The device's own code plays.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic synth happy.kin --strength 0.7 --out walk.bvh
  kinesic synth moods.kin --strength happy=1.2,sad=0.3 --out walk.glb --fps 30 --seconds 10
  kinesic synth happy.kin --strength -1 --to 1 --seconds 12 --out sweep.bvh --json
  kinesic synth happy.kin --strength 0@0s,1@2s,0.3@4s --out rising.bvh
  kinesic synth moods.kin --strength happy=0@1s,1@3s,sad=0.3 --out both.glb
  kinesic synth moods.kin --strength happy=@curve.csv --out as-drawn.bvh")]
pub struct Args {
    /// Emotion pack
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// Strength, or NAME=STRENGTH,... where the pack has several attributes. A strength is a number, keys as 0@0s,1@2s, or @FILE with a
    /// time and a strength a line
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
    /// How long, s [default: the motion once, of a cycle three rounds; at least to the last key of --strength]
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
    /// Least and greatest of all keys.
    range: [f32; 2],
    /// Keys of the strength over time; 1 stays.
    keys: usize,
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
    let asked = Asked::new(args, &attributes)?;
    let fps = args.fps.unwrap_or_else(|| f64::from(pack.metadata().frame_rate));
    if !(1.0..=1000.0).contains(&fps) {
        return Err(miette!("--fps {fps}: expected 1 to 1000 frames a second"));
    }
    if args.seconds.is_some_and(|seconds| !(seconds > 0.0 && seconds <= 3600.0)) {
        return Err(miette!("--seconds: expected more than 0, at most 3600"));
    }
    if args.seconds.is_none() {
        check_length(args, &emotion, &asked, fps)?;
    }
    let seconds = args.seconds.or_else(|| asked.least(&emotion));
    let played = play_at(&pack, fps, seconds, &|frame, last| asked.at(frame, last, fps)).into_diagnostic()?;
    let last = played.clip.frames() - 1;
    let [from, to] = [0, last].map(|frame| asked.at(frame, last, fps));
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
                range: asked.range(at),
                keys: asked.curves[at].count(),
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
    let (end, length) = (asked.end(), summary.seconds);
    if end > length + 1.0 / fps {
        println!(
            "note: the last key of --strength is at {end} s, and the motion ends at {length:.2} s: it is not reached"
        );
    }
    Ok(())
}

/// What was asked for, attribute by attribute.
struct Asked {
    curves: [Curve; ATTRIBUTES],
    /// Strengths at the end, where they change evenly from those of the start.
    to: Option<Strengths>,
}

impl Asked {
    fn new(args: &Args, attributes: &[AttributeMeta]) -> miette::Result<Self> {
        let curves = strengths("--strength", &args.strength, attributes)?;
        let Some(to) = &args.to else { return Ok(Self { curves, to: None }) };
        let ends = strengths("--to", to, attributes)?;
        let constant = |curves: &[Curve; ATTRIBUTES]| curves.iter().all(|curve| curve.count() == 1);
        if !constant(&curves) || !constant(&ends) {
            return Err(miette!(
                help = "leave --to out, and make its strength the last key",
                "--to {to}: found keys of strengths over time beside it, expected one strength at the start and one at the end"
            ));
        }
        Ok(Self { curves, to: Some(ends.map(|end| end.at(0.0))) })
    }

    /// The strengths of a frame.
    fn at(&self, frame: usize, last: usize, fps: f64) -> Strengths {
        let part = frame as f32 / last.max(1) as f32;
        let at = |index: usize| {
            let now = self.curves[index].at(frame as f64 / fps);
            self.to.map_or(now, |to| now + part * (to[index] - now))
        };
        std::array::from_fn(at)
    }

    fn range(&self, index: usize) -> [f32; 2] {
        let [low, high] = self.curves[index].range();
        self.to.map_or([low, high], |to| [low.min(to[index]), high.max(to[index])])
    }

    /// When the last key is due, s.
    fn end(&self) -> f64 {
        self.curves.iter().map(Curve::end).fold(0.0, f64::max)
    }

    /// How long a motion with keys is at least: to the last one, where the motion itself is shorter.
    fn least(&self, emotion: &HostEmotion) -> Option<f64> {
        let own = usual(emotion, &self.at(0, 1, 1.0));
        (self.end() > own).then(|| self.end())
    }
}

/// How long a motion is where nobody says it, s.
fn usual(emotion: &HostEmotion, from: &Strengths) -> f64 {
    let mut state = Box::new(EmotionState::new());
    state.strength = *from;
    emotion.change(&mut state);
    let rounds = if emotion.meta().cycle { 3.0 } else { 1.0 };
    rounds * f64::from(state.seconds())
}

/// Frames that are made at most where the pack alone says how long: 200 MB of them.
const MOST_FRAMES: f64 = 40_000.0;

/// Refuses a motion that lasts longer than anybody may have wanted, unless it is asked for.
fn check_length(args: &Args, emotion: &HostEmotion, asked: &Asked, fps: f64) -> miette::Result<()> {
    let seconds = usual(emotion, &asked.at(0, 1, fps)).max(asked.end());
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
    let scores = |[a, b]: [f64; 2]| format!("{} .. {}", figure(a, 3), figure(b, 3));
    let two = |ends: [f32; 2]| scores(ends.map(f64::from));
    for attribute in &summary.attributes {
        println!(
            "{:<12} {:>16}   {:>16}   {:>16}   {:>14}",
            plain::line(&attribute.name),
            two(attribute.asked),
            two(attribute.played),
            scores(attribute.score),
            two(attribute.plausible)
        );
        let [low, high] = attribute.plausible;
        if attribute.range[0] < low || attribute.range[1] > high {
            println!(
                "note: {}: asked for more than nearly all training motions show; held",
                plain::line(&attribute.name)
            );
        }
    }
}

/// `STRENGTH` of the only attribute, or `NAME=STRENGTH,...`; what follows a comma without a name is the next key of the same attribute.
fn strengths(option: &str, text: &str, attributes: &[AttributeMeta]) -> miette::Result<[Curve; ATTRIBUTES]> {
    let names = attributes.iter().map(|a| a.name).collect::<Vec<_>>().join(", ");
    let curve = |text: &str| {
        Curve::from_str(text.trim()).map_err(|cause| {
            miette!(
                help = format!("or NAME=STRENGTH,...; the pack's attributes are: {names}"),
                "{option} {text}: not a strength: {cause}"
            )
        })
    };
    let mut strengths = std::array::from_fn(|_| Curve::still(0.0));
    // The name of a file may hold what looks like a name.
    if !text.contains('=') || text.starts_with('@') {
        if attributes.len() > 1 {
            return Err(miette!(
                help = format!("write NAME=STRENGTH,...; the attributes are: {names}"),
                "{option} {text}: the pack has {} attributes",
                attributes.len()
            ));
        }
        strengths[0] = curve(text)?;
        return Ok(strengths);
    }
    let mut entries: Vec<(&str, String)> = Vec::new();
    for entry in text.split(',') {
        match (entry.split_once('='), entries.last_mut()) {
            (Some((name, value)), _) => entries.push((name.trim(), value.to_owned())),
            (None, Some((_, keys))) if keys.contains('@') => keys.extend([",", entry]),
            (None, _) => return Err(miette!("{option} {entry}: expected NAME=STRENGTH")),
        }
    }
    for (name, value) in entries {
        let at = attributes.iter().position(|a| a.name.eq_ignore_ascii_case(name)).ok_or_else(|| {
            miette!(help = format!("the attributes are: {names}"), "{option} {name}: there is no such attribute")
        })?;
        strengths[at] = curve(&value)?;
    }
    Ok(strengths)
}
