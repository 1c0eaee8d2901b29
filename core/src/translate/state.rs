//! What a translator remembers between frames, and what its user may turn.

use nalgebra::Vector3;

use crate::pose::{Controls, Heading};

/// What a running translator remembers: `STATES` numbers of the filters, and where the root and the heading were.
///
/// The default is the zero initial state of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TranslatorState<const JOINTS: usize, const STATES: usize> {
    /// f32 or int32, as the pack has it: see [`view`](Self::view). All bits zero is zero in both.
    pub(super) filters: [u32; STATES],
    pub(super) heading: Heading,
    pub(super) last_root: Option<Vector3<f32>>,
    /// How far the styled root has travelled away from the source's, world, m.
    pub(super) drift: Vector3<f32>,
    /// What the user may turn while it runs.
    pub controls: Controls<JOINTS>,
}

impl<const JOINTS: usize, const STATES: usize> TranslatorState<JOINTS, STATES> {
    /// Zero state, full strength, all joints.
    pub fn new() -> Self {
        Self {
            filters: [0; STATES],
            heading: Heading::default(),
            last_root: None,
            drift: Vector3::zeros(),
            controls: Controls::default(),
        }
    }

    /// The next frame's root is taken to have stood here before: a gap or a leap is no travel.
    pub(crate) fn rebase(&mut self, root: Vector3<f32>) {
        self.last_root = Some(root);
    }

    /// The filters as f32 or as i32: both have the size and the alignment of a word.
    pub(super) fn view<T: bytemuck::Pod>(&mut self) -> &mut [T] {
        bytemuck::try_cast_slice_mut(&mut self.filters).unwrap_or_default()
    }

    /// Forgets the past, keeps the controls.
    pub fn reset(&mut self) {
        *self = Self { controls: self.controls, ..Self::new() };
    }
}

impl<const JOINTS: usize, const STATES: usize> Default for TranslatorState<JOINTS, STATES> {
    fn default() -> Self {
        Self::new()
    }
}

/// What the style does to the clock. A live stream keeps its own and ignores this; the host warps clips with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Frames of the styled motion that this source frame lasts: below 1 the style hurries, above 1 it lingers.
    pub duration: f32,
}
