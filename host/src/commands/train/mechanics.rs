//! `kinesic train mechanics`.

use std::cell::RefCell;
use std::path::PathBuf;
use std::time::Instant;

use clap::ValueEnum;
use kinesic_host::mechanics::{
    Distances, Figures, NamedClip, Split, TrainOptions, Trained, evaluate, propose, train_kept,
};
use kinesic_host::pack::{Baselines, Metric};
use kinesic_host::prepare::{Source, common_rate};
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use super::learned::Forced;
use super::report::{ReportArgs, mechanics::page};
use super::resume::ResumeArgs;
use super::session::Session;
use crate::commands::clips::{Reading, clip_paths};
use crate::commands::origin::{fingerprints, name_of};
use crate::commands::precision::Precision;

/// Learn which pose a body's mechanics ask for, from clips without expression
///
/// A denoising autoencoder learns poses from all clips; a network from dynamic features to its code learns from the
/// body-mechanics clips; both are stacked and fine-tuned (Boehs, Vieira, Pereira 2017).
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Clips are files, folders, or tables: manifest.tsv:label=body-mechanics,skeleton=cmu31 takes the rows that fulfil the conditions.

Examples:
  kinesic train mechanics --clips plain-walks/ --pool all-clips/ --out mechanics.kin
  kinesic train mechanics --clips manifest.tsv:label=body-mechanics,skeleton=cmu31 --pool manifest.tsv:skeleton=cmu31 \\
      --hidden 50 --out mechanics.kin
  kinesic train mechanics --pool all-clips/ --propose --out mechanics.kin
  kinesic train mechanics --clips plain-walks/ --out mechanics.kin --resume     # goes on after a kill")]
