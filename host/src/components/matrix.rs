//! A clip as a matrix: frames x channels, the mean pose removed, divided by one deviation.

use faer::Mat;

use crate::rig::Locals;

/// Frames per second of a component model.
pub const FRAME_RATE: f64 = 60.0;

/// A standardised clip: `position = mean + scale * values`.
///
/// One deviation for all channels, as in Neumann 2013: bones keep their proportions, and a small joint does not weigh as
/// much as an arm. Phong 2018, section 3.1.
#[derive(Clone, Debug)]
pub struct Motion {
    /// `[frames x 3 joints]`, in deviations.
    pub values: Mat<f64>,
    /// Mean pose, m, `[3 joints]`.
    pub mean: Vec<f64>,
    /// Deviation over all channels, m.
    pub scale: f64,
}

impl Motion {
    /// A clip with its own mean and deviation.
    pub fn new(locals: &Locals) -> Self {
        let mean = mean(locals);
        let channels = locals.channels();
        let squares: f64 = locals
            .positions
            .chunks_exact(channels)
            .flat_map(|row| row.iter().zip(&mean))
            .map(|(x, m)| (x - m).powi(2))
            .sum();
        let scale = (squares / locals.positions.len().max(1) as f64).sqrt();
        // A clip that stands still is all zeros, whatever it is divided by.
        Self::scaled(locals, if scale > 1e-9 { scale } else { 1.0 })
    }

    /// A clip with its own mean, in another clip's deviations, so that amplitudes can be compared.
    pub fn scaled(locals: &Locals, scale: f64) -> Self {
        let mean = mean(locals);
        let channels = locals.channels();
        let value = |f: usize, c: usize| (locals.positions[f * channels + c] - mean[c]) / scale;
        Self { values: Mat::from_fn(locals.frames(), channels, value), mean, scale }
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.values.nrows()
    }

    /// Three a joint.
    pub fn channels(&self) -> usize {
        self.values.ncols()
    }
}

fn mean(locals: &Locals) -> Vec<f64> {
    let mut mean = vec![0.0; locals.channels()];
    for row in locals.positions.chunks_exact(locals.channels()) {
        mean.iter_mut().zip(row).for_each(|(m, x)| *m += x);
    }
    mean.iter_mut().for_each(|m| *m /= locals.frames().max(1) as f64);
    mean
}
