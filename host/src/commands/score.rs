//! `kinesic score`.

use std::path::PathBuf;

use kinesic_host::emotion::evaluate::{Scorer, mean};
use kinesic_host::emotion::segment::FRAME_RATE;
use kinesic_host::pack::PackFile;
use kinesic_host::plain;
use kinesic_host::prepare::Source;
use miette::{IntoDiagnostic, WrapErr};
use serde::Serialize;

use super::clips::{Reading, clip_paths};
use super::figure::figure;
use super::output::{print_json, spinner};

/// Say how strongly motions show an emotion
///
/// Every clip is put on the pack's skeleton and read by the device's ranking functions: 0 is as strong as the weakest label of
/// the training, 1 as the strongest. A gait has a strength for each stride; shown are their mean, the lowest and the highest.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic score walk.kin mine.bvh
  kinesic score walk.kin walks/ --json
  kinesic score walk.kin 'manifest.tsv:action=walk'")]
pub struct Args {
    /// Emotion pack
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// Clips: files, folders, or tables with conditions
    #[arg(value_name = "CLIP", required = true)]
    clips: Vec<PathBuf>,
    /// Print one JSON object: the strengths of every clip, motion by motion
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
    let reading = args.reading.options_for(&pack)?;
    let bar = spinner();
    let mut clips = Vec::new();
    for path in clip_paths(&args.clips)? {
        bar.set_message(format!("reading {}", plain::line(&path.display().to_string())));
        let source = Source::read(&path, &reading).into_diagnostic()?;
        let motions = scorer.read(&source.on_rig(&scorer.rig, FRAME_RATE).into_diagnostic()?);
        clips.push(Clip { file: source.name(), strength: mean(&motions), motions });
    }
    bar.finish_and_clear();
    let scores = Scores { attributes: scorer.attributes(), clips };
    if args.json {
        return print_json(&scores);
    }
    print(&scores);
    Ok(())
}

#[derive(Serialize)]
struct Scores {
    attributes: Vec<String>,
    clips: Vec<Clip>,
}

#[derive(Serialize)]
struct Clip {
    file: String,
    /// Mean over the motions, attribute by attribute; empty if there are none.
    strength: Vec<f64>,
    motions: Vec<Vec<f64>>,
}

fn print(scores: &Scores) {
    let heads: Vec<String> = scores.attributes.iter().map(|name| format!("{:>24}", plain::line(name))).collect();
    println!("motions {}  clip", heads.join(" "));
    for clip in &scores.clips {
        let cell = |(index, mean): (usize, &f64)| {
            let of = || clip.motions.iter().map(move |row| row[index]);
            let (low, high) = (of().fold(f64::INFINITY, f64::min), of().fold(f64::NEG_INFINITY, f64::max));
            let range = if clip.motions.len() > 1 {
                format!(" ({} to {})", figure(low, 2), figure(high, 2))
            } else {
                String::new()
            };
            format!("{:>24}", format!("{}{range}", figure(*mean, 3)))
        };
        let cells: Vec<String> = clip.strength.iter().enumerate().map(cell).collect();
        let none = || format!("{:>24}", "no whole stride");
        let cells = if cells.is_empty() { none() } else { cells.join(" ") };
        println!("{:>7} {cells}  {}", clip.motions.len(), plain::line(&clip.file));
    }
}
