//! The workloads by name: their pack, their input frames, and the same frames run on the host.
//!
//! A new workload is: its work in `firmware-sim/workloads/src/NAME.rs`, three lines in `firmware-sim/image/src/bin/NAME.rs`,
//! its pack and input here, an entry in `budgets.toml`.

mod components;
mod emotion;
mod face;
mod kernel;
mod limit;
mod machine;
mod mechanics;
mod modal;
mod network;
mod pipeline;
pub mod recorded;
mod servos;
pub mod styled;
mod translator;

use std::path::PathBuf;

use kinesic_host::prepare::PrepareError;
use kinesic_host::rig::RigError;
use kinesic_host::translate::TrainError;
use kinesic_workloads::{Digest, Frames, Workload};

/// Pack and input of a workload, and the hashes that the host computed from them.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// File name of the pack that the image includes.
    pub pack_name: &'static str,
    /// The pack.
    pub pack: Vec<u8>,
    /// The block of input frames.
    pub input: Vec<u8>,
    /// Hash of each frame's output on the host.
    pub hashes: Vec<u64>,
    run: Host,
}

/// The same workload on the host over other input: a hash a frame, and how many frames had a number that is not finite.
type Host = fn(pack: &[u8], input: &[u8]) -> Option<(Vec<u64>, usize)>;

impl Prepared {
    /// The same frames, `rounds` times over, the state going on; and the number of frames with numbers that are not finite.
    pub fn rounds(&self, rounds: u32) -> Option<(Self, usize)> {
        let mut input = self.input.clone();
        input.get_mut(12..16)?.copy_from_slice(&rounds.to_le_bytes());
        let (hashes, broken) = (self.run)(&self.pack, &input)?;
        Some((Self { input, hashes, ..self.clone() }, broken))
    }
}

