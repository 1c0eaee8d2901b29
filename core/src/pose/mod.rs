//! Skeleton, pose, forward kinematics and heading.
//!
//! Rotations are unit quaternions, local to the parent; the root's is relative to the world. Only `+ - * /` and square
//! roots are used, all correctly rounded, so results have the same bits on every IEEE 754 machine.

mod forward;
mod heading;
mod skeleton;

pub use forward::{World, forward};
pub use heading::{Heading, local_positions};
pub use skeleton::Skeleton;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::kernel::sqrt;

/// Numbers from here on are no coordinates.
pub(crate) const FARTHEST: f32 = 1e6;

/// True for what is finite and nearer than [`FARTHEST`]. By bits: a comparison of floats is dear where they are software.
pub(crate) fn is_number(x: f32) -> bool {
    x.to_bits() & !(1 << 31) < FARTHEST.to_bits()
}

/// Local rotations of up to `JOINTS` joints and the root's position.
///
/// Joints past the skeleton's own are ignored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose<const JOINTS: usize> {
    /// World position of the root joint, m.
    pub root: Vector3<f32>,
    /// Rotation of each joint relative to its parent.
    pub rotations: [UnitQuaternion<f32>; JOINTS],
}

impl<const JOINTS: usize> Pose<JOINTS> {
    /// True if the root is within a thousand kilometres and the first `joints` rotations are nearly of length one: what a
    /// dropped, garbled or non-finite frame is not.
    pub fn is_sound(&self, joints: usize) -> bool {
        // Positive floats are in the order of their bits, and software compares bits sooner.
        let unit =
            |q: &UnitQuaternion<f32>| (0.9f32.to_bits()..1.1f32.to_bits()).contains(&q.coords.dot(&q.coords).to_bits());
        self.root.iter().all(|x| is_number(*x)) && self.rotations.iter().take(joints).all(unit)
    }

    /// All joints at rest, root at the origin.
    pub fn identity() -> Self {
        Self { root: Vector3::zeros(), rotations: [UnitQuaternion::identity(); JOINTS] }
    }
}

impl<const JOINTS: usize> Default for Pose<JOINTS> {
    fn default() -> Self {
        Self::identity()
    }
}

/// `q / |q|`, or the identity if `q` is (nearly) zero.
pub(crate) fn unit(q: Quaternion<f32>) -> UnitQuaternion<f32> {
    let norm = sqrt(q.coords.dot(&q.coords));
    // One division, four products: divisions are the dearest operation of every core.
    if norm > 1e-6 { UnitQuaternion::new_unchecked(q * (1.0 / norm)) } else { UnitQuaternion::identity() }
}

/// Normalised linear interpolation along the shorter arc: `a` at weight 0, `b` at weight 1.
///
/// It follows the great arc of `slerp` at a slightly uneven speed, without its transcendental functions.
pub fn nlerp(a: &UnitQuaternion<f32>, b: &UnitQuaternion<f32>, weight: f32) -> UnitQuaternion<f32> {
    let weight_b = if a.coords.dot(&b.coords) < 0.0 { -weight } else { weight };
    unit(Quaternion::from(a.coords * (1.0 - weight) + b.coords * weight_b))
}
