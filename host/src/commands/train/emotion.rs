//! `kinesic train emotion`.

use std::path::PathBuf;

use kinesic_host::clip::ReadOptions;
use kinesic_host::emotion::evaluate::{Report, Scorer, evaluate};
use kinesic_host::emotion::labels::{self, Attribute};
use kinesic_host::emotion::motions::{Example, hold_out, read};
use kinesic_host::emotion::segment::Cut;
use kinesic_host::emotion::{Distances, TrainOptions, Trained, compare_motions, train};
use kinesic_host::measure::Distance;
use kinesic_host::pack::{Metric, PackFile};
use kinesic_host::prepare::Source;
use kinesic_host::rig::Rig;
use miette::{IntoDiagnostic, WrapErr, miette};
use serde::Serialize;

use super::learned::{Forced, by_chance, no_nearer};
use super::report::{ReportArgs, emotion::page};
use super::session::{Session, part, share};
use crate::commands::clips::Reading;
use crate::commands::figure::{figure, percent};
use crate::commands::origin::{fingerprints, name_of};
use crate::commands::quality;

/// Learn how strongly motions show emotions, and how a motion looks at every strength
///
/// From a tab-separated table with one clip a line: its file (paths start from the table's folder), and either a label, whose
/// order is given by --order, or a column of numbers for each --attribute. Optional columns: group (only clips of one group are
/// compared: the action), take or subject (held out together). All clips should show one action: what is synthesised is
/// between them. Gaits are cut into strides. Strength 1 is the strongest label's, 0 the weakest's; of numbers, the numbers'.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic train emotion --labels walks.tsv --order 'happy>normal>sad' --out walk.kin
  kinesic train emotion --labels walks.tsv --order 'anger:angry>normal=happy=sad' --order 'happy>normal>sad' --out walk.kin
  kinesic train emotion --labels blends.tsv --attribute angry --attribute sad --hold-out 0 --out blends.kin --json

walks.tsv (tab-separated):
  file             label   take
  walk_angry.bvh   angry   1
  walk_calm.bvh    normal  2

Then:
  kinesic synth walk.kin --strength 0.7 --out happier.bvh
  kinesic score walk.kin some-walk.bvh")]
pub struct Args {
    /// Table of labelled clips
    #[arg(long, value_name = "TSV")]
    labels: PathBuf,
    /// Labels from the strongest to the weakest, = for equally strong; NAME: in front names the attribute (default: the strongest
    /// label). May be repeated
    #[arg(long, value_name = "[NAME:]A>B=C>D", value_parser = Attribute::from_order)]
    order: Vec<Attribute>,
    /// Column of the table with numbers for strengths (may be repeated)
    #[arg(long, value_name = "COLUMN")]
    attribute: Vec<String>,
    /// Pack to write
    #[arg(long, value_name = "FILE.kin")]
    out: PathBuf,
    /// Name of the motion (default: the pack's file name)
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// What a motion is: a stride of a gait, or a whole clip
    #[arg(long, value_name = "HOW", value_enum, default_value_t = How::Auto)]
    cut: How,
    /// Clip whose skeleton all clips are put on (default: the first of the table)
    #[arg(long, value_name = "CLIP")]
    rig: Option<PathBuf>,
    /// Keyframes of a motion
    #[arg(long, value_name = "N", default_value_t = 13)]
    keyframes: usize,
    /// Principal components of a keyframe
    #[arg(long, value_name = "N", default_value_t = 40)]
    components: usize,
    /// Hidden units of the network from strengths to keyframes: 3 for dozens of motions, 10 for a thousand
    #[arg(long, value_name = "N", default_value_t = 3)]
    hidden: usize,
    /// Share of the takes, 0 to 0.9, that is not trained on but measured
    #[arg(long, value_name = "SHARE", default_value_t = 0.2, value_parser = share)]
    hold_out: f64,
    /// Seed of all random choices
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    forced: Forced,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    report: ReportArgs,
    #[command(flatten)]
    reading: Reading,
}

