//! `kinesic robot`.

mod import;
mod retarget;
mod show;
pub mod table;

use clap::Subcommand;

/// Robots: from a description or a table of servos to a pack that commands and firmware know; a person's motion on them
#[derive(Debug, Subcommand)]
pub enum Action {
    Import(import::Args),
    Show(show::Args),
    Retarget(retarget::Args),
}

/// Runs the subcommand.
pub fn run(action: &Action) -> miette::Result<()> {
    match action {
        Action::Import(args) => import::run(args),
        Action::Show(args) => show::run(args),
        Action::Retarget(args) => retarget::run(args),
    }
}
