//! The page that every training writes beside its pack: one file an engine, and what they share.

pub mod components;
pub mod emotion;
pub mod face;
pub mod mechanics;
pub mod translate;

use std::path::{Path, PathBuf};

use kinesic_host::pack::PackFile;
use kinesic_host::report::{Report, Table};
use miette::{IntoDiagnostic, miette};

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
        let value = |value: &serde_json::Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        report.table(&Table {
            caption: format!(
                "The {}: what `kinesic inspect` prints. docs/latency.md says what a frame costs on six cores",
                model.engine
            ),
            head: vec!["figure".into(), "value".into()],
            rows: model.figures.iter().map(|(name, v)| vec![name.replace('_', " "), value(v)]).collect(),
        });
    }
    Ok(())
}
