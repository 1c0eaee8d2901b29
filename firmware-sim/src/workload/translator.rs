//! Packs and input of the translators: written by the host crate, of the shape that training gives by default, with seeded
//! stable dynamics. Cost depends on the shape alone, so nothing has to be trained to measure it.

use kinesic_host::clip::Clip;
use kinesic_host::pack::{PackFile, Provenance};
use kinesic_host::quantise::to_int16;
use kinesic_host::rig::{Locals, Rig};
use kinesic_host::translate::{BankModel, TimingModel, TranslatorModel};
use kinesic_workloads::posed::{JOINTS, PerJoint, PerJointFixed, WholeBody, WholeBodyFixed};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

use super::{Prepared, WorkloadError, on_host};
use crate::synthetic::{self, FRAME_RATE};

const SEED: u64 = 3;
const ORDER: usize = 40;
const DRIVES: usize = 8;

pub fn per_joint(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let (pack, frames) = made_per_joint(frames);
    on_host::<PerJoint>(name, "translator.kin", pack, &frames)
}

/// The same in fixed point.
pub fn per_joint_fixed(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let (pack, frames) = made_per_joint(frames);
    on_host::<PerJointFixed>(name, "translator-i16.kin", fixed(&pack)?, &frames)
}

pub fn fixed(pack: &[u8]) -> Result<Vec<u8>, WorkloadError> {
    let provenance = Provenance { tool: "kinesic-firmware-sim".to_owned(), seed: SEED, ..Provenance::default() };
    Ok(to_int16(&PackFile::from_bytes(pack), &provenance)?)
}

fn made_per_joint(frames: usize) -> (Vec<u8>, Vec<Vec<f32>>) {
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut block = || -> [f64; 16] {
        let [a, b, c, d] = stable(&mut random);
        let mut block: [f64; 16] = std::array::from_fn(|_| random.random_range(-0.05..0.05));
        block[..4].copy_from_slice(&[a, b, c, d]);
        block[10..].iter_mut().for_each(|c| *c *= 0.05);
        block
    };
    let (rig, clip) = (synthetic::rig(), synthetic::walk(frames, SEED));
    let bank = (0..rig.rows()).map(|_| (0..ORDER / 2).map(|_| block()).collect()).collect();
    let motion = rig.locals(&rig.poses(&clip));
    (pack(&rig, &motion, BankModel::PerJoint(bank), Vec::new()), numbers(&rig, &clip, JOINTS))
}

pub fn whole_body(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let (pack, frames) = made_whole_body(frames);
    on_host::<WholeBody>(name, "translator-body.kin", pack, &frames)
}

/// The same in fixed point.
pub fn whole_body_fixed(name: &str, frames: usize) -> Result<Prepared, WorkloadError> {
    let (pack, frames) = made_whole_body(frames);
    on_host::<WholeBodyFixed>(name, "translator-body-i16.kin", fixed(&pack)?, &frames)
}

fn made_whole_body(frames: usize) -> (Vec<u8>, Vec<Vec<f32>>) {
    let (rig, clip) = (synthetic::rig(), synthetic::walk(frames, SEED));
    (shared(&rig, &clip), numbers(&rig, &clip, JOINTS))
}

/// The pack of one model for all joints of a rig.
pub fn shared(rig: &Rig, clip: &Clip) -> Vec<u8> {
    shared_over(rig, &rig.locals(&rig.poses(clip)), DRIVES)
}

/// The same for any motion, behind so many principal coordinates.
pub fn shared_over(rig: &Rig, motion: &Locals, drives: usize) -> Vec<u8> {
    let channels = 3 * rig.rows();
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let transition = (0..ORDER / 2).map(|_| stable(&mut random)).collect();
    let mut matrix = |rows: usize, columns: usize, size: f64| -> Vec<f64> {
        (0..rows * columns).map(|_| random.random_range(-size..size)).collect()
    };
    let bank = BankModel::WholeBody {
        project: matrix(drives, channels, 0.2),
        transition,
        input: matrix(ORDER, drives, 0.1),
        output: matrix(channels, ORDER + drives, 0.002),
    };
    let states = matrix(1, ORDER + drives, 0.01);
    pack(rig, motion, bank, states)
}

/// A rotation-scaling block with poles inside the unit circle.
fn stable(random: &mut ChaCha8Rng) -> [f64; 4] {
    let (radius, angle) = (random.random_range(0.3..0.97), random.random_range(0.01..1.5));
    let (re, im) = (radius * libm::cos(angle), radius * libm::sin(angle));
    [re, -im, im, re]
}

/// The pack around a bank, for a motion on a rig.
fn pack(rig: &Rig, motion: &Locals, bank: BankModel, timing_states: Vec<f64>) -> Vec<u8> {
    let channels = 3 * rig.rows();
    let (mean, deviation) = moments(motion);
    let mut direct = vec![0.0; 3 * channels];
    for (channel, deviation) in deviation.iter().enumerate() {
        direct[channel / 3 * 9 + channel % 3 * 4] = 0.9 * deviation;
    }
    let model = TranslatorModel {
        style: "made".to_owned(),
        frame_rate: FRAME_RATE,
        bias: mean.clone(),
        inverse_deviation: deviation.iter().map(|s| if *s > 1e-6 { 1.0 / s } else { 0.0 }).collect(),
        mean,
        direct,
        bank,
        timing: TimingModel { bias: 0.1, range: [-1.0, 1.0], input: vec![0.002; channels], states: timing_states },
        strength: [0.0, 1.5],
        gate: None,
        experts: None,
    };
    let provenance = Provenance { tool: "kinesic-firmware-sim".to_owned(), seed: SEED, ..Provenance::default() };
    model.pack(rig, &provenance)
}

/// Mean and deviation of each coordinate.
fn moments(motion: &Locals) -> (Vec<f64>, Vec<f64>) {
    let (channels, frames) = (3 * motion.rows, motion.frames() as f64);
    let mut mean = vec![0.0; channels];
    let mut square = vec![0.0; channels];
    for row in motion.coordinates.chunks_exact(channels) {
        for (channel, value) in row.iter().enumerate() {
            mean[channel] += value / frames;
            square[channel] += value * value / frames;
        }
    }
    let deviation = mean.iter().zip(&square).map(|(mean, square)| (square - mean * mean).max(0.0).sqrt()).collect();
    (mean, deviation)
}

/// The frames of a clip as the workload takes them.
pub fn numbers(rig: &Rig, clip: &Clip, joints: usize) -> Vec<Vec<f32>> {
    let pose = |pose: &kinesic::Pose<{ kinesic_host::rig::MAX_JOINTS }>| -> Vec<f32> {
        let rotations = pose.rotations.iter().take(joints).flat_map(|rotation| rotation.coords.iter().copied());
        pose.root.iter().copied().chain(rotations).collect()
    };
    rig.poses(clip).iter().map(pose).collect()
}
