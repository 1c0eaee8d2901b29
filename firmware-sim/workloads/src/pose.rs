//! Poses in and out of a workload.

use kinesic::Pose;
use nalgebra::{Quaternion, Unit, Vector3};

use crate::Digest;

/// Takes an input frame: the root's position, then `x y z w` of every joint's rotation.
pub fn load<const JOINTS: usize>(pose: &mut Pose<JOINTS>, input: &[u8]) {
    let mut numbers = input.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
    let mut next = || numbers.next().unwrap_or(0.0);
    pose.root = Vector3::new(next(), next(), next());
    for rotation in &mut pose.rotations {
        let [x, y, z, w] = [next(), next(), next(), next()];
        *rotation = Unit::new_unchecked(Quaternion::new(w, x, y, z));
    }
}

/// Every bit of a pose.
pub fn output<const JOINTS: usize>(pose: &Pose<JOINTS>, digest: &mut Digest) {
    pose.root.iter().for_each(|value| digest.float(*value));
    for rotation in &pose.rotations {
        rotation.coords.iter().for_each(|value| digest.float(*value));
    }
}
