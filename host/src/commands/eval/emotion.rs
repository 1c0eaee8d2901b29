//! `kinesic eval emotion`.

use std::path::PathBuf;

use kinesic_host::emotion::evaluate::{Report, Scorer, evaluate};
use kinesic_host::emotion::labels::{self, Attribute};
use kinesic_host::emotion::motions::read;
use kinesic_host::emotion::{Distances, compare_motions};
use kinesic_host::pack::PackFile;
use miette::{IntoDiagnostic, WrapErr, miette};
use serde::Serialize;

use crate::commands::angles;
use crate::commands::clips::Reading;
use crate::commands::figure::{figure, percent};
use crate::commands::output::{print_json, spinner};
use crate::commands::quality;

/// Measure an emotion pack on labelled clips
///
/// Every clip is read by the pack's ranking functions (a gait: the mean of its strides); a pair of clips of one group with
/// different labels is right if their strengths are in the same order. What the pack plays at the strengths of a clip's labels is
/// compared with the clip's motions, and so is the motion at the middle of the ranges, which no label changes: centimetres and
/// degrees. Use takes that the pack was not trained on.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic eval emotion walk.kin --labels others.tsv
  kinesic eval emotion walk.kin --labels others.tsv --json
  kinesic eval emotion walk.kin --labels others.tsv --order 'happy:cheerful>normal>gloomy'")]
pub struct Args {
    /// Pack to measure
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// Table of labelled clips, as for training
    #[arg(long, value_name = "TSV")]
    labels: PathBuf,
    /// Order of the labels of an attribute of the pack, where it is not that of the training (may be repeated)
    #[arg(long, value_name = "[NAME:]A>B=C>D", value_parser = Attribute::from_order)]
    order: Vec<Attribute>,
    /// Print one JSON object: pair_accuracy, spearman, pairs, the same by attribute, and distances (cm and degrees over all joints,
    /// leaves, inner joints and by joint, with swing and twist)
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let file = PackFile::read(&args.pack).into_diagnostic()?;
    let pack = file.pack().into_diagnostic()?;
    let scorer = Scorer::load(&pack).into_diagnostic().wrap_err_with(|| args.pack.display().to_string())?;
    let notes = file.provenance().map(|provenance| provenance.notes).unwrap_or_default();
    let trained: Vec<Attribute> = notes.iter().filter_map(|note| Attribute::from_note(note)).collect();
    let names = scorer.attributes();
    if let Some(unknown) = args.order.iter().find(|order| !names.contains(&order.name)) {
        return Err(miette!(
            help = "name it in front of the order: --order 'NAME:strong>weak'",
            "the pack has no attribute {:?}; it has: {}",
            unknown.name,
            names.join(", ")
        ));
    }
    let known = |name: &String| args.order.iter().chain(&trained).find(|order| order.name == *name).cloned();
    let attributes: Vec<Attribute> =
        names.iter().map(|name| known(name).unwrap_or_else(|| Attribute::from_column(name))).collect();
    let rows = labels::read(&args.labels, &attributes).into_diagnostic()?;
    let reading = args.reading.options_for(&pack)?;
    let bar = spinner();
    let all = rows.len();
    let progress = |index: usize| bar.set_message(format!("reading clip {} of {all}", index + 1));
    let (_, examples) = read(rows, Some(scorer.rig.clone()), &reading, &progress).into_diagnostic()?;
    let report = evaluate(&scorer, &examples);
    bar.set_message("playing and comparing");
    let distances = compare_motions(&pack, &scorer, &examples);
    bar.finish_and_clear();
    if report.pairs == 0 {
        return Err(miette!(
            help = "labels that differ are needed to tell whether the order is right; a pack of a gait needs whole strides",
            "{}: no two of the {} clips can be compared, {} of them hold no motion",
            args.labels.display(),
            report.clips,
            report.unread.len()
        ));
    }
    let distances = distances.into_diagnostic()?;
    if args.json {
        return print_json(&Figures { report: &report, distances: distances.as_ref() });
    }
    print(&report);
    if let Some(Distances { error, identity, quality: found }) = &distances {
        println!();
        println!("to the recorded motions: aligned RMS joint distance, cm; {}", angles::CAPTION);
        println!("{:>10.2}{:>10.2}   cm", identity.cm, error.cm);
        angles::print(&[("middle", Some(&identity.degrees)), ("labelled", Some(&error.degrees))]);
        if let Some(found) = found {
            println!();
            quality::compared(found, ["middle", "recorded", "labelled"], "means of the motions");
        }
    }
    Ok(())
}

#[derive(Serialize)]
struct Figures<'a> {
    #[serde(flatten)]
    report: &'a Report,
    distances: Option<&'a Distances>,
}

fn print(report: &Report) {
    println!("{} clips, {} motions", report.clips, report.motions);
    report.unread.iter().for_each(|name| println!("note: {name} holds no motion of the pack's kind"));
    println!("                   clips    pairs   in the right order   Spearman");
    for attribute in &report.attributes {
        println!(
            "{:<15} {:>8} {:>8} {:>20} {:>10}",
            attribute.attribute,
            attribute.labelled,
            attribute.pairs,
            percent(attribute.pair_accuracy, 2),
            figure(attribute.spearman, 3)
        );
    }
}
