//! Observed = expressive x mechanics (Boehs 2017, section 4).

use nalgebra::UnitQuaternion;

use super::rotation::{angle, power};
use crate::kernel::tanh;
use crate::pose::{Pose, unit};

/// Splits an observed pose by the one that the body's mechanics ask for.
///
/// For every joint but the hips: `E = O B^-1`; activity `A = clamp((tansig(angle of E) g)^b, 0, 1)`; `E* = E^A`;
/// `B' = E*^-1 O`, so that `E* B' = O`. With the paper's g = 2 and b = 4 a difference of 12 degrees counts 3 %, of 31 degrees
/// and more fully. (Quaternions do not commute: of the two orders in which `B'` could be written this one makes the product exact.)
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decoupler {
    /// Gain `g`.
    pub gain: f32,
    /// Exponent `b`, at most 16.
    pub exponent: u8,
}

/// Largest exponent.
pub(super) const LARGEST_EXPONENT: u8 = 16;

impl Default for Decoupler {
    /// The paper's: g = 2, b = 4.
    fn default() -> Self {
        Self { gain: 2.0, exponent: 4 }
    }
}

/// A pose in its two parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decoupled<const JOINTS: usize> {
    /// `B'`: the pose without expression; root and hips are the observed ones.
    pub mechanics: Pose<JOINTS>,
    /// `E*`: what expression adds to each joint, on the left; the identity at the hips.
    pub expressive: [UnitQuaternion<f32>; JOINTS],
    /// `A` of each joint, 0..1; 0 at the hips.
    pub activity: [f32; JOINTS],
}

impl<const JOINTS: usize> Decoupled<JOINTS> {
    /// Everything at rest.
    pub fn identity() -> Self {
        Self { mechanics: Pose::identity(), expressive: [UnitQuaternion::identity(); JOINTS], activity: [0.0; JOINTS] }
    }

    /// `E* B'`: the observed pose again, to rounding.
    pub fn observed(&self) -> Pose<JOINTS> {
        let mut pose = self.mechanics;
        for (rotation, expressive) in pose.rotations.iter_mut().zip(&self.expressive) {
            *rotation = expressive * *rotation;
        }
        pose
    }
}

impl<const JOINTS: usize> Default for Decoupled<JOINTS> {
    fn default() -> Self {
        Self::identity()
    }
}

impl Decoupler {
    /// The activity index of an angle, rad.
    pub fn activity(&self, angle: f32) -> f32 {
        let base = tanh(angle) * self.gain;
        let mut product = 1.0;
        for _ in 0..self.exponent.min(LARGEST_EXPONENT) {
            product *= base;
        }
        product.clamp(0.0, 1.0)
    }

    /// Splits `observed` by `mechanics`, both sound. Joint 0, the hips, is all mechanics. Cost: about 130 multiply-adds a joint.
    pub fn split<const JOINTS: usize>(
        &self,
        observed: &Pose<JOINTS>,
        mechanics: &Pose<JOINTS>,
        parts: &mut Decoupled<JOINTS>,
    ) {
        parts.mechanics = *observed;
        let joints = parts.mechanics.rotations.iter_mut().zip(&mut parts.expressive).zip(&mut parts.activity);
        for (((kept, expressive), activity), mechanics) in joints.zip(&mechanics.rotations).skip(1) {
            let whole = *kept * mechanics.inverse();
            *activity = self.activity(angle(&whole));
            *expressive = power(&whole, *activity);
            *kept = unit((expressive.inverse() * *kept).into_inner());
        }
    }
}
