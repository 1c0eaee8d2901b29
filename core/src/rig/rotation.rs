//! Rotation vectors: direction of the axis, length of the angle, rad.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::kernel::{sin_cos, sqrt};

/// `angle / sin(angle / 2)` in powers of `1 - cos(angle / 2)`, for angles up to half a turn. Error below 4e-7.
const LOG: [f32; 10] = [
    2.0,
    0.666_671_45,
    0.266_514_78,
    0.116_148_08,
    0.039_319_467,
    0.063_073_63,
    -0.072_187_975,
    0.107_036_56,
    -0.067_923_51,
    0.022_940_188,
];

/// Rotation vector of the shorter turn, 0..pi rad, of a quaternion of length one. Absolute error below 2e-6. Cost: 15 multiply-adds.
pub fn log(q: &UnitQuaternion<f32>) -> Vector3<f32> {
    let (w, v) = if q.w < 0.0 { (-q.w, -q.imag()) } else { (q.w, q.imag()) };
    let d = 1.0 - w;
    v * LOG.iter().rev().fold(0.0, |sum, c| sum * d + c)
}

/// The turn by `|v|` rad about `v`, for `|v|` up to 100. Cost: 25 multiply-adds, a root, a division.
pub fn exp(v: Vector3<f32>) -> UnitQuaternion<f32> {
    let angle = sqrt(v.dot(&v));
    let (sin, cos) = sin_cos(0.5 * angle);
    let ratio = if angle > 1e-4 { sin / angle } else { 0.5 };
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cos, v * ratio))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithm_and_exponential_are_inverse() {
        for step in 0..3_140 {
            let v = Vector3::new(0.48, -0.6, 0.64) * (step as f32 * 0.001);
            assert!((log(&exp(v)) - v).norm() < 2e-6, "{v}");
            let q = exp(v);
            assert!((q.norm() - 1.0).abs() < 1e-6);
            assert!((log(&UnitQuaternion::new_unchecked(-q.into_inner())) - v).norm() < 2e-6, "either sign: {v}");
        }
        assert_eq!(exp(Vector3::zeros()), UnitQuaternion::identity());
    }

    #[test]
    fn the_logarithm_is_that_of_double_precision() {
        for step in 1..1_000 {
            let angle = f64::from(step) * (core::f64::consts::PI / 1_000.0);
            let exact = nalgebra::UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 0.8, 0.6) * angle);
            let found = log(&exact.cast::<f32>());
            assert!((found.cast::<f64>() - exact.scaled_axis()).norm() < 2e-6, "{angle}");
        }
    }
}
