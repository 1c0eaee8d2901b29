//! `kinesic demo`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use kinesic::{Pipeline, PipelineState, Pose};
use kinesic_host::clip::{Canonical, Clip, JointMap};
use kinesic_host::gait::{Manner, walk};
use kinesic_host::measure::turns::Turns;
use kinesic_host::measure::{Degrees, Measurable, compare};
use kinesic_host::mechanics::decouple;
use kinesic_host::models;
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::retarget::retarget;
use kinesic_host::rig::{MAX_JOINTS, MAX_ROWS, Rig};
use kinesic_host::translate::{
    FormChoice, HostTranslator, NamedPair, OPEN, TrainOptions, TrainPair, evaluate, plausible, train,
};
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use super::origin::command_line;
use super::output::{print_json, spinner, write_whole};

/// Show the whole way: make two manners of walking, learn the difference, pack it, play an unseen walk frame by frame
///
/// Then the pack of body mechanics that comes with the program takes the expression out of the weary walk. Writes the made
/// walks, the pack and the results to a folder.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic demo
  kinesic demo --out /tmp/demo --seed 7")]
pub struct Args {
    /// Folder to write to; it is made if it is missing
    #[arg(long, value_name = "FOLDER", default_value = "kinesic-demo")]
    out: PathBuf,
    /// Seed of the made walks
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
}

impl Default for Args {
    fn default() -> Self {
        Self { out: PathBuf::from("kinesic-demo"), seed: 1, json: false }
    }
}

const FPS: f64 = 60.0;
const SECONDS: f64 = 6.0;

#[derive(Serialize)]
struct Summary {
    folder: String,
    error_cm: f64,
    identity_cm: f64,
    offset_cm: f64,
    affine_cm: f64,
    floor_cm: f64,
    /// The same in degrees, over all joints and over leaves.
    error_degrees: [f64; 2],
    identity_degrees: [f64; 2],
    offset_degrees: Option<[f64; 2]>,
    affine_degrees: Option<[f64; 2]>,
    floor_degrees: [f64; 2],
    pack_bytes: usize,
    multiply_adds_per_frame: usize,
    microseconds_per_frame: f64,
    frames: usize,
    /// Mean angle of the neck to the vertical, degrees: of the plain walk, of the weary one, of the weary one's mechanics.
    nod_deg: [f64; 3],
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    std::fs::create_dir_all(&args.out).map_err(|error| {
        miette!(help = "choose another with --out FOLDER", "{}: cannot be made: {error}", args.out.display())
    })?;
    let bar = spinner();
    bar.set_message("making walks and training");
    // Same content, two manners; the unseen walk starts elsewhere in the stride and varies in another way.
    let made = |manner: &Manner, phase: f64, seed: u64| {
        let seconds = SECONDS * Manner::NEUTRAL.cadence / manner.cadence;
        walk(manner, seconds, FPS, phase, args.seed.wrapping_mul(1000).wrapping_add(seed))
    };
    let (neutral, weary) = (made(&Manner::NEUTRAL, 0.0, 1), made(&Manner::WEARY, 0.0, 2));
    let (unseen, expected, again) =
        (made(&Manner::NEUTRAL, 0.3, 3), made(&Manner::WEARY, 0.3, 4), made(&Manner::WEARY, 0.3, 5));
    let map = JointMap::detect(&neutral.skeleton).ok_or_else(|| miette!("the made skeleton is not known"))?;
    let rig = Rig::new(&neutral.skeleton, &map).into_diagnostic()?;
    let rig = rig.centred(&[&rig.poses(&neutral), &rig.poses(&weary)]);
    let pair = TrainPair {
        source_name: "neutral.bvh".into(),
        target_name: "weary.bvh".into(),
        source: rig.locals_of(&neutral),
        target: rig.locals_of(&weary),
    };
    // One made-up gait says nothing of how far people's walks differ.
    let options = TrainOptions { form: FormChoice::WholeBody, gate: false, ..TrainOptions::default() };
    let mut trained = train(&rig, &[pair], "weary", FPS, &options, &|_| {}).into_diagnostic()?;
    let turns = Turns::of_pairs(&rig, [(&neutral, &weary)]).into_diagnostic()?;
    let provenance = Provenance {
        tool: format!("kinesic {}", env!("CARGO_PKG_VERSION")),
        command: command_line(),
        seed: args.seed,
        notes: vec!["trained on made-up walks (kinesic demo)".to_owned()],
        baselines: trained.baselines.clone(),
        turns: turns.numbers(),
        ..Provenance::default()
    };
    let preview = PackFile::from_bytes(&trained.model.pack(&rig, &provenance));
    trained.model.strength =
        plausible(&preview.pack().into_diagnostic()?, &rig, &[&neutral], &[&weary]).into_diagnostic()?.range();
    let bytes = trained.model.pack(&rig, &provenance);
    let path = |name: &str| args.out.join(name);
    write_whole(&path("weary.kin"), &bytes)?;

