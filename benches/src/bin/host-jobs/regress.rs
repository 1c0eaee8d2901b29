//! Strength -> 13 keyframes of 40 numbers: ten tanh units, 1,000 motions, tested on 1,000 more.

use std::error::Error;
use std::path::Path;

use kinesic_host::learn::{RegressOptions, Samples, regress};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use serde_json::{Value, json};

use kinesic_benches::measure::{peak_mib, timed, write};

const MOTIONS: f64 = 1000.0;
const OUTPUTS: usize = 520;
/// Deviation of what strength does not explain; the explained part is of size one.
const NOISE: f64 = 0.1;

pub fn run(folder: &Path, scale: f64) -> Result<Value, Box<dyn Error>> {
    let count = (MOTIONS * scale).round() as usize;
    let (strengths, values) = made(2 * count);
    write(folder, "strengths.f64", &strengths)?;
    write(folder, "values.f64", &values)?;
    let (s, s_test) = strengths.split_at(count);
    let (y, y_test) = values.split_at(count * OUTPUTS);
    let options = RegressOptions::default();
    let (seconds, found) = timed(|| regress(&Samples::new(s, 1), &Samples::new(y, OUTPUTS), &options));
    let peak = peak_mib();
    let square = |s: &f64, y: &[f64]| {
        found.network.apply(&[*s]).iter().zip(y).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / OUTPUTS as f64
    };
    let unseen = s_test.iter().zip(y_test.chunks_exact(OUTPUTS)).map(|(s, y)| square(s, y)).sum::<f64>() / count as f64;
    Ok(json!({
        "seconds": seconds, "peak_mib": peak, "objective": found.history.last(), "steps": found.history.len() - 1,
        "error": found.error.powi(2), "unseen": unseen, "motions": count, "outputs": OUTPUTS, "noise": NOISE,
        "hidden": options.hidden, "ridge": options.ridge, "decay": options.decay,
    }))
}

/// Strengths, and a curve over them in 520 dimensions: straight, saturating, and bent, with noise.
fn made(count: usize) -> (Vec<f64>, Vec<f64>) {
    let mut random = ChaCha8Rng::seed_from_u64(13);
    let ways: Vec<[f64; 6]> = (0..OUTPUTS).map(|_| std::array::from_fn(|_| random.random_range(-0.8..0.8))).collect();
    let strengths: Vec<f64> = (0..count).map(|_| random.random_range(-3.0..3.0)).collect();
    let mut values = Vec::with_capacity(count * OUTPUTS);
    for s in &strengths {
        let bends = [*s / 2.0, (2.0 * s).tanh(), (s - 1.0).powi(2) / 4.0, (1.7 * s).sin(), 1.0 / (1.0 + s * s), 1.0];
        values.extend(ways.iter().map(|way| {
            let curve: f64 = way.iter().zip(bends).map(|(w, b)| w * b).sum();
            curve + NOISE * 3f64.sqrt() * random.random_range(-1.0..1.0)
        }));
    }
    (strengths, values)
}
