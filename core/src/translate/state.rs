//! What a translator remembers between frames, and what its user may turn.

use crate::engine::Controls;

/// What a running translator remembers: `STATES` numbers of the filters.
///
/// The default is the zero initial state of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TranslatorState<const ROWS: usize, const STATES: usize> {
    /// f32 or int32, as the pack has it: see [`view`](Self::view). All bits zero is zero in both.
    pub(super) filters: [u32; STATES],
    /// What the user may turn while it runs.
    pub controls: Controls<ROWS>,
}

impl<const ROWS: usize, const STATES: usize> TranslatorState<ROWS, STATES> {
    /// Zero state, full strength, all joints.
    pub const fn new() -> Self {
        Self { filters: [0; STATES], controls: Controls::new() }
    }

    /// The filters as f32 or as i32: both have the size and the alignment of a word.
    pub(super) fn view<T: bytemuck::Pod>(&mut self) -> &mut [T] {
        bytemuck::try_cast_slice_mut(&mut self.filters).unwrap_or_default()
    }

    /// Forgets the past, keeps the controls.
    pub fn reset(&mut self) {
        self.filters = [0; STATES];
    }
}

impl<const ROWS: usize, const STATES: usize> Default for TranslatorState<ROWS, STATES> {
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
