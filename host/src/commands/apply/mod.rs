//! `kinesic apply`.

mod land;

use std::path::PathBuf;

use clap::ValueEnum;
use kinesic::Pack;
use kinesic::engine::Controls;
use kinesic::model::ModelMeta;
use kinesic_host::clip::{Clip, Memory};
use kinesic_host::limit::{self, Clamps};
use kinesic_host::pack::PackFile;
use kinesic_host::prepare::Source;
use kinesic_host::rig::{MAX_JOINTS, MAX_ROWS, Rig};
use kinesic_host::robot::Machine;
use kinesic_host::translate::{self, TIMING_STRENGTH, Timing};
use kinesic_host::{components, engines};
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use self::land::{Feet, Judged, On, Place};
use super::clips::Reading;
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
  kinesic apply angry.kin walk.bvh --out as-on-the-device.bvh --on pack
  kinesic apply angry.kin walk.bvh --out arms-only.bvh --mask '*=0,LeftArm+=1,r_shoulder+=1'
  kinesic apply child.kin jump.csv --out child-jump.bvh --timing learned
  kinesic apply components.kin --stored --out stored.bvh
  kinesic apply lively-robot.kin nod.json --out lively-nod.json --strength 0.7")]
pub struct Args {
    /// Pack to play
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// Clip to play (BVH, glTF, Kinect CSV; of a robot CSV, JSON, YAML)
    #[arg(value_name = "CLIP", required_unless_present = "stored")]
    clip: Option<PathBuf>,
    /// Play the motion that a pack of style components stores, instead of a clip
    #[arg(long, conflicts_with = "clip")]
    stored: bool,
    /// Motion to write, in the format that its name says: .bvh, .glb or .gltf (glTF 2.0), .csv (joint angles); of a robot .csv, .json,
    /// .jsonl, .yaml
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// 0 = the clip itself, 1 = the style as learned, beyond = exaggerated
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    strength: f32,
    /// Weights of joints, 0 = untouched, 1 = translated, by the pack's names or canonical ones; JOINT+=W means all joints below
    /// it too, *=W is the rest
    #[arg(long, value_name = "JOINT=W,...")]
    mask: Vec<String>,
    /// Keep the clip's timing, or stretch and squeeze it as learned
    #[arg(long, value_enum, default_value_t = Clock::Keep)]
    timing: Clock,
    /// Whose skeleton the result has [default: the clip's; the pack's where it holds limits, and of a robot]
    #[arg(long, value_enum, value_name = "SKELETON")]
    on: Option<On>,
    /// Hold feet where they stand in the clip, or leave them as they come [default: lock; on the pack's skeleton free, as on the device]
    #[arg(long, value_enum)]
    feet: Option<Feet>,
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

#[derive(Serialize)]
struct Summary {
    out: String,
    frames: usize,
    frame_rate: f64,
    #[serde(flatten)]
    quality: Judged,
    /// What the pack's limits did.
    #[serde(skip_serializing_if = "Option::is_none")]
    limits: Option<Clamps>,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    if !args.strength.is_finite() {
        return Err(miette!("--strength {}: expected a number, usually from 0 to 1", args.strength));
    }
    if matches!(args.timing, Clock::Learned) && args.strength.abs() > TIMING_STRENGTH {
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
    check_motion(&args.out, machine.is_some())?;
    let mut controls = Controls { strength: args.strength, ..Controls::default() };
    let mut weights = [1.0; MAX_JOINTS];
    mask::apply(&args.mask, &rig, 1.0, &mut weights)?;
    controls.mask = rig.coordinate_weights(&weights);
    let bar = spinner();
    bar.set_message("playing");
    let fps = f64::from(pack.metadata().frame_rate);
    let options = args.reading.options_for(&pack)?;
    let source = args.clip.as_ref().map(|path| Source::read(path, &options)).transpose().into_diagnostic()?;
    let clip = source.as_ref().map(|source| source.on_rig(&rig, fps)).transpose().into_diagnostic()?;
    let played = play(args, &pack, &rig, clip.as_ref(), controls)?;
    let place = Place::choose(args.on, args.feet, &pack, source.as_ref())?;
    let (styled, quality) = match &clip {
        Some(clip) if machine.is_none() => place.land(source.as_ref(), &rig, clip, &played),
        _ => (played.timed(&rig), land::alone(&played.clip, machine.is_none().then_some(&rig.map))),
    };
    let (styled, limits) = match limit::play(&pack, &rig, &styled).into_diagnostic()? {
        Some((clip, clamps)) => (clip, Some(clamps)),
        None => (styled, None),
    };
    write_motion(&args.out, &styled, machine.as_ref(), source.as_ref().and_then(|source| source.moves.as_ref()))?;
    bar.finish_and_clear();
    let frame_rate = 1.0 / styled.frame_time;
    let summary = Summary { out: args.out.display().to_string(), frames: styled.frames(), frame_rate, quality, limits };
    if args.json {
        return print_json(&summary);
    }
    let [low, high] = played.plausible;
    if !(low..=high).contains(&args.strength) {
        println!("note: strength {} is outside the plausible range of this pack, {low} to {high}", args.strength);
    }
    summary.quality.print();
    summary.limits.iter().for_each(print_clamps);
    println!("{}: {} frames at {frame_rate} a second", summary.out, summary.frames);
    Ok(())
}

/// What a pack made on its rig, frame for frame; when each frame is due, in frames, if the pack decides; and the strengths that it calls
/// plausible.
struct Played {
    clip: Clip,
    clock: Option<Vec<f64>>,
    plausible: [f32; 2],
}

impl Played {
    fn timed(&self, rig: &Rig) -> Clip {
        self.clock.as_ref().map_or_else(|| self.clip.clone(), |clock| translate::retime(rig, &self.clip, clock))
    }
}

/// Refuses a clip that the pack's clock may make too long. Each frame lasts `2^log2` frames, between the ends of the clock's range, to
/// the power of the strength.
fn check_length(args: &Args, pack: &Pack, clip: &Clip) -> miette::Result<()> {
    let timing = pack.slice::<[f32; 3]>("translate/timing", 1).into_diagnostic()?;
    let farthest = timing.iter().flat_map(|[_, low, high]| [low, high]).map(|end| end.abs()).fold(0.0, f32::max);
    let wanted = clip.frames() as f64 * f64::from(farthest * args.strength.abs()).exp2();
    Memory::check(clip.frames(), wanted, clip.skeleton.len()).map_err(|memory| {
        miette!(
            help = "cut the clip, ask for less strength, or keep the clip's timing: --timing keep",
            "--timing learned: {}: the {wanted:.0} frames that its clock may make of this clip {memory}",
            args.pack.display()
        )
    })
}

/// Plays with the engine that the pack holds.
fn play(
    args: &Args,
    pack: &Pack,
    rig: &Rig,
    clip: Option<&Clip>,
    controls: Controls<MAX_ROWS>,
) -> miette::Result<Played> {
    let models: Vec<ModelMeta> = pack.metadata().models.iter().collect();
    let learned = matches!(args.timing, Clock::Learned);
    match (engines::player(pack, true), clip) {
        (Some(("translator", player)), Some(clip)) if learned => {
            check_length(args, pack, clip)?;
            let settings = translate::Settings { controls, timing: Timing::Learned };
            let (clip, clock) = translate::play_on_clock(pack, rig, clip, &settings).into_diagnostic()?;
            return Ok(Played { clip, clock: Some(clock), plausible: player.plausible });
        }
        (Some((engine, _)), Some(_)) if learned => {
            return Err(miette!("--timing learned: the {engine} of this pack has no timing, only a translator has"));
        }
        (Some((_, player)), Some(clip)) => {
            let clip = (player.play)(pack, rig, clip, controls).into_diagnostic()?;
            return Ok(Played { clip, clock: None, plausible: player.plausible });
        }
        _ => {}
    }
    if let (Some(meta), None) = (models.iter().find_map(|m| m.components()), clip) {
        if learned {
            return Err(miette!("--timing learned: the stored motion has no timing, only a translator has"));
        }
        let clip = components::play_stored(pack, rig, &components::Settings { controls }).into_diagnostic()?;
        if clip.frames() == 0 {
            return Err(miette!(help = "name a clip to play", "the pack stores no motion"));
        }
        return Ok(Played { clip, clock: None, plausible: meta.strength });
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
