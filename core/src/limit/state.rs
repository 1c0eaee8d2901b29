//! What a limiter remembers and reports.

use super::axis::{Axis, Plain};
use super::smooth::Smooth;
use crate::pose::Heading;

/// Why a coordinate did not go where it was told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Clamped {
    /// Told to go beyond a position limit by more than 1e-5.
    pub position: bool,
    /// Not there, by more than 1e-5, for want of speed or acceleration.
    pub rate: bool,
}

impl Clamped {
    /// True if it went elsewhere.
    pub fn any(self) -> bool {
        self.position || self.rate
    }
}

/// What happened to the last frame, and to all of them. Counts stop at their largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LimitReport {
    /// Coordinates that the last frame told to go beyond a position limit.
    pub position: u16,
    /// Coordinates that were not where the last frame told them, for want of speed or acceleration; the root's travel counts as one,
    /// its heading as another.
    pub rate: u16,
    /// Frames without input since the last one with it.
    pub gap: u32,
    /// Frames in which a coordinate was clamped.
    pub clamped_frames: u32,
}

/// What a [`Limiter`](super::Limiter) remembers.
pub type LimitState<const ROWS: usize> = LimitStateOf<ROWS, Plain>;

/// What a [`SmoothLimiter`](super::SmoothLimiter) remembers; two to three times as much.
pub type SmoothLimitState<const ROWS: usize> = LimitStateOf<ROWS, Smooth>;

/// What a running limiter remembers: where every coordinate is and how fast it goes.
///
/// A new state is at rest, as the table says; [`Limiter::start`](super::LimiterOf::start) puts it where the robot is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitStateOf<const ROWS: usize, A> {
    pub(super) axes: [[A; 3]; ROWS],
    pub(super) clamped: [[Clamped; 3]; ROWS],
    /// Last step of the root over the ground, and what it was short of then, world, m.
    pub(super) root_step: [f32; 2],
    pub(super) root_error: [f32; 2],
    /// Where it is told to be against where the source stands, and where that stood, world, m.
    pub(super) aim: [f32; 2],
    pub(super) ground: Option<[f32; 2]>,
    /// Where the body faces, the last step of it, and what it was short of, rad.
    pub(super) heading: Option<Heading>,
    pub(super) heading_step: f32,
    pub(super) heading_error: f32,
    pub(super) started: bool,
    pub(super) report: LimitReport,
}

const FREE: Clamped = Clamped { position: false, rate: false };

impl<const ROWS: usize, A: Axis> LimitStateOf<ROWS, A> {
    /// At rest; the heading is that of the first frame.
    pub const fn new() -> Self {
        Self {
            axes: [[A::REST; 3]; ROWS],
            clamped: [[FREE; 3]; ROWS],
            root_step: [0.0; 2],
            root_error: [0.0; 2],
            aim: [0.0; 2],
            ground: None,
            heading: None,
            heading_step: 0.0,
            heading_error: 0.0,
            started: false,
            report: LimitReport { position: 0, rate: 0, gap: 0, clamped_frames: 0 },
        }
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        *self = Self::new();
    }

    /// What happened to the last frame, and to all of them.
    pub fn report(&self) -> &LimitReport {
        &self.report
    }

    /// Where a coordinate is, rad or m; `None` past the last row.
    pub fn coordinate(&self, index: usize) -> Option<f32> {
        self.axes.as_flattened().get(index).map(|axis| axis.at())
    }

    /// Why a coordinate is not where the last frame told it to be; `None` past the last row.
    pub fn clamped(&self, index: usize) -> Option<Clamped> {
        self.clamped.as_flattened().get(index).copied()
    }
}

impl<const ROWS: usize, A: Axis> Default for LimitStateOf<ROWS, A> {
    fn default() -> Self {
        Self::new()
    }
}
