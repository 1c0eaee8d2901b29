//! `kinesic robot`.

mod import;
mod retarget;
mod show;
pub mod table;

use std::path::Path;

use clap::Subcommand;

/// Robots: from a description or a table of servos to a pack that commands and firmware know; a person's motion on them
#[derive(Debug, Subcommand)]
#[command(after_help = "\
Examples:
  kinesic robot import desk.toml --out desk.kin                   # servos without a description
  kinesic robot import arm.urdf --servos arm.toml --out arm.kin   # a description, and its servos
  kinesic robot show arm.urdf --at elbow=0.5
  kinesic robot retarget arm.urdf walk.bvh --robot arm.kin --out walk.csv
  kinesic inspect arm.kin                                         # the joints of a pack")]
pub enum Action {
    Import(import::Args),
    Show(show::Args),
    Retarget(retarget::Args),
}

/// A table of servos, by name.
fn is_table(path: &Path) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case("toml"))
}

/// Runs the subcommand.
pub fn run(action: &Action) -> miette::Result<()> {
    match action {
        Action::Import(args) => import::run(args),
        Action::Show(args) => show::run(args),
        Action::Retarget(args) => retarget::run(args),
    }
}
