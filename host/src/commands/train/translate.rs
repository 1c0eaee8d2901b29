//! `kinesic train translate`.

use std::path::PathBuf;

use clap::ValueEnum;
use kinesic_host::clip::Clip;
use kinesic_host::measure::Degrees;
use kinesic_host::measure::turns::Turns;
use kinesic_host::pack::{Metric, PackFile};
use kinesic_host::plausible::Plausible;
use kinesic_host::prepare::{Source, common_rate};
use kinesic_host::step_cache::StepCache;
use kinesic_host::translate::{
    AFFINE, Alignment, Base, Candidate, Errors, FormChoice, NamedPair, OPEN, Poles, Report, Stage, TrainOptions,
    TrainPair, Trained, evaluate, plausible, train_kept,
};
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use super::doubtful::doubtful;
use super::learned::{Forced, no_nearer, same};
use super::report::{ReportArgs, translate::page};
use super::resume::ResumeArgs;
use super::session::Session;
use crate::commands::angles;
use crate::commands::clips::{Pairs, Reading};
use crate::commands::origin::{fingerprints, name_of};
use crate::commands::precision::Precision;
use crate::commands::quality;

/// Learn to translate one manner of moving into another, from pairs of clips
///
/// The clips of a pair show the same content in two manners; their timing may differ. Form, order and penalties are chosen by
/// cross-validation within the training pairs.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic train translate --pair neutral.bvh angry.bvh --out angry.kin
  kinesic train translate --pairs pairs.tsv --where style=child --where 'neutral!~p734' --out child.kin
  kinesic train translate --pair my.bvh mine-sad.bvh --map my-skeleton.toml --form per-joint --order 40 --out sad.kin")]
