//! From one motion into another: what is left of the first goes to nothing.

use crate::kernel::sqrt;
use crate::pose::is_number;

/// Longer blends are cut, frames: single precision could not tell how a motion goes on.
const LONGEST: u16 = 1000;

/// What is left of a velocity, or of an acceleration, goes as far as this, rad or m, or as far as the motions are apart.
const FAR: f32 = 0.5;

/// What is left of a motion when another one has begun (inertialisation, Bollo 2018).
///
/// The difference of the two at the change, with its velocity and its acceleration, goes to 0 on a polynomial of degree five. A target without a known
/// future is [sought](Self::seek) instead. Numbers are finite, rad or m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blend<const N: usize> {
    /// What went out in the last three frames, the last one first.
    past: [[f32; N]; 3],
    /// The difference at the change, its velocity and acceleration per frame. In a search the last two are the motion's own.
    left: [[f32; N]; 3],
    /// Frames since the change, and in all.
    at: u16,
    frames: u16,
    seeks: bool,
}

impl<const N: usize> Blend<N> {
    /// Standing at `place`.
    pub const fn standing(place: [f32; N]) -> Self {
        Self { past: [place; 3], left: [[0.0; N]; 3], at: 0, frames: 0, seeks: false }
    }

    /// What went out last.
    pub fn last(&self) -> &[f32; N] {
        &self.past[0]
    }

    /// From now on another motion comes in, whose next three frames are `next`. What is left of the old one is gone after `frames` frames, from 1
    /// to 1000; earlier where it is so fast that it would go far in that time. Cost: about 20 multiply-adds per coordinate.
    pub fn begin(&mut self, next: [&[f32; N]; 3], frames: u16) {
        let [x0, x1, x2] = next;
        let [y1, y2, y3] = &self.past;
        let [places, speeds, changes] = &mut self.left;
        let left = places.iter_mut().zip(speeds).zip(changes);
        let past = y1.iter().zip(y2).zip(y3);
        let next = x0.iter().zip(x1).zip(x2);
        let mut most = f32::from(frames.clamp(1, LONGEST));
        for ((((place, speed), change), ((y1, y2), y3)), ((x0, x1), x2)) in left.zip(past).zip(next) {
            // The new motion as it would have come here: its acceleration goes on backwards.
            let pull = x0 - 2.0 * x1 + x2;
            let back = x1 - x0;
            let d1 = y1 - (x0 - back + pull);
            let d2 = y2 - (x0 - 2.0 * back + 3.0 * pull);
            let d3 = y3 - (x0 - 3.0 * back + 6.0 * pull);
            (*place, *speed, *change) = (d1, 0.5 * (3.0 * d1 - 4.0 * d2 + d3), d1 - 2.0 * d2 + d3);
            // The polynomial of a velocity goes .16 of it times its frames, that of an acceleration .0173 times their square.
            let far = if d1.abs() > FAR { d1.abs() } else { FAR };
            if 0.16 * speed.abs() * most > far {
                most = far / (0.16 * speed.abs());
            }
            if 0.0173 * change.abs() * (most * most) > far {
                most = sqrt(far / (0.0173 * change.abs()));
            }
        }
        (self.at, self.frames, self.seeks) = (0, (most as u16).max(1), false);
    }

    /// One frame: `x` of the motion that comes in, and in its place what goes out. Cost: three multiply-adds per coordinate, and a division.
    pub fn step(&mut self, x: &mut [f32; N]) {
        if self.at < self.frames {
            self.at += 1;
            self.add(f32::from(self.at), x);
        }
        self.remember(x);
    }

    /// Adds what is left after `at` frames.
    fn add(&self, at: f32, x: &mut [f32; N]) {
        let frames = f32::from(self.frames);
        let t = at / frames;
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

    /// One frame towards a target that may jump: three poles in a row at `1 - share`, from wherever and however the motion goes. What is
    /// left of an earlier one goes with it. Cost: six multiply-adds per coordinate.
    pub fn seek(&mut self, target: &[f32; N], share: f32) {
        let s = share;
        let (place, speed, pull) = (s * s * s, s * s * (3.0 - 2.0 * s), s * (3.0 - s * (3.0 - s)));
        let mut out = *target;
        let [y1, y2, y3] = &self.past;
        let [_, steps, changes] = &mut self.left;
        // Velocity and acceleration are kept beside the places, which could not tell slow ones.
        if !self.seeks {
            for (((step, change), (y1, y2)), y3) in steps.iter_mut().zip(&mut *changes).zip(y1.iter().zip(y2)).zip(y3) {
                (*step, *change) = (y1 - y2, y1 - 2.0 * y2 + y3);
            }
        }
        for (((x, y1), step), change) in out.iter_mut().zip(y1).zip(steps).zip(changes) {
            *change -= place * (y1 - *x) + speed * *step + pull * *change;
            *step += *change;
            *x = y1 + *step;
        }
        (self.frames, self.seeks) = (self.at, true);
        self.remember(&out);
    }

    fn remember(&mut self, x: &[f32; N]) {
        let [last, before, first] = &mut self.past;
        (*first, *before, *last) = (*before, *last, *x);
    }
}

/// Numbers that go to where they are told without a jump, to their second derivative, and stay between 0 and a bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ease<const N: usize> {
    target: [f32; N],
    most: f32,
    blend: Blend<N>,
}

impl<const N: usize> Ease<N> {
    /// There, at most `most`.
    pub const fn at(x: [f32; N], most: f32) -> Self {
        Self { target: x, most, blend: Blend::standing(x) }
    }

    /// Where they go.
    pub fn target(&self) -> &[f32; N] {
        &self.target
    }

    /// Where they are.
    pub fn now(&self) -> &[f32; N] {
        self.blend.last()
    }

    /// There in `frames` frames; earlier where they would leave their range on the way. Numbers that are not finite are ignored.
    pub fn go(&mut self, target: [f32; N], frames: u16) {
        take(&mut self.target, &target);
        // `f32::clamp` would panic for a bound that is no number.
        self.target = self.target.map(|x| x.max(0.0).min(self.most));
        let mut frames = frames;
        loop {
            self.blend.begin([&self.target; 3], frames);
            if frames <= 1 || self.stays() {
                return;
            }
            frames = self.blend.frames.min(frames) / 2;
        }
    }

    /// True if they stay within their range.
    fn stays(&self) -> bool {
        (1..16).all(|part: u8| {
            let mut x = self.target;
            self.blend.add(f32::from(self.blend.frames) * f32::from(part) * (1.0 / 16.0), &mut x);
            x.iter().all(|x| (-ROUNDING..=self.most + ROUNDING).contains(x))
        })
    }

    pub fn step(&mut self) -> &[f32; N] {
        let mut x = self.target;
        self.blend.step(&mut x);
        self.blend.last()
    }
}

/// Rounding of weights.
const ROUNDING: f32 = 1e-5;

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
        let mut ease = Ease::at([0.0], 1.0);
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
