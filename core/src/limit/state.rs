//! What a limiter remembers and reports.

use nalgebra::Vector3;

use super::axis::Coordinate;
use super::guard::{Fault, Guard};
use crate::pose::Pose;

/// How many joints a frame had that could not go where they were told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Clamped {
    /// Told to go beyond a position limit by more than 1e-5 rad.
    pub position: u16,
    /// Not there, by more than 1e-5 rad or m, for want of speed or acceleration; the root's position counts as a joint.
    pub rate: u16,
}

/// What happened to the last frame, and to all of them. Counts stop at their largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LimitReport {
    /// What was wrong with the last frame.
    pub fault: Option<Fault>,
    /// Frames since the last sound one.
    pub gap: u32,
    /// Joints clamped in the last frame.
    pub clamped: Clamped,
    /// Frames so far.
    pub frames: u32,
    /// Frames that were quarantined.
    pub faulty_frames: u32,
    /// Frames in which a joint was clamped.
    pub clamped_frames: u32,
    /// Joints clamped, all frames together; a joint that was clamped both ways counts once.
    pub clamped_joints: u32,
}

/// What a running limiter remembers: where every coordinate is and how fast it goes.
///
/// A new state is at rest, as the table says; [`Limiter::start`](super::Limiter::start) puts it where the robot is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitState<const JOINTS: usize> {
    pub(super) joints: [Joint; JOINTS],
    pub(super) root_went: Vector3<f32>,
    pub(super) root_left: Vector3<f32>,
    /// The last frame that went out.
    pub(super) pose: Pose<JOINTS>,
    pub(super) started: bool,
    pub(super) rooted: bool,
    pub(super) guard: Guard,
    pub(super) report: LimitReport,
}

/// Coordinates of a joint; of a free one, step and remainder as rotation vectors.
pub(super) type Joint = [Coordinate; 3];

const REST: Coordinate = Coordinate { at: 0.0, went: 0.0, left: 0.0 };

impl<const JOINTS: usize> LimitState<JOINTS> {
    /// At rest; the root's position is that of the first sound frame.
    pub fn new() -> Self {
        Self {
            joints: [[REST; 3]; JOINTS],
            root_went: Vector3::zeros(),
            root_left: Vector3::zeros(),
            pose: Pose::identity(),
            started: false,
            rooted: false,
            guard: Guard::default(),
            report: LimitReport::default(),
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

    /// The last frame that went out.
    pub fn pose(&self) -> &Pose<JOINTS> {
        &self.pose
    }

    /// Coordinates of a joint, rad: a hinge's servo angle first; hinges of a chain in order; of a ball the twist and two components of
    /// the swing. Zero for a free joint and past the last one.
    pub fn angles(&self, joint: usize) -> [f32; 3] {
        self.joints.get(joint).map_or([0.0; 3], |axes| axes.map(|x| x.at))
    }
}

impl<const JOINTS: usize> Default for LimitState<JOINTS> {
    fn default() -> Self {
        Self::new()
    }
}
