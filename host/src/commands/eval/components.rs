//! `kinesic eval components`.

use std::path::PathBuf;

use kinesic_host::components::{FRAME_RATE, Report, ToClip, evaluate, to_clip};
use kinesic_host::pack::PackFile;
use kinesic_host::prepare::Source;
use kinesic_host::rig::Rig;
use miette::{IntoDiagnostic, miette};
use serde::Serialize;

use crate::commands::angles;
use crate::commands::clips::Reading;
use crate::commands::output::print_json;
use crate::commands::quality;

/// Measure a pack of style components
///
/// The stored stream is played through the device's code, restyled and plain. Reconstruction error, style distance and
/// the angles to the style need the training clips: they are what the training recorded. The change is that of the
/// restyled stream from the plain one, frame for frame. With --target both are also compared with a clip, at the best
/// alignment in time.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic eval components old.kin
  kinesic eval components old.kin --target walk-of-an-old-man.bvh
  kinesic eval components old.kin --json")]
pub struct Args {
    /// Pack to measure
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// Clip that the restyled motion should be like: the content, performed in the style
    #[arg(long, value_name = "CLIP")]
    target: Option<PathBuf>,
    /// Print one JSON object: reconstruction_error, density, style_distance, content_distance, degrees_after,
    /// jerk_ratio, change and target (cm and degrees over all joints, leaves, inner joints and by joint) and more
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let file = PackFile::read(&args.pack).into_diagnostic()?;
    let pack = file.pack().into_diagnostic()?;
    let provenance =
        file.provenance().ok_or_else(|| miette!("{}: its provenance cannot be read", args.pack.display()))?;
    let rig = Rig::from_pack(&pack).into_diagnostic()?;
    let report = evaluate(&pack, &rig, &provenance.metrics).into_diagnostic()?;
    let target = match &args.target {
        Some(path) => {
            let clip = Source::read(path, &args.reading.options_for(&pack)?).into_diagnostic()?;
            let clip = clip.on_rig(&rig, FRAME_RATE).into_diagnostic()?;
            Some(to_clip(&pack, &rig, &clip).into_diagnostic()?)
        }
        None => None,
    };
    if args.json {
        return print_json(&Figures { report: &report, target: target.as_ref() });
    }
    print(&report);
    println!();
    println!("change: RMS joint distance, cm; {}", angles::CAPTION);
    println!("{:>10.2}   cm", report.change.cm);
    angles::print(&[("change", Some(&report.change.degrees))]);
    if let Some(ToClip { error, identity, quality: found }) = &target {
        println!();
        println!("to the target: aligned RMS joint distance, cm; {}", angles::CAPTION);
        println!("{:>10.2}{:>10.2}   cm", identity.cm, error.cm);
        angles::print(&[("plain", Some(&identity.degrees)), ("restyled", Some(&error.degrees))]);
        if let Some(found) = found {
            println!();
            quality::compared(found, ["plain", "target", "restyled"], "stored stream");
        }
    }
    Ok(())
}

#[derive(Serialize)]
struct Figures<'a> {
    #[serde(flatten)]
    report: &'a Report,
    #[serde(skip_serializing_if = "Option::is_none")]
    target: Option<&'a ToClip>,
}

fn print(report: &Report) {
    let line = |name: &str, value: f64, what: &str| println!("{name:<32} {value:9.4}  {what}");
    println!("{:<32} {:9}", "components", report.components);
    line("density", report.density, "share of joint groups that move");
    line("reconstruction error", report.reconstruction_error, "relative, content clip (recorded)");
    line("style distance", report.style_distance, "Gram matrices, relative (recorded)");
    line("content distance", report.content_distance, "components, relative");
    line("degrees to the style, before", report.degrees_before.all, "mean over all joints (recorded)");
    line("degrees to the style, after", report.degrees_after.all, "mean over all joints (recorded)");
    line("the same, leaves, before", report.degrees_before.leaves, "head, hands, feet (recorded)");
    line("the same, leaves, after", report.degrees_after.leaves, "head, hands, feet (recorded)");
    line("jerk", report.jerk, "m/s^3");
    line("jerk ratio", report.jerk_ratio, "to the content, both from the stored stream");
}
