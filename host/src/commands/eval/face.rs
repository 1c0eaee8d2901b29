//! `kinesic eval face`.

use std::fmt::Write;
use std::path::PathBuf;

use kinesic::model::ModelMeta;
use kinesic_host::face::{Report, evaluate, landmarks, read_all};
use kinesic_host::pack::PackFile;
use miette::{IntoDiagnostic, miette};

use crate::commands::figure::{figure, percent};
use crate::commands::output::{check_output, print_json, write_whole};

/// Measure a face pack on labelled faces
///
/// Every face is read through the device's code; a pair of faces with different labels is right if their strengths are in
/// the same order. Use people that the pack was not trained on.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic eval face smile.kin --landmarks others.csv
  kinesic eval face smile.kin --landmarks others.csv --json
  kinesic eval face smile.kin --landmarks others.csv --attribute amusement --scores scores.csv")]
pub struct Args {
    /// Pack to measure
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// Table of labelled landmarks, as for training
    #[arg(long, value_name = "FILE.csv")]
    landmarks: PathBuf,
    /// Column of the labels (default: the expression that the pack was trained on)
    #[arg(long, value_name = "NAME")]
    attribute: Option<String>,
    /// Also write what the device reads from every face: picture, person, label, cluster, strength
    #[arg(long, value_name = "FILE.csv")]
    scores: Option<PathBuf>,
    /// Print one JSON object: pair_accuracy, spearman, pairs, and the same by cluster of head pose
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    if let Some(path) = &args.scores {
        check_output(path, "csv")?;
    }
    let file = PackFile::read(&args.pack).into_diagnostic()?;
    let pack = file.pack().into_diagnostic()?;
    let meta = pack.metadata().models.iter().find_map(ModelMeta::face);
    let meta = meta.ok_or_else(|| {
        miette!(help = "train one: kinesic train face --help", "{}: the pack holds no face model", args.pack.display())
    })?;
    let attribute = args.attribute.as_deref().unwrap_or(meta.attribute);
    let faces = landmarks::read(&args.landmarks, Some(attribute)).into_diagnostic()?;
    let report = evaluate(&pack, &faces).into_diagnostic()?;
    if report.pairs == 0 {
        return Err(miette!(
            help = "labels that differ are needed to tell whether the order is right",
            "{}: the {} labelled faces all have the same '{attribute}'",
            args.landmarks.display(),
            report.labelled
        ));
    }
    if let Some(path) = &args.scores {
        let mut table = String::from("image,subject,label,cluster,strength\n");
        for read in read_all(&pack, &faces).into_diagnostic()? {
            let label = read.face.label.map(|label| label.to_string()).unwrap_or_default();
            let (picture, person) = (quoted(&read.face.picture), quoted(&read.face.person));
            // Writing to a string does not fail.
            let _ = writeln!(table, "{picture},{person},{label},{},{}", read.reading.cluster, read.reading.strength);
        }
        write_whole(path, table.as_bytes())?;
    }
    if args.json {
        return print_json(&report);
    }
    print(&report);
    Ok(())
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

fn print(report: &Report) {
    println!("{} faces, {} labelled", report.faces, report.labelled);
    println!("                   pairs   in the right order   Spearman");
    let line = |name: &str, pairs: u64, accuracy: f64, spearman: Option<f64>| {
        let spearman = spearman.map_or(String::new(), |s| format!("{:>10}", figure(s, 3)));
        println!("{name:<15} {pairs:>8} {:>20} {spearman}", percent(accuracy, 2));
    };
    line("all", report.pairs, report.pair_accuracy, Some(report.spearman));
    line("within clusters", report.pairs_within_clusters, report.pair_accuracy_within_clusters, None);
    for (index, cluster) in report.clusters.iter().enumerate().filter(|(_, cluster)| cluster.pairs > 0) {
        line(&format!("cluster {index}"), cluster.pairs, cluster.pair_accuracy, Some(cluster.spearman));
    }
}
