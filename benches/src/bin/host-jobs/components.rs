//! Sparse components of a made motion, and style learning on them: how their cost grows. Their peers: `peers/components.py`.

use std::error::Error;

use faer::{Mat, MatRef};
use kinesic_benches::measure::{peak_mib, timed};
use kinesic_benches::synthetic;
use kinesic_host::components::{Objective, Optimiser, Sparsity, Weights, learn, noise, sparse};
use serde_json::{Value, json};

const FRAMES: f64 = 200.0;
const CHANNELS: usize = 69;
const COUNT: usize = 25;
const STEPS: usize = 500;

pub fn factorise(scale: f64) -> Result<Value, Box<dyn Error>> {
    let motion = motion(scale, 21);
    let (seconds, found) = timed(|| sparse(motion.as_ref(), COUNT, &Sparsity::default()));
    Ok(json!({
        "seconds": seconds, "peak_mib": peak_mib(), "frames": motion.nrows(), "density": found.factors.density(),
    }))
}

pub fn learn_style(scale: f64) -> Result<Value, Box<dyn Error>> {
    let [content, style] =
        [21, 23].map(|seed| sparse(motion(scale, seed).as_ref(), COUNT, &Sparsity::default()).factors);
    let objective = Objective::new(&content, &style, Weights::default());
    let how = Optimiser { max_steps: STEPS, threshold: -1.0, ..Optimiser::default() };
    let (seconds, learned) = timed(|| learn(&objective, noise(CHANNELS, COUNT, 1), &how));
    Ok(json!({
        "seconds": seconds, "peak_mib": peak_mib(), "frames": content.weights.nrows(), "steps": learned.history.len() - 1,
    }))
}

fn motion(scale: f64, seed: u64) -> Mat<f64> {
    let frames = (FRAMES * scale).round() as usize;
    let rows = synthetic::rows(&synthetic::channels(CHANNELS, seed), frames, |t| t, seed + 1);
    synthetic::centred(MatRef::from_row_major_slice(&rows, frames, CHANNELS))
}
