//! Measured against allowed, for every target and workload asked for.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use kinesic_workloads::Digest;

use crate::build::{self, BuildError, Folders};
use crate::data::{self, Data, DataError, Limit, Target};
use crate::elf::{ElfError, Image};
use crate::emulator::{self, RunError};
use crate::price::{Cycles, PriceError, Timing};
use crate::profile::{Instruction, Profile};
use crate::toolchain::{self, ToolchainError};
use crate::workload::{self, Prepared, WorkloadError};

/// A check could not be carried out.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum CheckError {
    /// Data files.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Data(#[from] DataError),
    /// Compiler.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Toolchain(#[from] ToolchainError),
    /// Build.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Build(#[from] BuildError),
    /// Workload.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Workload(#[from] WorkloadError),
    /// Image.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Elf(#[from] ElfError),
    /// Run.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Run(#[from] RunError),
    /// Cycle model.
    #[error("{target}, {workload}: {source}")]
    Price {
        /// The target.
        target: String,
        /// The workload.
        workload: String,
        /// Why.
        #[diagnostic_source]
        source: PriceError,
    },
}

/// One workload on one target.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Name of the workload.
    pub workload: String,
    /// The peer whose code it is, if it is not ours.
    pub peer: Option<String>,
    /// Name of the target.
    pub target: String,
    /// The compiler that built the image.
    pub compiler: String,
    /// Frames that ran.
    pub frames: usize,
    /// Fewest, median and most instructions of a frame.
    pub instructions: [u64; 3],
    /// Modelled cycles of the longest frame.
    pub cycles: Cycles,
    /// The end of that range that counts.
    pub gated_cycles: f64,
    /// `gated_cycles` at the target's clock.
    pub microseconds: f64,
    /// `microseconds` as a share of the frame time, percent.
    pub share: f64,
    /// Flash without the pack, B.
    pub flash: u64,
    /// The pack, B.
    pub pack: u64,
    /// Static RAM, B.
    pub ram: u64,
    /// Deepest stack while frames ran, B.
    pub stack: u64,
    /// Deepest stack at start-up, B.
    pub stack_start_up: u64,
    /// Functions by modelled cycles of the longest frame, dearest first.
    pub hot: Vec<(String, f64)>,
    /// Functions and constants in flash by size, largest first.
    pub largest: Vec<(String, u64)>,
    /// Everything that is not as it must be.
    pub failures: Vec<String>,
    /// Hash over all frames' output bits, the same on host and target; or where they differ.
    pub same_bits: Result<u64, String>,
    /// Symbols of panic, formatting or heap machinery.
    pub forbidden: Vec<String>,
    /// What was allowed.
    pub allowed: Limit,
}

impl Measured {
    /// The longest frame lasts longer than a frame's time.
    pub fn is_late(&self) -> bool {
        self.share > 100.0
    }
}

/// What to check: everything where a list is empty.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// Targets by name.
    pub targets: Vec<String>,
    /// Workloads by name.
    pub workloads: Vec<String>,
}

pub(crate) fn chosen<'a, T>(
    wanted: &'a [String],
    table: &'a BTreeMap<String, T>,
    file: &'static str,
) -> Result<Vec<&'a str>, DataError> {
    for name in wanted {
        data::find(table, name, file)?;
    }
    let names = table.keys().map(String::as_str);
    Ok(names.filter(|name| wanted.is_empty() || wanted.iter().any(|wanted| wanted == name)).collect())
}

/// Everything that is the same for all targets of a check.
struct Bench<'a> {
    data: &'a Data,
    folders: Folders,
    plugin: PathBuf,
    prepared: BTreeMap<String, Prepared>,
    progress: &'a (dyn Fn(&str) + Sync),
}

