//! `kinesic train face`.

use std::path::PathBuf;

use kinesic_host::face::landmarks;
use kinesic_host::face::{Face, Report, TrainOptions, evaluate, hold_out, train};
use kinesic_host::pack::{Metric, PackFile};
use miette::{IntoDiagnostic, WrapErr};
use serde::Serialize;

use super::learned::{Forced, by_chance};
use super::report::{ReportArgs, face::page};
use super::session::{Session, part, share};
use crate::commands::figure::{figure, percent};
use crate::commands::origin::fingerprints;
use crate::commands::precision::Precision;

/// Learn how strongly faces show an expression, and how it moves their landmarks
///
/// From a CSV table with one face a line: a column that names the picture (image), optionally the person (subject), how
/// strong the expression is (0 and 1, or steps in between; empty where nobody judged), and 68 landmarks x0, y0, ... x67, y67
/// in pixels, in the order of iBUG 300-W, which most face trackers give. Some people are held out, and measured at the end.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic train face --landmarks faces.csv --attribute smile --out smile.kin
  kinesic train face --landmarks faces.csv --attribute smile --hold-out 0 --clusters 6 --out smile.kin --json

Then:
  kinesic face smile.kin --image me.jpg --landmarks me.csv --change +0.5 --out more.png")]
pub struct Args {
    /// Table of landmarks
    #[arg(long, value_name = "FILE.csv")]
    landmarks: PathBuf,
    /// Column that says how strong the expression is; smile also finds posed_smile and smile_true
    #[arg(long, value_name = "NAME")]
    attribute: String,
    /// Pack to write
    #[arg(long, value_name = "FILE.kin")]
    out: PathBuf,
    /// Number type of the pack: faces have f32 only
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    precision: Precision,
    /// Clusters of head pose
    #[arg(long, value_name = "N", default_value_t = 12)]
    clusters: usize,
    /// Hidden units of each cluster's network
    #[arg(long, value_name = "N", default_value_t = 10)]
    hidden: usize,
    /// Share of the people, 0 to 0.9, that is not trained on but measured
    #[arg(long, value_name = "SHARE", default_value_t = 0.2, value_parser = share)]
    hold_out: f64,
    /// Seed of all random choices
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Accepted as with the other engines: a face is trained within seconds and keeps no checkpoint, so it begins anew
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    forced: Forced,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    report: ReportArgs,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let session = Session::begin(&args.out, args.seed, args.json, &args.report)?;
    args.precision.check("faces", None)?;
    if args.resume {
        eprintln!("{}: faces keep no checkpoint, training from the beginning", args.out.display());
    }
    session.say("reading the landmarks");
    let faces = landmarks::read(&args.landmarks, Some(&args.attribute)).into_diagnostic()?;
    let out = hold_out(&faces, args.hold_out, args.seed);
    let (kept, held) = (part(&faces, &out, false), part(&faces, &out, true));
    session.say(format!("ranking {} faces", kept.len()));
    let options = TrainOptions { clusters: args.clusters, hidden: args.hidden, seed: args.seed };
    let trained = train(&kept, &args.attribute, &options)
        .into_diagnostic()
        .wrap_err_with(|| args.landmarks.display().to_string())?;

    let mut provenance = session.provenance(fingerprints([args.landmarks.as_path()])?, trained.notes.clone());
    let preview = PackFile::from_bytes(&trained.model.pack(&provenance));
    let measure = |faces: &[Face]| evaluate(&preview.pack().into_diagnostic()?, faces).into_diagnostic();
    let training = measure(&kept)?;
    let why = by_chance(&format!("{} is not read from the training faces", args.attribute), training.pair_accuracy);
    args.forced.check(why, "check that the labels are in the right column")?;
    let unseen = if held.is_empty() { None } else { Some(measure(&held)?) };
    provenance.metrics.push(Metric::new("pair_accuracy_training", training.pair_accuracy));
    if let Some(unseen) = &unseen {
        provenance.metrics.push(Metric::new("pair_accuracy_people_held_out", unseen.pair_accuracy));
        provenance.metrics.push(Metric::new("spearman_people_held_out", unseen.spearman));
    }
    let bytes = trained.model.pack(&provenance);
    let file = session.write(&bytes)?;
    let page = page(&trained, &training, unseen.as_ref(), &file, &kept)?;
    let summary = Summary {
        pack: args.out.display().to_string(),
        bytes: bytes.len(),
        attribute: &args.attribute,
        clusters: trained.model.clusters.len(),
        strength: trained.model.strength,
        notes: &trained.notes,
        training: &training,
        held_out: unseen.as_ref(),
    };
    session.finish(&file, page, None, &summary, |summary| {
        print(summary);
        Ok(())
    })
}

#[derive(Serialize)]
struct Summary<'a> {
    pack: String,
    bytes: usize,
    attribute: &'a str,
    clusters: usize,
    strength: [f32; 2],
    notes: &'a [String],
    training: &'a Report,
    held_out: Option<&'a Report>,
}

fn print(summary: &Summary) {
    println!("                       faces      pairs   in the right order   Spearman");
    for (name, report) in
        std::iter::once(("trained on", summary.training)).chain(summary.held_out.map(|r| ("held out", r)))
    {
        println!(
            "{name:<18} {:>9} {:>10} {:>20} {:>10}",
            report.faces,
            report.pairs,
            percent(report.pair_accuracy, 2),
            figure(report.spearman, 3)
        );
    }
    summary.notes.iter().for_each(|note| println!("note: {note}"));
    let [low, high] = summary.strength.map(|end| figure(f64::from(end), 2));
    println!(
        "{}: {} bytes, {} clusters of head pose, strengths from {low} to {high}",
        summary.pack, summary.bytes, summary.clusters
    );
}
