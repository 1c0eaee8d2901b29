//! `kinesic apply`.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use kinesic::Pack;
use kinesic::engine::Controls;
use kinesic::model::ModelMeta;
use kinesic_host::clip::{Clip, Memory, ReadOptions};
use kinesic_host::feet::Hold;
use kinesic_host::limit::{self, Clamps};
use kinesic_host::pack::PackFile;
use kinesic_host::prepare::Source;
use kinesic_host::rig::{MAX_JOINTS, Rig};
use kinesic_host::robot::Machine;
use kinesic_host::strength::{Curve, Knobs};
use kinesic_host::translate::{self, TIMING_STRENGTH, Timing};
use kinesic_host::{components, engines};
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use super::batch::{Batch, FORMATS, Job};
use super::clips::Reading;
use super::land::{Feet, Judged, On, Place};
use super::mask;
use super::output::{check_motion, print_clamps, print_json, spinner, write_motion};

/// Play a clip through a pack, frame by frame as the device would, and write the result
///
/// For packs of translators and of style components.
///
/// The clip may have another skeleton and frame rate than the pack. The engine plays it on the pack's skeleton, as on the device. What
/// changed is carried to the clip's own skeleton: its joints, names, rest pose, fingers and rate stay. Feet are held where they stand in the
/// clip (--feet). With --on pack the result is what the device makes, on the pack's skeleton and at its rate. BVH is in centimetres, glTF in
/// metres.
///
/// A robot's motion is a file of its joints, and so is the result: what its servos take. Where the pack holds limits, they are the
/// last stage, as on the device, and the result is on the pack's skeleton.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic apply angry.kin walk.bvh --out angry-walk.bvh
  kinesic apply angry.kin walk.bvh --out a-little.bvh --strength 0.4
  kinesic apply angry.kin walk.bvh --out angry-walk.glb
  kinesic apply angry.kin walk.bvh --out angrier.bvh --strength 0@0s,1@2s,0.3@4s
  kinesic apply angry.kin walk.bvh --out as-drawn.bvh --strength @curve.csv
  kinesic apply angry.kin walks/ --out angry-walks/ --format glb
  kinesic apply angry.kin walk.bvh --out as-on-the-device.bvh --on pack
  kinesic apply angry.kin walk.bvh --out feet-held-on-it.bvh --on pack --feet live
  kinesic apply angry.kin walk.bvh --out same-path.bvh --mask pelvis=0
  kinesic apply angry.kin walk.bvh --out arms-only.bvh --mask '*=0,LeftArm+=1,r_shoulder+=1'
  kinesic apply child.kin jump.csv --out child-jump.bvh --timing learned
  kinesic apply components.kin --stored --out stored.bvh
  kinesic apply lively-robot.kin nod.json --out lively-nod.json --strength 0.7")]
