//! One layer of a player.

use super::Move;
use super::blend::{Blend, Ease, take};

/// How a layer joins those beneath it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Takes their place: `x + w (y - x)`.
    #[default]
    Over,
    /// Comes on top, by how far it is from rest: `x + w (y - rest)`.
    Add,
}

/// What a layer plays.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Source<'a, const N: usize> {
    Rest,
    Move(Move<'a, N>, usize),
    /// A target, and the share of the way to it that each of three poles goes in a frame.
    Live([f32; N], f32),
}

/// Greatest strength.
const STRONGEST: f32 = 4.0;

/// One layer: a move, a live target or rest.
///
/// What is called between two frames never makes a jump. Frames are those of the pipeline; numbers that are not finite are ignored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer<'a, const N: usize> {
    /// How it joins those beneath it. A change is seen at once: make it while the weight is 0.
    pub mode: Mode,
    source: Source<'a, N>,
    blend: Blend<N>,
    /// A new source has come, and takes over in so many frames.
    change: Option<u16>,
    /// Frames of a blend where a move ends, and stands or begins again.
    seam: u16,
    /// Frames before the end of a gesture in which it fades.
    fade: Option<u16>,
    weight: Ease<1>,
    strength: Ease<1>,
    mask: Ease<N>,
}

impl<'a, const N: usize> Layer<'a, N> {
    /// At rest, with this weight.
    pub(super) const fn new(rest: [f32; N], weight: f32) -> Self {
        Self {
            mode: Mode::Over,
            source: Source::Rest,
            blend: Blend::standing(rest),
            change: None,
            seam: 1,
            fade: None,
            weight: Ease::at([weight], 1.0),
            strength: Ease::at([1.0], STRONGEST),
            mask: Ease::at([1.0; N], 1.0),
        }
    }

    /// Puts it where the robot is, all of it seen; what it plays takes over in `frames` frames.
    pub(super) fn stand(&mut self, place: &[f32; N], frames: u16) {
        *self = Self { source: self.source, seam: self.seam, change: Some(frames.max(1)), ..Self::new(*place, 1.0) };
    }

    /// Not seen from now on.
    pub(super) fn hide(&mut self) {
        self.weight = Ease::at([0.0], 1.0);
    }

    /// Plays a move from its beginning, at full weight. What was played before is gone after `frames` frames, from 1 to 1000; earlier where it
    /// would go far in that time. A move that ends while it moves comes to a stand in as many, and one that is looped blends its ends in as many, or in half
    /// its own frames.
    pub fn play(&mut self, motion: Move<'a, N>, frames: u16) {
        (self.source, self.seam, self.fade) = (Source::Move(motion, 0), frames, None);
        // What is not seen begins without a blend.
        self.change = Some(if self.is_seen() { frames.max(1) } else { 0 });
        self.appear(frames);
    }

    /// Plays a move once: it comes in `frames` frames, and goes in its last `frames` frames, of a short move in half its frames each.
    pub fn gesture(&mut self, motion: Move<'a, N>, frames: u16) {
        let frames = frames.min(motion.half());
        self.play(motion.once(), frames);
        self.fade = Some(frames);
    }

    /// Goes to a target that is given as it comes, a gaze for example, at full weight. Nine tenths of a step of the target are
    /// there after about `frames` frames. To be called whenever there is a new target; a number that is not finite leaves that coordinate's.
    pub fn follow(&mut self, target: &[f32; N], frames: u16) {
        let mut goal = match self.source {
            Source::Live(goal, _) => goal,
            Source::Rest | Source::Move(..) => *self.blend.last(),
        };
        take(&mut goal, target);
        if !self.is_seen() {
            self.blend = Blend::standing(goal);
        }
        // Three equal poles have nine tenths of a step after 5.3 times their time constant.
        self.source = Source::Live(goal, 1.0 / (1.0 + f32::from(frames) * (1.0 / 5.3)));
        (self.fade, self.change) = (None, None);
        self.appear(frames);
    }

