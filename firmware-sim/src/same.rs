//! Sameness on recorded motion: translators trained on real clips, fed a real clip, on every target and on the host.

use std::path::Path;

use crate::build::{self, Folders};
use crate::check::{CheckError, chosen, one_hash, same_bits, two_at_a_time};
use crate::data::{self, Data};
use crate::elf::Image;
use crate::emulator;
use crate::toolchain;
use crate::workload::recorded::{self, Trained};

/// One translator on one target.
#[derive(Clone, Debug)]
pub struct Same {
    /// Name of the workload.
    pub workload: &'static str,
    /// Name of the target.
    pub target: String,
    /// Frames that ran.
    pub frames: usize,
    /// Fewest, median and most instructions of a frame.
    pub instructions: [u64; 3],
    /// Hash over all frames' output bits, the same on host and target; or where they differ.
    pub bits: Result<u64, String>,
}

/// What the host computed, and what every target did with the same frames.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The translators and the host's hashes.
    pub trained: Vec<Trained>,
    /// Ordered by workload, then by target.
    pub all: Vec<Same>,
}

/// Trains on the clips in `clips` and runs up to `frames` frames on the host and on `targets` (all, if there are none).
pub fn same(
    data: &Data,
    clips: &Path,
    targets: &[String],
    frames: usize,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Comparison, CheckError> {
    let targets = chosen(targets, &data.targets, "targets.toml")?;
    let folders = Folders::new();
    progress("training on the recorded clips");
    let trained = recorded::train_both(clips, frames)?;
    for one in &trained {
        build::write(&folders.packs().join(one.prepared.pack_name), &one.prepared.pack)?;
    }
    progress("building the emulator's plugin");
    let plugin = build::plugin(&folders)?;
    let binaries: Vec<&str> = trained.iter().map(|one| one.name).collect();
    let on_target = |name: &str| {
        let target = data::find(&data.targets, name, "targets.toml")?;
        progress(&format!("{name}: building and running"));
        let images = build::images(&folders, name, target, &toolchain::find(&target.triple)?, &binaries)?;
        let mut all = Vec::new();
        for one in &trained {
            let image = Image::read(&images.join(one.name))?;
            let run = emulator::run(target, &image, Some(&plugin), &one.prepared.input, &folders.run(name, one.name))?;
            all.push(Same {
                workload: one.name,
                target: name.to_owned(),
                frames: run.hashes.len(),
                instructions: run.profile.spread(),
                bits: same_bits(&one.prepared.hashes, &run.hashes),
            });
        }
        Ok(all)
    };
    let mut all: Vec<Same> = two_at_a_time(&targets, on_target)?.into_iter().flatten().collect();
    all.sort_by(|a, b| (a.workload, &a.target).cmp(&(b.workload, &b.target)));
    Ok(Comparison { trained, all })
}

impl Comparison {
    /// Everything that is not the same, in one sentence each.
    pub fn failures(&self) -> Vec<String> {
        let failed = |one: &Same| {
            let difference = one.bits.as_ref().err()?;
            Some(format!("{}, {}: output bits differ between host and target: {difference}", one.target, one.workload))
        };
        self.all.iter().filter_map(failed).collect()
    }

    /// The table: the host's line first, then the targets'.
    pub fn table(&self) -> String {
        let mut text = String::new();
        for trained in &self.trained {
            let hashes = &trained.prepared.hashes;
            text += &format!("{}: {}\n", trained.name, trained.story);
            text += "| target  | frames | hash of all frames | insns/frame min |    median |       max |\n";
            text += &format!(
                "| host    | {:6} |   {:016x} |                 |           |           |\n",
                hashes.len(),
                one_hash(hashes)
            );
            for one in self.all.iter().filter(|one| one.workload == trained.name) {
                let hash = one.bits.as_ref().map_or_else(|_| "DIFFERS".to_owned(), |hash| format!("{hash:016x}"));
                let [shortest, median, longest] = one.instructions;
                text += &format!(
                    "| {:7} | {:6} | {hash:>18} | {shortest:>15} | {median:>9} | {longest:>9} |\n",
                    one.target, one.frames
                );
            }
        }
        text
    }
}
