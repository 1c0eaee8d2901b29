//! Euler angles of the writer: Z, then X, then Y (`R = Rz Rx Ry`), exact also at gimbal lock.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

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

/// Rotation by `degrees` about axis 0 (X), 1 (Y) or 2 (Z).
pub(super) fn about_axis(axis: usize, degrees: f64) -> UnitQuaternion<f64> {
    let (sin, cos) = (degrees.to_radians() / 2.0).sin_cos();
    let mut v = Vector3::zeros();
    if let Some(component) = v.get_mut(axis) {
        *component = sin;
    }
    UnitQuaternion::new_unchecked(nalgebra::Quaternion::from_parts(cos, v))
}
