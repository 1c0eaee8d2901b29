//! What is remembered between frames.

use nalgebra::Vector3;

use crate::mechanics::contact;

/// What [`Feet`](super::Feet) remember.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeetState {
    /// Where the source's feet are, and whether they stand.
    pub(super) source: [contact::Foot; 2],
    pub(super) held: [Held; 2],
    /// Where the source's root was, world, m.
    pub(super) root: Vector3<f32>,
    /// How far the pipeline had carried the root from the source's, m.
    pub(super) by: [f32; 2],
    /// How far the root is carried besides, and how fast that changes, over the ground, m and m/s.
    pub(super) shift: [f32; 2],
    pub(super) speed: [f32; 2],
    /// Frames since the last one with a source.
    pub(super) gap: u16,
    pub(super) started: bool,
}

/// One foot of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Held {
    /// How much it is held, 0..1, before it is smoothed.
    pub weight: f32,
    /// Where the source's foot was, and where this one came, world, m.
    pub before: [Vector3<f32>; 2],
    /// The slow way of the source's foot while that stands, m a frame.
    pub slow: Vector3<f32>,
    /// Height at which it is held, world, m.
    pub ground: f32,
    /// How far it is moved from where it came, m.
    pub way: Vector3<f32>,
    /// The axis about which its knee bends, in the frame of the thigh, by how far it bends.
    pub axis: Vector3<f32>,
}

const NOTHING: Vector3<f32> = Vector3::new(0.0, 0.0, 0.0);
const FREE: Held = Held { weight: 0.0, before: [NOTHING; 2], slow: NOTHING, ground: 0.0, way: NOTHING, axis: NOTHING };

impl FeetState {
    /// Nothing seen yet. It can stand in a `static`.
    pub const fn new() -> Self {
        Self {
            source: [contact::Foot::new(); 2],
            held: [FREE; 2],
            root: NOTHING,
            by: [0.0; 2],
            shift: [0.0; 2],
            speed: [0.0; 2],
            gap: 0,
            started: false,
        }
    }

    /// Forgets everything: the next frame is the first, and the root where the pipeline puts it.
    pub fn reset(&mut self) {
        *self = Self::new();
    }

    /// Whether each foot of the source stands, left and right.
    pub fn stands(&self) -> [bool; 2] {
        self.source.map(|foot| foot.stands())
    }

    /// How far the root is carried from where the pipeline put it, over the ground, world, m: x and z.
    pub fn shift(&self) -> [f32; 2] {
        self.shift
    }
}

impl Default for FeetState {
    fn default() -> Self {
        Self::new()
    }
}
