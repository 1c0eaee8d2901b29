//! What the tests of body mechanics share.
#![allow(dead_code)] // Each test binary takes its part.

use std::path::Path;

use kinesic_host::clip::{Clip, ReadOptions};
use kinesic_host::prepare::Source;
use kinesic_host::rig::Rig;

/// Clips on the rig of the first, at 60 frames per second.
pub fn on_rig(folder: &Path, names: &[&str]) -> (Rig, Vec<Clip>) {
    let read = |name: &&str| Source::read(&folder.join(name), &ReadOptions::default()).expect("a clip");
    let sources: Vec<Source> = names.iter().map(read).collect();
    let rig = sources[0].rig().expect("a rig");
    let clips = sources.iter().map(|s| s.on_rig(&rig, 60.0).expect("on the rig")).collect();
    (rig, clips)
}