    /// Goes to rest, at the weight that it has.
    pub fn rest(&mut self, frames: u16) {
        (self.source, self.fade, self.change) = (Source::Rest, None, Some(frames.max(1)));
    }

    /// Fades until those beneath it are seen alone.
    pub fn leave(&mut self, frames: u16) {
        self.fade = None;
        self.weight.go([0.0], frames);
    }

    /// How much it counts against those beneath it, 0 to 1; there in at most `frames` frames.
    pub fn weight(&mut self, weight: f32, frames: u16) {
        self.weight.go([weight], frames);
    }

    /// How far it goes from rest: 0 stays there, 1 as recorded, at most 4; there in at most `frames` frames.
    pub fn strength(&mut self, strength: f32, frames: u16) {
        self.strength.go([strength], frames);
    }

    /// What of it counts, 0 to 1 per coordinate: `[0.0, 1.0]` is the second coordinate alone. There in at most `frames` frames; at once
    /// where the layer is not seen.
    pub fn mask(&mut self, mask: [f32; N], frames: u16) {
        self.mask.go(mask, frames);
        if !self.is_seen() {
            self.mask = Ease::at(*self.mask.target(), 1.0);
        }
    }

    /// True once a move that is not looped has come to its end, and of a gesture nothing is left.
    pub fn is_over(&self) -> bool {
        let ended = match self.source {
            Source::Move(motion, at) => !motion.is_looped() && at >= motion.frames(),
            Source::Rest | Source::Live(..) => false,
        };
        ended && (self.fade.is_none() || !self.is_seen())
    }

    fn is_seen(&self) -> bool {
        *self.weight.now() != [0.0] || *self.weight.target() != [0.0]
    }

    fn appear(&mut self, frames: u16) {
        if *self.weight.target() != [1.0] {
            self.weight.go([1.0], frames);
        }
    }

    /// One frame on top of `x`.
    pub(super) fn step(&mut self, rest: &[f32; N], x: &mut [f32; N]) {
        if let Source::Live(target, share) = &self.source {
            self.blend.seek(target, *share);
        } else {
            let [mut own, next, third] = self.read(rest);
            match self.change.take() {
                Some(0) => self.blend = Blend::standing(own),
                Some(frames) => self.blend.begin([&own, &next, &third], frames),
                None => {}
            }
            self.blend.step(&mut own);
        }
        let own = self.blend.last();
        let ([weight], [strength], mask) = (*self.weight.step(), *self.strength.step(), self.mask.step());
        for (((x, own), rest), mask) in x.iter_mut().zip(own).zip(rest).zip(mask) {
            let away = strength * (own - rest);
            let weight = weight * mask;
            *x += weight
                * match self.mode {
                    Mode::Over => rest + away - *x,
                    Mode::Add => away,
                };
        }
    }

    /// The source's next frame, and the two after it.
    fn read(&mut self, rest: &[f32; N]) -> [[f32; N]; 3] {
        let Source::Move(motion, at) = &mut self.source else { return [*rest; 3] };
        if *at == motion.frames() {
            // What comes next, its beginning or a stand at its end, is another motion.
            let frames = match motion.is_looped() {
                true => self.seam.min(motion.half()),
                false => self.seam,
            };
            *at = if motion.is_looped() { 0 } else { *at };
            if !motion.ends_meet() {
                self.change = Some(self.change.unwrap_or(frames.max(1)));
            }
        }
        let frames = [0, 1, 2].map(|next| motion.frame(at.saturating_add(next)));
        *at = at.saturating_add(1);
        let left = motion.frames().saturating_sub(*at);
        if let Some(fade) = self.fade
            && left <= usize::from(fade)
            && *self.weight.target() != [0.0]
        {
            self.weight.go([0.0], fade);
        }
        frames
    }
}
