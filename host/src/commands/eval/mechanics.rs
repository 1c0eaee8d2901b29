//! `kinesic eval mechanics`.

use std::path::PathBuf;

use kinesic_host::mechanics::{Report, evaluate};
use kinesic_host::pack::PackFile;
use kinesic_host::prepare::{Source, fingerprint};
use kinesic_host::rig::Rig;
use miette::{IntoDiagnostic, miette};

use crate::commands::angles;
use crate::commands::clips::{Reading, clip_paths};
use crate::commands::output::{print_json, spinner};

/// Measure how near the predicted pose is, and how much expression is left, clip by clip
///
/// Angles are geodesic, means over the joints that move in these clips (by a degree or more) and over all frames. Beside the pack:
/// linear regression from the same features, and the mean pose, both fitted on the pack's training clips. These two are not measured
/// here: they are what the pack states. A second table is over all joints of the skeleton, with the distance of the joints in
/// centimetres.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic eval mechanics models/mechanics.kin --clips manifest.tsv:label=body-mechanics,skeleton=cmu31 --unseen
  kinesic eval mechanics models/mechanics.kin --clips dances/ --json")]
pub struct Args {
    /// Pack to measure
    #[arg(value_name = "PACK.kin")]
    pack: PathBuf,
    /// Clips: files, folders, tables
    #[arg(long, value_name = "CLIPS", num_args = 1.., required = true)]
    clips: Vec<PathBuf>,
    /// Leave out the clips that the pack was trained on
    #[arg(long)]
    unseen: bool,
    /// Random seed; the measurement makes no random choice
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object: autoencoder_mse, stacked_mse, geodesic_deg, linear_deg, mean_pose_deg, expressive_deg, moving_joints,
    /// as_the_pack_states, distances (cm and degrees over all joints, leaves, inner joints and by joint, with swing and twist), and
    /// every clip
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
    let options = args.reading.options()?;
    let fps = f64::from(pack.metadata().frame_rate);
    let bar = spinner();
    let mut clips = Vec::new();
    let paths = clip_paths(&args.clips)?;
    for (index, path) in paths.iter().enumerate() {
        bar.set_message(format!("reading clip {} of {}", index + 1, paths.len()));
        let print = fingerprint(path).map_err(|error| miette!("{}: cannot be read: {error}", path.display()))?;
        let trained_on = provenance.inputs.iter().any(|input| input.sha256 == print.sha256);
        if trained_on && args.unseen {
            continue;
        }
        let source = Source::read(path, &options).into_diagnostic()?;
        clips.push((source.name(), source.on_rig(&rig, fps).into_diagnostic()?, trained_on));
    }
    if clips.is_empty() {
        return Err(miette!(
            help = "name other clips, or leave out --unseen",
            "{}: it was trained on every one of the {} clips",
            args.pack.display(),
            paths.len()
        ));
    }
    bar.set_message("playing");
    let report = evaluate(&pack, &rig, &provenance.baselines, &provenance.metrics, &clips).into_diagnostic()?;
    bar.finish_and_clear();
    if report.moving_joints == 0 {
        return Err(miette!(
            help = "name clips of motions",
            "{}: no joint turns by a degree or more in these clips: there is nothing to predict",
            args.pack.display()
        ));
    }
    if args.json {
        return print_json(&report);
    }
    print(&report);
    Ok(())
}

fn print(report: &Report) {
    println!(
        "degrees a joint, over the {} joints that move in these clips: predicted pose; linear regression and mean pose as the pack \
         states them; expression left",
        report.moving_joints
    );
    println!("{:>9} {:>9} {:>9} {:>10}   clip", "predicted", "linear", "mean", "expression");
    let row = |[a, b, c, d]: [f64; 4], name: &str| println!("{a:9.2} {b:9.2} {c:9.2} {d:10.2}   {name}");
    for clip in &report.clips {
        let name = if clip.trained_on { format!("{} (trained on)", clip.clip) } else { clip.clip.clone() };
        row([clip.geodesic_deg, clip.linear_deg, clip.mean_pose_deg, clip.expressive_deg], &name);
    }
    let mean = [report.geodesic_deg, report.linear_deg, report.mean_pose_deg, report.expressive_deg];
    row(mean, &format!("all {}, MSE {:.5}", report.clips.len(), report.stacked_mse));
    let models = [
        ("mean pose", &report.distances.mean_pose),
        ("linear", &report.distances.linear),
        ("predicted", &report.distances.predicted),
    ];
    println!();
    println!("all joints, frame for frame: RMS joint distance, cm; {}", angles::CAPTION);
    println!("{}   cm", models.map(|(_, distance)| format!("{:>10.2}", distance.cm)).concat());
    angles::print(&models.map(|(name, distance)| (name, Some(&distance.degrees))));
}
