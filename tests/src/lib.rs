//! What the tests of all crates share: the real clips, which stay outside the repository.

use std::collections::HashMap;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The data folder: `KINESIC_DATA`, default `../shared/data` beside the repository.
///
/// Without it the named test is skipped: `None`, a line on standard error, and a line in the file `KINESIC_SKIPPED`, from
/// which `ci.sh` counts. With `CI=true` the absence is a failure.
///
/// # Panics
/// Where `CI=true` and there are no data.
pub fn data(test: &str) -> Option<PathBuf> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data");
    let folder = PathBuf::from(std::env::var("KINESIC_DATA").unwrap_or_else(|_| default.into()));
    if folder.join("manifest.tsv").is_file() {
        return Some(folder);
    }
    let message = format!("{test}: no manifest.tsv in {} (set KINESIC_DATA)", folder.display());
    assert!(std::env::var("CI").as_deref() != Ok("true"), "{message}");
    skipped(&message);
    None
}

/// Says that a test is skipped, and why: a line on standard error, and a line in the file `KINESIC_SKIPPED`.
///
/// # Panics
/// Where that file cannot be written.
pub fn skipped(message: &str) {
    eprintln!("SKIPPED {message}");
    if let Ok(list) = std::env::var("KINESIC_SKIPPED") {
        let list = std::fs::OpenOptions::new().append(true).create(true).open(list);
        list.and_then(|mut list| writeln!(list, "{message}"))
            .expect("KINESIC_SKIPPED names a file that can be written");
    }
}

/// The lines of a tab-separated file with a header, as maps from column to cell.
///
/// # Panics
/// Where the file cannot be read.
pub fn table(path: &Path) -> Vec<HashMap<String, String>> {
    let text = std::fs::read_to_string(path).expect("readable table");
    let mut lines = text.lines().map(|l| l.split('\t').map(str::to_owned).collect::<Vec<_>>());
    let header = lines.next().expect("a header");
    lines.map(|l| header.iter().cloned().zip(l).collect()).collect()
}
