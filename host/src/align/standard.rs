//! Zero mean and unit deviation for each channel, and the layout of the space warp.

use super::banded::{LANES, Lane};
use super::series::Series;

/// A channel is divided by at least this part of the root mean square deviation of all channels: what hardly moves is noise.
const FLOOR: f64 = 0.1;

/// A clip as `[block of 4 channels][frame][4 channels]`, with the constants that lead back.
#[derive(Debug)]
pub(super) struct Standard {
    pub values: Vec<Lane>,
    pub frames: usize,
    pub channels: usize,
    pub mean: Vec<f64>,
    pub deviation: Vec<f64>,
}

impl Standard {
    /// O(frames x channels). Channels beyond the last up to a whole block are zero.
    pub fn new(series: Series<'_>, standardise: bool) -> Self {
        let (frames, channels) = (series.frames(), series.channels());
        let (mut mean, mut deviation) = (vec![0.0; channels], vec![1.0; channels]);
        if standardise {
            for row in series.rows() {
                for (m, &v) in mean.iter_mut().zip(row) {
                    *m += v / frames as f64;
                }
            }
            let mut variance = vec![0.0; channels];
            for row in series.rows() {
                for ((s, &v), &m) in variance.iter_mut().zip(row).zip(&mean) {
                    *s += (v - m).powi(2) / frames as f64;
                }
            }
            let overall = (variance.iter().sum::<f64>() / channels as f64).sqrt();
            // A clip that stands still in all channels is left at its own scale.
            let floor = if overall > 0.0 { FLOOR * overall } else { 1.0 };
            deviation = variance.iter().map(|v| v.sqrt().max(floor)).collect();
        }
        let mut values = vec![[0.0; LANES]; frames * channels.div_ceil(LANES)];
        for (t, row) in series.rows().enumerate() {
            for (c, ((&v, &m), &s)) in row.iter().zip(&mean).zip(&deviation).enumerate() {
                values[(c / LANES) * frames + t][c % LANES] = (v - m) / s;
            }
        }
        Self { values, frames, channels, mean, deviation }
    }

    /// All frames of a block.
    pub fn block(&self, block: usize) -> &[Lane] {
        &self.values[block * self.frames..(block + 1) * self.frames]
    }

    /// Blocks of four channels.
    pub fn blocks(&self) -> usize {
        self.channels.div_ceil(LANES)
    }

    /// Row-major f32 for the time warp; `map(block, frame, value)` is applied on the way.
    pub fn rows(&self, map: impl Fn(usize, usize, Lane) -> Lane) -> Vec<f32> {
        let mut out = vec![0.0; self.frames * self.channels];
        for block in 0..self.blocks() {
            for (t, (row, &v)) in out.chunks_exact_mut(self.channels).zip(self.block(block)).enumerate() {
                let mapped = map(block, t, v);
                for (to, &v) in row[block * LANES..].iter_mut().zip(&mapped) {
                    *to = v as f32;
                }
            }
        }
        out
    }
}
