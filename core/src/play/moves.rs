//! A recorded move.

use crate::pose::is_number;

/// A move in flash: frames of a machine's coordinates, rad or m, at the rate of the pipeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move<'a, const N: usize> {
    frames: &'a [[f32; N]],
    looped: bool,
}

impl<'a, const N: usize> Move<'a, N> {
    /// A move of these frames. `None` if there are none, or if a number in them is not finite.
    pub fn new(frames: &'a [[f32; N]]) -> Option<Self> {
        let sound = frames.as_flattened().iter().all(|x| is_number(*x));
        (sound && !frames.is_empty()).then_some(Self { frames, looped: false })
    }

    /// The same move without an end: after its last frame comes its first. Ends that do not meet are blended.
    pub fn looped(self) -> Self {
        Self { looped: true, ..self }
    }

    /// True for a move without an end.
    pub fn is_looped(&self) -> bool {
        self.looped
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.frames.len()
    }

    /// One frame; past the end the last one.
    pub fn frame(&self, at: usize) -> [f32; N] {
        self.frames.get(at).or(self.frames.last()).copied().unwrap_or([0.0; N])
    }
}
