//! The page that every training writes beside its pack: one file an engine, and what they share.

pub mod components;
pub mod emotion;
pub mod face;
pub mod mechanics;
pub mod translate;

use std::path::{Path, PathBuf};

use kinesic::Pack;
use kinesic_host::clip::{Clip, JointMap};
use kinesic_host::pack::PackFile;
use kinesic_host::report::{Report, Table, latency};
use kinesic_host::robot::Machine;
use kinesic_host::robot::look::Look;
use kinesic_host::sheet::{Actor, View, sheet};
use miette::{IntoDiagnostic, miette};
use serde_json::Value;

use crate::commands::inspect;
use crate::commands::output::{check_output, write_whole};

/// Where the report goes.
#[derive(Debug, clap::Args)]
pub struct ReportArgs {
    /// Report to write (default: beside the pack, NAME.report.html)
    #[arg(long, value_name = "FILE.html", conflicts_with = "no_report")]
    report: Option<PathBuf>,
    /// Write no report
    #[arg(long)]
    no_report: bool,
}

/// Height of the largest figure, pixels.
const FIGURE: f64 = 110.0;
/// Figures in a row.
const MOMENTS: usize = 8;

/// Adds clips of a pack's body or robot as rows of figures. `what` says of which moments.
fn figures(page: &mut Report, pack: &Pack, rows: &[(&str, &Clip)], what: &str) -> miette::Result<()> {
    let machine = Machine::from_pack(pack).into_diagnostic()?;
    let row = |(name, clip): &(&str, &Clip)| {
        let actor = match &machine {
            Some(machine) => Actor::machine(name, (*clip).clone(), Look::of_machine(machine)),
            None => Actor::body(name, (*clip).clone(), JointMap::detect(&clip.skeleton).as_ref()),
        };
        let moments = actor.even(MOMENTS);
        (actor, moments)
    };
    let drawing = sheet(&rows.iter().map(row).collect::<Vec<_>>(), View::Oblique, FIGURE).into_diagnostic()?;
    let sides = if machine.is_some() { "" } else { " Left limbs blue, right ones orange." };
    page.figure(&drawing.svg(), &format!("{what}{sides}"));
    Ok(())
}

impl ReportArgs {
    /// The report of the pack `out`, unless none is wanted.
    pub fn path(&self, out: &Path) -> Option<PathBuf> {
        (!self.no_report).then(|| self.report.clone().unwrap_or_else(|| out.with_extension("report.html")))
    }

    /// Refuses the path before long work.
    pub fn check(&self, out: &Path) -> miette::Result<()> {
        self.path(out).map_or(Ok(()), |path| check_output(&path, "html"))
    }

    /// Adds what every report says at the end (the pack on the device, where it comes from), and writes the page.
    pub fn write(&self, out: &Path, file: &PackFile, mut report: Report) -> miette::Result<()> {
        let Some(path) = self.path(out) else { return Ok(()) };
        device(&mut report, file)?;
        let provenance = file.provenance().ok_or_else(|| miette!("{}: the provenance is gone", out.display()))?;
        report.provenance(&provenance);
        write_whole(&path, report.html().as_bytes())
    }
}

/// What the device holds and does.
fn device(report: &mut Report, file: &PackFile) -> miette::Result<()> {
    let pack = file.pack().into_diagnostic()?;
    let joints = match pack.metadata().joints.len() {
        0 => String::new(),
        joints => format!(", at {} frames a second for {joints} joints", pack.metadata().frame_rate),
    };
    report.heading("On the device").text(&format!(
        "{} bytes of flash, of which {} are tensors that are used in place{joints}.",
        file.bytes().len(),
        pack.payload_len(),
    ));
    for model in inspect::models(&pack)? {
        report.table(&Table {
            caption: format!("The {}, as `kinesic inspect` prints it", model.engine),
            head: vec!["figure".into(), "value".into()],
            rows: model.figures.iter().map(|(name, v)| vec![explained(name), value(v)]).collect(),
        });
        latency(report, model.engine);
    }
    Ok(())
}

/// A figure as text; numbers to four digits behind the point.
fn value(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Object(named) => {
            named.iter().map(|(name, v)| format!("{name} {}", self::value(v))).collect::<Vec<_>>().join(", ")
        }
        Value::Array(values) => values.iter().map(self::value).collect::<Vec<_>>().join(" to "),
        Value::Number(number) => match number.as_f64() {
            Some(x) if x.fract() != 0.0 => format!("{x:.4}").trim_end_matches('0').to_owned(),
            Some(x) => format!("{x}"),
            None => number.to_string(),
        },
        other => other.to_string(),
    }
}

/// A figure's name, and what it is.
fn explained(figure: &str) -> String {
    let name = figure.replace('_', " ");
    match explain(figure) {
        "" => name,
        what => format!("{name}: {what}"),
    }
}

/// What a figure of `kinesic inspect` is, with its unit.
fn explain(figure: &str) -> &'static str {
    match figure {
        "style" | "attribute" => "name of what was learned",
        "form" => "one model a joint, or one for the whole body",
        "filter_states" => "numbers that the filters remember, two a block",
        "drives" => "inputs of the filters",
        "multiply_adds_per_frame_before_kinematics" => "the model itself, a frame; kinematics come on top",
        "multiply_adds_per_update_before_the_frame" => {
            "the model itself, a face; finding the face's frame comes on top"
        }
        "capacity" => "the type's parameters in Rust",
        "state_bytes" => "RAM that is kept between frames",
        "plausible_strength" => "strengths that training vouches for; 0 is none, 1 as learned (faces: as labelled)",
        "hidden" => "units of the hidden layer",
        "code" => "numbers that the autoencoder's code has",
        "weights" => "type of the weights in flash",
        "numbers" => "type of the coefficients in flash",
        "body_height_m" => "height of the body that it was trained on, m",
        "hip_height_m" => "height of its hips, m",
        "components" => "basic motions, K (emotions: principal components of a keyframe)",
        "cycle" => "true if the motion goes on for ever",
        "keyframes" => "moments that the network makes, a spline between them",
        "motion" => "name of the motion",
        "multiply_adds_per_change_of_strength" => "network and back-projection; a frame of playback does neither",
        "plausible_strengths" => "strengths of 98 % of the training motions; what is asked beyond is held",
        "stored_frames" => "frames of the stored stream in the pack",
        "clusters" => "groups of head pose, each with its own ranking and network",
        _ => "",
    }
}

/// What a frame costs by core.
fn latency(report: &mut Report, engine: &str) {
    let workloads = latency::workloads(engine);
    if workloads.is_empty() {
        return;
    }
    let size = |w: &latency::Workload| format!("{} ({})", w.name, w.size);
    let share = |us: u32| format!("{us} us, {:.2} %", f64::from(us) * 60.0 / 1e4);
    report.table(&Table {
        caption: "Longest frame by core, and its share of 1/60 s: modelled cycles of real images, without flash waits, of the firmware \
                  workloads, not of this pack; compare the sizes. docs/latency.md says how it was measured"
            .into(),
        head: std::iter::once("core".to_owned()).chain(workloads.iter().map(size)).collect(),
        rows: latency::CORES
            .iter()
            .enumerate()
            .map(|(k, core)| {
                std::iter::once((*core).to_owned()).chain(workloads.iter().map(|w| share(w.microseconds[k]))).collect()
            })
            .collect(),
    });
}
