//! A joint's rotation as up to three coordinates, and back.

use core::f32::consts::{PI, TAU};

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::kernel::{quadrant_angle, sin_cos, sqrt};

/// Which coordinates a joint has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum JointKind {
    /// None: the joint stays at its reference.
    Fixed = 0,
    /// One angle, about the first axis.
    Hinge = 1,
    /// Two or three hinges in order, at right angles: `R(axis 0) R(axis 1) R(axis 2)`. Two have a third that stays 0.
    Chain = 2,
    /// The rotation vector from the reference, along the joint's own axes.
    Ball = 3,
    /// One length along the first axis, m. A pose holds rotations alone and does not show it.
    Slider = 4,
}

impl JointKind {
    /// The kind with this number in the tensor `rig/kinds`.
    pub fn from_code(code: u16) -> Option<Self> {
        match code {
            0 => Some(Self::Fixed),
            1 => Some(Self::Hinge),
            2 => Some(Self::Chain),
            3 => Some(Self::Ball),
            4 => Some(Self::Slider),
            _ => None,
        }
    }

    /// Number of coordinates.
    pub fn coordinates(self) -> usize {
        match self {
            Self::Fixed => 0,
            Self::Hinge | Self::Slider => 1,
            Self::Chain | Self::Ball => 3,
        }
    }

    /// Index of the joint's first coordinate, where those before it end at `end`.
    pub(super) fn first(self, end: usize) -> usize {
        if self.coordinates() == 3 { end.next_multiple_of(3) } else { end }
    }
}

/// Below this share of its length a direction is no direction.
const SMALL: f32 = 1e-6;

/// An angle keeps to the turn that it is in up to so far from the middle of its range: at half a turn it would flicker.
const KEEP: f32 = 1.2 * PI;

/// The three axes of a chain, in its reference.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axes {
    axes: [Vector3<f32>; 3],
    /// A left-handed triple is taken as a right-handed one whose third axis, and third coordinate, is turned round.
    hand: f32,
}

impl Axes {
    pub fn new(axes: &[[f32; 3]; 3]) -> Self {
        let [a, b, c] = axes.map(Vector3::from);
        let hand = if a.cross(&b).dot(&c) < 0.0 { -1.0 } else { 1.0 };
        Self { axes: [a, b, c * hand], hand }
    }

    /// The angles of the rotation `q` from the reference. Of all the values that mean the same rotation the one nearest to `middle`
    /// counts, but the turn of `last` is kept for a while. Where a rotation leaves an angle open (gimbal lock) it stays as in `last`.
    /// What the axes cannot do is left out. Cost: up to 120 multiply-adds, ten roots.
    pub fn angles(&self, q: &UnitQuaternion<f32>, last: [f32; 3], middle: [f32; 3]) -> [f32; 3] {
        let ([last0, last1, last2], [middle0, middle1, middle2]) = (last, middle);
        let ([a, b, c], v) = (&self.axes, q.imag());
        let [a, b, c] = chain([q.w, v.dot(a), v.dot(b), v.dot(c)], [last0, last1, self.hand * last2]);
        let turned = |[a, b, c]: [f32; 3]| {
            [near(a, last0, middle0), near(b, last1, middle1), near(self.hand * c, last2, middle2)]
        };
        let first = turned([a, b, c]);
        // The other way to the same rotation.
        let second = turned([a + PI, PI - b, c + PI]);
        let cost = |x: &[f32; 3]| x.iter().zip(last).map(|(x, last)| (x - last).abs()).sum::<f32>();
        if cost(&second) < cost(&first) { second } else { first }
    }

    /// The rotation from the reference with these angles. Cost: 70 multiply-adds.
    pub fn rotation(&self, [a, b, c]: [f32; 3]) -> UnitQuaternion<f32> {
        let (s, t) = sin_cos(0.5 * a);
        let ((sb, cb), (sc, cc)) = (sin_cos(0.5 * b), sin_cos(0.5 * self.hand * c));
        let [w, x, y, z] = [cb * cc, sb * sc, sb * cc, cb * sc];
        let [w, x, y, z] = [t * w - s * x, t * x + s * w, t * y - s * z, t * z + s * y];
        let [a, b, c] = &self.axes;
        UnitQuaternion::new_unchecked(Quaternion::from_parts(w, a * x + b * y + c * z))
    }
}

/// The angle of a hinge: the turn about `axis` that is nearest to `q`, chosen among equal ones as [`Axes::angles`] does. Cost: 30
/// multiply-adds, three roots.
pub(super) fn hinge(axis: &[f32; 3], q: &UnitQuaternion<f32>, last: f32, middle: f32) -> f32 {
    near(twist(q.w, q.imag().dot(&Vector3::from(*axis))).unwrap_or(last), last, middle)
}

/// The turn by an angle about a hinge's axis. Cost: 20 multiply-adds.
pub(super) fn hinged(axis: &[f32; 3], angle: f32) -> UnitQuaternion<f32> {
    let (sin, cos) = sin_cos(0.5 * angle);
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cos, Vector3::from(*axis) * sin))
}

/// The rotation vector `v` of the shorter turn, or the other one that means the same rotation if `last` is nearer to that.
pub(super) fn ball(v: Vector3<f32>, last: [f32; 3]) -> [f32; 3] {
    let square = v.dot(&v);
    // Only a long vector has another one within reach.
    if square > (TAU - KEEP) * (TAU - KEEP) {
        let other = v * (1.0 - TAU / sqrt(square));
        let last = Vector3::from(last);
        let (near, far) = (v - last, other - last);
        if far.dot(&far) < near.dot(&near) {
            return other.into();
        }
    }
    v.into()
}

