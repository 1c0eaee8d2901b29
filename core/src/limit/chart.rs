//! A joint's rotation as up to three coordinates, and back.
//!
//! In the joint's own axes `(w, x, y, z)` is the rotation from neutral: `x`, `y`, `z` along the three axes. A left-handed triple is
//! taken as a right-handed one whose third axis, and third coordinate, is turned round. Formulas are homogeneous: quaternions need
//! not be of length one.

use core::f32::consts::{PI, TAU};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::model::JointKind;
use crate::kernel::{quadrant_angle, sin_cos, sqrt};
use crate::pose::unit;

/// Below this share of its length a direction is no direction.
const SMALL: f32 = 1e-6;

/// Rotation from neutral in the joint's axes, and the handedness of the axes.
pub(super) struct Frame {
    axes: [Vector3<f32>; 3],
    hand: f32,
}

impl Frame {
    pub fn new(axes: &[[f32; 3]; 3]) -> Self {
        let [a, b, c] = axes.map(Vector3::from);
        let hand = if a.cross(&b).dot(&c) < 0.0 { -1.0 } else { 1.0 };
        Self { axes: [a, b, c * hand], hand }
    }

    fn components(&self, q: &UnitQuaternion<f32>) -> [f32; 4] {
        let [a, b, c] = &self.axes;
        let v = q.imag();
        [q.w, v.dot(a), v.dot(b), v.dot(c)]
    }

    fn rotation(&self, [w, x, y, z]: [f32; 4]) -> UnitQuaternion<f32> {
        let [a, b, c] = &self.axes;
        unit(Quaternion::from_parts(w, a * x + b * y + c * z))
    }

    /// Coordinates of the rotation `q` from neutral, each the representative nearest to the middle of its range. Where a rotation
    /// leaves a coordinate open (gimbal lock, a swing by half a turn) it stays `at`. Of a hinge's or a chain's rotation what its
    /// axes cannot do is left out. Cost: up to 120 multiply-adds, ten roots.
    pub fn coordinates(
        &self,
        kind: JointKind,
        q: &UnitQuaternion<f32>,
        at: [f32; 3],
        [lower, upper]: [&[f32; 3]; 2],
    ) -> [f32; 3] {
        let [at0, at1, at2] = at;
        let q = self.components(q);
        let turned = |[a, b, c]: [f32; 3]| {
            let mut out = [a, b, self.hand * c];
            for ((x, low), high) in out.iter_mut().zip(lower).zip(upper) {
                *x = nearest(*x, 0.5 * (low + high));
            }
            out
        };
        match kind {
            JointKind::Free => [0.0; 3],
            JointKind::Hinge => turned([twist(&q).unwrap_or(at0), 0.0, 0.0]),
            JointKind::Ball => {
                let [twist, y, z] = swing_twist(q, at0);
                turned([twist, y, z])
            }
            JointKind::Chain => {
                let [a, b, c] = chain(q, [at0, at1, self.hand * at2]);
                let first = turned([a, b, c]);
                // The other way to the same rotation.
                let second = turned([a + PI, PI - b, c + PI]);
                let cost = |x: &[f32; 3]| -> f32 {
                    let each = x.iter().zip(at).zip(lower.iter().zip(upper));
                    each.map(|((x, at), (low, high))| (x - at).abs() + 4.0 * (low - x).max(x - high).max(0.0)).sum()
                };
                if cost(&second) < cost(&first) { second } else { first }
            }
        }
    }

    /// The rotation from neutral with these coordinates. Cost: up to 90 multiply-adds, two roots.
    pub fn compose(&self, kind: JointKind, [a, b, c]: [f32; 3]) -> UnitQuaternion<f32> {
        let (s, t) = sin_cos(0.5 * a);
        let c = self.hand * c;
        match kind {
            JointKind::Free => UnitQuaternion::identity(),
            JointKind::Hinge => self.rotation([t, s, 0.0, 0.0]),
            JointKind::Chain => {
                let ((sb, cb), (sc, cc)) = (sin_cos(0.5 * b), sin_cos(0.5 * c));
                let [w, x, y, z] = [cb * cc, sb * sc, sb * cc, cb * sc];
                self.rotation([t * w - s * x, t * x + s * w, t * y - s * z, t * z + s * y])
            }
            JointKind::Ball => {
                let angle = sqrt(b * b + c * c);
                let (sin, cos) = sin_cos(0.5 * angle);
                let ratio = if angle > 1e-4 { sin / angle } else { 0.5 };
                let (y, z) = (b * ratio, c * ratio);
                self.rotation([cos * t, cos * s, y * t + z * s, z * t - y * s])
            }
        }
    }
}

/// Angle of the vector `(cos, sin)` of any length, -pi..pi; `None` for a vector of (nearly) none.
fn arc(sin: f32, cos: f32) -> Option<f32> {
    let norm = sqrt(sin * sin + cos * cos);
    if norm > SMALL {
        let angle = quadrant_angle(sin.abs(), cos.abs(), norm);
        let angle = if cos < 0.0 { PI - angle } else { angle };
        Some(if sin < 0.0 { -angle } else { angle })
    } else {
        None
    }
}

/// The angle that differs from `x` by whole turns and lies nearest to `middle`.
fn nearest(x: f32, middle: f32) -> f32 {
    let turns = (x - middle) * (1.0 / TAU);
    let whole = (turns + if turns < 0.0 { -0.5 } else { 0.5 }) as i32;
    x - whole as f32 * TAU
}

/// The turn about the first axis that is nearest to `q`, -pi..pi.
fn twist([w, x, ..]: &[f32; 4]) -> Option<f32> {
    arc(if *w < 0.0 { -*x } else { *x }, w.abs()).map(|half| 2.0 * half)
}

