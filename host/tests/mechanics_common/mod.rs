//! What the tests of body mechanics share.
#![allow(dead_code)] // Each test binary takes its part.

use std::path::{Path, PathBuf};

use kinesic_host::clip::{Clip, ReadOptions};
use kinesic_host::prepare::Source;
use kinesic_host::rig::Rig;

/// The data, or a note that the test was skipped; with `CI=true` its absence is a failure.
pub fn data(test: &str) -> Option<PathBuf> {
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let folder = std::env::var_os("KINESIC_DATA").map_or(default, PathBuf::from);
    if folder.join("manifest.tsv").is_file() {
        return Some(folder);
    }
    assert!(std::env::var("CI").as_deref() != Ok("true"), "no data in {}: set KINESIC_DATA", folder.display());
    eprintln!("skipped: {test} needs the clips in {}", folder.display());
    None
}

/// Clips on the rig of the first, at 60 frames per second.
pub fn on_rig(folder: &Path, names: &[&str]) -> (Rig, Vec<Clip>) {
    let read = |name: &&str| Source::read(&folder.join(name), &ReadOptions::default()).expect("a clip");
    let sources: Vec<Source> = names.iter().map(read).collect();
    let rig = sources[0].rig().expect("a rig");
    let clips = sources.iter().map(|s| s.on_rig(&rig, 60.0).expect("on the rig")).collect();
    (rig, clips)
}
