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
    /// At the origin, facing +Z.
    pub const fn new() -> Self {
        Self { ground: Vector3::new(0.0, 0.0, 0.0), heading: Heading::FORWARD }
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    fn place(x: f32, z: f32, angle: f32) -> Place {
        let heading = Heading::default().turned(libm::sinf(angle), libm::cosf(angle));
        Place { ground: Vector3::new(x, 0.0, z), heading }
    }

    #[test]
    fn places_follow_each_other() {
        let (a, b) = (place(1.0, -2.0, 0.7), place(0.3, 0.9, -1.9));
        let point = Vector3::new(0.4, 1.1, -0.6);
        assert!((a.then(&b).apply(point) - a.apply(b.apply(point))).norm() < 1e-6);
        assert!((a.undo(a.apply(point)) - point).norm() < 1e-6);
    }

    #[test]
    fn a_part_of_a_turn_lies_between() {
        let turn = place(0.0, 0.0, 0.6).heading;
        assert_eq!(part_of(turn, 0.0), Heading::default());
        let [sin, cos] = part_of(turn, 1.0).turn_from(turn);
        assert!(sin.abs() < 1e-6 && cos > 0.999_999);
        let [sin, _] = part_of(turn, 0.5).turn_from(Heading::default());
        assert!((sin - libm::sinf(0.3)).abs() < 1e-3);
    }
}
