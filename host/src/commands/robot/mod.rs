//! `kinesic robot`: descriptions of robots.

mod retarget;
mod show;

use clap::Subcommand;

/// A robot's description: its joints, and a person's motion on it
#[derive(Debug, Subcommand)]
pub enum Robot {
    Show(show::Args),
    Retarget(retarget::Args),
}

/// Runs the command.
pub fn run(command: &Robot) -> miette::Result<()> {
    match command {
        Robot::Show(args) => show::run(args),
        Robot::Retarget(args) => retarget::run(args),
    }
}
