//! The command `kinesic-firmware-sim`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use kinesic_firmware_sim::again::again;
use kinesic_firmware_sim::check::{Selection, check};
use kinesic_firmware_sim::data::{Data, home};
use kinesic_firmware_sim::report;
use kinesic_firmware_sim::same::same;
use kinesic_firmware_sim::soak;
use miette::{IntoDiagnostic, WrapErr};

/// Runs kinesic on simulated microcontrollers and checks that every frame fits.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Builds the images, runs them, prints measured against allowed; exit 1 where anything is over.
    Check {
        /// Only this target (repeatable); see targets.toml.
        #[arg(long)]
        target: Vec<String>,
        /// Only this workload (repeatable); see budgets.toml.
        #[arg(long)]
        workload: Vec<String>,
        /// Writes everything measured to a file as well.
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
        /// Other budgets than the repository's.
        #[arg(long, value_name = "FILE")]
        budgets: Option<PathBuf>,
        /// Shows the dearest and the largest functions of each image too.
        #[arg(long)]
        hot: bool,
        /// Prints limits for budgets.toml too: what was measured, and so many percent more.
        #[arg(long, value_name = "PERCENT")]
        suggest: Option<f64>,
        /// Runs a sample of an earlier check again, from the file that its --json wrote; exit 1 where a digit differs.
        #[arg(long, value_name = "FILE", conflicts_with_all = ["target", "workload", "json", "suggest", "hot"])]
        again: Option<PathBuf>,
        /// Any text, such as a commit: it decides which of the earlier results are in the sample.
        #[arg(long, value_name = "TEXT", default_value = "", requires = "again")]
        seed: String,
    },
    /// Trains translators on recorded clips and compares every output bit of every target with the host's.
    Same {
        /// Folder of the recorded clips, default ../shared/data beside the repository.
        #[arg(long, env = "KINESIC_DATA", value_name = "FOLDER")]
        data: Option<PathBuf>,
        /// Only this target (repeatable); see targets.toml.
        #[arg(long)]
        target: Vec<String>,
        /// Frames of the long take.
        #[arg(long, default_value_t = 1000)]
        frames: usize,
    },
    /// Runs workloads for very many frames and compares every output bit with the host's; exit 1 where one differs or is NaN.
    Soak {
        /// On this target (repeatable); see targets.toml.
        #[arg(long, default_values_t = ["m4f".to_owned()])]
        target: Vec<String>,
        /// Only this workload (repeatable); see budgets.toml.
        #[arg(long)]
        workload: Vec<String>,
        /// Frames of each workload, up to the next whole round of its input.
        #[arg(long, default_value_t = 100_000)]
        frames: usize,
    },
}

fn main() -> miette::Result<ExitCode> {
    let failures = match Arguments::parse().command {
        Command::Check { again: Some(earlier), seed, budgets, .. } => {
            let compared = again(&Data::read(budgets.as_deref())?, &earlier, &seed, &|news| eprintln!("{news}"))?;
            println!("{compared}");
            compared.failures
        }
        Command::Check { target, workload, json, budgets, hot, suggest, .. } => {
            let data = Data::read(budgets.as_deref())?;
            let all = check(&data, &Selection { targets: target, workloads: workload }, &|news| eprintln!("{news}"))?;
            print!("{}", report::table(&data, &all));
            if hot {
                print!("\n{}", report::hot(&all));
            }
            if let Some(percent) = suggest {
                print!("{}", report::limits(&all, percent));
            }
            if let Some(path) = json {
                let text = serde_json::to_string_pretty(&report::json(&data, &all)).into_diagnostic()? + "\n";
                std::fs::write(&path, text)
                    .into_diagnostic()
                    .wrap_err_with(|| format!("writing {}", path.display()))?;
            }
            all.into_iter().flat_map(|one| one.failures).collect::<Vec<_>>()
        }
        Command::Same { data: clips, target, frames } => {
            let clips = clips.unwrap_or_else(|| home().join("../../shared/data"));
            let compared = same(&Data::read(None)?, &clips, &target, frames, &|news| eprintln!("{news}"))?;
            print!("{}", compared.table());
            compared.failures()
        }
        Command::Soak { target, workload, frames } => {
            let all = soak::soak(&Data::read(None)?, &target, &workload, frames, &|news| eprintln!("{news}"))?;
            print!("{}", soak::table(&all));
            soak::failures(&all)
        }
    };
    for failure in &failures {
        eprintln!("FAILED: {failure}");
    }
    Ok(if failures.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
