//! A recorded move.

use crate::pose::is_number;

/// A move in flash: frames of a machine's coordinates, rad or m, at the rate of the pipeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move<'a, const N: usize> {
    frames: &'a [[f32; N]],
    looped: bool,
    /// It is looped, and its end goes on into its beginning.
    ends_meet: bool,
}

/// Ends meet if the acceleration changes there by no more than so many times what it does elsewhere.
const LIKE_ELSEWHERE: f32 = 2.0;

/// Rounding of what meets, rad or m.
const ROUNDING: f32 = 1e-5;

impl<'a, const N: usize> Move<'a, N> {
    /// A move of these frames. `None` if there are none, or if a number in them is not finite.
    pub fn new(frames: &'a [[f32; N]]) -> Option<Self> {
        let sound = frames.as_flattened().iter().all(|x| is_number(*x));
        (sound && !frames.is_empty()).then_some(Self { frames, looped: false, ends_meet: false })
    }

    /// The same move without an end: after its last frame comes its first. Ends that do not go on into each other are blended.
    /// Cost: four multiply-adds per number of the move.
    pub fn looped(self) -> Self {
        let count = self.frames.len();
        let (mut elsewhere, mut ends) = (0.0f32, 0.0f32);
        for at in 0..count {
            let next = [0, 1, 2, 3].map(|next| self.frame((at + next) % count));
            let [a, b, c, d] = &next;
            let jerks = a.iter().zip(b).zip(c.iter().zip(d)).map(|((a, b), (c, d))| (d - 3.0 * c + 3.0 * b - a).abs());
            let most = if at + 3 < count { &mut elsewhere } else { &mut ends };
            *most = jerks.fold(*most, |most, jerk| if jerk > most { jerk } else { most });
        }
        Self { looped: true, ends_meet: ends <= LIKE_ELSEWHERE * elsewhere + ROUNDING, ..self }
    }

    /// The same move with an end.
    pub(super) fn once(self) -> Self {
        Self { looped: false, ends_meet: false, ..self }
    }

    /// True for a move without an end.
    pub fn is_looped(&self) -> bool {
        self.looped
    }

    pub(super) fn ends_meet(&self) -> bool {
        self.ends_meet
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.frames.len()
    }

    /// Half its frames, at most as many as can be counted.
    pub(super) fn half(&self) -> u16 {
        u16::try_from(self.frames.len() / 2).unwrap_or(u16::MAX)
    }

    /// One frame; past the end the last one.
    pub fn frame(&self, at: usize) -> [f32; N] {
        self.frames.get(at).or(self.frames.last()).copied().unwrap_or([0.0; N])
    }
}
