//! `kinesic eval translate`.

use std::path::PathBuf;

use kinesic_host::measure::turns::Turns;
use kinesic_host::pack::PackFile;
use kinesic_host::prepare::Source;
use kinesic_host::rig::Rig;
use kinesic_host::translate::{Errors, NamedPair, Report, evaluate};
use miette::{IntoDiagnostic, miette};

use crate::commands::angles;
use crate::commands::clips::{Pairs, Reading};
use crate::commands::output::{print_json, spinner};
use crate::commands::quality;

/// Measure how well a pack translates: aligned RMS joint distance to the target, cm, and mean angle to it, degrees
///
/// Every source is played through the device's code and compared with its target, both on the pack's skeleton, in
/// heading-local coordinates without horizontal root movement, at the best alignment in time. Beside it: the source itself
/// (identity), and the mean offset and the best affine map of each joint, fitted on the pack's training pairs: of positions for
/// the distances, of rotations for the angles. These two are not fitted here but what the pack states. Angles are geodesic, between
/// local rotations; the root counts with its tilt. Feet, rhythm, jerk and posture stand
/// beside them, for source, target and result.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic eval translate angry.kin --pair neutral2.bvh angry2.bvh
  kinesic eval translate child.kin --pairs pairs.tsv --where style=child --where neutral~p734 --json")]
pub struct Args {
    /// Pack to measure
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    #[command(flatten)]
    pairs: Pairs,
    /// Print one JSON object: error_cm, identity_cm, offset_cm, affine_cm, the same with open ends, degrees (over all joints, leaves,
    /// inner joints and by joint, with swing and twist), quality (foot slide, standing time, steps a minute, jerk, lean and posture of source,
    /// result and target), and every pair
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let file = PackFile::read(&args.pack).into_diagnostic()?;
    let pack = file.pack().into_diagnostic()?;
    let provenance = file
        .provenance()
        .ok_or_else(|| miette!("{}: its provenance, which holds the baselines, cannot be read", args.pack.display()))?;
    let rig = Rig::from_pack(&pack).into_diagnostic()?;
    let options = args.reading.options_for(&pack)?;
    let fps = f64::from(pack.metadata().frame_rate);
    let bar = spinner();
    let mut clips = Vec::new();
    let paths = args.pairs.paths()?;
    for (index, (source, target)) in paths.iter().enumerate() {
        bar.set_message(format!("reading pair {} of {}", index + 1, paths.len()));
        let read = |path| {
            let source = Source::read(path, &options).into_diagnostic()?;
            Ok::<_, miette::Report>((source.name(), source.on_rig(&rig, fps).into_diagnostic()?))
        };
        clips.push((read(source)?, read(target)?));
    }
    bar.set_message("playing and comparing");
    let turns = Turns::from_numbers(&provenance.turns, rig.joints());
    let named: Vec<NamedPair> =
        clips.iter().map(|((source, a), (target, b))| NamedPair { source: (source, a), target: (target, b) }).collect();
    let report = evaluate(&pack, &rig, &provenance.baselines, turns.as_ref(), &named).into_diagnostic()?;
    bar.finish_and_clear();
    if args.json {
        print_json(&report)
    } else {
        print(&report);
        Ok(())
    }
}

fn print(report: &Report) {
    println!(
        "aligned RMS joint distance to the target, cm (in brackets: with open ends); offset and affine as the pack states them"
    );
    println!("{:>15} {:>15} {:>15} {:>15}   pair", "identity", "offset", "affine", "pack");
    let row = |e: &Errors, name: String| {
        let cell = |closed: f64, open: f64| format!("{closed:.2} ({open:.2})");
        println!(
            "{:>15} {:>15} {:>15} {:>15}   {name}",
            cell(e.identity_cm, e.open_identity_cm),
            cell(e.offset_cm, e.open_offset_cm),
            cell(e.affine_cm, e.open_affine_cm),
            cell(e.error_cm, e.open_error_cm),
        );
    };
    for pair in &report.pairs {
        row(&pair.errors, format!("{} -> {}", pair.source, pair.target));
    }
    row(&report.errors, format!("mean of {}", report.pairs.len()));
    println!();
    println!("mean of {}: {}", report.pairs.len(), angles::CAPTION);
    angles::print(&angles::columns(&report.errors));
    if let Some(found) = &report.quality {
        println!();
        quality::compared(found, quality::PAIR, &format!("mean of {}", report.pairs.len()));
    }
}
