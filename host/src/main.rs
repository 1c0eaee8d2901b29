//! The command `kinesic`: learn how a motion is performed, pack it, play it through the device's code.

mod commands;

use std::process::ExitCode;

fn main() -> ExitCode {
    match commands::run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(report) => {
            // One line a cause, for people and for scripts alike.
            commands::complain(&report);
            ExitCode::FAILURE
        }
    }
}