pub struct Args {
    /// Clips that show body mechanics without expression: files, folders, tables
    #[arg(long, value_name = "CLIPS", num_args = 1.., required_unless_present = "propose")]
    clips: Vec<PathBuf>,
    /// Clips of any kind, for the autoencoder (those of --clips are always taken too)
    #[arg(long, value_name = "CLIPS", num_args = 1..)]
    pool: Vec<PathBuf>,
    /// Take from the pool as body mechanics what measurable rules find without expression: hands below the shoulders and near
    /// the trunk, facing where it goes, upright, under way
    #[arg(long)]
    propose: bool,
    /// Pack to write
    #[arg(long, value_name = "FILE.kin")]
    out: PathBuf,
    /// Number type of the pack: i8 needs a quarter of the flash and half the RAM; the figures are of f32
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    precision: Precision,
    /// Units of the autoencoder's hidden layer
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u16).range(1..=1024))]
    hidden: u16,
    /// Units of the layer between the features and the autoencoder's
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u16).range(1..=1024))]
    feature_hidden: u16,
    /// Passes over the data in each of the three stages
    #[arg(long, default_value_t = 80, value_parser = clap::value_parser!(u16).range(1..))]
    epochs: u16,
    /// Part held back for the figures, 0..0.9; 0 trains on everything
    #[arg(long, default_value_t = 0.3)]
    hold_out: f64,
    /// What is held back together
    #[arg(long, value_enum, default_value_t = SplitBy::Clip)]
    split: SplitBy,
    /// Frames per second of the pack (default: that of the slowest clip, at most 60; of a robot, at most its own)
    #[arg(long, value_name = "RATE")]
    fps: Option<f64>,
    /// Seed of weights, order, noise and split
    #[arg(long, default_value_t = 1)]
    seed: u64,
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
enum SplitBy {
    /// Single frames (the paper's): neighbours of every test frame are trained on
    Sample,
    /// Whole clips
    Clip,
    /// All clips of a person: file names that begin alike, up to the first _
    Subject,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let session = Session::begin(&args.out, args.seed, args.json, &args.report)?;
    args.precision.check("body-mechanics networks", Some(Precision::I8))?;
    if !(0.0..=0.9).contains(&args.hold_out) {
        return Err(miette!("--hold-out {}: expected a part from 0 to 0.9", args.hold_out));
    }
    let begun = Instant::now();
    let options = args.reading.options()?;
    let named = clip_paths(&args.clips)?;
    let pool = clip_paths(&args.pool)?;
    let paths: Vec<&PathBuf> = named.iter().chain(pool.iter().filter(|p| !named.contains(p))).collect();
    session.say(format!("reading {} clips", paths.len()));
    let sources: Vec<Source> =
        paths.iter().map(|p| Source::read(p, &options).into_diagnostic()).collect::<Result<_, _>>()?;
    let plain = |index: usize, source: &Source| {
        index < named.len() || args.propose && propose(&source.clip, &source.map).is_some_and(|p| p.plain)
    };
    let mechanics: Vec<bool> = sources.iter().enumerate().map(|(i, s)| plain(i, s)).collect();
    let first = mechanics.iter().position(|m| *m).ok_or_else(|| {
        miette!(help = "name them with --clips", "none of the {} clips of the pool looks non-expressive", paths.len())
    })?;
    let fps = args.fps.unwrap_or_else(|| common_rate(sources.iter()));
    let rig = sources[first].rig().into_diagnostic()?;
    let mut clips = Vec::new();
    for (source, mechanics) in sources.iter().zip(&mechanics) {
        let clip = source.on_rig(&rig, fps).into_diagnostic()?;
        clips.push(NamedClip { name: name_of(&source.name()), clip, mechanics: *mechanics });
    }
    let options = TrainOptions {
        code: usize::from(args.hidden),
        hidden: usize::from(args.feature_hidden),
        epochs: usize::from(args.epochs),
        hold_out: args.hold_out,
        split: match args.split {
            SplitBy::Sample => Split::Sample,
            SplitBy::Clip => Split::Clip,
            SplitBy::Subject => Split::Subject,
        },
        seed: args.seed,
    };
    let name = session.name(None, "mechanics");
    let history = RefCell::new(Vec::new());
    let progress = |stage: &'static str, epoch: usize, epochs: usize, error: f64| {
        history.borrow_mut().push((stage, error));
        session.say(format!("{stage}: {epoch} of {epochs}, error {error:.4}"));
        if session.is_silent() && (epoch == epochs || epoch.is_multiple_of(10)) {
            eprintln!("{stage}: epoch {epoch} of {epochs}, error {error:.5}");
        }
    };
    let prints = fingerprints(paths.iter().map(|path| path.as_path()))?;
    // The same options, the same clips in the same order, read in the same way: the same training.
    let options_and_rate = format!("mechanics {options:?} {fps}");
    let clips_by_hash = format!("{prints:?} {mechanics:?}");
    let mut checkpoint =
        args.resume.checkpoint(&args.out, &[options_and_rate, clips_by_hash, args.reading.deciding()?])?;
    let trained = train_kept(&rig, &clips, &name, &options, &progress, &mut checkpoint).into_diagnostic()?;
    let help = "train on more clips that move, or longer (--epochs)";
    args.forced.check(why_not(&trained.training), help)?;
    let inputs = prints.into_iter().zip(&trained.trained_on).filter(|(_, trained)| **trained).map(|(i, _)| i).collect();
    let mut provenance = session.provenance(inputs, notes(args, &trained, &mechanics));
    provenance.metrics = metrics(&trained);
    provenance.baselines = Baselines { offset: trained.mean_pose.clone(), affine: trained.linear.weights.clone() };
    let bytes = args.precision.of(trained.model.pack(&rig, &provenance), &provenance)?;
    let file = session.write(&bytes)?;
    // As `kinesic eval` measures it: on the body-mechanics clips that were held back whole, else on those of the training.
    let unseen = clips.iter().zip(&trained.trained_on).any(|(clip, trained)| clip.mechanics && !trained);
    let measured =
        clips.iter().zip(&trained.trained_on).filter(|(clip, trained)| clip.mechanics && **trained != unseen);
    let measured: Vec<_> = measured.map(|(clip, trained)| (clip.name.clone(), clip.clip.clone(), *trained)).collect();
    let pack = file.pack().into_diagnostic()?;
    let distances = evaluate(&pack, &rig, &provenance.baselines, &[], &measured).into_diagnostic()?.distances;
    // A plain clip that was not trained on shows more than one that was.
    let shown = (0..clips.len()).filter(|i| clips[*i].mechanics).min_by_key(|i| trained.trained_on[*i]).unwrap_or(0);
    let page = page(&trained, (&distances, unseen), &history.take(), &clips[shown], &rig, &file)?;
    let summary = Summary {
        pack: args.out.display().to_string(),
        bytes: bytes.len(),
        frame_rate: fps,
        clips: mechanics.iter().filter(|m| **m).count(),
        pool: mechanics.len(),
        moving_joints: trained.moving,
        hidden: options.code,
        split: args.split.to_possible_value().map_or_else(String::new, |v| v.get_name().to_owned()),
        held_back: trained.held_back.clone(),
        training: trained.training.clone(),
        distances,
        seconds: begun.elapsed().as_secs_f64(),
        peak_memory_mib: peak_memory(),
    };
    session.finish(&file, page, Some(checkpoint), &summary, |summary| {
        summary.print();
        Ok(())
    })
}

