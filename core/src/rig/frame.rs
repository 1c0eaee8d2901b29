//! All coordinates of one moment.

use super::REACH;
use crate::pose::{FARTHEST, Heading, is_number};

/// The coordinates of one moment, three to a row, and where the body stands. See the [module](super) for the order of rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame<const ROWS: usize> {
    /// Coordinates, rad or m. Rows past the rig's own are 0.
    pub rows: [[f32; 3]; ROWS],
    /// Direction in which the body faces. Engines leave it alone.
    pub heading: Heading,
    /// Point on the ground below the root, world, m: x and z. Engines leave it alone.
    pub ground: [f32; 2],
    /// How far the body was put elsewhere since the last frame, world, m: no travel, but a way that limits have to bridge.
    pub leap: [f32; 2],
    /// How far engines may carry the body from where the source stands, m: see [`Drift`](super::Drift).
    pub reach: f32,
    /// Where limits have put the body against where the source stands, world, m. They keep the reach themselves: a change of their
    /// travel would break them.
    pub(crate) carried: Option<[f32; 2]>,
    /// True once a pose was read: the next one has travelled from here.
    pub(super) started: bool,
    /// True once a pose was read: `ground` means something.
    pub(super) known: bool,
}

impl<const ROWS: usize> Frame<ROWS> {
    /// All coordinates 0, at the origin, facing +Z.
    pub const fn new() -> Self {
        Self {
            rows: [[0.0; 3]; ROWS],
            heading: Heading::FORWARD,
            ground: [0.0; 2],
            leap: [0.0; 2],
            reach: REACH,
            carried: None,
            started: false,
            known: false,
        }
    }

    /// A frame of coordinates in order, for a machine that stands: servo angles, say. Numbers past the rows are left out.
    pub fn from_coordinates(coordinates: &[f32]) -> Self {
        let mut frame = Self::new();
        frame.coordinates_mut().iter_mut().zip(coordinates).for_each(|(to, from)| *to = *from);
        frame
    }

    /// The coordinates in order.
    pub fn coordinates(&self) -> &[f32] {
        self.rows.as_flattened()
    }

    /// The coordinates in order, to be changed.
    pub fn coordinates_mut(&mut self) -> &mut [f32] {
        self.rows.as_flattened_mut()
    }

    /// True if every number is finite and below a million. Both ends of a leap are, so it may be twice as far.
    pub fn is_sound(&self) -> bool {
        let mut numbers = self.coordinates().iter().chain(&self.ground);
        let leaps = self.leap.iter().all(|x| x.abs() <= 2.0 * FARTHEST);
        leaps && numbers.all(|x| is_number(*x)) && self.heading.is_sound()
    }

    /// The next pose has not travelled: what it is farther on counts as a leap. The last leap is over.
    pub fn forget_place(&mut self) {
        self.started = false;
        self.leap = [0.0; 2];
    }
}

impl<const ROWS: usize> Default for Frame<ROWS> {
    fn default() -> Self {
        Self::new()
    }
}
