//! A vector under velocity and acceleration limits alone: the root's position, the rotation of a free joint.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::axis::{CATCH_UP, reach};
use crate::kernel::{quadrant_angle, sin_cos, sqrt};
use crate::pose::unit;

/// The step of a frame: `error` is the way to the target, `went` the last step, `left` the error after it. The norms of the step
/// and of its change are limited. Cost: about 60 multiply-adds, five roots.
pub(super) fn advance(
    error: Vector3<f32>,
    went: Vector3<f32>,
    left: Vector3<f32>,
    speed: f32,
    change: f32,
) -> Vector3<f32> {
    let far = norm(left);
    let behind = if far > 1e-9 { left * (reach(far, CATCH_UP * change) / far) } else { left };
    let wanted = within(within(error - left, speed) + behind, speed);
    within(went + within(wanted - went, change), speed)
}

/// `v`, or as much of it as `length` allows.
pub(super) fn within(v: Vector3<f32>, length: f32) -> Vector3<f32> {
    let norm = norm(v);
    if norm > length { v * (length / norm) } else { v }
}

pub(super) fn norm(v: Vector3<f32>) -> f32 {
    sqrt(v.dot(&v))
}

/// Rotation vector of the shorter turn, 0..pi rad. Absolute error below 2e-6.
pub(super) fn log(q: &UnitQuaternion<f32>) -> Vector3<f32> {
    let (w, v) = if q.w < 0.0 { (-q.w, -q.imag()) } else { (q.w, q.imag()) };
    let sin = norm(v);
    // For small angles the ratio is 2.
    if sin > 1e-4 { v * (2.0 * quadrant_angle(sin, w, 1.0) / sin) } else { v * 2.0 }
}

/// The turn by `|v|` rad about `v`.
pub(super) fn exp(v: Vector3<f32>) -> UnitQuaternion<f32> {
    let angle = norm(v);
    let (sin, cos) = sin_cos(0.5 * angle);
    let ratio = if angle > 1e-4 { sin / angle } else { 0.5 };
    unit(Quaternion::from_parts(cos, v * ratio))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithm_and_exponential_are_inverse() {
        for step in 0..310 {
            let v = Vector3::new(0.48, -0.6, 0.64) * (step as f32 * 0.01);
            assert!((log(&exp(v)) - v).norm() < 1e-5, "{v}");
        }
        assert_eq!(exp(Vector3::zeros()), UnitQuaternion::identity());
    }
}
