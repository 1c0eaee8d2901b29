//! The limits of one joint.

use kinesic::rig::JointKind;

use crate::rig::JointCoordinates;

/// Bound of the components of a free joint's rotation vector, rad: no rotation vector reaches it.
const FREE: f32 = 4.0;

/// What one joint may do. Lists have one entry per coordinate; entries past the joint's coordinates are 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimit {
    /// Which coordinates the joint has.
    pub coordinates: JointCoordinates,
    /// Least coordinates, rad or m.
    pub lower: [f32; 3],
    /// Greatest coordinates, rad or m.
    pub upper: [f32; 3],
    /// Largest speeds, rad/s or m/s.
    pub velocity: [f32; 3],
    /// Largest accelerations, rad/s^2 or m/s^2.
    pub acceleration: [f32; 3],
    /// Largest jerks, rad/s^3 or m/s^3; 0 for no limit.
    pub jerk: [f32; 3],
    /// Coordinates at rest, rad or m.
    pub rest: [f32; 3],
}

impl JointLimit {
    /// A ball without position limits; the rates hold for each component of its rotation vector.
    pub fn free(velocity: f32, acceleration: f32) -> Self {
        Self {
            coordinates: JointCoordinates::new(JointKind::Ball),
            lower: [-FREE; 3],
            upper: [FREE; 3],
            velocity: [velocity; 3],
            acceleration: [acceleration; 3],
            jerk: [0.0; 3],
            rest: [0.0; 3],
        }
    }

    /// A joint without coordinates.
    pub fn fixed() -> Self {
        Self { coordinates: JointCoordinates::new(JointKind::Fixed), ..Self::free(0.0, 0.0) }.within([0.0; 3], [0.0; 3])
    }

    /// One servo about `axis` (length one); it rests at zero, or at the bound nearest to it.
    pub fn hinge(axis: [f32; 3], [lower, upper]: [f32; 2], velocity: f32, acceleration: f32) -> Self {
        let coordinates =
            JointCoordinates { axes: [axis, [0.0; 3], [0.0; 3]], ..JointCoordinates::new(JointKind::Hinge) };
        Self { coordinates, ..Self::free(velocity, acceleration) }.within([lower, 0.0, 0.0], [upper, 0.0, 0.0])
    }

    /// Three servos in order, at right angles.
    pub fn chain(axes: [[f32; 3]; 3], lower: [f32; 3], upper: [f32; 3], velocity: f32, acceleration: f32) -> Self {
        let coordinates = JointCoordinates { axes, ..JointCoordinates::new(JointKind::Chain) };
        Self { coordinates, ..Self::free(velocity, acceleration) }.within(lower, upper)
    }

    /// A box of rotation vectors about the reference, along the joint's own axes.
    pub fn ball(lower: [f32; 3], upper: [f32; 3], velocity: f32, acceleration: f32) -> Self {
        Self::free(velocity, acceleration).within(lower, upper)
    }

    /// The same joint with these position limits, at rest at zero or at the bound nearest to it. Angles of hinges and chains are
    /// counted from the middle of their range. What the joint does not have becomes 0.
    pub fn within(mut self, lower: [f32; 3], upper: [f32; 3]) -> Self {
        if matches!(self.coordinates.kind, JointKind::Hinge | JointKind::Chain) {
            self.coordinates.middle = std::array::from_fn(|axis| 0.5 * (lower[axis] + upper[axis]));
        }
        let count = self.count();
        let own = |values: [f32; 3]| std::array::from_fn(|axis| if axis < count { values[axis] } else { 0.0 });
        Self {
            lower: own(lower),
            upper: own(upper),
            velocity: own(self.velocity),
            acceleration: own(self.acceleration),
            jerk: own(self.jerk),
            rest: own(std::array::from_fn(|axis| 0.0f32.max(lower[axis]).min(upper[axis]))),
            ..self
        }
    }

    /// The same joint with this jerk limit of every coordinate, rad/s^3 or m/s^3; 0 for none.
    pub fn with_jerk(self, jerk: f32) -> Self {
        let count = self.count();
        Self { jerk: std::array::from_fn(|axis| if axis < count { jerk } else { 0.0 }), ..self }
    }

    /// True for a ball whose bounds no rotation reaches.
    pub fn is_free(&self) -> bool {
        let wide = self.lower.iter().all(|x| *x <= -FREE) && self.upper.iter().all(|x| *x >= FREE);
        self.coordinates.kind == JointKind::Ball && wide
    }

    /// Number of coordinates.
    pub fn count(&self) -> usize {
        self.coordinates.kind.coordinates()
    }
}

/// What the height of a travelling root may do, m, m/s, m/s^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeightLimit {
    /// Least height.
    pub lower: f32,
    /// Greatest height.
    pub upper: f32,
    /// Largest speed.
    pub velocity: f32,
    /// Largest acceleration.
    pub acceleration: f32,
    /// Largest jerk, m/s^3; 0 for no limit.
    pub jerk: f32,
    /// Height at rest.
    pub rest: f32,
}
