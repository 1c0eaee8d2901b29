//! More or less expression, and one's mechanics with another's expression (Boehs 2017, section 5).

use super::decouple::Decoupled;
use super::rotation::power;
use crate::pose::{Pose, unit};

/// How much expression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modulation<const JOINTS: usize> {
    /// 0 = none, 1 = as observed, 2 = twice; beyond and below zero are extrapolated.
    pub amount: f32,
    /// Weight of each joint: 0 leaves it as observed, 1 takes the whole amount.
    pub mask: [f32; JOINTS],
}

impl<const JOINTS: usize> Default for Modulation<JOINTS> {
    fn default() -> Self {
        Self { amount: 1.0, mask: [1.0; JOINTS] }
    }
}

/// Expression times `amount`: `E*^k B'`, computed as `E*^(k - 1) O` so that 1 returns the observed pose exactly. Root and hips
/// stay. A non-finite amount or weight counts as 1. Cost: about 70 multiply-adds a joint.
pub fn modulate<const JOINTS: usize>(
    observed: &Pose<JOINTS>,
    parts: &Decoupled<JOINTS>,
    modulation: &Modulation<JOINTS>,
    out: &mut Pose<JOINTS>,
) {
    *out = *observed;
    let joints = out.rotations.iter_mut().zip(&parts.expressive).zip(&modulation.mask);
    for ((rotation, expressive), weight) in joints.skip(1) {
        let change = weight * (modulation.amount - 1.0);
        let change = if change.is_finite() { change } else { 0.0 };
        // At no change the product is the pose itself, bit for bit.
        let changed = power(expressive, change) * *rotation;
        *rotation = if change == 0.0 { *rotation } else { unit(changed.into_inner()) };
    }
}

/// The mechanics of one (root and hips included) with the expression of another: `E*_b^(k w) E*_a^(1 - w) B'_a`, where `k` is the
/// amount and `w` the joint's weight. At 1 this is the paper's `E*_b B'_a`; at 0 the joint moves as in the first motion, its own
/// expression included (so legs that jump can be left alone). Cost: about 120 multiply-adds a joint.
pub fn mix<const JOINTS: usize>(
    mechanics: &Decoupled<JOINTS>,
    expressive: &Decoupled<JOINTS>,
    modulation: &Modulation<JOINTS>,
    out: &mut Pose<JOINTS>,
) {
    *out = mechanics.mechanics;
    let expressions = mechanics.expressive.iter().zip(&expressive.expressive);
    let joints = out.rotations.iter_mut().zip(expressions).zip(&modulation.mask);
    for ((rotation, (own, other)), weight) in joints.skip(1) {
        let kept = power(own, 1.0 - weight) * *rotation;
        *rotation = unit((power(other, weight * modulation.amount) * kept).into_inner());
    }
}
