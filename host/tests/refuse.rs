//! Bad command lines and bad files: each is refused with a cause, none with a panic, and nothing is left behind.

#[path = "refuse/cases.rs"]
mod cases;
#[path = "refuse/files.rs"]
mod files;

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, Output};

const KINESIC: &str = env!("CARGO_BIN_EXE_kinesic");

/// Every file with its bytes, folders as `None`.
fn contents(folder: &Path) -> BTreeMap<OsString, Option<Vec<u8>>> {
    let entries = std::fs::read_dir(folder).unwrap().map(Result::unwrap);
    entries.map(|entry| (entry.file_name(), std::fs::read(entry.path()).ok())).collect()
}

fn squeeze(text: &str) -> String {
    // Reports wrap lines and draw bars: compare without them.
    text.chars().filter(|c| !c.is_whitespace() && *c != '│').collect()
}

/// What is wrong with a refusal, if anything.
fn fault(output: &Output, cause: &str) -> Option<String> {
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    let status = output.status;
    if !matches!(status.code(), Some(1 | 2)) {
        return Some(format!("ended with {status}, expected 1 or 2: {message}"));
    }
    if message.contains("panicked") || message.contains("RUST_BACKTRACE") {
        return Some(format!("panicked: {message}"));
    }
    (!squeeze(&message).contains(&squeeze(cause))).then(|| format!("does not say '{cause}': {message}"))
}

#[test]
fn a_hundred_bad_command_lines_are_refused_with_a_cause() {
    assert!(cases::CASES.len() >= 100, "{} cases", cases::CASES.len());
    let folder = tempfile::tempdir().unwrap();
    files::make(folder.path());
    let before = contents(folder.path());
    let mut faults = Vec::new();
    for (line, cause) in cases::CASES {
        let line = ["mechanics", "translate", "components"].iter().fold((*line).to_owned(), |line, engine| {
            line.replace(&format!("{{{}}}", &engine[..1]), &format!("train {engine} --out o.kin"))
        });
        // A gigabyte is plenty for clips of two seconds: what asks for more would bring a machine down.
        let script = format!("ulimit -v 4000000; exec \"$0\" {}", line.replace('*', "\\*"));
        let output = Command::new("sh").args(["-c", &script, KINESIC]).current_dir(folder.path()).output().unwrap();
        faults.extend(fault(&output, cause).map(|fault| format!("kinesic {line}: {fault}")));
        let after = contents(folder.path());
        if after != before {
            let names = after.keys().filter(|name| !before.contains_key(*name)).collect::<Vec<_>>();
            faults.push(format!("kinesic {line}: left {names:?} or changed a file"));
            names.iter().for_each(|name| drop(std::fs::remove_file(folder.path().join(name))));
        }
    }
    assert!(faults.is_empty(), "{} of {}:\n{}", faults.len(), cases::CASES.len(), faults.join("\n"));
}
