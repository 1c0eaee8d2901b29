//! What running components remember between frames.

use nalgebra::Vector3;

use crate::pose::{Controls, Heading};

/// What running components remember: the heading, and for the stored stream where it is. No filters, no history.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComponentsState<const JOINTS: usize> {
    pub(super) heading: Heading,
    /// Point on the ground below the root of the stored stream, world, m.
    pub(super) ground: Vector3<f32>,
    /// Next frame of the stored stream.
    pub(super) frame: usize,
    /// What the user may turn while it runs.
    pub controls: Controls<JOINTS>,
}

impl<const JOINTS: usize> ComponentsState<JOINTS> {
    /// At the origin, facing +Z, full strength, all joints.
    pub fn new() -> Self {
        Self { heading: Heading::default(), ground: Vector3::zeros(), frame: 0, controls: Controls::default() }
    }

    /// Forgets the past, keeps the controls.
    pub fn reset(&mut self) {
        *self = Self { controls: self.controls, ..Self::new() };
    }
}

impl<const JOINTS: usize> Default for ComponentsState<JOINTS> {
    fn default() -> Self {
        Self::new()
    }
}
