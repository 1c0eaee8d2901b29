//! What every training does around the learning: checks before long work, provenance, the files, the figures at the end.

use std::path::Path;

use indicatif::ProgressBar;
use kinesic_host::clip::ReadOptions;
use kinesic_host::pack::{InputFile, PackFile, Provenance};
use kinesic_host::report::Report;
use miette::IntoDiagnostic;
use serde::Serialize;

use super::report::ReportArgs;
use super::resume::Told;
use crate::commands::origin::command_line;
use crate::commands::output::{check_output, print_json, spinner, write_whole};

/// A training from its command line to its files.
pub struct Session<'a> {
    out: &'a Path,
    seed: u64,
    json: bool,
    report: &'a ReportArgs,
    bar: ProgressBar,
}

impl<'a> Session<'a> {
    /// Refuses paths that cannot be written, before long work.
    pub fn begin(out: &'a Path, seed: u64, json: bool, report: &'a ReportArgs) -> miette::Result<Self> {
        check_output(out, "kin")?;
        report.check(out)?;
        Ok(Self { out, seed, json, report, bar: spinner() })
    }

    /// What goes on.
    pub fn say(&self, what: impl Into<String>) {
        self.bar.set_message(what.into());
    }

    /// Whether nobody watches the spinner.
    pub fn is_silent(&self) -> bool {
        self.bar.is_hidden()
    }

    /// The name of what is learned: as given, or the pack's file name.
    pub fn name(&self, given: Option<&String>, otherwise: &str) -> String {
        let stem = || self.out.file_stem().map_or_else(|| otherwise.to_owned(), |s| s.to_string_lossy().into_owned());
        given.cloned().unwrap_or_else(stem)
    }

    /// Where the pack comes from.
    pub fn provenance(&self, inputs: Vec<InputFile>, notes: Vec<String>) -> Provenance {
        Provenance {
            tool: format!("kinesic {}", env!("CARGO_PKG_VERSION")),
            command: command_line(),
            seed: self.seed,
            inputs,
            notes,
            ..Provenance::default()
        }
    }

    /// The pack with the robot's limits and servos, where the clips are a robot's.
    pub fn of_robot(&self, bytes: Vec<u8>, reading: &ReadOptions, provenance: &Provenance) -> miette::Result<Vec<u8>> {
        let Some(machine) = &reading.machine else { return Ok(bytes) };
        let file = PackFile::from_bytes(&bytes);
        machine.pack(Some(&file.pack().into_diagnostic()?), provenance).into_diagnostic()
    }

    /// Writes the pack.
    pub fn write(&self, bytes: &[u8]) -> miette::Result<PackFile> {
        write_whole(self.out, bytes)?;
        Ok(PackFile::from_bytes(bytes))
    }

    /// Writes the report, removes the checkpoint and tells the figures: `summary` as JSON, or what `print` makes of it.
    pub fn finish<S: Serialize>(
        self,
        file: &PackFile,
        page: Report,
        checkpoint: Option<Told>,
        summary: &S,
        print: impl FnOnce(&S) -> miette::Result<()>,
    ) -> miette::Result<()> {
        self.report.write(self.out, file, page)?;
        checkpoint.into_iter().for_each(Told::finish);
        self.bar.finish_and_clear();
        if self.json { print_json(summary) } else { print(summary) }
    }
}

/// The items that are held out, or those that are not.
pub fn part<T: Clone>(items: &[T], out: &[bool], held: bool) -> Vec<T> {
    items.iter().zip(out).filter(|(_, out)| **out == held).map(|(item, _)| item.clone()).collect()
}

/// A share that is held out, from the command line.
pub fn share(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(share) if (0.0..=0.9).contains(&share) => Ok(share),
        _ => Err("expected a number from 0 to 0.9".to_owned()),
    }
}