/// Builds and runs what was chosen, two targets at a time. `progress` hears what is going on.
pub fn check(
    data: &Data,
    selection: &Selection,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Vec<Measured>, CheckError> {
    let targets = chosen(&selection.targets, &data.targets, "targets.toml")?;
    let workloads = chosen(&selection.workloads, &data.budgets.workloads, "[workloads] of budgets.toml")?;
    // A workload without a limit on some target must not pass unseen.
    for workload in &workloads {
        let limits = data::find(&data.budgets.limits, workload, "[limits] of budgets.toml")?;
        for target in &targets {
            data::find(limits, target, "[limits] of this workload in budgets.toml")?;
        }
    }
    let folders = Folders::new();
    let mut prepared = BTreeMap::new();
    for name in &workloads {
        let entry = data::find(&data.budgets.workloads, name, "budgets.toml")?;
        let ready = workload::prepare(name, entry.frames)?;
        build::write(&folders.packs().join(ready.pack_name), &ready.pack)?;
        prepared.insert((*name).to_owned(), ready);
    }
    progress("building the emulator's plugin");
    let plugin = build::plugin(&folders)?;
    let bench = Bench { data, folders, plugin, prepared, progress };
    let mut all: Vec<Measured> = two_at_a_time(&targets, |name| bench.target(name))?.into_iter().flatten().collect();
    let place = |one: &Measured| (workloads.iter().position(|w| *w == one.workload), one.target.clone());
    all.sort_by_key(place);
    Ok(all)
}

/// Does something for every target, two at a time: each build is mostly one compiler on one core.
pub(crate) fn two_at_a_time<T: Send>(
    targets: &[&str],
    work: impl Fn(&str) -> Result<T, CheckError> + Sync,
) -> Result<Vec<T>, CheckError> {
    let next = AtomicUsize::new(0);
    let worker = || {
        let mut done = Vec::new();
        while let Some(name) = targets.get(next.fetch_add(1, Ordering::Relaxed)) {
            done.push(work(name)?);
        }
        Ok::<_, CheckError>(done)
    };
    let halves = std::thread::scope(|scope| {
        [scope.spawn(worker), scope.spawn(worker)].map(|half| half.join().expect("a worker does not panic"))
    });
    let mut all = Vec::new();
    for half in halves {
        all.extend(half?);
    }
    Ok(all)
}

impl Bench<'_> {
    fn target(&self, name: &str) -> Result<Vec<Measured>, CheckError> {
        let target = data::find(&self.data.targets, name, "targets.toml")?;
        let toolchain = toolchain::find(&target.triple)?;
        (self.progress)(&format!("{name}: building with {}", toolchain.version));
        let binaries: Vec<&str> = self.prepared.keys().map(String::as_str).collect();
        let images = build::images(&self.folders, name, target, &toolchain, &binaries)?;
        let mut all = Vec::new();
        for (workload, prepared) in &self.prepared {
            (self.progress)(&format!("{name}: running {workload}"));
            let image = Image::read(&images.join(workload))?;
            all.push(self.measure(name, workload, prepared, &image, toolchain.version.clone())?);
        }
        Ok(all)
    }

    fn measure(
        &self,
        name: &str,
        workload: &str,
        prepared: &Prepared,
        image: &Image,
        compiler: String,
    ) -> Result<Measured, CheckError> {
        let target = data::find(&self.data.targets, name, "targets.toml")?;
        let timing = data::find(&self.data.timings, &target.timing, "cycles.toml")?;
        let limits = data::find(&self.data.budgets.limits, workload, "[limits] of budgets.toml")?;
        let limit = data::find(limits, name, "[limits] of this workload in budgets.toml")?.clone();
        let run = emulator::run(target, image, Some(&self.plugin), &prepared.input, &self.folders.run(name, workload))?;
        let unpriced = |source| CheckError::Price { target: name.to_owned(), workload: workload.to_owned(), source };
        let cycles = timing.price(target.isa, &run.profile.instructions, |one| one.longest).map_err(unpriced)?;
        let gated_cycles = timing.gated(cycles);
        let microseconds = gated_cycles / target.clock_mhz;
        let entry = data::find(&self.data.budgets.workloads, workload, "budgets.toml")?;
        let mut measured = Measured {
            workload: workload.to_owned(),
            peer: entry.peer.clone(),
            target: name.to_owned(),
            compiler,
            frames: run.profile.frames.len(),
            instructions: run.profile.spread(),
            cycles,
            gated_cycles,
            microseconds,
            share: microseconds * self.data.budgets.frame_hz / 1e4,
            flash: image.flash,
            pack: image.pack,
            ram: image.ram,
            stack: run.stack_frames,
            stack_start_up: run.stack_start_up,
            hot: hot(timing, target, image, &run.profile).map_err(unpriced)?,
            largest: image.largest(),
            same_bits: same_bits(&prepared.hashes, &run.hashes),
            forbidden: image.forbidden(),
            allowed: limit,
            failures: Vec::new(),
        };
        measured.failures = judge(&measured);
        Ok(measured)
    }
}

