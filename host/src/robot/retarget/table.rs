//! A robot's motion as every other motion of a machine.

use super::Retargeted;
use crate::moves::{Channel, Moves, Unit};
use crate::robot::{Motion, Robot};

impl Retargeted {
    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.values.len().checked_div(self.joints.len()).unwrap_or(0)
    }

    /// One channel for every joint that leads: rad of a hinge, m of a slider.
    pub fn moves(&self, robot: &Robot) -> Moves {
        let channel = |at: &usize| {
            let joint = &robot.joints[*at];
            let unit = if joint.motion == Motion::Prismatic { Unit::Metres } else { Unit::Radians };
            Channel { name: joint.name.clone(), unit: Some(unit) }
        };
        let times = (0..self.frames()).map(|frame| frame as f64 * self.frame_time).collect();
        Moves::new(self.joints.iter().map(channel).collect(), times, self.values.clone())
    }
}