pub struct Args {
    /// Pack to play
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// Clip to play (BVH, glTF, Kinect CSV; of a robot CSV, JSON, YAML); or several, folders and tables of clips
    #[arg(value_name = "CLIP", required_unless_present = "stored")]
    clips: Vec<PathBuf>,
    /// Play the motion that a pack of style components stores, instead of a clip
    #[arg(long, conflicts_with = "clips")]
    stored: bool,
    /// Motion to write, in the format that its name says: .bvh, .glb or .gltf (glTF 2.0), .csv (joint angles), .positions.csv; of a robot .csv,
    /// .json, .jsonl, .yaml. For several clips a folder
    #[arg(long, value_name = "FILE|FOLDER")]
    out: PathBuf,
    /// Format of the files in a folder [default: each as its clip]
    #[arg(long, value_parser = FORMATS, conflicts_with = "stored")]
    format: Option<String>,
    /// 0 = the clip itself, 1 = the style as learned, beyond = exaggerated. Keys STRENGTH@SECONDS,... change it while the clip plays, evenly from
    /// one to the next: 0@0s,1@2s. @FILE reads keys from a table, a time in seconds and a strength a line. Seconds are the clip's
    #[arg(long, default_value = "1", allow_hyphen_values = true)]
    strength: Curve,
    /// Weights of joints, 0 = untouched, 1 = translated, by the pack's names or canonical ones; JOINT+=W means all joints below
    /// it too, *=W is the rest. The pelvis stands for the root: pelvis=0 keeps the clip's travel, height and tilt, and held feet stand on the clip's
    /// spots
    #[arg(long, value_name = "JOINT=W,...")]
    mask: Vec<String>,
    /// Keep the clip's timing, or stretch and squeeze it as learned
    #[arg(long, value_enum, default_value_t = Clock::Keep)]
    timing: Clock,
    /// Whose skeleton the result has [default: the clip's; the pack's where it holds limits, and of a robot]
    #[arg(long, value_enum, value_name = "SKELETON")]
    on: Option<On>,
    /// Hold feet where they stand in the clip, or leave them as they come [default: lock; on the pack's skeleton free, as on a device that holds
    /// none]
    #[arg(long, value_enum)]
    feet: Option<Feet>,
    /// Where the clip is unlike the training of a translator: fade the style, or keep all of it
    #[arg(long, value_enum, default_value_t = Unfamiliar::Fade)]
    unfamiliar: Unfamiliar,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Clock {
    /// Frame for frame, as on a live stream
    Keep,
    /// As learned from the training pairs
    Learned,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Unfamiliar {
    /// As on the device unless told otherwise
    Fade,
    /// The whole style everywhere
    Keep,
}

#[derive(Serialize)]
struct Summary {
    #[serde(skip_serializing_if = "Option::is_none")]
    clip: Option<String>,
    out: String,
    frames: usize,
    frame_rate: f64,
    #[serde(flatten)]
    quality: Judged,
    /// Percent of the frames that are unlike the training; absent for packs that do not know.
    #[serde(skip_serializing_if = "Option::is_none")]
    unfamiliar_percent: Option<f64>,
    /// What the pack's limits did.
    #[serde(skip_serializing_if = "Option::is_none")]
    limits: Option<Clamps>,
    /// What is to be said about the strength.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
}

/// Percent of a clip from which its being unlike the training is worth a note.
const UNFAMILIAR: f64 = 5.0;

/// What plays every clip.
struct Stage<'p> {
    args: &'p Args,
    pack: &'p Pack<'p>,
    rig: Rig,
    machine: Option<Machine>,
    options: ReadOptions,
    knobs: Knobs,
    hold: Hold<'static>,
}

/// Greatest strength, whatever its sign.
fn most(strength: &Curve) -> f32 {
    strength.range().into_iter().map(f32::abs).fold(0.0, f32::max)
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    if matches!(args.timing, Clock::Learned) && most(&args.strength) > TIMING_STRENGTH {
        return Err(miette!(
            help = "choose a smaller strength, or keep the clip's timing (--timing keep)",
            "--strength {} with --timing learned: expected {} to {TIMING_STRENGTH}",
            args.strength,
            -TIMING_STRENGTH
        ));
    }
    let file = PackFile::read(&args.pack).into_diagnostic()?;
    let pack = file.pack().into_diagnostic()?;
    let rig = Rig::from_pack(&pack).into_diagnostic()?;
    let machine = Machine::from_pack(&pack).into_diagnostic()?;
    let [low, high] = args.strength.range();
    let mut controls = Controls { strength: high, ..Controls::default() };
    let mut weights = [1.0; MAX_JOINTS];
    mask::apply(&args.mask, &rig, 1.0, &mut weights)?;
    controls.mask = rig.coordinate_weights(&weights);
    let knobs = Knobs { controls, curve: (low < high).then(|| args.strength.clone()) };
    let options = args.reading.options_for(&pack)?;
    let hold = Hold { travels: mask::travels(&weights), ..Hold::default() };
    let stage = Stage { args, pack: &pack, rig, machine, options, knobs, hold };
    if args.stored {
        check_motion(&args.out, stage.machine.is_some())?;
        let summary = stage.play(None, &args.out)?;
        if args.json {
            return print_json(&summary);
        }
        summary.print();
        return Ok(());
    }
    let batch = Batch::new(&args.clips, &args.out, args.format.as_deref(), stage.machine.is_some())?;
    let print = |_: &Job, summary: &Summary| if batch.is_folder() { summary.line() } else { summary.print() };
    batch.run(args.json, |job| stage.play(Some(&job.clip), &job.out), print)
}

impl Stage<'_> {
    /// Plays a clip, or what the pack stores, and writes the result.
    fn play(&self, path: Option<&Path>, out: &Path) -> miette::Result<Summary> {
        let Self { args, pack, rig, options, .. } = self;
        let bar = spinner();
        bar.set_message("playing");
        let fps = f64::from(pack.metadata().frame_rate);
        let source = path.map(|path| Source::read(path, options)).transpose().into_diagnostic()?;
        let clip = source.as_ref().map(|source| source.on_rig(rig, fps)).transpose().into_diagnostic()?;
        let place = Place::choose(args.on, args.feet, pack, source.as_ref())?;
        let played = play(args, pack, rig, clip.as_ref(), &self.knobs, !place.is_own())?;
        let familiar = if args.unfamiliar == Unfamiliar::Fade { played.familiar.as_deref() } else { None };
        let hold = Hold { familiar: familiar.unwrap_or_default(), ..self.hold };
        let mut landed =
            place.land(source.as_ref(), (pack, rig), clip.as_ref(), &played.clip, hold).into_diagnostic()?;
        landed.clip = played.on_clock(&landed.clip, clip.as_ref().unwrap_or(&played.clip));
        let (styled, limits) = match limit::play(pack, rig, &landed.clip).into_diagnostic()? {
            Some((clip, clamps)) => (Cow::Owned(clip), Some(clamps)),
            None => (Cow::Borrowed(&landed.clip), None),
        };
        let moves = source.as_ref().and_then(|source| source.moves.as_ref());
        write_motion(out, &styled, self.machine.as_ref(), moves)?;
        bar.finish_and_clear();
        Ok(Summary {
            clip: path.map(|path| path.display().to_string()),
            out: out.display().to_string(),
            frames: styled.frames(),
            frame_rate: 1.0 / styled.frame_time,
            quality: landed.judge(&styled),
            unfamiliar_percent: played.unfamiliar_percent(),
            limits,
            notes: self.notes(&played),
        })
    }

