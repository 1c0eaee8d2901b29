//! Euler angles of the writer: Z, then X, then Y (`R = Rz Rx Ry`), exact also at gimbal lock.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

/// Below this cosine of the middle angle, the first angle is free: the previous frame's is kept.
const LOCKED: f64 = 1e-9;

/// Angles `[z, x, y]` in radians with `Rz Rx Ry` equal to the rotation, as near as possible to the angles `near` (those of
/// the frame before), so that curves do not jump by whole turns.
///
/// The second and third angle are taken from the matrix *after* the first was undone, so an ill-determined first angle is
/// made good by the third: the product stays exact to rounding for every rotation.
pub fn zxy(rotation: &UnitQuaternion<f64>, near: [f64; 3]) -> [f64; 3] {
    let m = rotation.to_rotation_matrix().into_inner();
    let locked = m[(0, 1)].hypot(m[(1, 1)]) < LOCKED;
    let z = if locked { near[0] } else { (-m[(0, 1)]).atan2(m[(1, 1)]) };
    // Both solutions of the same rotation; the nearer one is taken.
    let one = rest(&m, z);
    let two = rest(&m, z + PI);
    let (one, two) = (unwind(one, near), unwind(two, near));
    if distance(one, near) <= distance(two, near) { one } else { two }
}

/// The other two angles, once the first is chosen.
fn rest(m: &Matrix3<f64>, z: f64) -> [f64; 3] {
    let (sin, cos) = z.sin_cos();
    // Rows 0 and 1 of Rz(-z) m, which is Rx Ry.
    let row = |c: usize| (cos * m[(0, c)] + sin * m[(1, c)], cos * m[(1, c)] - sin * m[(0, c)]);
    let x = m[(2, 1)].atan2(row(1).1);
    let y = row(2).0.atan2(row(0).0);
    [z, x, y]
}

fn unwind(angles: [f64; 3], near: [f64; 3]) -> [f64; 3] {
    let mut out = angles;
    for (angle, near) in out.iter_mut().zip(near) {
        *angle += TAU * ((near - *angle) / TAU).round();
    }
    out
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

/// Rotation about axis 0 (X), 1 (Y) or 2 (Z), by twice the angle of this sine and cosine.
fn about_axis(axis: usize, (sin, cos): (f64, f64)) -> UnitQuaternion<f64> {
    let mut v = Vector3::zeros();
    if let Some(component) = v.get_mut(axis) {
        *component = sin;
    }
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cos, v))
}

/// The rotation times one by `degrees` about axis 0 (X), 1 (Y) or 2 (Z), as [`about_axis`] makes it to the bit, with half of the products: the others are 0, and matter for the sign of a 0 alone.
pub(super) fn then_about_axis(rotation: &UnitQuaternion<f64>, axis: usize, degrees: f64) -> UnitQuaternion<f64> {
    let (s, c) = half(degrees);
    let [x, y, z, w] = rotation.coords.data.0[0];
    let product = match axis {
        0 => [w * s + x * c, y * c + z * s, z * c - y * s, w * c - x * s],
        1 => [x * c - z * s, w * s + y * c, x * s + z * c, w * c - y * s],
        _ => [x * c + y * s, y * c - x * s, w * s + z * c, w * c - z * s],
    };
    if product.contains(&0.0) {
        return rotation * about_axis(axis, (s, c));
    }
    UnitQuaternion::new_unchecked(Quaternion::from_vector(product.into()))
}

/// Sine and cosine of half an angle. Many channels are 0 throughout, and theirs are known.
fn half(degrees: f64) -> (f64, f64) {
    if degrees == 0.0 { (degrees, 1.0) } else { (degrees.to_radians() / 2.0).sin_cos() }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn bits(rotation: &UnitQuaternion<f64>) -> [u64; 4] {
        rotation.coords.data.0[0].map(f64::to_bits)
    }

    /// Angles as files have them: often 0, of both signs, and whole turns.
    fn angle() -> impl Strategy<Value = f64> {
        prop_oneof![
            Just(0.0),
            Just(-0.0),
            Just(180.0),
            Just(-90.0),
            Just(360.0),
            -400.0..400.0,
            -1e-300..1e-300,
            -1e300..1e300
        ]
    }

    proptest! {
        #[test]
        fn a_product_with_fewer_terms_has_the_same_bits(turns in prop::collection::vec((0usize..3, angle()), 1..5)) {
            let mut whole = UnitQuaternion::identity();
            let mut short = UnitQuaternion::identity();
            for (axis, degrees) in turns {
                whole *= about_axis(axis, half(degrees));
                short = then_about_axis(&short, axis, degrees);
                prop_assert_eq!(bits(&whole), bits(&short));
            }
        }
    }
}
