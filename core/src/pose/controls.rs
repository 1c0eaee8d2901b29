//! What the user of a running model may turn.

/// Strength and mask; they may change at any frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controls<const JOINTS: usize> {
    /// 0 = the source, 1 = the learned style, beyond = exaggerated. The pack states a plausible range.
    pub strength: f32,
    /// Weight of each joint, 0 = the source's rotation, 1 = the styled one; the root's also weights its position.
    pub mask: [f32; JOINTS],
}

impl<const JOINTS: usize> Default for Controls<JOINTS> {
    fn default() -> Self {
        Self { strength: 1.0, mask: [1.0; JOINTS] }
    }
}
