//! Seeded, gait-like signals.

use faer::{Mat, MatRef};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Radians of a stride's phase in a frame: a stride lasts a little over a second at 60 frames a second.
const STRIDE: f64 = 0.09;

/// One channel: the first three harmonics of a stride whose pace drifts, a slow sway, and 5 % of noise.
#[derive(Debug)]
pub struct Channel {
    harmonics: [[f64; 2]; 3],
    sway: [f64; 2],
}

/// `count` channels.
pub fn channels(count: usize, seed: u64) -> Vec<Channel> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let channel = |_| Channel {
        harmonics: std::array::from_fn(|k| {
            [random.random_range(0.2..1.0) / (k + 1) as f64, random.random_range(0.0..std::f64::consts::TAU)]
        }),
        sway: [random.random_range(0.1..0.4), random.random_range(0.004..0.012)],
    };
    (0..count).map(channel).collect()
}

impl Channel {
    /// At a time on the gait's own clock, in frames.
    pub fn at(&self, time: f64) -> f64 {
        let phase = STRIDE * (time + 9.0 * (time / 411.0).sin());
        let strides: f64 = self
            .harmonics
            .iter()
            .enumerate()
            .map(|(k, [size, start])| size * ((k + 1) as f64 * phase + start).sin())
            .sum();
        strides + self.sway[0] * (self.sway[1] * time).sin()
    }
}

/// Row-major `[frames x channels]` on a clock, with noise.
pub fn rows(channels: &[Channel], frames: usize, clock: impl Fn(f64) -> f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut row = |frame: usize| -> Vec<f64> {
        let time = clock(frame as f64);
        channels.iter().map(|channel| channel.at(time) + random.random_range(-0.05..0.05)).collect()
    };
    (0..frames).flat_map(&mut row).collect()
}

/// Less the mean of every column.
pub fn centred(rows: MatRef<'_, f64>) -> Mat<f64> {
    let mut centred = rows.to_owned();
    for column in centred.col_iter_mut() {
        let mean = column.sum() / column.nrows().max(1) as f64;
        column.iter_mut().for_each(|x| *x -= mean);
    }
    centred
}