    /// Strengths that the pack calls implausible, and keys that the clip does not reach.
    fn notes(&self, played: &Played) -> Vec<String> {
        let strength = &self.args.strength;
        let [low, high] = played.plausible;
        let mut notes = Vec::new();
        if !strength.range().iter().all(|strength| (low..=high).contains(strength)) {
            notes.push(format!("strength {strength} is outside the plausible range of this pack, {low} to {high}"));
        }
        if let Some(percent) = played.unfamiliar_percent().filter(|percent| *percent >= UNFAMILIAR) {
            let what = match self.args.unfamiliar {
                Unfamiliar::Fade => "the style fades there (--unfamiliar keep keeps it)",
                Unfamiliar::Keep => "and keeps all of the style",
            };
            notes.push(format!("{percent:.0} % of the clip is unlike the training: {what}"));
        }
        if strength.end() > played.clip.duration() + played.clip.frame_time && strength.constant().is_none() {
            let (end, lasts) = (strength.end(), played.clip.duration());
            notes.push(format!(
                "the last key of --strength is at {end} s, and the clip ends at {lasts:.2} s: it is not reached"
            ));
        }
        notes
    }
}

impl Summary {
    fn print(&self) {
        self.notes.iter().for_each(|note| println!("note: {note}"));
        self.quality.print();
        self.limits.iter().for_each(print_clamps);
        println!("{}: {} frames at {} a second", self.out, self.frames, self.frame_rate);
    }

    /// The same in one line, for one of many clips.
    fn line(&self) {
        let clamped = self.limits.iter().filter(|limits| limits.clamped_frames > 0);
        let clamped: String = clamped.map(|l| format!("; limits clamped in {} frames", l.clamped_frames)).collect();
        let notes: String = self.notes.iter().map(|note| format!("; {note}")).collect();
        let rate = self.frame_rate;
        println!("{}: {} frames at {rate:.2} a second{}{clamped}{notes}", self.out, self.frames, self.quality.line());
    }
}

