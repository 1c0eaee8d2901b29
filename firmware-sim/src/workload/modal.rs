//! One model of order 40, 3 inputs and 3 outputs, seeded: modal in f32 and in fixed point, and dense for nalgebra.

use kinesic::kernel::{FixedBlock, is_bounded};
use kinesic::model::Kind;
use kinesic_host::pack::{PackWriter, Provenance};
use kinesic_workloads::arithmetic::Arithmetic;
use kinesic_workloads::modal::{Modal, ModalFixed, Nalgebra, ORDER, SIDES};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use super::{Prepared, WorkloadError, on_host};
use crate::synthetic::FRAME_RATE;

const SEED: u64 = 3;

/// One pack for all three. The dense model is one of its own: cost depends on the shape alone.
fn pack() -> Vec<u8> {
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let (mut blocks, mut fixed) = (Vec::new(), Vec::new());
    for _ in 0..ORDER / 2 {
        let (radius, angle) = (random.random_range(0.3..0.97), random.random_range(0.01..1.5));
        let (re, im) = (radius * libm::cos(angle), radius * libm::sin(angle));
        let mut block: [f64; 16] = std::array::from_fn(|_| random.random_range(-0.05..0.05));
        block[..4].copy_from_slice(&[re, -im, im, re]);
        blocks.extend(block.map(|value| value as f32));
        let integer = |at: usize| (block[at] * if at < 4 { 32_768.0 } else { 32_768.0 * 6.0 }).round() as i16;
        let entries: FixedBlock = std::array::from_fn(|at| if at < 16 { integer(at) } else { 5 });
        debug_assert!(is_bounded(&entries));
        fixed.extend(entries);
    }
    let mut matrix = |len: usize| -> Vec<f32> { (0..len).map(|_| random.random_range(-0.04..0.04)).collect() };
    let mut out = PackWriter::new(Kind::Style, "modal", FRAME_RATE as f32);
    out.f32s("modal/blocks", 16, &blocks);
    out.i16s("modal/fixed", 18, &fixed);
    out.f32s("dense/a", 1, &matrix(ORDER * ORDER));
    out.f32s("dense/b", 1, &matrix(ORDER * SIDES));
    out.f32s("dense/c", 1, &matrix(SIDES * ORDER));
    out.finish(&Provenance { tool: "kinesic-firmware-sim".to_owned(), seed: SEED, ..Provenance::default() })
}

fn input(frames: usize) -> Vec<Vec<f32>> {
    let mut random = ChaCha8Rng::seed_from_u64(SEED + 1);
    (0..frames).map(|_| (0..SIDES).map(|_| random.random_range(-2.0..2.0)).collect()).collect()
}

/// Numbers that are drawn on the device: a seed a frame, and the pack of the others, since there must be one.
pub fn arithmetic(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let mut random = ChaCha8Rng::seed_from_u64(SEED + 2);
    let seeds: Vec<Vec<f32>> = (0..frames).map(|_| vec![random.random_range(0.0..1.0)]).collect();
    on_host::<Arithmetic>(name, "modal.kin", pack(), &seeds)
}

pub fn f32(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    on_host::<Modal>(name, "modal.kin", pack(), &input(frames))
}

pub fn i16(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    on_host::<ModalFixed>(name, "modal.kin", pack(), &input(frames))
}

pub fn nalgebra(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    on_host::<Nalgebra>(name, "modal.kin", pack(), &input(frames))
}
