//! A face model of the paper's size with seeded numbers, over made faces that turn and smile.

use kinesic_host::face::synthetic;
use kinesic_host::pack::Provenance;
use kinesic_workloads::face::{CLUSTERS, Face, UNITS};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use super::{Prepared, WorkloadError, on_host};

const SEED: u64 = 3;

pub fn prepare(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let model = synthetic::model(CLUSTERS, UNITS, &mut random);
    let provenance = Provenance { tool: "kinesic-firmware-sim".to_owned(), seed: SEED, ..Provenance::default() };
    let frame = |_| {
        let change = random.random_range(-1.0..1.0);
        let (strength, yaw) = (random.random_range(0.0..1.0), random.random_range(-1.0..1.0));
        let landmarks = synthetic::landmarks(strength, yaw, &mut random);
        std::iter::once(change).chain(landmarks.as_flattened().iter().copied()).collect()
    };
    let frames: Vec<Vec<f32>> = (0..frames).map(frame).collect();
    on_host::<Face>(name, "face.kin", model.pack(&provenance), &frames)
}
