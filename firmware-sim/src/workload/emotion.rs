//! The made walk of the paper's size: strengths that change in every frame, and one that stays.

use kinesic_host::emotion::synthetic;
use kinesic_host::pack::Provenance;
use kinesic_workloads::Workload;
use kinesic_workloads::emotion::{Change, Play};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use super::{Prepared, WorkloadError, on_host};

const SEED: u64 = 4;

pub fn change(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    prepare::<Change>(name, frames)
}

pub fn play(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    prepare::<Play>(name, frames)
}

fn prepare<W: Workload>(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let (model, rig) = synthetic::model(1);
    let provenance = Provenance { tool: "kinesic-firmware-sim".to_owned(), seed: SEED, ..Provenance::default() };
    let frames: Vec<Vec<f32>> = (0..frames).map(|_| vec![random.random_range(0.0..1.0), 1.0 / 60.0]).collect();
    on_host::<W>(name, "emotion.kin", model.pack(&rig, &provenance), &frames)
}