/// How clips are cut.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum How {
    /// Strides, if nearly all clips are gaits.
    Auto,
    /// Strides.
    Cycles,
    /// Whole clips.
    Whole,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let session = Session::begin(&args.out, args.seed, args.json, &args.report)?;
    let attributes = args.attributes()?;
    let rows = labels::read(&args.labels, &attributes).into_diagnostic()?;
    let out = hold_out(&rows, args.hold_out, args.seed);
    let inputs = fingerprints(rows.iter().map(|row| row.path.as_path()).chain([args.labels.as_path()]))?;
    let reading = args.reading.options()?;
    let all = rows.len();
    let progress = |index: usize| session.say(format!("reading clip {} of {all}", index + 1));
    let (rig, mut examples) = read(rows, args.rig(&reading)?, &reading, &progress).into_diagnostic()?;
    examples.iter_mut().for_each(|example| example.name = name_of(&example.name));
    // The table has rows, so there is a first clip.
    let rig = rig.ok_or_else(|| miette!("{}: there is no clip", args.labels.display()))?;
    let (kept, held) = (part(&examples, &out, false), part(&examples, &out, true));
    session.say(format!("learning from {} clips", kept.len()));
    let names: Vec<String> = attributes.iter().map(|attribute| attribute.name.clone()).collect();
    let name = session.name(args.name.as_ref(), "motion");
    let mut trained = train(&rig, &name, &names, &kept, &args.options())
        .into_diagnostic()
        .wrap_err_with(|| args.labels.display().to_string())?;
    // A robot is told where to go at its own rate.
    if let Some(machine) = &reading.machine {
        trained.model.frame_rate = machine.limits.frame_rate as f32;
    }

    let notes = attributes.iter().map(Attribute::note).chain(trained.notes.iter().cloned());
    let mut provenance = session.provenance(inputs, notes.collect());
    let preview = PackFile::from_bytes(&trained.model.pack(&trained.rig, &provenance));
    let pack = preview.pack().into_diagnostic()?;
    let scorer = Scorer::load(&pack).into_diagnostic()?;
    let training = evaluate(&scorer, &kept);
    let unseen = (!held.is_empty()).then(|| evaluate(&scorer, &held));
    let distances = |examples: &[Example]| compare_motions(&pack, &scorer, examples).into_diagnostic();
    let distances = [distances(&kept)?, distances(&held)?];
    let help = "check that the labels are in the right column and order, and that all clips show one action";
    // Labels are coarse: two clips of one label may be read as half as strong and twice as strong. So what is made has a second chance.
    let unlabelled = || -> Vec<Example> {
        let without = |example: &Example| Example { levels: vec![None; example.levels.len()], ..example.clone() };
        kept.iter().map(without).collect()
    };
    let why = match why_not(&training, distances[0].as_ref()) {
        Some(_) => why_not(&training, compare_motions(&pack, &scorer, &unlabelled()).into_diagnostic()?.as_ref()),
        None => None,
    };
    args.forced.check(why, help)?;
    provenance.metrics = metrics(&trained, &training, unseen.as_ref());
    for (name, found) in ["training", "takes_held_out"].into_iter().zip(&distances) {
        let values = found.iter().flat_map(|d| [("error", &d.error), ("identity", &d.identity)]);
        provenance.metrics.extend(values.flat_map(|(model, distance)| {
            [
                Metric::new(format!("{name}_{model}_cm"), distance.cm),
                Metric::new(format!("{name}_{model}_degrees"), distance.degrees.all),
            ]
        }));
    }
    let bytes = session.of_robot(trained.model.pack(&trained.rig, &provenance), &reading, &provenance)?;
    let file = session.write(&bytes)?;
    let page = page(&trained, &training, unseen.as_ref(), &distances, &scorer, &kept, &file.pack().into_diagnostic()?)?;
    let summary = Summary {
        pack: args.out.display().to_string(),
        bytes: bytes.len(),
        motion: &trained.model.motion,
        cycle: trained.model.cycle,
        attributes: trained
            .model
            .attributes
            .iter()
            .map(|a| Strengths { name: &a.name, strength: a.strength })
            .collect(),
        keyframe_error_cm: 100.0 * trained.keyframe_error,
        network_error_cm: 100.0 * trained.network_error,
        variance_explained: trained.explained,
        notes: &trained.notes,
        training: &training,
        held_out: unseen.as_ref(),
        distances: &distances,
    };
    session.finish(&file, page, None, &summary, |summary| {
        print(summary);
        Ok(())
    })
}