/// The first frame whose output differs between host and target.
pub(crate) fn same_bits(host: &[u64], target: &[u64]) -> Result<u64, String> {
    let differs = host.iter().zip(target).position(|(host, target)| host != target);
    match differs {
        Some(frame) => Err(format!("frame {frame}: host {:016x}, target {:016x}", host[frame], target[frame])),
        None if host.len() != target.len() => Err(format!("host ran {} frames, target {}", host.len(), target.len())),
        None => Ok(one_hash(host)),
    }
}

/// One hash of all frames' hashes, in order.
pub(crate) fn one_hash(frames: &[u64]) -> u64 {
    let mut digest = Digest::default();
    for hash in frames {
        digest.word(*hash as u32);
        digest.word((hash >> 32) as u32);
    }
    digest.value()
}

fn hot(timing: &Timing, target: &Target, image: &Image, profile: &Profile) -> Result<Vec<(String, f64)>, PriceError> {
    let mut functions: BTreeMap<String, BTreeMap<u64, Instruction>> = BTreeMap::new();
    for (address, one) in &profile.instructions {
        functions.entry(image.function(*address)).or_default().insert(*address, one.clone());
    }
    let mut hot = Vec::new();
    for (name, instructions) in functions {
        hot.push((name, timing.gated(timing.price(target.isa, &instructions, |one| one.longest)?)));
    }
    hot.sort_by(|a, b| b.1.total_cmp(&a.1));
    Ok(hot)
}

/// Everything over its limit, and every proof that failed: target, workload, measured and allowed in one sentence each.
fn judge(one: &Measured) -> Vec<String> {
    let Measured { target, workload, allowed, .. } = one;
    let mut failures = Vec::new();
    let [shortest, _, longest] = one.instructions;
    let mut hold = |what: &str, measured: u64, allowed: u64| {
        if measured > allowed {
            failures.push(format!("{target}, {workload}: {what}: measured {measured}, allowed {allowed}"));
        }
    };
    hold("instructions of the longest frame", longest, allowed.instructions);
    hold("instructions, longest less shortest frame", longest - shortest, allowed.spread);
    hold("modelled cycles of the longest frame", one.gated_cycles.ceil() as u64, allowed.cycles);
    hold("flash without the pack, B", one.flash, allowed.flash);
    hold("static RAM, B", one.ram, allowed.ram);
    hold("stack, B", one.stack.max(one.stack_start_up), allowed.stack);
    if one.is_late() && allowed.late.is_none() && one.peer.is_none() {
        let (share, microseconds) = (one.share, one.microseconds);
        failures.push(format!(
            "{target}, {workload}: a frame does not fit its time: {microseconds:.0} us are {share:.1} % (budgets.toml has no `late`)"
        ));
    }
    if let Err(difference) = &one.same_bits {
        failures.push(format!("{target}, {workload}: output bits differ between host and target: {difference}"));
    }
    // A peer's panics are its own affair: that it has them is part of what is shown.
    if !one.forbidden.is_empty() && one.peer.is_none() {
        let symbols = one.forbidden.join(", ");
        failures.push(format!("{target}, {workload}: panic, formatting or heap machinery is linked: {symbols}"));
    }
    failures
}