    // From here on as a device would: the pack from disk, one pose in and one pose out a frame.
    bar.set_message("playing an unseen walk through the device's code");
    let file = PackFile::read(&path("weary.kin")).into_diagnostic()?;
    let pack = file.pack().into_diagnostic()?;
    let translator = HostTranslator::load(&pack).into_diagnostic()?;
    let source = rig.poses(&unseen);
    let (styled, microseconds) = play_timed(&translator, &rig, &source)?;
    let errors = evaluate(
        &pack,
        &rig,
        &trained.baselines,
        Some(&turns),
        &[NamedPair { source: ("unseen", &unseen), target: ("expected", &expected) }],
    )
    .into_diagnostic()?
    .errors
    .judged(trained.alignment);
    // Two takes of the same manner: no translation can be expected to come nearer.
    let take = |clip| Measurable::new(&rig, clip);
    let floor = compare(&rig, &take(&again), &take(&expected), OPEN).into_diagnostic()?;
    let angles = |degrees: &Degrees| [degrees.all, degrees.leaves];
    let simpler = |degrees: &Option<Degrees>| degrees.as_ref().map(angles);
    let clips: [(&str, &Clip); 4] =
        [("neutral.bvh", &neutral), ("weary.bvh", &weary), ("unseen.bvh", &unseen), ("expected.bvh", &expected)];
    for (name, clip) in clips {
        clip.write_bvh(path(name)).into_diagnostic()?;
    }
    rig.clip(&styled, 1.0 / FPS).write_bvh(path("unseen-weary.bvh")).into_diagnostic()?;
    bar.set_message("taking the expression out of the weary walk");
    let [plain_walk, weary_walk, without] = mechanics(&neutral, &weary, &map)?;
    without.0.write_bvh(path("weary-plain.bvh")).into_diagnostic()?;
    let nod_deg = [nod(&plain_walk)?, nod(&weary_walk)?, nod(&without)?];
    bar.finish_and_clear();
    let summary = Summary {
        folder: args.out.display().to_string(),
        error_cm: errors.error_cm,
        identity_cm: errors.identity_cm,
        offset_cm: errors.offset_cm,
        affine_cm: errors.affine_cm,
        floor_cm: floor.cm,
        error_degrees: angles(&errors.degrees.error),
        identity_degrees: angles(&errors.degrees.identity),
        offset_degrees: simpler(&errors.degrees.offset),
        affine_degrees: simpler(&errors.degrees.affine),
        floor_degrees: angles(&floor.degrees),
        pack_bytes: bytes.len(),
        multiply_adds_per_frame: translator.multiply_adds(),
        microseconds_per_frame: microseconds,
        frames: source.len(),
        nod_deg,
    };
    if args.json {
        print_json(&summary)
    } else {
        print(&summary, &args.out);
        Ok(())
    }
}

/// Plays frame by frame; time of a frame is the median of five passes.
fn play_timed(
    translator: &HostTranslator,
    rig: &Rig,
    source: &[Pose<MAX_JOINTS>],
) -> miette::Result<(Vec<Pose<MAX_JOINTS>>, f64)> {
    let mut styled = vec![Pose::identity(); source.len()];
    let pipeline = Pipeline::<_, MAX_ROWS>::new(rig.frames(), *translator).into_diagnostic()?;
    let mut passes: Vec<f64> = (0..5)
        .map(|_| {
            let mut state = Box::new(PipelineState::new());
            pipeline.start(&mut state, &source[0]);
            let begin = Instant::now();
            for (pose, out) in source.iter().zip(&mut styled) {
                pipeline.step(&mut state, Some(pose), out);
            }
            begin.elapsed().as_secs_f64() * 1e6 / source.len() as f64
        })
        .collect();
    passes.sort_by(f64::total_cmp);
    Ok((styled, passes[2]))
}

