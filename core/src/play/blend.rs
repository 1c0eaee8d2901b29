//! From one motion into another: what is left of the first goes to nothing.

use crate::pose::is_number;

/// What is left of a motion when another one has begun (inertialisation, Bollo 2018).
///
/// The difference of the two at the change, with its velocity and its acceleration, goes to 0 on a polynomial of degree five. A target without a known
/// future is [sought](Self::seek) instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend<const N: usize> {
    /// What went out in the last three frames, the last one first.
    past: [[f32; N]; 3],
    /// The difference at the change, its velocity and acceleration per frame.
    left: [[f32; N]; 3],
    /// Frames since the change, and in all.
    at: u16,
    frames: u16,
}

impl<const N: usize> Blend<N> {
    /// Standing at `place`.
    pub const fn standing(place: [f32; N]) -> Self {
        Self { past: [place; 3], left: [[0.0; N]; 3], at: 0, frames: 0 }
    }

    /// What went out last.
    pub fn last(&self) -> &[f32; N] {
        &self.past[0]
    }

    /// From now on another motion comes in, whose next three frames are `next`. What is left of the old one is gone after `frames` frames, at
    /// least one. Cost: 12 multiply-adds per coordinate.
    pub fn begin(&mut self, next: [&[f32; N]; 3], frames: u16) {
        let [x0, x1, x2] = next;
        let [y1, y2, y3] = &self.past;
        let before = y1.iter().zip(y2).zip(y3);
        let after = x0.iter().zip(x1).zip(x2);
        for ((((y1, y2), y3), ((x0, x1), x2)), index) in before.zip(after).zip(0..) {
            // The new motion as it would have come here: its acceleration goes on backwards.
            let pull = x0 - 2.0 * x1 + x2;
            let back = x1 - x0;
            let [d1, d2, d3] =
                [y1 - (x0 - back + pull), y2 - (x0 - 2.0 * back + 3.0 * pull), y3 - (x0 - 3.0 * back + 6.0 * pull)];
            let change = d1 - 2.0 * d2 + d3;
            let left = [d1, 0.5 * (3.0 * d1 - 4.0 * d2 + d3), change];
            for (own, left) in self.left.iter_mut().zip(left) {
                if let Some(own) = own.get_mut(index) {
                    *own = left;
                }
            }
        }
        (self.at, self.frames) = (0, frames.max(1));
    }

    /// One frame: `x` of the motion that comes in, and in its place what goes out. Cost: three multiply-adds per coordinate, and a division.
    pub fn step(&mut self, x: &mut [f32; N]) {
        if self.at < self.frames {
            self.at += 1;
            let frames = f32::from(self.frames);
            let t = f32::from(self.at) / frames;
            // 1, t and t^2 / 2 at the change, to the second derivative; 0 at the end, to the second derivative.
            let end = 1.0 - t;
            let cube = end * end * end;
            let place = cube * (1.0 + t * (3.0 + 6.0 * t));
            let speed = cube * t * (1.0 + 3.0 * t) * frames;
            let change = 0.5 * cube * t * t * (frames * frames);
            let [places, speeds, changes] = &self.left;
            for (x, ((own, step), pull)) in x.iter_mut().zip(places.iter().zip(speeds).zip(changes)) {
                *x += place * own + speed * step + change * pull;
            }
        }
        self.remember(x);
    }

    /// One frame towards a target that may jump: three poles in a row at `1 - share`, from wherever and however the motion goes. What is
    /// left of an earlier one goes with it. Cost: six multiply-adds per coordinate.
    pub fn seek(&mut self, target: &[f32; N], share: f32) {
        let s = share;
        let (place, speed, pull) = (s * s * s, s * s * (3.0 - 2.0 * s), s * (3.0 - s * (3.0 - s)));
        let mut out = *target;
        for ((x, y1), (y2, y3)) in out.iter_mut().zip(&self.past[0]).zip(self.past[1].iter().zip(&self.past[2])) {
            let (error, went) = (y1 - *x, y1 - y2);
            let change = went - (y2 - y3);
            *x = y1 + (went + (change - (place * error + speed * went + pull * change)));
        }
        self.frames = self.at;
        self.remember(&out);
    }

    fn remember(&mut self, x: &[f32; N]) {
        let [last, before, first] = &mut self.past;
        (*first, *before, *last) = (*before, *last, *x);
    }
}

/// Numbers that go to where they are told without a jump, to their second derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ease<const N: usize> {
    target: [f32; N],
    blend: Blend<N>,
}

impl<const N: usize> Ease<N> {
    pub const fn at(x: [f32; N]) -> Self {
        Self { target: x, blend: Blend::standing(x) }
    }

    /// Where they go.
    pub fn target(&self) -> &[f32; N] {
        &self.target
    }

    /// Where they are.
    pub fn now(&self) -> &[f32; N] {
        self.blend.last()
    }

    /// There in `frames` frames. Numbers that are not finite are ignored.
    pub fn go(&mut self, target: [f32; N], frames: u16) {
        take(&mut self.target, &target);
        self.blend.begin([&self.target; 3], frames);
    }

    pub fn step(&mut self) -> &[f32; N] {
        let mut x = self.target;
        self.blend.step(&mut x);
        self.blend.last()
    }
}

/// Takes numbers over, but for those that are not finite.
pub(super) fn take<const N: usize>(own: &mut [f32; N], new: &[f32; N]) {
    for (own, x) in own.iter_mut().zip(new) {
        *own = if is_number(*x) { *x } else { *own };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_any_motion_into_any_other_nothing_jumps_and_nothing_is_left() {
        let from = |t: f32| 0.7 * libm::sinf(0.11 * t + 1.0);
        let to = |t: f32| 0.4 * libm::cosf(0.07 * t) - 0.9;
        for change in 5..60 {
            let mut blend = Blend::standing([from(0.0)]);
            let (mut past, mut most) = ([from(0.0); 3], 0.0f32);
            for frame in 0..120 {
                let t = frame as f32;
                if frame == change {
                    blend.begin([&[to(t)], &[to(t + 1.0)], &[to(t + 2.0)]], 30);
                }
                let mut x = [if frame < change { from(t) } else { to(t) }];
                blend.step(&mut x);
                let jerk = x[0] - 3.0 * past[0] + 3.0 * past[1] - past[2];
                // It stood at first.
                most = if frame > 3 { most.max(jerk.abs()) } else { most };
                past = [x[0], past[0], past[1]];
                assert!(frame < change + 30 || x[0] == to(t), "{change} {frame}");
            }
            // The polynomial of the largest difference, 1.9 rad in 30 frames, has a jerk of 60 * 1.9 / 30^3.
            assert!(most < 0.007, "{change}: {most}");
        }
    }

    #[test]
    fn a_number_goes_where_it_is_told_also_when_it_is_told_again_on_its_way() {
        let mut ease = Ease::at([0.0]);
        ease.go([1.0], 20);
        let (mut past, mut most) = ([0.0f32; 3], 0.0f32);
        for frame in 0..60 {
            if frame == 7 {
                ease.go([0.25], 20);
            }
            let [x] = *ease.step();
            most = most.max((x - 3.0 * past[0] + 3.0 * past[1] - past[2]).abs());
            past = [x, past[0], past[1]];
        }
        assert!((ease.now(), ease.target()) == (&[0.25], &[0.25]) && most < 0.01, "{ease:?} {most}");
    }
}
