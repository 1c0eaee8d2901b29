//! What a caller can choose.

use super::error::AlignError;

/// Whether the ends of both clips must match.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Ends {
    /// First frame matches first frame, last matches last.
    #[default]
    Closed,
    /// The head and the tail of either clip may stay unmatched: for walks that start at another phase of the gait.
    ///
    /// What is minimised is the cost divided by the number of covered frames of both clips, so leaving frames out only pays
    /// where they fit worse than the average. The price of an unmatched frame that follows from this is found on the first
    /// path (Dinkelbach's method for ratios) and then kept, so that the total cost cannot rise.
    Open {
        /// Largest part of a clip that may be left out at each of its ends, 0 to 0.5.
        max_fraction: f64,
    },
}

impl Ends {
    /// Frames of a clip that may be left out at each end.
    pub(super) fn slack(self, frames: usize) -> usize {
        match self {
            Ends::Closed => 0,
            // Never the whole clip: one frame is left between the two ends.
            Ends::Open { max_fraction } => ((frames as f64 * max_fraction) as usize).min(frames.saturating_sub(1) / 2),
        }
    }

    pub(super) fn check(self) -> Result<(), AlignError> {
        match self {
            Ends::Open { max_fraction } if !(0.0..=0.5).contains(&max_fraction) => {
                Err(AlignError::Setting { name: "ends.max_fraction", found: max_fraction, expected: "0 to 0.5" })
            }
            _ => Ok(()),
        }
    }
}

/// Weights of the squared first and second differences along time: `F` and `G` of the energy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoothness {
    /// Weight of `(x[t+1] - x[t])^2`.
    pub first: f64,
    /// Weight of `(x[t+1] - 2 x[t] + x[t-1])^2`.
    pub second: f64,
}

impl Smoothness {
    /// Weights that let changes slower than `frames` per cycle through, for data of unit deviation.
    ///
    /// A penalty `w |D x|^2` halves what has frequency `w^(-1/2)` rad/frame, `w |D^2 x|^2` what has `w^(-1/4)`.
    pub fn period(frames: f64) -> Self {
        let per_rad = frames / std::f64::consts::TAU;
        Self { first: per_rad.powi(2), second: per_rad.powi(4) }
    }
}

/// How the best time warp is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Search {
    /// Start at reduced frame rate, then search a corridor around the previous path; the corridor widens where the path
    /// touches its edge, and becomes the full search at last.
    Corridor {
        /// Frames on either side of the previous path; the first search takes four times as many, the second twice.
        radius: usize,
    },
    /// Every cell in every iteration.
    Full,
}

/// Settings of [`align`](super::align).
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Closed by default.
    pub ends: Ends,
    /// Smoothness of the scale `a`; [`Smoothness::period`] of 240 frames by default.
    pub scale: Smoothness,
    /// Smoothness of the offset `b`; [`Smoothness::period`] of 240 frames by default.
    pub offset: Smoothness,
    /// Weight of `|a - 1|^2 + |b|^2` (1e-4): makes channels solvable that do not move. In units of a channel's variance.
    pub ridge: f64,
    /// The local speed may be this many times faster or slower than the ratio of the lengths: 3, range 1 to 16.
    ///
    /// Steps are whole frames, so that a source frame can always be doubled or left out.
    pub max_stretch: f64,
    /// Weight of `ln(local speed / average speed)^2` for each step, in variances of a frame (1e-3): settles the timing
    /// where both clips stand still.
    pub timing: f64,
    /// Bring every channel of both clips to zero mean and unit deviation first (default). A channel that moves less than
    /// a tenth of the average is not blown up further than that tenth. The smoothness weights mean what they say only then.
    pub standardise: bool,
    /// Iterations (a time step and a space step each) at most: 20.
    pub max_iterations: usize,
    /// Stop when an iteration lowers the cost by less than this part of it: 1e-4. With zero only a path that no longer
    /// changes ends the iteration early.
    pub tolerance: f64,
    /// Corridor of 32 frames by default.
    pub search: Search,
    /// Half-width in frames of the triangular kernel that takes the staircase out of the timing (4); 0 leaves it raw.
    pub clock_smoothing: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            ends: Ends::Closed,
            scale: Smoothness::period(240.0),
            offset: Smoothness::period(240.0),
            ridge: 1e-4,
            max_stretch: 3.0,
            timing: 1e-3,
            standardise: true,
            max_iterations: 20,
            tolerance: 1e-4,
            search: Search::Corridor { radius: 32 },
            clock_smoothing: 4,
        }
    }
}

impl Settings {
    pub(super) fn check(&self) -> Result<(), AlignError> {
        self.ends.check()?;
        let fields = [
            ("scale.first", self.scale.first, 0.0, 1e12, "0 to 1e12"),
            ("scale.second", self.scale.second, 0.0, 1e12, "0 to 1e12"),
            ("offset.first", self.offset.first, 0.0, 1e12, "0 to 1e12"),
            ("offset.second", self.offset.second, 0.0, 1e12, "0 to 1e12"),
            ("ridge", self.ridge, 1e-12, 1e12, "1e-12 to 1e12"),
            ("max_stretch", self.max_stretch, 1.0, 16.0, "1 to 16"),
            ("timing", self.timing, 0.0, 1e6, "0 to 1e6"),
            ("tolerance", self.tolerance, 0.0, 1.0, "0 to 1"),
            ("max_iterations", self.max_iterations as f64, 1.0, 1e6, "1 to 1,000,000"),
        ];
        for (name, found, low, high, expected) in fields {
            if !(low..=high).contains(&found) {
                return Err(AlignError::Setting { name, found, expected });
            }
        }
        Ok(())
    }
}