pub struct Args {
    #[command(flatten)]
    pairs: Pairs,
    /// Pack to write
    #[arg(long, value_name = "FILE.kin")]
    out: PathBuf,
    /// Number type of the pack: i16 needs no FPU and half the flash
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    precision: Precision,
    /// Name of the style (default: the pack's file name)
    #[arg(long, value_name = "NAME")]
    style: Option<String>,
    /// Largest order: states of each joint's model, or of the shared one (default: 40 a joint, 64 shared)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=512))]
    order: Option<u16>,
    /// One model a joint (Dong 2018), one for the whole body (Hsu 2005), or the better of the two
    #[arg(long, value_enum, default_value_t = Form::Auto)]
    form: Form,
    /// How the clips of a pair are brought together
    #[arg(long, value_enum, default_value_t = Align::Auto)]
    align: Align,
    /// Train on left-right mirrored copies too
    #[arg(long, value_enum, default_value_t = Mirror::Auto)]
    mirror: Mirror,
    /// Frames per second of the pack (default: that of the slowest clip, at most 60; of a robot, at most its own)
    #[arg(long, value_name = "RATE", allow_negative_numbers = true)]
    fps: Option<f64>,
    /// Seed of random choices; recorded in the pack (this trainer makes none)
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Leave out what tells familiar motion from other: no fading, one action, about 3 kB and 1,100 multiply-adds less
    #[arg(long)]
    no_gate: bool,
    #[command(flatten)]
    forced: Forced,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten)]
    report: ReportArgs,
    #[command(flatten)]
    resume: ResumeArgs,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Form {
    /// The smaller validation error decides
    Auto,
    /// 3 inputs and 3 outputs a joint
    PerJoint,
    /// Principal coordinates in, all joints out
    WholeBody,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Align {
    /// In step for walks; each by itself for walks among others; else the way with the smallest error
    /// on the training pairs
    Auto,
    /// Iterative motion warping of the positions, first frame to first, last to last
    Warp,
    /// Evenly from beginning to end
    Uniform,
    /// By the phase of the limbs, in step; clips that start on different feet overlap in part
    InStep,
    /// By the phase of the limbs, left answering right: for clips that start on different feet
    Opposite,
    /// Each pair by itself: in step where both clips are walks, else by warping
    Each,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Mirror {
    /// If it lowers the validation error
    Auto,
    /// Always
    On,
    /// Never
    Off,
}

/// Refuses a rate far above that of every clip: it holds nothing more, and the work grows faster than the rate.
fn check_rate<'a>(fps: f64, clips: impl Iterator<Item = &'a Clip>) -> miette::Result<()> {
    let fastest = clips.map(Clip::fps).fold(60.0, f64::max);
    // Frame times are written with few digits.
    // What is no rate at all is refused where clips are resampled.
    if fps.is_nan() || fps <= 1.01 * fastest {
        return Ok(());
    }
    Err(miette!(
        help = "leave --fps out to take the rate of the slowest clip",
        "--fps {fps}: expected at most {fastest:.0}, the rate of the fastest clip (at least 60): frames in between hold nothing new, and fitting \
         them takes hours"
    ))
}

/// Why the pack cannot be of use, if so.
fn why_not(judged: &Errors) -> Option<String> {
    let before = [judged.identity_cm, judged.degrees.identity.all];
    if same(before) {
        return Some("the clips of the pairs are the same motion: there is nothing to learn".to_owned());
    }
    no_nearer("the pack comes no nearer to its own training clips", before, [judged.error_cm, judged.degrees.error.all])
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let session = Session::begin(&args.out, args.seed, args.json, &args.report)?;
    args.precision.check("translators", Some(Precision::I16))?;
    let paths = args.pairs.paths()?;
    let options = args.reading.options()?;
    session.say(format!("reading {} clips", 2 * paths.len()));
    let read = |path: &PathBuf| Source::read(path, &options).into_diagnostic();
    let sources =
        paths.iter().map(|(a, b)| Ok((read(a)?, read(b)?))).collect::<miette::Result<Vec<(Source, Source)>>>()?;
    let fps = args.fps.unwrap_or_else(|| common_rate(sources.iter().flat_map(|(a, b)| [a, b])));
    check_rate(fps, sources.iter().flat_map(|(a, b)| [&a.clip, &b.clip]))?;
    let rig = sources[0].0.rig().into_diagnostic()?;
    let on_rig = |source: &Source| source.on_rig(&rig, fps).into_diagnostic();
    let clips =
        sources.iter().map(|(a, b)| Ok((on_rig(a)?, on_rig(b)?))).collect::<miette::Result<Vec<(Clip, Clip)>>>()?;
    let poses: Vec<_> = clips.iter().flat_map(|(neutral, styled)| [rig.poses(neutral), rig.poses(styled)]).collect();
    let rig = rig.centred(&poses.iter().map(Vec::as_slice).collect::<Vec<_>>());
    drop(poses);
    let pair = |((source, target), (neutral, styled)): (&(Source, Source), &(Clip, Clip))| TrainPair {
        source_name: name_of(&source.name()),
        target_name: name_of(&target.name()),
        source: rig.locals_of(neutral),
        target: rig.locals_of(styled),
    };
    let pairs: Vec<TrainPair> = sources.iter().zip(&clips).map(pair).collect();
    let style = session.name(args.style.as_ref(), "style");
    let prints = fingerprints(paths.iter().flat_map(|(a, b)| [a.as_path(), b.as_path()]))?;
    // The same options, the same clips in the same order, read in the same way: the same training.
    let deciding = [format!("translate {:?} {fps}", args.options()), format!("{prints:?}"), args.reading.deciding()?];
    let mut checkpoint = args.resume.checkpoint(&args.out, &deciding)?;
    let cache = StepCache::new(&mut checkpoint).into_diagnostic()?;
    let progress = |stage| {
        session.say(match stage {
            Stage::Align => "aligning the clips",
            Stage::Validate => "comparing forms, orders and penalties",
            Stage::Fit => "fitting",
        });
    };
    let trained = train_kept(&rig, &pairs, &style, fps, &args.options(), &progress, &cache);
    let mut trained = trained.into_diagnostic()?;
    drop(cache);

    let named: Vec<NamedPair> = pairs
        .iter()
        .zip(&clips)
        .map(|(pair, (neutral, styled))| NamedPair {
            source: (&pair.source_name, neutral),
            target: (&pair.target_name, styled),
        })
        .collect();
    let turns = Turns::of_pairs(&rig, clips.iter().map(|(a, b)| (a, b))).into_diagnostic()?;
    let mut provenance = session.provenance(prints, notes(&trained));
    (provenance.baselines, provenance.turns) = (trained.baselines.clone(), turns.numbers());
    let preview = PackFile::from_bytes(&args.precision.of(trained.model.pack(&rig, &provenance), &provenance)?);
    let (neutral, styled): (Vec<&Clip>, Vec<&Clip>) = clips.iter().map(|(neutral, styled)| (neutral, styled)).unzip();
    let strengths = plausible(&preview.pack().into_diagnostic()?, &rig, &neutral, &styled).into_diagnostic()?;
    trained.model.strength = strengths.range();
    provenance.notes.extend(strengths.why().map(|why| format!("plausible strengths end: {why}")));
    let pack = preview.pack().into_diagnostic()?;
    let report = evaluate(&pack, &rig, &trained.baselines, Some(&turns), &named).into_diagnostic()?;
    let judged = report.errors.judged(trained.alignment);
    let doubtful = doubtful(&report.pairs, trained.alignment);
    args.forced.check(why_not(&judged), "check that the clips of a pair show the same content in two manners")?;
    provenance.metrics = metrics(&trained, &judged);
    let bytes = args.precision.of(trained.model.pack(&rig, &provenance), &provenance)?;
    let bytes = session.of_robot(bytes, &options, &provenance)?;
    let file = session.write(&bytes)?;
    let page = page(&trained, &report, &named[0], &rig, &file)?;
    let summary = Summary { doubtful, ..Summary::new(args, &trained, &report, strengths, bytes.len(), fps) };
    session.finish(&file, page, Some(checkpoint), &summary, |summary| {
        print(summary, &trained);
        Ok(())
    })
}

impl Args {
    fn options(&self) -> TrainOptions {
        TrainOptions {
            order: self.order.map(usize::from),
            form: match self.form {
                Form::Auto => FormChoice::Auto,
                Form::PerJoint => FormChoice::PerJoint,
                Form::WholeBody => FormChoice::WholeBody,
            },
            alignment: match self.align {
                Align::Auto => None,
                Align::Warp => Some(Alignment::Warp),
                Align::Uniform => Some(Alignment::Uniform),
                Align::InStep => Some(Alignment::InStep),
                Align::Opposite => Some(Alignment::Opposite),
                Align::Each => Some(Alignment::Each),
            },
            gate: !self.no_gate,
            mirror: match self.mirror {
                Mirror::Auto => None,
                Mirror::On => Some(true),
                Mirror::Off => Some(false),
            },
        }
    }
}

/// As on the command line.
pub(super) fn alignment_name(alignment: Alignment) -> &'static str {
    match alignment {
        Alignment::Warp => "warp",
        Alignment::Uniform => "uniform",
        Alignment::InStep => "in-step",
        Alignment::Opposite => "opposite",
        Alignment::Each => "each",
    }
}