/// Degrees by which poses differ from their mean under which nothing is to be learned.
const STILL: f64 = 0.05;

/// Why the pack cannot be of use, if so: judged on the clips that it was trained on.
fn why_not(training: &Figures) -> Option<String> {
    let Figures { geodesic_deg: after, mean_pose_deg: before, .. } = *training;
    if before < STILL {
        return Some("the clips hardly move: there is nothing to learn".to_owned());
    }
    // What is no number is no gain.
    let nearer = after < before;
    (!nearer).then(|| {
        format!(
            "the pack comes no nearer to its own training clips than their mean pose: {after:.2} against {before:.2} degrees a joint"
        )
    })
}

fn notes(args: &Args, trained: &Trained, mechanics: &[bool]) -> Vec<String> {
    let chosen = mechanics.iter().filter(|m| **m).count();
    vec![
        format!("{chosen} body-mechanics clips of {} in the pool, {} moving joints", mechanics.len(), trained.moving),
        format!("{} of everything held back by {:?}", args.hold_out, args.split).to_lowercase(),
    ]
}

fn metrics(trained: &Trained) -> Vec<Metric> {
    let of = |prefix: &str, f: &Figures| {
        [
            ("autoencoder_mse", f.autoencoder_mse),
            ("feature_mse", f.feature_mse),
            ("stacked_mse", f.stacked_mse),
            ("geodesic_deg", f.geodesic_deg),
            ("linear_deg", f.linear_deg),
            ("mean_pose_deg", f.mean_pose_deg),
        ]
        .map(|(name, value)| Metric::new(format!("{prefix}_{name}"), value))
    };
    let held_back = trained.held_back.iter().flat_map(|f| of("held_back", f));
    held_back.chain(of("training", &trained.training)).collect()
}

#[derive(Serialize)]
struct Summary {
    pack: String,
    bytes: usize,
    frame_rate: f64,
    clips: usize,
    pool: usize,
    moving_joints: usize,
    hidden: usize,
    split: String,
    held_back: Option<Figures>,
    training: Figures,
    distances: Distances,
    seconds: f64,
    peak_memory_mib: Option<f64>,
}

impl Summary {
    fn print(&self) {
        println!("{:32} {:>12} {:>12}", "", "held back", "training");
        let row = |name: &str, of: fn(&Figures) -> f64| {
            let held_back = self.held_back.as_ref().map_or_else(|| "-".to_owned(), |f| format!("{:.5}", of(f)));
            println!("{name:32} {held_back:>12} {:>12.5}", of(&self.training));
        };
        row("autoencoder, MSE", |f| f.autoencoder_mse);
        row("  components stretched to -1..1", |f| f.autoencoder_scaled_mse);
        row("mean pose of the pool, MSE", |f| f.pool_mean_mse[0]);
        row("features to code, MSE", |f| f.feature_mse);
        row("stacked, MSE", |f| f.stacked_mse);
        row("  before fine-tuning", |f| f.stacked_raw_mse);
        row("linear regression, MSE", |f| f.linear_mse);
        row("mean pose, MSE", |f| f.mean_pose_mse);
        row("stacked, degrees a joint", |f| f.geodesic_deg);
        row("linear regression, degrees", |f| f.linear_deg);
        row("mean pose, degrees", |f| f.mean_pose_deg);
        let Distances { predicted, linear, mean_pose } = &self.distances;
        println!("all joints, whole clips: RMS joint distance, cm; mean angle, degrees: all joints, leaves");
        for (name, d) in [("stacked", predicted), ("linear regression", linear), ("mean pose", mean_pose)] {
            println!("{name:32} {:>12.2} {:>12.2} {:>12.2}", d.cm, d.degrees.all, d.degrees.leaves);
        }
        let memory = self.peak_memory_mib.map_or_else(String::new, |m| format!(", peak memory {m:.0} MiB"));
        println!("{}: {} bytes, {:.0} s{memory}", self.pack, self.bytes, self.seconds);
    }
}

/// Largest resident memory of this process, MiB, where the system tells.
fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().trim_end_matches("kB").trim().parse::<f64>().ok()? / 1024.0)
}
