//! Made clips for the tests of the alignment. Seeded: the same on every machine.
#![allow(dead_code, missing_docs, reason = "each test file uses a part")]

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

/// A gait-like motion: every channel a sum of three harmonics of a common stride (36 frames) and a slow drift.
pub struct Gait {
    channels: Vec<[f64; 7]>,
    rng: ChaCha8Rng,
}

impl Gait {
    pub fn new(channels: usize, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let channels = (0..channels)
            .map(|_| std::array::from_fn(|k| rng.random_range(0.0..if k < 4 { std::f64::consts::TAU } else { 1.0 })))
            .collect();
        Self { channels, rng }
    }

    /// Channels at time `t` (source frames), in arbitrary units around 10.
    fn at(&self, t: f64) -> impl Iterator<Item = f64> {
        self.channels.iter().map(move |c| {
            let stride = t * std::f64::consts::TAU / 36.0;
            let drift = (t / (90.0 + 60.0 * c[6]) + c[3]).sin();
            10.0 + (stride + c[0]).sin()
                + c[4] * (2.0 * stride + c[1]).sin()
                + c[5] * (3.0 * stride + c[2]).sin()
                + drift
        })
    }

    /// Frames at the given times, with uniform noise of the given half-width.
    pub fn clip(&mut self, times: impl Iterator<Item = f64>, noise: f64) -> Vec<f64> {
        let mut out: Vec<f64> = times.flat_map(|t| self.at(t).collect::<Vec<_>>()).collect();
        out.iter_mut().for_each(|v| *v += noise * self.rng.random_range(-1.0..1.0));
        out
    }

    /// Another manner: each channel scaled by 0.5 to 1.5, which swells slowly, and shifted.
    pub fn style(&mut self, clip: &mut [f64]) {
        let channels = self.channels.len();
        let manner: Vec<(f64, f64)> =
            (0..channels).map(|_| (self.rng.random_range(0.5..1.5), self.rng.random_range(-3.0..3.0))).collect();
        for (t, row) in clip.chunks_exact_mut(channels).enumerate() {
            for (v, (a, b)) in row.iter_mut().zip(&manner) {
                *v = 10.0 + (*v - 10.0) * a * (1.0 + 0.2 * (t as f64 / 150.0).sin()) + b;
            }
        }
    }
}

/// White noise, or a random walk.
pub fn noise(frames: usize, channels: usize, walk: bool, seed: u64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut out: Vec<f64> = (0..frames * channels).map(|_| rng.random_range(-1.0..1.0)).collect();
    if walk {
        (channels..out.len()).for_each(|k| out[k] += out[k - channels]);
    }
    out
}

/// The total costs of a warp, which must never rise.
pub fn assert_never_rises(warp: &kinesic_host::align::Warp) {
    let totals: Vec<f64> = warp.history().iter().map(|p| p.energy.total()).collect();
    assert!(totals.iter().all(|t| t.is_finite() && *t >= 0.0), "{totals:?}");
    // 1e-12: the parts are added in another order.
    assert!(totals.windows(2).all(|w| w[1] <= w[0] * (1.0 + 1e-12)), "cost rose: {totals:?}");
}
