//! `kinesic eval components`.

use std::path::PathBuf;

use kinesic_host::components::{Report, evaluate};
use kinesic_host::pack::PackFile;
use kinesic_host::rig::Rig;
use miette::{IntoDiagnostic, miette};

use crate::commands::output::print_json;

/// Measure a pack of style components
///
/// The stored stream is played through the device's code, restyled and plain. Reconstruction error, style distance and
/// the angles to the style need the training clips: they are what the training recorded.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic eval components old.kin
  kinesic eval components old.kin --json")]
pub struct Args {
    /// Pack to measure
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// Print one JSON object: reconstruction_error, density, style_distance, content_distance, degrees_after,
    /// jerk_ratio and more
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let file = PackFile::read(&args.pack).into_diagnostic()?;
    let pack = file.pack().into_diagnostic()?;
    let provenance =
        file.provenance().ok_or_else(|| miette!("{}: its provenance cannot be read", args.pack.display()))?;
    let rig = Rig::from_pack(&pack).into_diagnostic()?;
    let report = evaluate(&pack, &rig, &provenance.metrics).into_diagnostic()?;
    if args.json {
        print_json(&report)
    } else {
        print(&report);
        Ok(())
    }
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
    line("moved", report.moved_cm, "cm a joint, the stored stream at strength 1 from that at 0");
    line("turned", report.moved_degrees.all, "degrees, mean over all joints, the same");
    line("turned, leaves", report.moved_degrees.leaves, "degrees, head, hands, feet, the same");
    line("jerk", report.jerk, "m/s^3");
    line("jerk ratio", report.jerk_ratio, "to the content, both from the stored stream");
}
