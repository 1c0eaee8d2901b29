//! A vector under velocity and acceleration limits alone: the root's way over the ground.

use nalgebra::Vector3;

use super::axis::{CATCH_UP, reach};
use crate::kernel::sqrt;

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
