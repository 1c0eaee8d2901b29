//! The weighted mean of several poses.

use crate::pose::{Pose, nlerp};

/// How much each stream counts. A weight that is negative or not finite counts as 0; if all do, the source passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// The source frame.
    pub source: f32,
    /// Modulated body mechanics.
    pub mechanics: f32,
    /// Style translation.
    pub translate: f32,
    /// Style components.
    pub components: f32,
    /// The motion that plays at an emotion's strength, whatever the source does.
    pub emotion: f32,
}

impl Default for Weights {
    /// Every engine that is there alike, but not the source, nor the emotion's motion, which is no version of it.
    fn default() -> Self {
        Self { source: 0.0, mechanics: 1.0, translate: 1.0, components: 1.0, emotion: 0.0 }
    }
}

/// Adds poses up, each along the shorter arc from the mean of those before it.
#[derive(Clone, Copy, Debug)]
pub struct Mix<const JOINTS: usize> {
    pose: Pose<JOINTS>,
    total: f32,
}

impl<const JOINTS: usize> Mix<JOINTS> {
    /// The source, with a weight that may be 0.
    pub fn new(source: &Pose<JOINTS>, weight: f32) -> Self {
        Self { pose: *source, total: usable(weight) }
    }

    /// Adds a pose. Weight 0 changes nothing; the first that counts is taken bit for bit. Cost: 20 multiply-adds and a root a joint.
    pub fn add(&mut self, pose: &Pose<JOINTS>, weight: f32) {
        let weight = usable(weight);
        if weight <= 0.0 {
            return;
        }
        if self.total <= 0.0 {
            (self.pose, self.total) = (*pose, weight);
            return;
        }
        self.total += weight;
        let share = weight / self.total;
        self.pose.root += (pose.root - self.pose.root) * share;
        for (mean, rotation) in self.pose.rotations.iter_mut().zip(&pose.rotations) {
            *mean = nlerp(mean, rotation, share);
        }
    }

    /// The mean.
    pub fn pose(&self) -> &Pose<JOINTS> {
        &self.pose
    }
}

fn usable(weight: f32) -> f32 {
    if (0.0..1e6).contains(&weight) { weight } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};

    fn turned(angle: f32) -> Pose<1> {
        let root = Vector3::new(angle, 0.0, 0.0);
        Pose { root, rotations: [UnitQuaternion::from_scaled_axis(Vector3::new(0.0, angle, 0.0))] }
    }

    #[test]
    fn it_is_the_weighted_mean() {
        let mut mix = Mix::new(&turned(0.0), 1.0);
        mix.add(&turned(0.1), 2.0);
        mix.add(&turned(0.4), 1.0);
        // nlerp is slerp up to the third order.
        assert!((mix.pose().root.x - 0.15).abs() < 1e-6);
        assert!((mix.pose().rotations[0].angle() - 0.15).abs() < 1e-3);
    }

    #[test]
    fn weights_that_are_none_count_as_zero() {
        let mut mix = Mix::new(&turned(0.3), f32::NAN);
        for weight in [0.0, -1.0, f32::INFINITY, f32::NAN] {
            mix.add(&turned(1.0), weight);
            assert_eq!(*mix.pose(), turned(0.3));
        }
        mix.add(&turned(1.0), 0.5);
        assert_eq!(*mix.pose(), turned(1.0));
    }
}
