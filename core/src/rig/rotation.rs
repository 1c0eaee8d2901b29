//! Rotation vectors: direction of the axis, length of the angle, rad.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::kernel::{sin_cos, sqrt};
use crate::pose::unit;

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

/// `sin(x) / x` and `cos(x)` in powers of `x^2`: Taylor.
const SINC: [f32; 6] = [1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5_040.0, 1.0 / 362_880.0, -1.0 / 39_916_800.0];
const COS: [f32; 7] =
    [1.0, -1.0 / 2.0, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40_320.0, -1.0 / 3_628_800.0, 1.0 / 479_001_600.0];

/// Square of the half angle up to which the powers hold: a turn of 3.7 rad.
const SHORT: f32 = 3.4;

/// The turn by `|v|` rad about `v`, for `|v|` up to 100. Absolute error below 5e-7. Cost: 20 multiply-adds; beyond 3.7 rad a root and a
/// division more.
pub fn exp(v: Vector3<f32>) -> UnitQuaternion<f32> {
    let square = 0.25 * v.dot(&v);
    let (cos, ratio) = if square <= SHORT {
        let sum = |powers: &[f32]| powers.iter().rev().fold(0.0, |sum, c| sum * square + c);
        (sum(&COS), 0.5 * sum(&SINC))
    } else {
        let half = sqrt(square);
        let (sin, cos) = sin_cos(half);
        (cos, 0.5 * sin / half)
    };
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cos, v * ratio))
}

/// Squares of lengths so near to 1 are mended without a root.
const NEAR: f32 = 1e-3;

/// A quaternion of length one, to rounding. Cost: 10 multiply-adds; where the length is not nearly 1 a root and a division more.
pub fn renormalised(q: Quaternion<f32>) -> UnitQuaternion<f32> {
    let off = q.coords.dot(&q.coords) - 1.0;
    if off.abs() < NEAR {
        // (1 + off)^(-1/2)
        UnitQuaternion::new_unchecked(q * (1.0 + off * (0.375 * off - 0.5)))
    } else {
        unit(q)
    }
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
    fn the_exponential_is_that_of_double_precision() {
        for step in 0..2_000 {
            let v = Vector3::new(0.48, -0.6, 0.64) * (f64::from(step) * 0.005);
            let exact = nalgebra::UnitQuaternion::from_scaled_axis(v);
            let found = exp(v.cast()).into_inner().cast::<f64>();
            assert!((found - exact.into_inner()).norm() < 1e-6, "{v}");
        }
    }

    #[test]
    fn lengths_are_mended() {
        let q = exp(Vector3::new(0.3, -1.2, 0.8)).into_inner();
        for factor in [1.0, 0.9996, 1.0004, 0.96, 1.05, 0.5] {
            assert!((renormalised(q * factor).norm() - 1.0).abs() < 2e-7, "{factor}");
        }
        assert_eq!(renormalised(Quaternion::from_parts(0.0, Vector3::zeros())), UnitQuaternion::identity());
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
