//! `kinesic train components`.

use std::path::{Path, PathBuf};

use kinesic_host::components::{
    FRAME_RATE, Optimiser, RECORDED, Report, Sparsity, ToClip, TradeOff, TrainOptions, Trained, Weights, evaluate,
    to_clip, trade_off, train_kept,
};
use kinesic_host::measure::Distance;
use kinesic_host::pack::{Metric, PackFile};
use kinesic_host::prepare::Source;
use kinesic_host::step_cache::StepCache;
use miette::IntoDiagnostic;
use serde::Serialize;

use super::learned::{Forced, no_nearer, same};
use super::report::{ReportArgs, components::page};
use super::resume::ResumeArgs;
use super::session::Session;
use crate::commands::clips::Reading;
use crate::commands::origin::fingerprints;
use crate::commands::precision::Precision;
use crate::commands::quality;

/// Style weights of the trade-off curve.
const CURVE: [f64; 8] = [0.0, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0];

/// Learn style components: the content's motion made of the style's basic motions
///
/// Two clips are enough, and they need not show the same content. Both are put on the content's skeleton at 60 frames a
/// second and factorised into sparse components; new components are learned that stay near the content's and share the
/// style's Gram matrix. The pack plays the restyled content clip (`apply --stored`) and restyles live poses (`apply`).
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  kinesic train components --content walk.bvh --style old.bvh --out old.kin
  kinesic train components --content bow.bvh --style angry.bvh -k 30 --style-weight 0.1 --smooth 1 --out angry.kin
  kinesic train components --content bow.bvh --style sad.bvh --curve --json --out sad.kin")]
pub struct Args {
    /// Clip whose motion is kept
    #[arg(long, value_name = "CLIP")]
    content: PathBuf,
    /// Clip whose manner is learned
    #[arg(long, value_name = "CLIP")]
    style: PathBuf,
    /// Pack to write
    #[arg(long, value_name = "FILE.kin")]
    out: PathBuf,
    /// Number type of the pack: style components have f32 only
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    precision: Precision,
    /// Name of the style (default: the pack's file name)
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Number of components, or auto: as many as make the clip visibly better
    #[arg(short = 'k', long = "components", value_name = "K", default_value = "auto", value_parser = count)]
    count: Count,
    /// Weight of the group norm: how much of a deviation a joint must move to be in a component
    #[arg(long, value_name = "L", default_value_t = 0.01)]
    sparsity: f64,
    /// Share of joint groups to keep, 0 to 1; 1 keeps all that --sparsity leaves
    #[arg(long, value_name = "SHARE", default_value_t = 0.15)]
    density: f64,
    /// Weight of staying like the content
    #[arg(long, value_name = "C", default_value_t = 1.0)]
    content_weight: f64,
    /// Weight of the style's Gram matrix; see --curve
    #[arg(long, value_name = "S", default_value_t = 0.01)]
    style_weight: f64,
    /// Weight of velocities and accelerations like the content's; 1 is a good start against jerky results
    #[arg(long, value_name = "W", default_value_t = 0.0)]
    smooth: f64,
    /// How much of the difference of the mean poses is style: 0 (the paper) keeps the content's posture
    #[arg(long, value_name = "SHARE", default_value_t = 1.0)]
    posture: f64,
    /// Also show what eight style weights lead to
    #[arg(long)]
    curve: bool,
    /// Seed of the noise that learning starts from
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
    #[command(flatten)]
    resume: ResumeArgs,
}

/// Number of components as given.
#[derive(Clone, Copy, Debug)]
enum Count {
    Auto,
    Given(usize),
}

fn count(text: &str) -> Result<Count, String> {
    match text.parse() {
        _ if text == "auto" => Ok(Count::Auto),
        Ok(count) if count > 0 => Ok(Count::Given(count)),
        _ => Err("expected auto or a number from 1 up".to_owned()),
    }
}

