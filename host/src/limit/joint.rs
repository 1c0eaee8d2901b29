//! The limits of one joint.

use kinesic::limit::{JointKind, LimitTable};

const UPRIGHT: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// One row of a [`LimitTable`]; its fields say what they mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimit {
    /// Which coordinates the joint has.
    pub kind: JointKind,
    /// Axes in the frame of `neutral`.
    pub axes: [[f32; 3]; 3],
    /// Local rotation `[i, j, k, w]` where the coordinates are zero.
    pub neutral: [f32; 4],
    /// Least coordinates, rad.
    pub lower: [f32; 3],
    /// Greatest coordinates, rad.
    pub upper: [f32; 3],
    /// Largest speeds, rad/s.
    pub velocity: [f32; 3],
    /// Largest accelerations, rad/s^2.
    pub acceleration: [f32; 3],
    /// Coordinates at rest, rad.
    pub rest: [f32; 3],
}

impl JointLimit {
    /// No position limits; rates of the whole angular velocity.
    pub fn free(velocity: f32, acceleration: f32) -> Self {
        Self {
            kind: JointKind::Free,
            axes: UPRIGHT,
            neutral: [0.0, 0.0, 0.0, 1.0],
            lower: [0.0; 3],
            upper: [0.0; 3],
            velocity: [velocity; 3],
            acceleration: [acceleration; 3],
            rest: [0.0; 3],
        }
    }

    /// One servo about `axis` (length one); it rests at zero, or at the bound nearest to it.
    pub fn hinge(axis: [f32; 3], [lower, upper]: [f32; 2], velocity: f32, acceleration: f32) -> Self {
        Self { kind: JointKind::Hinge, axes: [axis, [0.0; 3], [0.0; 3]], ..Self::free(velocity, acceleration) }
            .within([lower, 0.0, 0.0], [upper, 0.0, 0.0])
    }

    /// Three servos in order, at right angles.
    pub fn chain(axes: [[f32; 3]; 3], lower: [f32; 3], upper: [f32; 3], velocity: f32, acceleration: f32) -> Self {
        Self { kind: JointKind::Chain, axes, ..Self::free(velocity, acceleration) }.within(lower, upper)
    }

    /// Twist about the first axis, swing about the other two.
    pub fn ball(axes: [[f32; 3]; 3], lower: [f32; 3], upper: [f32; 3], velocity: f32, acceleration: f32) -> Self {
        Self { kind: JointKind::Ball, axes, ..Self::free(velocity, acceleration) }.within(lower, upper)
    }

    /// The same joint with these position limits, at rest at zero or at the bound nearest to it.
    pub fn within(self, lower: [f32; 3], upper: [f32; 3]) -> Self {
        Self { lower, upper, rest: std::array::from_fn(|axis| 0.0f32.max(lower[axis]).min(upper[axis])), ..self }
    }
}

/// The rows of a table.
pub(super) fn rows(table: &LimitTable) -> Vec<JointLimit> {
    let row = |joint: usize| JointLimit {
        kind: JointKind::from_code(table.kinds[joint]).unwrap_or(JointKind::Free),
        axes: table.axes[joint],
        neutral: table.neutral[joint],
        lower: table.lower[joint],
        upper: table.upper[joint],
        velocity: table.velocity[joint],
        acceleration: table.acceleration[joint],
        rest: table.rest[joint],
    };
    (0..table.kinds.len()).map(row).collect()
}