/// The host cannot run a workload.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum WorkloadError {
    /// `budgets.toml` names a workload that has no code.
    #[error("no workload is called {name}; there are {known}")]
    #[diagnostic(help("add it in firmware-sim/src/workload/mod.rs, or correct the name in budgets.toml"))]
    Unknown {
        /// The name.
        name: String,
        /// What there is.
        known: String,
    },
    /// A pack of the repository cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// Tables do not make a pack.
    #[error(transparent)]
    Load(#[from] kinesic::LoadError),
    /// A pack of the repository holds no skeleton.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// Components cannot be trained on the made walks.
    #[error(transparent)]
    Components(#[from] kinesic_host::components::TrainError),
    /// A pack cannot be quantised.
    #[error(transparent)]
    Quantise(#[from] kinesic_host::quantise::QuantiseError),
    /// Recorded clips cannot be used.
    #[error(transparent)]
    #[diagnostic(help("the recorded clips are looked for in --data, else in KINESIC_DATA, else in ../shared/data"))]
    Prepare(#[from] PrepareError),
    /// Recorded clips cannot be trained on.
    #[error(transparent)]
    Train(#[from] TrainError),
    /// The workload refuses its own pack.
    #[error("the workload {name} refuses its own pack")]
    #[diagnostic(help("its capacities in firmware-sim/workloads must hold what firmware-sim/src/workload makes"))]
    Refused {
        /// The name.
        name: String,
    },
}

type Make = fn(&str, usize) -> Result<Prepared, WorkloadError>;

const ALL: &[(&str, Make)] = &[
    ("translator", translator::per_joint),
    ("translator-body", translator::whole_body),
    ("mechanics", mechanics::prepare),
    ("mechanics-i8", mechanics::int8),
    ("translator-i16", translator::per_joint_fixed),
    ("translator-body-i16", translator::whole_body_fixed),
    ("network", network::f32),
    ("network-i8", network::i8),
    ("components", components::prepare),
    ("limit", limit::prepare),
    ("face", face::prepare),
    ("emotion-change", emotion::change),
    ("emotion-play", emotion::play),
    ("styled", styled::float),
    ("styled-i16", styled::fixed),
    ("styled-feet", styled::feet),
    ("servos", servos::float),
    ("servos-i16", servos::fixed),
    ("servo-head", machine::head),
    ("servo-lamp", machine::lamp),
    ("servo-antennas", machine::antennas),
    ("servo-player", machine::player),
    ("pipeline", pipeline::float),
    ("pipeline-int", pipeline::integer),
    ("kernel-f32", kernel::f32),
    ("kernel-i8", kernel::i8),
    ("arithmetic", modal::arithmetic),
    ("kernel-modal", modal::f32),
    ("kernel-modal-i16", modal::i16),
    ("peer-nalgebra", modal::nalgebra),
    ("peer-embedded-nn", network::embedded_nn),
];

/// Makes pack and input of a workload and runs it on the host.
pub fn prepare(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let (_, make) = ALL.iter().find(|(known, _)| *known == name).ok_or_else(|| WorkloadError::Unknown {
        name: name.to_owned(),
        known: ALL.iter().map(|(known, _)| *known).collect::<Vec<_>>().join(", "),
    })?;
    make(name, frames)
}

/// The host's half of the proof that host and device compute the same: the same source, the same pack, the same frames.
fn on_host<W: Workload>(
    name: &str,
    pack_name: &'static str,
    pack: Vec<u8>,
    frames: &[Vec<f32>],
) -> Result<Prepared, WorkloadError> {
    let stride = frames.first().map_or(0, Vec::len) * 4;
    let mut input: Vec<u8> = bytemuck::cast_slice(&Frames::header(frames.len() as u32, stride as u32, 1)).to_vec();
    frames.iter().for_each(|frame| input.extend_from_slice(bytemuck::cast_slice(frame)));

    let (hashes, _) = play::<W>(&pack, &input).ok_or_else(|| WorkloadError::Refused { name: name.to_owned() })?;
    Ok(Prepared { pack_name, pack, input, hashes, run: play::<W> })
}

fn play<W: Workload>(pack: &[u8], input: &[u8]) -> Option<(Vec<u64>, usize)> {
    let words = aligned(pack);
    let model = W::open(&bytemuck::cast_slice(&words)[..pack.len()]).ok()?;
    let mut state = W::power_on(&model);
    let (mut hashes, mut broken) = (Vec::new(), 0);
    for frame in Frames::open(input)?.iter() {
        W::load(&model, &mut state, frame);
        W::step(&model, &mut state);
        let mut digest = Digest::default();
        W::output(&model, &state, &mut digest);
        hashes.push(digest.value());
        broken += usize::from(!digest.is_finite());
    }
    Some((hashes, broken))
}

/// Packs are used in place and need their alignment on the host as in flash.
fn aligned(pack: &[u8]) -> Vec<u128> {
    let mut words = vec![0u128; pack.len().div_ceil(16)];
    bytemuck::cast_slice_mut(&mut words)[..pack.len()].copy_from_slice(pack);
    words
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use crate::data::{Data, home};

    /// Images that are no workloads of the check: the tool's own, and clips of the reader's.
    const OTHER: [&str; 4] = ["by-hand", "calibrate", "control-", "recorded"];

    #[test]
    fn every_image_is_a_workload_with_a_budget() {
        let known: BTreeSet<String> = super::ALL.iter().map(|(name, _)| (*name).to_owned()).collect();
        let budgets = Data::read(None).unwrap().budgets;
        assert_eq!(known, budgets.workloads.into_keys().collect(), "workload/mod.rs and [workloads] of budgets.toml");
        assert_eq!(known, budgets.limits.into_keys().collect(), "workload/mod.rs and [limits] of budgets.toml");
        let files = std::fs::read_dir(home().join("image/src/bin")).unwrap();
        let names = files.filter_map(|file| Some(file.unwrap().file_name().to_str()?.strip_suffix(".rs")?.to_owned()));
        let images: BTreeSet<String> =
            names.filter(|name| !OTHER.iter().any(|other| name.starts_with(other))).collect();
        assert_eq!(known, images, "workload/mod.rs and image/src/bin");
    }
}
