//! Printing that cannot panic. In the commands, `println!` and `eprintln!` are these.
//!
//! Those of std panic where nobody reads on (`kinesic inspect walk.bvh | head -1`) or where output goes to a full disk, and they send
//! the control characters of a name to the terminal.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write, stderr, stdout};

use kinesic_host::plain;
use miette::{MietteDiagnostic, Report};

macro_rules! println {
    () => { $crate::commands::print::line(format_args!("")) };
    ($($text:tt)*) => { $crate::commands::print::line(format_args!($($text)*)) };
}

macro_rules! eprintln {
    ($($text:tt)*) => { $crate::commands::print::aside(format_args!($($text)*)) };
}

/// A line on standard output. Commands print when their work is done, so a reader that has gone away is no failure; any other
/// refusal is.
pub fn line(text: Arguments) {
    raw(&format!("{}\n", plain::text(&text.to_string())));
}

/// As [`line`], for text of our own that is written as it is.
pub fn raw(text: &str) {
    let mut out = stdout().lock();
    let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush()) else { return };
    if error.kind() == ErrorKind::BrokenPipe {
        std::process::exit(0);
    }
    aside(format_args!("Error: standard output cannot be written: {error}"));
    std::process::exit(1);
}

/// A line on standard error. Where that is refused there is nowhere left to say so.
pub fn aside(text: Arguments) {
    let _ = writeln!(stderr().lock(), "{}", plain::message(&text.to_string()));
}

/// Why a command failed: what files brought in as plain text, laid out and coloured as the terminal can.
pub fn failure(report: &Report) {
    let mut causes: Vec<String> = report.chain().map(|cause| plain::message(&cause.to_string())).collect();
    let mut innermost = MietteDiagnostic::new(causes.pop().unwrap_or_default());
    innermost.help = report.help().map(|help| plain::message(&help.to_string()));
    let told = causes.into_iter().rev().fold(Report::from(innermost), Report::wrap_err);
    let _ = writeln!(stderr().lock(), "{told:?}");
}