/// A candidate in words.
pub(super) fn describe(candidate: &Candidate) -> String {
    if *candidate == AFFINE {
        return "per joint, static affine map".to_owned();
    }
    let poles = match candidate.poles {
        Poles::Static => "no memory".to_owned(),
        Poles::Relaxation => "2 real poles an input".to_owned(),
        Poles::Harmonics2 => "2 harmonics an input".to_owned(),
        Poles::Harmonics3 => "3 harmonics an input".to_owned(),
        Poles::Full => "2 real poles and 5 harmonics an input".to_owned(),
        Poles::Identified(order) => format!("identified, order {order}"),
    };
    let form = candidate.coordinates.map_or("per joint".to_owned(), |c| format!("whole body, {c} coordinates"));
    let base = match candidate.base {
        Base::Mean => "mean pose",
        Base::Identity => "the source",
        Base::Channel => "a gain a channel",
        Base::Joint => "a 3 x 3 a joint",
    };
    let experts = if candidate.experts { ", an expert an action" } else { "" };
    format!("{form}, {poles}{experts}, on {base}, penalty {}/{}", candidate.penalty, candidate.dynamic_penalty)
}

fn notes(trained: &Trained) -> Vec<String> {
    let mut notes = vec![
        format!("alignment: {}", alignment_name(trained.alignment)),
        format!("model: {}", describe(&trained.candidate.0)),
        format!("mirrored copies: {}", if trained.mirrored { "yes" } else { "no" }),
        format!("main frequency: {:.2} Hz", trained.main_frequency),
    ];
    if trained.candidate.0.experts {
        notes.push(
            "several actions: an expert for each was chosen on takes of them that were held back, and its error above is of actions left out"
                .to_owned(),
        );
    }
    if trained.alignment == Alignment::Opposite {
        notes.push(
            "the clips start on opposite feet and left answers right: for masks, or strengths below 1, train with \
             --align in-step"
                .to_owned(),
        );
    }
    notes
}

