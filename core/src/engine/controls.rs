//! What the user of a running model may turn.

use crate::pose::is_number;
use crate::rig::Frame;

/// Strength and mask; they may change at any frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controls<const ROWS: usize> {
    /// 0 = the source, 1 = the learned style, beyond = exaggerated. The pack states a plausible range. One that is not finite counts as 0.
    pub strength: f32,
    /// Weight of each coordinate, 0 = the source's, 1 = the styled one. One that is not finite counts as 0.
    pub mask: [[f32; 3]; ROWS],
}

impl<const ROWS: usize> Controls<ROWS> {
    /// Full strength, all joints.
    pub const fn new() -> Self {
        Self { strength: 1.0, mask: [[1.0; 3]; ROWS] }
    }

    /// `x + strength mask (y - x)` for the first `rows` rows of a frame `x`; `styled` is `y` and is spent. False, and the frame has not
    /// changed, if that is not sound. Cost: 2 multiply-adds per coordinate.
    pub(crate) fn apply(&self, styled: &mut [[f32; 3]; ROWS], frame: &mut Frame<ROWS>, rows: usize) -> bool {
        let mut sound = true;
        for ((y, x), weight) in styled.iter_mut().zip(&frame.rows).zip(&self.mask).take(rows) {
            for ((y, x), weight) in y.iter_mut().zip(x).zip(weight) {
                let weight = self.strength * weight;
                let weight = if weight.is_finite() { weight } else { 0.0 };
                *y = x + weight * (*y - x);
                sound &= is_number(*y);
            }
        }
        if sound {
            frame.rows.iter_mut().zip(styled).take(rows).for_each(|(x, y)| *x = *y);
        }
        sound
    }
}

impl<const ROWS: usize> Default for Controls<ROWS> {
    fn default() -> Self {
        Self::new()
    }
}
