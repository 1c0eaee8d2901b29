//! Printing that cannot panic. In the commands, `println!` and `eprintln!` are these.
//!
//! Those of std panic where nobody reads on (`kinesic inspect walk.bvh | head -1`) or where output goes to a full disk.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write, stderr, stdout};

macro_rules! println {
    () => { $crate::commands::say::line(format_args!("")) };
    ($($text:tt)*) => { $crate::commands::say::line(format_args!($($text)*)) };
}

macro_rules! eprintln {
    ($($text:tt)*) => { $crate::commands::say::aside(format_args!($($text)*)) };
}

/// A line on standard output. Commands print when their work is done, so a reader that has gone away is no failure; any other
/// refusal is.
pub fn line(text: Arguments) {
    let Err(error) = writeln!(stdout().lock(), "{text}") else { return };
    if error.kind() == ErrorKind::BrokenPipe {
        std::process::exit(0);
    }
    aside(format_args!("Error: standard output cannot be written: {error}"));
    std::process::exit(1);
}

/// A line on standard error. Where that is refused there is nowhere left to say so.
pub fn aside(text: Arguments) {
    let _ = writeln!(stderr().lock(), "{text}");
}