fn metrics(trained: &Trained, judged: &Errors) -> Vec<Metric> {
    vec![
        Metric::new("validation_cm", trained.candidate.1),
        Metric::new("training_error_cm", judged.error_cm),
        Metric::new("training_identity_cm", judged.identity_cm),
        Metric::new("training_offset_cm", judged.offset_cm),
        Metric::new("training_affine_cm", judged.affine_cm),
        Metric::new("training_error_degrees", judged.degrees.error.all),
        Metric::new("training_identity_degrees", judged.degrees.identity.all),
    ]
}

#[derive(Serialize)]
struct Summary<'a> {
    pack: String,
    bytes: usize,
    frame_rate: f64,
    alignment: &'static str,
    alignments: Vec<(&'static str, f64)>,
    model: String,
    forms: Vec<(String, f64)>,
    mirrored: bool,
    strength: [f64; 2],
    /// What ends the plausible strengths.
    #[serde(skip_serializing_if = "Option::is_none")]
    strength_ends: Option<String>,
    validation_cm: f64,
    /// Pairs whose clips do not seem to show the same action, and why.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    doubtful: Vec<String>,
    training: &'a Report,
}

impl<'a> Summary<'a> {
    fn new(args: &Args, trained: &Trained, report: &'a Report, strengths: Plausible, bytes: usize, fps: f64) -> Self {
        Self {
            pack: args.out.display().to_string(),
            bytes,
            frame_rate: fps,
            alignment: alignment_name(trained.alignment),
            alignments: trained.alignments.iter().map(|(way, error)| (alignment_name(*way), *error)).collect(),
            model: describe(&trained.candidate.0),
            forms: trained.forms.iter().map(|(candidate, error)| (describe(candidate), *error)).collect(),
            mirrored: trained.mirrored,
            strength: strengths.range(),
            strength_ends: strengths.why(),
            validation_cm: trained.candidate.1,
            doubtful: Vec::new(),
            training: report,
        }
    }
}

fn print(summary: &Summary, trained: &Trained) {
    println!("alignment      {:<10} error on the training pairs, cm", "");
    for (way, error) in &trained.alignments {
        let mark = if *way == trained.alignment { "*" } else { " " };
        println!("             {mark} {:<10} {error:8.2}", alignment_name(*way));
    }
    println!("model          validated among {} candidates, cm", trained.compared);
    for (candidate, error) in &trained.forms {
        let mark = if *candidate == trained.candidate.0 { "*" } else { " " };
        println!("             {mark} {error:8.2}  {}", describe(candidate));
    }
    let errors = &summary.training.errors.judged(trained.alignment);
    let ends = if trained.alignment.ends() == OPEN { " (open ends)" } else { "" };
    println!("training pairs: aligned RMS joint distance, cm; mean angle, degrees: all joints, leaves{ends}");
    let cm = [errors.identity_cm, errors.offset_cm, errors.affine_cm, errors.error_cm];
    for (cm, (name, degrees)) in cm.into_iter().zip(angles::columns(errors)) {
        let angle =
            |of: fn(&Degrees) -> f64| degrees.map_or_else(|| "-".to_owned(), |degrees| format!("{:.2}", of(degrees)));
        println!("               {name:<8} {cm:8.2} {:>8} {:>8}", angle(|d| d.all), angle(|d| d.leaves));
    }
    if let Some(found) = &summary.training.quality {
        quality::compared(found, quality::PAIR, "training pairs");
    }
    for note in notes(trained).iter().skip(4).chain(&summary.doubtful) {
        println!("note: {note}");
    }
    let [low, high] = summary.strength;
    let Summary { pack, bytes, frame_rate, .. } = summary;
    let why = summary.strength_ends.as_ref().map_or(String::new(), |why| format!("; {why}"));
    println!("{pack}: {bytes} bytes, {frame_rate} frames a second, plausible strengths {low} to {high}{why}");
}
