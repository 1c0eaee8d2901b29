//! Long runs on a target: the same bits as on the host after many frames, and every number finite.

use crate::build::{self, Folders};
use crate::check::{CheckError, chosen, same_bits};
use crate::data::{self, Data};
use crate::elf::Image;
use crate::emulator;
use crate::toolchain;
use crate::workload;

/// One workload that ran for long.
#[derive(Clone, Debug)]
pub struct Soaked {
    /// Name of the target.
    pub target: String,
    /// Name of the workload.
    pub workload: String,
    /// Frames that ran.
    pub frames: usize,
    /// Frames whose output, on the host, had a number that is infinite or NaN.
    pub broken: usize,
    /// Hash over all frames' output bits, the same on host and target; or where they differ.
    pub bits: Result<u64, String>,
}

/// Runs each workload for `frames` frames, or as many more as make whole rounds of its input, on `targets` (all, if there are none).
pub fn soak(
    data: &Data,
    targets: &[String],
    workloads: &[String],
    frames: usize,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Vec<Soaked>, CheckError> {
    let targets = chosen(targets, &data.targets, "targets.toml")?;
    let workloads = chosen(workloads, &data.budgets.workloads, "[workloads] of budgets.toml")?;
    let folders = Folders::new();
    let mut prepared = Vec::new();
    for name in &workloads {
        let once = data::find(&data.budgets.workloads, name, "budgets.toml")?.frames;
        let ready = workload::prepare(name, once)?;
        build::write(&folders.packs().join(ready.pack_name), &ready.pack)?;
        progress(&format!("{name}: running on the host"));
        let refused = || workload::WorkloadError::Refused { name: (*name).to_owned() };
        let (long, broken) = ready.rounds(frames.div_ceil(once) as u32).ok_or_else(refused)?;
        prepared.push((*name, long, broken));
    }
    let mut all = Vec::new();
    for name in targets {
        let target = data::find(&data.targets, name, "targets.toml")?;
        let images = build::images(&folders, name, target, &toolchain::find(&target.triple)?, &workloads)?;
        for (workload, prepared, broken) in &prepared {
            progress(&format!("{name}: running {workload}"));
            let image = Image::read(&images.join(workload))?;
            let run = emulator::run(target, &image, None, &prepared.input, &folders.run(name, workload))?;
            all.push(Soaked {
                target: name.to_owned(),
                workload: (*workload).to_owned(),
                frames: run.hashes.len(),
                broken: *broken,
                bits: same_bits(&prepared.hashes, &run.hashes),
            });
        }
    }
    Ok(all)
}

/// The table.
pub fn table(all: &[Soaked]) -> String {
    let mut text = "| target | workload | frames | frames with NaN | hash of all frames, host and target |\n|---|---|---|---|---|\n".to_owned();
    for one in all {
        let hash = one.bits.as_ref().map_or_else(|_| "DIFFERS".to_owned(), |hash| format!("{hash:016x}"));
        text += &format!("| {} | {} | {} | {} | {hash} |\n", one.target, one.workload, one.frames, one.broken);
    }
    text
}

/// Everything that is not as it must be, in one sentence each.
pub fn failures(all: &[Soaked]) -> Vec<String> {
    let differs = |one: &Soaked| {
        let difference = one.bits.as_ref().err()?;
        Some(format!("{}, {}: output bits differ between host and target: {difference}", one.target, one.workload))
    };
    let broken = all.iter().filter(|one| one.broken > 0);
    let broken = broken.map(|one| format!("{}: {} frames have numbers that are not finite", one.workload, one.broken));
    all.iter().filter_map(differs).chain(broken).collect()
}
