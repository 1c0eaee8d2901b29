//! Motion warping.

use std::error::Error;
use std::path::Path;

use kinesic_host::align::{Search, Series, Settings, align};
use serde_json::{Value, json};

use kinesic_benches::measure::{peak_mib, timed, write};
use kinesic_benches::synthetic;

const FRAMES: f64 = 1400.0;
const CHANNELS: usize = 60;
const ITERATIONS: usize = 10;

pub fn run(folder: &Path, scale: f64) -> Result<Value, Box<dyn Error>> {
    let frames = (FRAMES * scale).round() as usize;
    let channels = synthetic::channels(CHANNELS, 1);
    let u = synthetic::rows(&channels, frames, |t| t, 2);
    let later = |t: f64| t + 12.0 * (t / 180.0).sin() + 5.0 * (t / 47.0).sin();
    let mut v = synthetic::rows(&channels, frames, later, 3);
    for (k, v) in v.iter_mut().enumerate() {
        let channel = (k % CHANNELS) as f64;
        *v = *v * (1.0 + 0.3 * (0.7 * channel).sin()) + 0.3 * channel.cos();
    }
    write(folder, "u.f64", &u)?;
    write(folder, "v.f64", &v)?;
    let (u, v) = (Series::new(&u, CHANNELS)?, Series::new(&v, CHANNELS)?);
    let settings = Settings { max_iterations: ITERATIONS, tolerance: 0.0, ..Settings::default() };
    let (seconds, warp) = timed(|| align(u, v, &settings));
    let peak = peak_mib();
    let costs: Vec<f64> = warp?.history().iter().map(|step| step.energy.total()).collect();
    let full = align(u, v, &Settings { search: Search::Full, ..settings })?;
    let full = full.history().last().map_or(f64::NAN, |step| step.energy.total());
    let Settings { scale, offset, ridge, .. } = settings;
    Ok(json!({
        "seconds": seconds, "peak_mib": peak, "energy": costs.last(), "full_search_energy": full, "costs": costs,
        "frames": frames, "channels": CHANNELS, "iterations": ITERATIONS, "ridge": ridge,
        "scale": [scale.first, scale.second], "offset": [offset.first, offset.second],
    }))
}
