//! What a translator remembers between frames, and what its user may turn.

use crate::engine::Controls;

/// What a running translator remembers: `STATES` numbers of the filters and of the gate.
///
/// The default is the zero initial state of the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TranslatorState<const ROWS: usize, const STATES: usize> {
    /// f32 or int32, as the pack has it: see [`parts`](Self::parts). All bits zero is zero in both.
    pub(super) filters: [u32; STATES],
    /// What the user may turn while it runs.
    pub controls: Controls<ROWS>,
    /// Whether the style fades where the motion is unlike the training, for a model that [knows it](super::Translator::is_gated).
    pub fade: bool,
    pub(super) familiar: f32,
}

impl<const ROWS: usize, const STATES: usize> TranslatorState<ROWS, STATES> {
    /// Zero state, full strength, all joints.
    pub const fn new() -> Self {
        Self { filters: [0; STATES], controls: Controls::new(), fade: true, familiar: 1.0 }
    }

    /// How familiar the last frame was: 1 as in the training, 0 unlike anything in it; 1 for a model that does not know.
    pub fn familiar(&self) -> f32 {
        self.familiar
    }

    /// The filters as f32 or i32, and the gate's words, for a model with so many filters.
    pub(super) fn parts<T: bytemuck::Pod>(&mut self, filters: usize) -> (&mut [T], &mut [f32]) {
        let (filters, gate) = self.filters.split_at_mut_checked(filters).unwrap_or_default();
        (
            bytemuck::try_cast_slice_mut(filters).unwrap_or_default(),
            bytemuck::try_cast_slice_mut(gate).unwrap_or_default(),
        )
    }

    /// Forgets the past, keeps what the user may turn.
    pub fn reset(&mut self) {
        self.familiar = 1.0;
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