/// Twist about the first axis and rotation vector of the swing after it: `q = swing twist`.
fn swing_twist(q: [f32; 4], at: f32) -> [f32; 3] {
    let [w, x, y, z] = q;
    let length = sqrt(w * w + x * x);
    let twist = twist(&q).unwrap_or(at);
    let (sin, cos) = sin_cos(0.5 * twist);
    let flip = if w * cos + x * sin < 0.0 { -1.0 } else { 1.0 };
    let (y, z) = (flip * (y * cos - z * sin), flip * (z * cos + y * sin));
    let side = sqrt(y * y + z * z);
    let angle = 2.0 * arc(side, length).unwrap_or(0.0);
    let ratio = if side > 1e-4 { angle / side } else { 2.0 };
    [twist, y * ratio, z * ratio]
}

/// Angles of the turns about the first, second and third axis, `q = X Y Z`; the second within a quarter turn.
fn chain([w, x, y, z]: [f32; 4], [at0, _, at2]: [f32; 3]) -> [f32; 3] {
    let (sin, cos) = (2.0 * (w * x - y * z), w * w - x * x - y * y + z * z);
    // Square of the cosine of the second angle, against rounding.
    let first = if sin * sin + cos * cos > 1e-8 { arc(sin, cos).unwrap_or(at0) } else { at0 };
    let (sh, ch) = sin_cos(0.5 * first);
    let [w, x, y, z] = [ch * w + sh * x, ch * x - sh * w, ch * y + sh * z, ch * z - sh * y];
    let long = sqrt(w * w + z * z);
    let third = arc(z, w).map_or(at2, |half| 2.0 * half);
    let second = if long > SMALL { arc((y * w + x * z) / long, long).unwrap_or(0.0) } else { 0.5 * PI };
    [first, 2.0 * second, third]
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDE: [&[f32; 3]; 2] = [&[-3.1; 3], &[3.1; 3]];
    const RIGHT: [[f32; 3]; 3] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
    const LEFT: [[f32; 3]; 3] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]];

    fn turn(axis: [f32; 3], angle: f32) -> UnitQuaternion<f32> {
        UnitQuaternion::from_scaled_axis(Vector3::from(axis) * angle)
    }

    /// Every combination of angles.
    fn grid() -> impl Iterator<Item = [f32; 3]> {
        let at = |i: i32| i as f32 * 0.29;
        (-5..=5).flat_map(move |a| (-5..=5).flat_map(move |b| (-5..=5).map(move |c| [at(a), at(b), at(c)])))
    }

    fn near(a: &UnitQuaternion<f32>, b: &UnitQuaternion<f32>) -> bool {
        a.coords.dot(&b.coords).abs() > 1.0 - 1e-6
    }

    #[test]
    fn a_chain_is_its_hinges_in_order() {
        for axes in [RIGHT, LEFT] {
            let frame = Frame::new(&axes);
            for angles in grid() {
                let [a, b, c] = [0, 1, 2].map(|i| turn(axes[i], angles[i]));
                let q = a * b * c;
                assert!(near(&frame.compose(JointKind::Chain, angles), &q), "{angles:?}");
                let found = frame.coordinates(JointKind::Chain, &q, angles, WIDE);
                assert!(found.iter().zip(angles).all(|(x, y)| (x - y).abs() < 2e-5), "{angles:?} {found:?}");
            }
        }
    }

    #[test]
    fn a_second_hinge_may_pass_a_quarter_turn() {
        let frame = Frame::new(&RIGHT);
        let mut at = [0.3, 1.2, -0.4];
        for step in 0..120 {
            let angles = [0.3, 1.2 + step as f32 * 0.01, -0.4];
            let found = frame.coordinates(JointKind::Chain, &frame.compose(JointKind::Chain, angles), at, WIDE);
            let gimbal = (angles[1] - 0.5 * PI).abs() < 2e-3;
            assert!(gimbal || found.iter().zip(angles).all(|(x, y)| (x - y).abs() < 2e-3), "{angles:?} {found:?}");
            at = found;
        }
    }

    #[test]
    fn swing_and_twist_return() {
        for axes in [RIGHT, LEFT] {
            let frame = Frame::new(&axes);
            for angles in grid() {
                let q = frame.compose(JointKind::Ball, angles);
                let swing = turn(axes[1], angles[1]) * turn(axes[0], angles[0]);
                assert!(angles[2] != 0.0 || near(&q, &swing), "{angles:?}");
                let found = frame.coordinates(JointKind::Ball, &q, [0.0; 3], WIDE);
                assert!(found.iter().zip(angles).all(|(x, y)| (x - y).abs() < 1e-5), "{angles:?} {found:?}");
            }
        }
    }

    #[test]
    fn a_hinge_takes_the_part_about_its_axis() {
        let frame = Frame::new(&RIGHT);
        for step in -300..300 {
            let angle = step as f32 * 0.01;
            let q = frame.compose(JointKind::Ball, [angle, 0.4, -0.8]);
            let [found, ..] = frame.coordinates(JointKind::Hinge, &q, [0.0; 3], WIDE);
            assert!((found - angle).abs() < 1e-5);
            let range: [&[f32; 3]; 2] = [&[0.0; 3], &[TAU - 0.11; 3]];
            let [found, ..] = frame.coordinates(JointKind::Hinge, &q, [0.0; 3], range);
            let wrapped = if angle < -0.055 { angle + TAU } else { angle };
            assert!((found - wrapped).abs() < 1e-5, "{angle}: {found}");
        }
        // A half turn about another axis says nothing of this one.
        let across = turn([1.0, 0.0, 0.0], PI);
        assert_eq!(frame.coordinates(JointKind::Hinge, &across, [0.7, 0.0, 0.0], WIDE)[0], 0.7);
    }
}