/// A clip with the map of its joints.
type Mapped = (Clip, JointMap);

/// Both walks on the skeleton of the pack of body mechanics, and the mechanics `B'` of the weary one.
fn mechanics(neutral: &Clip, weary: &Clip, map: &JointMap) -> miette::Result<[Mapped; 3]> {
    let file = models::mechanics();
    let pack = file.pack().into_diagnostic()?;
    let rig = Rig::from_pack(&pack).into_diagnostic()?;
    let fps = f64::from(pack.metadata().frame_rate);
    let on_rig = |clip: &Clip| retarget(&clip.resample(fps).into_diagnostic()?, map, &rig).into_diagnostic();
    let (neutral, weary) = (on_rig(neutral)?, on_rig(weary)?);
    let parts = decouple(&pack, &rig.poses(&weary)).into_diagnostic()?;
    let poses: Vec<Pose<MAX_JOINTS>> = parts.iter().map(|parts| parts.mechanics).collect();
    let without = rig.clip(&poses, 1.0 / fps);
    Ok([neutral, weary, without].map(|clip| (clip, rig.map.clone())))
}

/// Mean angle between neck to head and the vertical, degrees.
fn nod((clip, map): &Mapped) -> miette::Result<f64> {
    let (Some(neck), Some(head)) = (map.joint(Canonical::Neck), map.joint(Canonical::Head)) else {
        return Err(miette!("the skeleton of models/mechanics.kin has no neck or no head"));
    };
    let angle = |frame: usize| {
        let positions = clip.positions(frame);
        let bone = positions[head] - positions[neck];
        bone.xz().norm().atan2(bone.y)
    };
    Ok((0..clip.frames()).map(angle).sum::<f64>().to_degrees() / clip.frames().max(1) as f64)
}

fn print(s: &Summary, folder: &Path) {
    println!("A walk that was not in the training, translated to a weary one.");
    println!(
        "Aligned RMS joint distance to the weary walk that belongs to it, open ends, cm; mean angle, degrees: all joints, leaves"
    );
    let row = |name: &str, cm: f64, degrees: Option<[f64; 2]>| {
        let [all, leaves] =
            [0, 1].map(|of| degrees.map_or_else(|| "-".to_owned(), |angles| format!("{:.2}", angles[of])));
        println!("  {name:<24} {cm:6.2} {all:>8} {leaves:>8}");
    };
    row("doing nothing", s.identity_cm, Some(s.identity_degrees));
    row("mean offset", s.offset_cm, s.offset_degrees);
    row("affine map per joint", s.affine_cm, s.affine_degrees);
    row("kinesic", s.error_cm, Some(s.error_degrees));
    row("another take (floor)", s.floor_cm, Some(s.floor_degrees));
    println!("Pack                       {:6} bytes", s.pack_bytes);
    println!("Multiply-adds per frame    {:6} and the rig's", s.multiply_adds_per_frame);
    println!(
        "Time per frame, this host  {:6.1} us ({} frames, median of 5 passes)",
        s.microseconds_per_frame, s.frames
    );
    println!();
    println!("The weary walk without its expression (body mechanics trained on CMU clips):");
    println!("Mean bend of the neck, degrees");
    let [plain, weary, without] = s.nod_deg;
    println!("  neutral walk             {plain:6.1}");
    println!("  weary walk               {weary:6.1}");
    println!("  weary, mechanics only    {without:6.1}");
    println!();
    println!("Written to {}:", folder.display());
    println!("  neutral.bvh, weary.bvh   the training pair");
    println!("  weary.kin                the pack");
    println!("  unseen.bvh               a walk that was not in the training");
    println!("  unseen-weary.bvh         the same, translated");
    println!("  expected.bvh             the weary walk that belongs to it");
    println!("  weary-plain.bvh          the weary walk without its expression");
    println!(
        "Next: kinesic inspect {0}/unseen-weary.bvh, or kinesic apply {0}/weary.kin YOUR.bvh --out out.bvh",
        folder.display()
    );
}