/// The angle that differs from `x` by whole turns and lies nearest to `middle`, or to `last` while that is within reach.
fn near(x: f32, last: f32, middle: f32) -> f32 {
    let turned = |to: f32| {
        let turns = (x - to) * (1.0 / TAU);
        let whole = (turns + if turns < 0.0 { -0.5 } else { 0.5 }) as i32;
        x - whole as f32 * TAU
    };
    let kept = turned(last);
    if (kept - middle).abs() < KEEP { kept } else { turned(middle) }
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

/// The turn about an axis that is nearest to a rotation, -pi..pi: `w` and the part along the axis of its quaternion.
fn twist(w: f32, x: f32) -> Option<f32> {
    arc(if w < 0.0 { -x } else { x }, w.abs()).map(|half| 2.0 * half)
}

/// Angles of the turns about the first, second and third axis, `q = X Y Z`; the second within a quarter turn.
fn chain([w, x, y, z]: [f32; 4], [last0, _, last2]: [f32; 3]) -> [f32; 3] {
    let (sin, cos) = (2.0 * (w * x - y * z), w * w - x * x - y * y + z * z);
    // Square of the cosine of the second angle, against rounding.
    let first = if sin * sin + cos * cos > 1e-8 { arc(sin, cos).unwrap_or(last0) } else { last0 };
    let (sh, ch) = sin_cos(0.5 * first);
    let [w, x, y, z] = [ch * w + sh * x, ch * x - sh * w, ch * y + sh * z, ch * z - sh * y];
    let long = sqrt(w * w + z * z);
    let third = arc(z, w).map_or(last2, |half| 2.0 * half);
    let second = if long > SMALL { arc((y * w + x * z) / long, long).unwrap_or(0.0) } else { 0.5 * PI };
    [first, 2.0 * second, third]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::{exp, log};

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

    fn same(a: &UnitQuaternion<f32>, b: &UnitQuaternion<f32>) -> bool {
        a.coords.dot(&b.coords).abs() > 1.0 - 1e-6
    }

    #[test]
    fn a_chain_is_its_hinges_in_order() {
        for axes in [RIGHT, LEFT] {
            let joint = Axes::new(&axes);
            for angles in grid() {
                let [a, b, c] = [0, 1, 2].map(|i| turn(axes[i], angles[i]));
                let q = a * b * c;
                assert!(same(&joint.rotation(angles), &q), "{angles:?}");
                let found = joint.angles(&q, angles, [0.0; 3]);
                assert!(found.iter().zip(angles).all(|(x, y)| (x - y).abs() < 2e-5), "{angles:?} {found:?}");
            }
        }
    }

    #[test]
    fn a_second_hinge_may_pass_a_quarter_turn() {
        let joint = Axes::new(&RIGHT);
        let mut last = [0.3, 1.2, -0.4];
        for step in 0..120 {
            let angles = [0.3, 1.2 + step as f32 * 0.01, -0.4];
            let q = joint.rotation(angles);
            let found = joint.angles(&q, last, [0.0; 3]);
            let gimbal = (angles[1] - 0.5 * PI).abs() < 2e-3;
            assert!(gimbal || found.iter().zip(angles).all(|(x, y)| (x - y).abs() < 2e-3), "{angles:?} {found:?}");
            last = found;
        }
    }

    #[test]
    fn a_ball_is_its_rotation_vector_and_passes_half_a_turn() {
        let mut last = [0.0; 3];
        for step in 0..=360 {
            let angle = step as f32 * 0.01;
            let v = [0.48 * angle, -0.6 * angle, 0.64 * angle];
            let found = ball(log(&exp(Vector3::from(v))), last);
            assert!(found.iter().zip(v).all(|(x, y)| (x - y).abs() < 1e-4), "{angle}: {v:?} {found:?}");
            last = found;
        }
        // Beyond 1.2 half turns the shorter turn is taken again, so that a somersault leaves nothing behind.
        let [x, ..] = ball(log(&exp(Vector3::new(3.9, 0.0, 0.0))), [3.7, 0.0, 0.0]);
        assert!((x - (3.9 - TAU)).abs() < 1e-4, "{x}");
    }

    #[test]
    fn a_hinge_takes_the_part_about_its_axis() {
        let axis = &RIGHT[0];
        let swing = turn([0.0, 0.0, 1.0], 0.4) * turn([1.0, 0.0, 0.0], -0.2);
        for step in -300..300 {
            let angle = step as f32 * 0.01;
            let q = turn([0.0, 1.0, 0.0], angle);
            let found = hinge(axis, &q, 0.0, 0.0);
            assert!((found - angle).abs() < 1e-5);
            assert!(same(&hinged(axis, angle), &q));
            // A range of nearly a turn, from 0 on.
            let found = hinge(axis, &q, 0.0, PI);
            let wrapped = if angle < PI - KEEP { angle + TAU } else { angle };
            assert!((found - wrapped).abs() < 1e-5, "{angle}: {found}");
        }
        let found = hinge(axis, &swing, 0.0, 0.0);
        assert!(found.abs() < 0.1, "{found}");
        // A half turn about another axis says nothing of this one.
        let across = turn([1.0, 0.0, 0.0], PI);
        assert_eq!(hinge(axis, &across, 0.7, 0.0), 0.7);
    }
}
