//! Identification of a state-space model: 3 inputs, 3 outputs.

use std::error::Error;
use std::path::{Path, PathBuf};

use faer::{Mat, MatRef};
use kinesic_host::align::{AlignError, Series, Settings, align};
use kinesic_host::prepare::Source;
use kinesic_host::rig::Locals;
use kinesic_host::translate::Dynamics;
use kinesic_host::translate::identify::identify;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use serde_json::{Value, json};

use kinesic_benches::measure::{peak_mib, timed, write};
use kinesic_benches::synthetic;

const ORDER: usize = 40;
const FRAMES: f64 = 6000.0;
const FRAME_RATE: f64 = 60.0;
/// Pairs of poles of the made system.
const POLES: usize = 8;
/// Noise of the made system's outputs, in their deviations.
const NOISE: f64 = 0.08;
/// Frames in which a simulation may settle before it is judged.
const SETTLE: usize = 60;

/// A made system driven by gait-like channels and noise.
pub fn made(folder: &Path, scale: f64) -> Result<Value, Box<dyn Error>> {
    let frames = (FRAMES * scale).round() as usize;
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut uniform = |size: f64| random.random_range(-size..size);
    let system = Dynamics {
        transition: (0..POLES)
            .map(|k| {
                let (radius, angle) = (0.75 + 0.02 * k as f64, 0.06 * (k + 1) as f64 + uniform(0.03));
                let (re, im) = (radius * angle.cos(), radius * angle.sin());
                [re, -im, im, re]
            })
            .collect(),
        input: (0..6 * POLES).map(|_| uniform(1.0)).collect(),
        inputs: 3,
    };
    let output = Mat::from_fn(3, 2 * POLES, |_, _| uniform(1.0));
    let total = 2 * frames;
    let channels = synthetic::channels(3, 6);
    let rows = synthetic::rows(&channels, total, |t| t, 7);
    let u = Mat::from_fn(total, 3, |t, c| rows[3 * t + c] + uniform(0.5));
    let clean = system.states_before(&u) * output.transpose();
    let deviation = (clean.squared_norm_l2() / (3 * total) as f64).sqrt();
    // Uniform noise of the wanted deviation.
    let y = Mat::from_fn(total, 3, |t, c| clean[(t, c)] / deviation + uniform(NOISE * 3f64.sqrt()));
    run(folder, &u, &y, frames)
}

/// Styles of the recorded pairs.
const STYLES: [&str; 6] = ["active", "elderly", "exhausted", "feminine", "masculine", "youthful"];

/// Recorded pairs: the left foot of a neutral walk, and of each styled one on its clock; learned on the first half, tested on the
/// second. The inputs go into a folder a style.
pub fn recorded(folder: &Path) -> Result<Value, Box<dyn Error>> {
    let data = std::env::var_os("KINESIC_DATA").map_or_else(|| PathBuf::from("../shared/data"), PathBuf::from);
    let read = |style: &str| Source::read(&data.join(format!("bandai2/walk_{style}_004.bvh")), &Default::default());
    let neutral = read("normal")?;
    let rig = neutral.rig()?;
    let joint = rig.skeleton.find("Foot_L").ok_or("no Foot_L")?;
    let locals = |source: &Source| -> Result<Locals, Box<dyn Error>> {
        Ok(rig.locals(&rig.poses(&source.on_rig(&rig, FRAME_RATE)?)))
    };
    let neutral = locals(&neutral)?;
    let mut pairs = serde_json::Map::new();
    for style in STYLES {
        let styled = locals(&read(style)?)?;
        let (from, to) = (series(&neutral)?, series(&styled)?);
        let on_clock = align(from, to, &Settings::default())?.apply(to)?;
        let of = |positions: &[f64]| standard(positions, neutral.channels(), joint);
        let (u, y) = (of(&neutral.positions), of(&on_clock));
        pairs.insert(style.into(), run(&folder.join(style), &u, &y, u.nrows() / 2)?);
    }
    Ok(pairs.into())
}

fn series(locals: &Locals) -> Result<Series<'_>, AlignError> {
    Series::new(&locals.positions, locals.channels())
}

/// A joint's channels less their mean, in deviations.
fn standard(positions: &[f64], channels: usize, joint: usize) -> Mat<f64> {
    let frames = positions.len() / channels;
    let at = |t: usize, d: usize| positions[t * channels + 3 * joint + d];
    let mean: [f64; 3] = std::array::from_fn(|d| (0..frames).map(|t| at(t, d)).sum::<f64>() / frames as f64);
    let centred = Mat::from_fn(frames, 3, |t, d| at(t, d) - mean[d]);
    let deviation = (centred.squared_norm_l2() / (3 * frames) as f64).sqrt();
    centred * faer::Scale(1.0 / deviation)
}

fn run(folder: &Path, u: &Mat<f64>, y: &Mat<f64>, frames: usize) -> Result<Value, Box<dyn Error>> {
    let numbers = |m: MatRef<'_, f64>| -> Vec<f64> {
        (0..m.nrows()).flat_map(|t| (0..m.ncols()).map(move |c| (t, c))).map(|at| m[at]).collect()
    };
    write(folder, "u.f64", &numbers(u.as_ref()))?;
    write(folder, "y.f64", &numbers(y.as_ref()))?;
    let train = |m: &Mat<f64>| vec![m.subrows(0, frames).to_owned()];
    let covered = 0..frames;
    let (inputs, outputs, covered) = (train(u), train(y), [covered]);
    let (seconds, model) = timed(|| identify(&inputs, &outputs, &covered, ORDER, FRAME_RATE));
    let peak = peak_mib();
    let model = model.ok_or("nothing identified")?;
    let (simulated, radius) = (model.simulate(&u.subrows(frames, u.nrows() - frames).to_owned()), model.radius());
    let test = y.subrows(frames, y.nrows() - frames);
    Ok(json!({
        "seconds": seconds, "peak_mib": peak, "fit": fit(test, simulated.as_ref()), "radius": radius,
        "order": ORDER, "frames": frames, "settle": SETTLE,
    }))
}

/// `100 (1 - |y - found| / |y - mean|)` of unseen frames, %, mean over the outputs.
fn fit(y: MatRef<'_, f64>, found: MatRef<'_, f64>) -> f64 {
    let share = |c: usize| {
        let (y, found) = (y.col(c), found.col(c));
        let of = |t: usize| (y[t], found[t]);
        let mean = (SETTLE..y.nrows()).map(|t| y[t]).sum::<f64>() / (y.nrows() - SETTLE) as f64;
        let [error, spread] = (SETTLE..y.nrows())
            .map(of)
            .fold([0.0; 2], |[error, spread], (y, found)| [error + (y - found).powi(2), spread + (y - mean).powi(2)]);
        100.0 * (1.0 - (error / spread).sqrt())
    };
    (0..y.ncols()).map(share).sum::<f64>() / y.ncols() as f64
}
