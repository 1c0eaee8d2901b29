//! Where the real clips are.

use std::path::{Path, PathBuf};

/// The data, or a note that the test was skipped; with `CI=true` its absence is a failure.
pub fn data(test: &str) -> Option<PathBuf> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let folder = std::env::var_os("KINESIC_DATA").map_or(default, PathBuf::from);
    if folder.join("pairs.tsv").is_file() {
        return Some(folder);
    }
    assert!(std::env::var("CI").as_deref() != Ok("true"), "no data in {}: set KINESIC_DATA", folder.display());
    eprintln!("skipped: {test} needs the clips in {}", folder.display());
    None
}
