//! `kinesic robot`: descriptions of robots.

mod retarget;
mod show;

use clap::Subcommand;

/// Read a robot's description (URDF or MJCF)
#[derive(Debug, Subcommand)]
pub enum Task {
    Show(show::Args),
    Retarget(retarget::Args),
}

/// Runs the command.
pub fn run(task: &Task) -> miette::Result<()> {
    match task {
        Task::Show(args) => show::run(args),
        Task::Retarget(args) => retarget::run(args),
    }
}