/// Runs the command.
pub fn run(args: &Args) -> miette::Result<()> {
    let session = Session::begin(&args.out, args.seed, args.json, &args.report)?;
    args.precision.check("style components", None)?;
    let reading = args.reading.options()?;
    session.say("reading the clips");
    let read = |path: &Path| Source::read(path, &reading).into_diagnostic();
    let (content, style) = (read(&args.content)?, read(&args.style)?);
    let rig = content.rig().into_diagnostic()?;
    let on_rig = |source: &Source| source.on_rig(&rig, FRAME_RATE).into_diagnostic();
    let (content, style) = (on_rig(&content)?, on_rig(&style)?);
    let rig = rig.centred(&[&rig.poses(&content), &rig.poses(&style)]);
    session.say("factorising and learning");
    let options = args.options();
    let name = session.name(args.name.as_ref(), "style");
    let prints = fingerprints([args.content.as_path(), args.style.as_path()])?;
    // The same options and the same clips, read in the same way: the same training.
    let deciding = [format!("components {options:?} {}", args.curve), format!("{prints:?}"), args.reading.deciding()?];
    let mut checkpoint = args.resume.checkpoint(&args.out, &deciding)?;
    let cache = StepCache::new(&mut checkpoint).into_diagnostic()?;
    let trained = train_kept(&rig, &content, &style, &name, &options, &cache).into_diagnostic()?;
    let curve = if args.curve { trade_off(&trained, &options, &CURVE, &cache) } else { Vec::new() };
    drop(cache);

    let ends = trained.strengths.why().map(|why| format!("plausible strengths end: {why}"));
    let notes = std::iter::once(trained.choice.reason.clone()).chain(ends).collect();
    let mut provenance = session.provenance(prints, notes);
    provenance.metrics = recorded(&trained);
    let preview = PackFile::from_bytes(&trained.model.pack(&rig, &provenance));
    let report = evaluate(&preview.pack().into_diagnostic()?, &rig, &provenance.metrics).into_diagnostic()?;
    let to_style = to_clip(&preview.pack().into_diagnostic()?, &rig, &style).into_diagnostic()?;
    let help = "choose two clips that differ in manner, or give the style more weight (--style-weight, --posture)";
    args.forced.check(why_not(&trained, &report, &to_style), help)?;
    provenance.metrics.extend(measured(&report));
    let bytes = session.of_robot(trained.model.pack(&rig, &provenance), &reading, &provenance)?;
    let file = session.write(&bytes)?;
    let page = page(&trained, &report, &to_style, &curve, [&content, &style], &rig, &file)?;
    let summary = Summary {
        pack: args.out.display().to_string(),
        bytes: bytes.len(),
        frame_rate: FRAME_RATE,
        components: trained.choice.count,
        reason: &trained.choice.reason,
        steps: trained.learned.history.len() - 1,
        objective: trained.learned.history.last().copied().unwrap_or_default(),
        strength: trained.model.strength,
        strength_ends: trained.strengths.why(),
        style_distance_before: trained.style_distance_before,
        curve: &curve,
        training: &report,
        to_style: &to_style,
    };
    session.finish(&file, page, Some(checkpoint), &summary, |summary| {
        print(summary);
        Ok(())
    })
}

impl Args {
    fn options(&self) -> TrainOptions {
        TrainOptions {
            count: match self.count {
                Count::Auto => None,
                Count::Given(count) => Some(count),
            },
            sparsity: Sparsity {
                penalty: self.sparsity,
                density: (self.density != 1.0).then_some(self.density),
                ..Sparsity::default()
            },
            weights: Weights { content: self.content_weight, style: self.style_weight, smooth: self.smooth },
            optimiser: Optimiser { seed: self.seed, ..Optimiser::default() },
            posture: self.posture,
        }
    }
}

