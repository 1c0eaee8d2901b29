//! A clip as a matrix: frames x channels, the mean frame removed, divided by one deviation.

use faer::Mat;

use crate::rig::{Locals, Rig};

/// Frames per second of a component model.
pub const FRAME_RATE: f64 = 60.0;

/// A standardised clip: `coordinate = mean + scale * values`, channel by channel.
///
/// Every coordinate is multiplied by its [lever](Rig::levers), so that a turn counts by how far it moves the body. Then all
/// are divided by one deviation, as in Neumann 2013: a small joint does not weigh as much as an arm. Phong 2018, section 3.1.
/// Travel of the root is left out: a style's components change how a body moves, the content says where it goes.
#[derive(Clone, Debug)]
pub struct Motion {
    /// `[frames x 3 rows]`, in deviations.
    pub values: Mat<f64>,
    /// Mean coordinates, rad or m, `[3 rows]`; 0 for travel.
    pub mean: Vec<f64>,
    /// Coordinates per deviation, rad or m, `[3 rows]`.
    pub scale: Vec<f64>,
    /// Deviation over all channels, m at the lever.
    pub deviation: f64,
}

impl Motion {
    /// A clip with its own mean and deviation. `locals` are those of `rig`.
    pub fn new(rig: &Rig, locals: &Locals) -> Self {
        // In metres.
        let metres = Self::scaled(rig, locals, 1.0);
        let count = (metres.frames() * metres.channels()).max(1) as f64;
        let deviation = (metres.values.squared_norm_l2() / count).sqrt();
        // A clip that stands still is all zeros, whatever it is divided by.
        Self::scaled(rig, locals, if deviation > 1e-9 { deviation } else { 1.0 })
    }

    /// A clip with its own mean, in another clip's deviations, so that amplitudes can be compared.
    pub fn scaled(rig: &Rig, locals: &Locals, deviation: f64) -> Self {
        let scale: Vec<f64> = rig.levers().iter().map(|lever| deviation / lever).collect();
        let channels = scale.len();
        let travels = rig.frames().travels();
        let travel = |c: usize| travels && (c == 0 || c == 2);
        let frames = locals.coordinates.len() / channels.max(1);
        let at = |f: usize, c: usize| if travel(c) { 0.0 } else { locals.coordinates[f * channels + c] };
        let mean: Vec<f64> =
            (0..channels).map(|c| (0..frames).map(|f| at(f, c)).sum::<f64>() / frames.max(1) as f64).collect();
        let value = |f: usize, c: usize| (at(f, c) - mean[c]) / scale[c];
        Self { values: Mat::from_fn(frames, channels, value), mean, scale, deviation }
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.values.nrows()
    }

    /// Three per row of coordinates.
    pub fn channels(&self) -> usize {
        self.values.ncols()
    }
}
