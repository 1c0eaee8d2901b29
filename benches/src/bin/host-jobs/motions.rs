//! Made motions whose strength is known: 13 keyframes of 20 joints' positions and velocities.

use faer::{Mat, MatRef};
use kinesic_benches::synthetic::centred;
use kinesic_host::components::pca;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

pub const KEYFRAMES: usize = 13;
/// Positions and velocities of 20 joints.
pub const CHANNELS: usize = 120;
/// Principal components of a keyframe, as in the paper.
pub const COMPONENTS: usize = 40;

/// What motions differ in beside their strength: style, pace, person.
const MANNERS: usize = 60;
/// Deviation of a judge who says how strong a motion is; strengths go from -2 to 2.
const JUDGE: f64 = 0.6;

/// Motions, their true strengths, and what a judge said.
pub struct Motions {
    /// Row-major `[motions x keyframes x channels]`.
    pub values: Vec<f64>,
    pub judged: Vec<f64>,
}

/// Seeded: the first `n` motions are the same however many are made.
pub fn made(count: usize) -> Motions {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let pattern = |size: f64, random: &mut ChaCha8Rng| -> Vec<f64> {
        let harmonic = random.random_range(0..4);
        let channels: Vec<[f64; 2]> = (0..CHANNELS)
            .map(|_| [size * random.random_range(-1.0..1.0), random.random_range(0.0..std::f64::consts::TAU)])
            .collect();
        let at = |k: usize| std::f64::consts::TAU * (harmonic * k) as f64 / KEYFRAMES as f64;
        (0..KEYFRAMES).flat_map(|k| channels.iter().map(move |[a, b]| a * (at(k) + b).sin())).collect()
    };
    let manners: Vec<Vec<f64>> = (0..MANNERS).map(|m| pattern(1.0 / (1.0 + m as f64).sqrt(), &mut random)).collect();
    // Strength shows in a straight direction and in one that saturates.
    let shown = [pattern(0.12, &mut random), pattern(0.08, &mut random)];
    let mut values = Vec::with_capacity(count * KEYFRAMES * CHANNELS);
    let mut judged = Vec::with_capacity(count);
    for _ in 0..count {
        let strength: f64 = random.random_range(-2.0..2.0);
        let mut motion: Vec<f64> = (0..KEYFRAMES * CHANNELS).map(|_| random.random_range(-0.1..0.1)).collect();
        let mut add = |size: f64, pattern: &[f64]| motion.iter_mut().zip(pattern).for_each(|(x, p)| *x += size * p);
        manners.iter().for_each(|pattern| add(random.random_range(-1.0..1.0), pattern));
        add(strength, &shown[0]);
        add((2.0 * strength).tanh(), &shown[1]);
        values.extend(motion);
        judged.push(strength + JUDGE * 3f64.sqrt() * random.random_range(-1.0..1.0));
    }
    Motions { values, judged }
}

impl Motions {
    /// Keyframes less their mean, one a row, `[motions keyframes x channels]`.
    pub fn keyframes(&self) -> Mat<f64> {
        centred(MatRef::from_row_major_slice(&self.values, self.values.len() / CHANNELS, CHANNELS))
    }

    /// The motions on the principal components of the keyframes of the first `fitted` motions: `[motions x 520]`, row-major.
    pub fn reduced(&self, fitted: usize) -> Vec<f64> {
        let keyframes = self.keyframes();
        let basis = pca(keyframes.subrows(0, fitted * KEYFRAMES), COMPONENTS).components;
        // The components carry their deviation; coordinates are wanted in the unit of the keyframes.
        let norm = |k: usize| basis.col(k).norm_l2().max(1e-12);
        let basis = Mat::from_fn(CHANNELS, COMPONENTS, |c, k| basis[(c, k)] / norm(k));
        let reduced = keyframes * basis;
        (0..reduced.nrows()).flat_map(|r| (0..COMPONENTS).map(move |k| (r, k))).map(|at| reduced[at]).collect()
    }
}