/// Why the pack cannot be of use, if so.
fn why_not(trained: &Trained, report: &Report, to_style: &ToClip) -> Option<String> {
    let apart = |distance: &Distance| [distance.cm, distance.degrees.all];
    let before = apart(&to_style.identity);
    if same(before) {
        return Some("the content clip and the style clip are the same motion: there is nothing to learn".to_owned());
    }
    if same(apart(&report.change)) {
        return Some("the pack learned nothing: it changes nothing of the content".to_owned());
    }
    // The two clips may show different content, so it is enough that the components come nearer to the style's.
    let nearer = report.style_distance < trained.style_distance_before;
    no_nearer("the restyled motion comes no nearer to the style clip", before, apart(&to_style.error))
        .filter(|_| !nearer)
}

fn recorded(trained: &Trained) -> Vec<Metric> {
    let (before, after) = (&trained.degrees_before, &trained.degrees_after);
    let values =
        [trained.reconstruction_error, trained.style_distance, before.all, before.leaves, after.all, after.leaves];
    RECORDED.into_iter().zip(values).map(|(name, value)| Metric::new(name, value)).collect()
}

fn measured(report: &Report) -> Vec<Metric> {
    vec![
        Metric::new("density", report.density),
        Metric::new("content_distance", report.content_distance),
        Metric::new("jerk_ratio", report.jerk_ratio),
        Metric::new("change_cm", report.change.cm),
        Metric::new("change_degrees", report.change.degrees.all),
        Metric::new("change_degrees_leaves", report.change.degrees.leaves),
    ]
}

#[derive(Serialize)]
struct Summary<'a> {
    pack: String,
    bytes: usize,
    frame_rate: f64,
    components: usize,
    reason: &'a str,
    steps: usize,
    objective: f64,
    strength: [f64; 2],
    /// What ends the plausible strengths.
    #[serde(skip_serializing_if = "Option::is_none")]
    strength_ends: Option<String>,
    /// `|Gram(C_S) - Gram(C_C)| / |Gram(C_S)|`: doing nothing.
    style_distance_before: f64,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    curve: &'a [TradeOff],
    training: &'a Report,
    to_style: &'a ToClip,
}

fn print(summary: &Summary) {
    let report = summary.training;
    println!("components     {:>8}  {}", summary.components, summary.reason);
    println!(
        "reconstruction {:8.4}  relative error, with {:.0} % of the joint groups",
        report.reconstruction_error,
        100.0 * report.density
    );
    println!("learning       {:8}  steps", summary.steps);
    println!(
        "style distance {:8.3}  {:.3} before, content distance {:.3} (all relative)",
        report.style_distance, summary.style_distance_before, report.content_distance
    );
    println!(
        "angles         {:8.1}  degrees to the style, {:.1} before; head, hands, feet {:.1}, {:.1} before",
        report.degrees_after.all, report.degrees_before.all, report.degrees_after.leaves, report.degrees_before.leaves
    );
    println!("jerk           {:8.2}  times the content's", report.jerk_ratio);
    let row = |name: &str, Distance { cm, degrees }: &Distance| {
        println!("{name:<14} {cm:8.2}  cm {:8.2} degrees {:8.2} degrees at the leaves", degrees.all, degrees.leaves);
    };
    row("change", &report.change);
    row("content: style", &summary.to_style.identity);
    row("result: style", &summary.to_style.error);
    if let Some(found) = &summary.to_style.quality {
        quality::compared(found, ["content", "style", "result"], "stored stream");
    }
    if !summary.curve.is_empty() {
        println!("style weight   style distance   content distance");
        for point in summary.curve {
            println!("{:12}   {:14.3}   {:16.3}", point.style_weight, point.style_distance, point.content_distance);
        }
    }
    println!(
        "{}: {} bytes, {} frames a second, plausible strengths 0 to {}{}",
        summary.pack,
        summary.bytes,
        summary.frame_rate,
        summary.strength[1],
        summary.strength_ends.as_ref().map_or(String::new(), |why| format!("; {why}"))
    );
}
