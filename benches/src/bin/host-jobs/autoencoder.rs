//! An epoch of the autoencoder.

use std::error::Error;
use std::path::Path;

use kinesic_host::mechanics::network::{Batch, Fit, Layer, Network, fit};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use serde_json::{Value, json};

use kinesic_benches::measure::{peak_mib, timed, write};
use kinesic_benches::synthetic;

const SAMPLES: f64 = 33_000.0;
const TESTED: usize = 3_000;
const WIDTH: usize = 120;
const HIDDEN: usize = 300;
const BATCH: usize = 128;
const RATE: f32 = 1e-3;

pub fn run(folder: &Path, scale: f64) -> Result<Value, Box<dyn Error>> {
    let samples = (SAMPLES * scale).round() as usize;
    let rows = synthetic::rows(&synthetic::channels(WIDTH, 1), samples + TESTED, |t| t, 2);
    let rows: Vec<f32> = rows.iter().map(|x| *x as f32).collect();
    let (data, test) = rows.split_at(samples * WIDTH);
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let start = Network {
        layers: vec![Layer::random(WIDTH, HIDDEN, true, &mut random), Layer::random(HIDDEN, WIDTH, false, &mut random)],
    };
    write(folder, "data.f32", data)?;
    write(folder, "test.f32", test)?;
    for (k, values) in start.parameters().enumerate() {
        write(folder, &format!("start-{k}.f32"), values)?;
    }
    let how = Fit { epochs: 1, batch: BATCH, rate: RATE, noise: 0.0, decay: 0.0 };
    let (seconds, network) = timed(|| {
        let mut network = start.clone();
        let mut random = ChaCha8Rng::seed_from_u64(4);
        fit(&mut network, Batch { input: data, target: data }, &how, &mut random, &|_, _| ());
        network
    });
    let peak = peak_mib();
    let found = network.apply(test);
    let error = found.iter().zip(test).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>() / test.len() as f64;
    Ok(json!({
        "seconds": seconds, "peak_mib": peak, "test_error": error,
        "samples": samples, "width": WIDTH, "hidden": HIDDEN, "batch": BATCH, "rate": RATE,
    }))
}
