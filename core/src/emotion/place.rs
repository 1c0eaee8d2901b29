//! Where a motion is in the world: a point on the ground and a direction.

use nalgebra::Vector3;

use crate::pose::Heading;

/// A turn about the vertical, then a shift along the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Point on the ground that the motion's origin is at, m.
    pub ground: Vector3<f32>,
    /// Direction of the motion's +Z.
    pub heading: Heading,
}

impl Place {
    /// World position of a point of the motion.
    pub fn apply(&self, point: Vector3<f32>) -> Vector3<f32> {
        self.ground + self.heading.to_world(point)
    }

    /// The point of the motion at a world position.
    pub fn undo(&self, point: Vector3<f32>) -> Vector3<f32> {
        self.heading.to_local(point - self.ground)
    }

    /// The place `next`, which is given in this one's frame, in the world.
    pub fn then(&self, next: &Place) -> Self {
        let [sin, cos] = next.heading.turn_from(Heading::default());
        Self { ground: self.apply(next.ground), heading: self.heading.turned(sin, cos) }
    }
}

/// The part (0 to 1) of a turn.
pub(super) fn part_of(turn: Heading, part: f32) -> Heading {
    let [sin, cos] = turn.turn_from(Heading::default());
    Heading::default().turned(part * sin, 1.0 - part + part * cos)
}
