//! What running components remember between frames.

use crate::engine::Controls;
use crate::pose::Heading;

/// What running components remember: for the stored stream where it is. No filters, no history.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComponentsState<const ROWS: usize> {
    pub(super) heading: Heading,
    /// Point on the ground below the root of the stored stream, world, m.
    pub(super) ground: [f32; 2],
    /// Next frame of the stored stream.
    pub(super) frame: usize,
    /// What the user may turn while it runs.
    pub controls: Controls<ROWS>,
}

impl<const ROWS: usize> ComponentsState<ROWS> {
    /// At the origin, facing +Z, full strength, all joints.
    pub const fn new() -> Self {
        Self { heading: Heading::FORWARD, ground: [0.0; 2], frame: 0, controls: Controls::new() }
    }

    /// Forgets the past, keeps the controls.
    pub fn reset(&mut self) {
        *self = Self { controls: self.controls, ..Self::new() };
    }
}

impl<const ROWS: usize> Default for ComponentsState<ROWS> {
    fn default() -> Self {
        Self::new()
    }
}
