//! Angle and power of a rotation, by short polynomials.

use nalgebra::{Quaternion, UnitQuaternion};

use crate::kernel::{quadrant_angle, sin_cos, sqrt};
use crate::pose::unit;

/// Largest exponent of [`power`]; larger ones are cut.
const LARGEST: f32 = 32.0;

/// Sine and cosine of half the angle, both >= 0, and the quaternion on that half of the sphere.
fn half(q: &UnitQuaternion<f32>) -> (f32, f32, Quaternion<f32>) {
    let q = if q.w < 0.0 { -q.into_inner() } else { q.into_inner() };
    (sqrt(q.i * q.i + q.j * q.j + q.k * q.k), q.w, q)
}

/// Angle of a rotation, 0..pi rad. Absolute error below 2e-6.
pub fn angle(q: &UnitQuaternion<f32>) -> f32 {
    let (sin, cos, _) = half(q);
    2.0 * quadrant_angle(sin, cos, 1.0)
}

/// `q^exponent`: the rotation about the same axis by `exponent` times the angle (that of the shorter arc). 0 gives the
/// identity, 1 gives `q` to rounding, -1 its inverse; exponents are cut at +-32, a NaN counts as 0. Cost: about 40 multiply-adds.
pub fn power(q: &UnitQuaternion<f32>, exponent: f32) -> UnitQuaternion<f32> {
    let exponent = if exponent.is_nan() { 0.0 } else { exponent.clamp(-LARGEST, LARGEST) };
    let (sin, cos, q) = half(q);
    let (sin_out, cos_out) = sin_cos(exponent * quadrant_angle(sin, cos, 1.0));
    // For small angles the ratio of the sines is the exponent.
    let ratio = if sin > 1e-6 { sin_out / sin } else { exponent };
    unit(Quaternion::new(cos_out, q.i * ratio, q.j * ratio, q.k * ratio))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    #[test]
    fn powers_are_multiples_of_the_rotation_vector() {
        for step in 0..200 {
            let turn = step as f32 * 0.0157;
            let axis = Vector3::new(0.3, -0.5, 0.8).normalize();
            let q = UnitQuaternion::from_scaled_axis(axis * turn);
            assert!((angle(&q) - turn).abs() < 3e-6);
            for exponent in [-1.0, 0.0, 0.5, 1.0, 2.5] {
                let expected = UnitQuaternion::from_scaled_axis(axis * (turn * exponent));
                let found = power(&q, exponent);
                assert!(found.coords.dot(&expected.coords).abs() > 1.0 - 1e-6, "{turn} x {exponent}");
            }
            assert_eq!(power(&q, 0.0), UnitQuaternion::identity());
        }
    }

    #[test]
    fn odd_exponents_stay_unit() {
        let q = UnitQuaternion::from_scaled_axis(Vector3::new(1.0, 2.0, 0.5));
        for exponent in [f32::NAN, f32::INFINITY, -1e30, 1e-30] {
            assert!((power(&q, exponent).norm() - 1.0).abs() < 1e-5);
        }
    }
}
