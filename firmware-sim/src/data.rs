//! The data files: targets, timing, workloads and budgets.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::isa::Isa;
use crate::price::Timing;

/// A stretch of the board's memory.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// First address.
    pub origin: u64,
    /// As much as the part has, KiB.
    pub kib: u64,
}

/// A simulated part.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Target {
    /// For people.
    pub title: String,
    /// rustc's target.
    pub triple: String,
    /// rustc's `target-cpu`.
    pub cpu: String,
    /// rustc's `target-feature`.
    #[serde(default)]
    pub features: String,
    /// What its instructions decode as.
    pub isa: Isa,
    /// Its table in `cycles.toml`.
    pub timing: String,
    /// Core clock.
    pub clock_mhz: f64,
    /// QEMU program.
    pub emulator: String,
    /// QEMU board.
    pub machine: String,
    /// Where code and packs go.
    pub flash: Region,
    /// Where data and the stack go.
    pub ram: Region,
    /// Where the emulator places input frames.
    pub frames: u64,
}

/// A workload as `budgets.toml` names it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WorkloadEntry {
    /// For people.
    pub title: String,
    /// Frames to run.
    pub frames: usize,
    /// The crate that a user would take instead: measured beside ours, and free to panic.
    pub peer: Option<String>,
}

/// What one workload may cost on one target.
#[derive(Clone, Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Limit {
    /// Instructions of the longest frame.
    pub instructions: u64,
    /// Instructions of the longest frame less the shortest: 0 where cost does not depend on the data.
    pub spread: u64,
    /// Why there is a spread: one of `[causes]`. Without a cause no spread is allowed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cause: Option<String>,
    /// Why the longest frame may last longer than a frame's time: one of `[causes]`. Without it that is a failure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub late: Option<String>,
    /// Modelled cycles of the longest frame.
    pub cycles: u64,
    /// Flash without the pack, B.
    pub flash: u64,
    /// Static RAM, B.
    pub ram: u64,
    /// Stack, B.
    pub stack: u64,
}

/// `budgets.toml`.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Budgets {
    /// Frames per second that the product runs at.
    pub frame_hz: f64,
    /// Known reasons for a spread, by name.
    pub causes: BTreeMap<String, String>,
    /// The workloads by name.
    pub workloads: BTreeMap<String, WorkloadEntry>,
    /// Limits by workload and target.
    pub limits: BTreeMap<String, BTreeMap<String, Limit>>,
}

/// A data file cannot be used.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum DataError {
    /// It cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It is not what the tool expects.
    #[error("{file}: {source}")]
    Parse {
        /// The file.
        file: String,
        /// Where and why.
        source: toml::de::Error,
    },
    /// A spread is allowed without a reason.
    #[error("budgets.toml allows {workload} on {target} a spread and gives no cause")]
    #[diagnostic(help("name one of [causes], or find out why cost depends on the data"))]
    NoCause {
        /// The workload.
        workload: String,
        /// The target.
        target: String,
    },
    /// One file names what another does not have.
    #[error("{wanted} is not in {file}; it has {known}")]
    #[diagnostic(help("the names are the table headings of the file"))]
    Unknown {
        /// What was asked for.
        wanted: String,
        /// The file.
        file: &'static str,
        /// What there is.
        known: String,
    },
}

/// All data files, checked against each other.
#[derive(Clone, Debug)]
pub struct Data {
    /// Targets by name.
    pub targets: BTreeMap<String, Target>,
    /// Timing tables by name.
    pub timings: BTreeMap<String, Timing>,
    /// Workloads and limits.
    pub budgets: Budgets,
}

/// The folder of this crate: images are built from the sources beside it.
pub fn home() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

impl Data {
    /// Reads the files; `budgets` replaces the repository's own.
    pub fn read(budgets: Option<&Path>) -> Result<Self, DataError> {
        let own = home().join("budgets.toml");
        let data = Self {
            targets: parse(&home().join("targets.toml"))?,
            timings: parse(&home().join("cycles.toml"))?,
            budgets: parse(budgets.unwrap_or(&own))?,
        };
        for target in data.targets.values() {
            find(&data.timings, &target.timing, "cycles.toml")?;
        }
        for (workload, limits) in &data.budgets.limits {
            find(&data.budgets.workloads, workload, "[workloads] of budgets.toml")?;
            for (target, limit) in limits {
                find(&data.targets, target, "targets.toml")?;
                if let Some(cause) = &limit.late {
                    find(&data.budgets.causes, cause, "[causes] of budgets.toml")?;
                }
                match &limit.cause {
                    Some(cause) => drop(find(&data.budgets.causes, cause, "[causes] of budgets.toml")?),
                    None if limit.spread > 0 => {
                        return Err(DataError::NoCause { workload: workload.clone(), target: target.clone() });
                    }
                    None => {}
                }
            }
        }
        Ok(data)
    }
}

/// The entry `wanted` of a table.
pub fn find<'a, T>(table: &'a BTreeMap<String, T>, wanted: &str, file: &'static str) -> Result<&'a T, DataError> {
    table.get(wanted).ok_or_else(|| DataError::Unknown {
        wanted: wanted.to_owned(),
        file,
        known: table.keys().map(String::as_str).collect::<Vec<_>>().join(", "),
    })
}

fn parse<T: serde::de::DeserializeOwned>(path: &Path) -> Result<T, DataError> {
    let text = std::fs::read_to_string(path).map_err(|source| DataError::Read { path: path.to_owned(), source })?;
    toml::from_str(&text).map_err(|source| DataError::Parse { file: path.display().to_string(), source })
}