impl Args {
    fn attributes(&self) -> miette::Result<Vec<Attribute>> {
        let columns = self.attribute.iter().map(|name| Attribute::from_column(name));
        let attributes: Vec<Attribute> = self.order.iter().cloned().chain(columns).collect();
        if attributes.is_empty() {
            return Err(miette!(
                help = "give --order 'happy>normal>sad' for labels, or --attribute COLUMN for numbers",
                "nothing says which motion shows more"
            ));
        }
        let mut names: Vec<&str> = attributes.iter().map(|attribute| attribute.name.as_str()).collect();
        names.sort_unstable();
        if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(miette!(
                help = "name an order: --order 'calmness:calm>angry'",
                "there are two attributes called {:?}",
                twice[0]
            ));
        }
        Ok(attributes)
    }

    fn rig(&self, reading: &ReadOptions) -> miette::Result<Option<Rig>> {
        let Some(path) = &self.rig else { return Ok(None) };
        Ok(Some(Source::read(path, reading).and_then(|source| source.rig()).into_diagnostic()?))
    }

    fn options(&self) -> TrainOptions {
        TrainOptions {
            keyframes: self.keyframes,
            components: self.components,
            hidden: self.hidden,
            cut: match self.cut {
                How::Auto => None,
                How::Cycles => Some(Cut::Cycles),
                How::Whole => Some(Cut::Whole),
            },
            seed: self.seed,
        }
    }
}

/// Why the pack cannot be of use, if so: judged on the clips that it was trained on.
fn why_not(training: &Report, distances: Option<&Distances>) -> Option<String> {
    let mut attributes = training.attributes.iter();
    let by_chance = attributes
        .find_map(|a| by_chance(&format!("{} is not read from the training clips", a.attribute), a.pair_accuracy));
    let apart = |distance: &Distance| [distance.cm, distance.degrees.all];
    let made = |d: &Distances| {
        no_nearer(
            "the motions made for the training clips come no nearer to these",
            apart(&d.identity),
            apart(&d.error),
        )
    };
    by_chance.or_else(|| distances.and_then(made))
}

fn metrics(trained: &Trained, training: &Report, unseen: Option<&Report>) -> Vec<Metric> {
    let mut metrics = vec![
        Metric::new("keyframe_error_cm", 100.0 * trained.keyframe_error),
        Metric::new("network_error_cm", 100.0 * trained.network_error),
        Metric::new("pair_accuracy_training", training.pair_accuracy),
    ];
    if let Some(unseen) = unseen {
        metrics.push(Metric::new("pair_accuracy_takes_held_out", unseen.pair_accuracy));
        metrics.push(Metric::new("spearman_takes_held_out", unseen.spearman));
    }
    metrics
}

#[derive(Serialize)]
struct Summary<'a> {
    pack: String,
    bytes: usize,
    motion: &'a str,
    cycle: bool,
    attributes: Vec<Strengths<'a>>,
    keyframe_error_cm: f64,
    network_error_cm: f64,
    variance_explained: f64,
    notes: &'a [String],
    training: &'a Report,
    held_out: Option<&'a Report>,
    /// To the recorded motions: of the training clips, of the clips held out.
    distances: &'a [Option<Distances>; 2],
}

#[derive(Serialize)]
struct Strengths<'a> {
    name: &'a str,
    strength: [f32; 2],
}

fn print(summary: &Summary) {
    println!("                       clips    motions      pairs   in the right order   Spearman");
    for (name, report) in
        std::iter::once(("trained on", summary.training)).chain(summary.held_out.map(|r| ("held out", r)))
    {
        for attribute in &report.attributes {
            println!(
                "{:<18} {:>9} {:>10} {:>10} {:>20} {:>10}",
                format!("{name}, {}", attribute.attribute),
                attribute.labelled,
                report.motions,
                attribute.pairs,
                percent(attribute.pair_accuracy, 2),
                figure(attribute.spearman, 3)
            );
        }
    }
    summary.notes.iter().for_each(|note| println!("note: {note}"));
    println!(
        "error of a joint, root mean square: {:.1} cm between keyframes, {:.1} cm from strengths to a motion",
        summary.keyframe_error_cm, summary.network_error_cm
    );
    for (name, found) in ["trained on", "held out"].into_iter().zip(summary.distances) {
        for (model, distance) in found.iter().flat_map(|d| [("labels", &d.error), ("middle", &d.identity)]) {
            println!(
                "{name:<10} played at the {model}: {:6.2} cm {:6.2} degrees {:6.2} degrees at the leaves from the clips",
                distance.cm, distance.degrees.all, distance.degrees.leaves
            );
        }
    }
    if let Some(found) = summary.distances[0].as_ref().and_then(|d| d.quality.as_ref()) {
        quality::compared(found, ["middle", "recorded", "labels"], "trained on");
    }
    for Strengths { name, strength: [low, high] } in &summary.attributes {
        let [low, high] = [low, high].map(|end| figure(f64::from(*end), 2));
        println!("{name}: strengths from {low} to {high}");
    }
    println!("{}: {} bytes", summary.pack, summary.bytes);
}