/// What a pack made on its rig, frame for frame; when each frame is due, in frames, if the pack decides; the strengths that it calls
/// plausible; and how familiar each frame is, if it knows.
struct Played {
    clip: Clip,
    clock: Option<Vec<f64>>,
    plausible: [f32; 2],
    familiar: Option<Vec<f32>>,
}

impl Played {
    /// Percent of the frames that are unlike the training.
    fn unfamiliar_percent(&self) -> Option<f64> {
        self.familiar.as_deref().map(translate::unfamiliar_percent)
    }

    /// A motion on the pack's clock, if that decides. `on_rig` has the frames that the clock counts.
    fn on_clock(&self, clip: &Clip, on_rig: &Clip) -> Clip {
        self.clock.as_ref().map_or_else(|| clip.clone(), |due| clip.on_clock(due, on_rig.frame_time))
    }
}

/// Refuses a clip that the pack's clock may make too long. Each frame lasts `2^log2` frames, between the ends of the clock's range, to
/// the power of the strength.
fn check_length(args: &Args, pack: &Pack, clip: &Clip) -> miette::Result<()> {
    let timing = pack.slice::<[f32; 3]>("translate/timing", 1).into_diagnostic()?;
    let farthest = timing.iter().flat_map(|[_, low, high]| [low, high]).map(|end| end.abs()).fold(0.0, f32::max);
    let wanted = clip.frames() as f64 * f64::from(farthest * most(&args.strength)).exp2();
    Memory::check(clip.frames(), wanted, clip.skeleton.len()).map_err(|memory| {
        miette!(
            help = "cut the clip, ask for less strength, or keep the clip's timing: --timing keep",
            "--timing learned: {}: the {wanted:.0} frames that its clock may make of this clip {memory}",
            args.pack.display()
        )
    })
}

/// Plays with the engine that the pack holds; `live` as a device does, which does not know the clip before it begins.
fn play(args: &Args, pack: &Pack, rig: &Rig, clip: Option<&Clip>, knobs: &Knobs, live: bool) -> miette::Result<Played> {
    let (controls, curve) = (knobs.controls, || knobs.curve.clone());
    let models: Vec<ModelMeta> = pack.metadata().models.iter().collect();
    let learned = matches!(args.timing, Clock::Learned);
    match (engines::player(pack, true), clip) {
        (Some(("translator", player)), Some(clip)) => {
            let timing = if learned { Timing::Learned } else { Timing::Keep };
            if learned {
                check_length(args, pack, clip)?;
            }
            let fade = args.unfamiliar == Unfamiliar::Fade;
            let settings = translate::Settings { controls, curve: curve(), timing, fade, live };
            let played = translate::play_on_clock(pack, rig, clip, &settings).into_diagnostic()?;
            let clock = learned.then_some(played.clock);
            return Ok(Played { clip: played.clip, clock, plausible: player.plausible, familiar: played.familiar });
        }
        (Some((engine, _)), Some(_)) if learned => {
            return Err(miette!("--timing learned: the {engine} of this pack has no timing, only a translator has"));
        }
        (Some((_, player)), Some(clip)) => {
            let clip = (player.play)(pack, rig, clip, knobs).into_diagnostic()?;
            return Ok(Played { clip, clock: None, plausible: player.plausible, familiar: None });
        }
        _ => {}
    }
    if let (Some(meta), None) = (models.iter().find_map(|m| m.components()), clip) {
        if learned {
            return Err(miette!("--timing learned: the stored motion has no timing, only a translator has"));
        }
        let clip =
            components::play_stored(pack, rig, &components::Settings { controls, curve: curve() }).into_diagnostic()?;
        if clip.frames() == 0 {
            return Err(miette!(help = "name a clip to play", "the pack stores no motion"));
        }
        return Ok(Played { clip, clock: None, plausible: meta.strength, familiar: None });
    }
    let (found, help) = match args.stored {
        true => ("--stored: the pack holds no style components, which alone store a motion", "name a clip to play"),
        false => (
            "the pack holds neither a translator nor style components",
            "for body mechanics there are kinesic decouple, modulate, mix and blend, for an emotion kinesic synth",
        ),
    };
    Err(miette!(help = help, "{}: {found}", args.pack.display()))
}
