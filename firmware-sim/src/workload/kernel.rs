//! A matrix of 120 x 300 with seeded entries, and seeded vectors.

use kinesic::kernel::{LARGEST_ACTIVATION, PRE_ACTIVATION_BITS};
use kinesic::model::Kind;
use kinesic_host::pack::{PackWriter, Provenance};
use kinesic_host::quantise::layer;
use kinesic_workloads::kernel::{COLUMNS, F32, I8, ROWS};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use super::{Prepared, WorkloadError, on_host};
use crate::synthetic::FRAME_RATE;

const SEED: u64 = 3;

struct Made {
    pack: PackWriter,
    weights: Vec<f32>,
    frames: Vec<Vec<f32>>,
    provenance: Provenance,
}

fn made(frames: usize) -> Made {
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut vector =
        |len: usize, size: f32| -> Vec<f32> { (0..len).map(|_| random.random_range(-size..size)).collect() };
    let weights = vector(ROWS * COLUMNS, 0.2);
    let frames = (0..frames).map(|_| vector(COLUMNS, 1.0)).collect();
    let provenance = Provenance { tool: "kinesic-firmware-sim".to_owned(), seed: SEED, ..Provenance::default() };
    Made { pack: PackWriter::new(Kind::Style, "kernel", FRAME_RATE as f32), weights, frames, provenance }
}

pub fn f32(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let Made { mut pack, weights, frames, provenance } = made(frames);
    pack.tiled("kernel/weights", COLUMNS, &weights);
    on_host::<F32>(name, "kernel-f32.kin", pack.finish(&provenance), &frames)
}

pub fn i8(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let Made { mut pack, weights, frames, provenance } = made(frames);
    let unit = 1.0 / f64::from(LARGEST_ACTIVATION);
    let integer = layer("kernel/weights", COLUMNS, &weights, &[0.0; ROWS], unit, PRE_ACTIVATION_BITS)?;
    pack.integer_layer(["kernel/weights", "kernel/scale", "kernel/bias"], &integer);
    on_host::<I8>(name, "kernel-i8.kin", pack.finish(&provenance), &frames)
}
