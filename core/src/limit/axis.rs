//! What a coordinate remembers, and one coordinate under position, velocity and acceleration limits.

use crate::kernel::sqrt;

/// Share of the acceleration that catches up with the target; the rest follows the target's own.
pub(super) const CATCH_UP: f32 = 0.5;

/// What one coordinate may do. Rates are per frame: `velocity dt`, `acceleration dt^2` and `jerk dt^3`; a jerk of 0 is no limit.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub lower: f32,
    pub upper: f32,
    pub speed: f32,
    pub change: f32,
    pub jerk: f32,
}

/// Frames that the longest stop takes under a jerk limit, about. Rates are per frame: `velocity dt`, `acceleration dt^2`, `jerk dt^3`.
pub fn stop_frames(speed: f32, change: f32, jerk: f32) -> f32 {
    let change = change.min(sqrt(speed * jerk));
    3.0 * change / jerk + speed / change
}

/// What a limiter remembers of one coordinate: [`Plain`], or [`Smooth`](super::Smooth) where jerk is limited too.
pub trait Axis: Along {}

/// One coordinate on its way.
pub trait Along: Copy + PartialEq + core::fmt::Debug {
    /// True if jerk limits are kept.
    const JERK: bool;

    /// Stands at 0.
    const REST: Self;

    /// Stands there.
    fn standing(at: f32) -> Self;

    /// Where it is.
    fn at(&self) -> f32;

    /// How far the last target was when it had gone.
    fn left(&self) -> f32;

    /// One frame towards `target`, which lies within the bounds.
    fn advance(&mut self, target: f32, bounds: &Bounds);
}

/// Where a coordinate is, how far it went in the last frame, and how far the last target was when it had.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plain {
    pub(super) at: f32,
    pub(super) went: f32,
    pub(super) left: f32,
}

impl Axis for Plain {}

impl Along for Plain {
    const JERK: bool = false;
    const REST: Self = Self { at: 0.0, went: 0.0, left: 0.0 };

    fn standing(at: f32) -> Self {
        Self { at, ..Self::REST }
    }

    fn at(&self) -> f32 {
        self.at
    }

    fn left(&self) -> f32 {
        self.left
    }

    #[inline(always)]
    fn advance(&mut self, target: f32, bounds: &Bounds) {
        *self = self.gone(target, bounds);
    }
}

/// The largest step per frame from which braking by `change` a frame ends within `room`: the inverse of
/// `D(w) = (n + 1) w - n (n + 1) / 2 change`, `n = floor(w / change)`. Cost: a root, two divisions where that is more than one step.
pub(super) fn reach(room: f32, change: f32) -> f32 {
    if room <= change {
        // No whole step.
        return if room > 0.0 { room } else { 0.0 };
    }
    let whole = (0.5 * (sqrt(1.0 + 8.0 * (room / change)) - 1.0)) as u32 as f32;
    room / (whole + 1.0) + 0.5 * whole * change
}

/// `x`, within bounds. None of the three is NaN, so that two comparisons do; `f32::clamp` and `min` take more where there is no instruction.
pub(super) fn within(x: f32, lower: f32, upper: f32) -> f32 {
    let x = if x < lower { lower } else { x };
    if x > upper { upper } else { x }
}

impl Plain {
    /// One frame towards `target`, which lies within the bounds. Cost: about 15 multiply-adds; a root and two divisions more where it
    /// has to catch up, and as many where it has to brake.
    #[inline(always)]
    pub(super) fn gone(self, target: f32, bounds: &Bounds) -> Self {
        let Bounds { lower, upper, speed, change, .. } = *bounds;
        let error = target - self.at;
        // The target's own step, and beside it what catches up with where the target was.
        let own = within(error - self.left, -speed, speed);
        let behind = if self.left == 0.0 { 0.0 } else { reach(self.left.abs(), CATCH_UP * change) };
        let wanted = own + if self.left < 0.0 { -behind } else { behind };
        let step = within(within(wanted, self.went - change, self.went + change), -speed, speed);
        let room = if step < 0.0 { self.at - lower } else { upper - self.at };
        // `D(w) <= w (w + u) / u`: with so much room there is nothing to brake for.
        let far = step.abs();
        let brakes = if far * (far + change) <= room * change { far } else { reach(room, change) };
        let at = within(self.at + within(step, -brakes, brakes), lower, upper);
        Self { at, went: at - self.at, left: target - at }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    const BOUNDS: Bounds = Bounds { lower: -1.0, upper: 0.8, speed: 0.05, change: 0.004, jerk: 0.0 };

    #[test]
    fn reach_is_the_inverse_of_the_braking_distance() {
        for step in 1..4_000 {
            let (room, change) = (step as f32 * 1e-3, 0.01f32);
            let (mut speed, mut way) = (reach(room, change), 0.0);
            while speed > 0.0 {
                way += speed;
                speed -= change;
            }
            assert!((way - room).abs() < 1e-5 * room.max(1.0), "{room}: {way}");
        }
        assert_eq!(reach(-1.0, 0.01), 0.0);
    }

    #[test]
    fn a_motion_within_the_limits_passes() {
        let wave = |frame: i32| 0.5 * libm::sinf(frame as f32 * 0.05);
        let mut x = Plain { at: 0.0, went: 0.0, left: 0.0 };
        for frame in 0..400 {
            x = x.gone(wave(frame), &BOUNDS);
            // It starts with a jump of speed, which takes a few frames to catch up with.
            assert!(frame < 40 || x.left.abs() < 1e-6, "{frame}: {x:?}");
        }
    }

    #[test]
    fn it_arrives_at_a_bound_without_overshoot_or_bounce() {
        let mut x = Plain { at: -1.0, went: 0.0, left: 0.0 };
        let mut frames = 0;
        while x.left != 0.0 || frames == 0 {
            let before = x;
            x = x.gone(BOUNDS.upper, &BOUNDS);
            assert!(x.went >= 0.0 && (x.went - before.went).abs() < BOUNDS.change + 1e-6, "{before:?} {x:?}");
            frames += 1;
            assert!(frames < 200, "{x:?}");
        }
        assert_eq!(x.at, BOUNDS.upper);
        // 1.8 rad at .05 a frame is 36 frames; starting and braking cost 12 or so.
        assert!(frames < 70, "{frames}");
    }
}
