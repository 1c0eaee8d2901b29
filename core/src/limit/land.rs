//! How a coordinate comes to a target: where it would stand if it braked now, and the way that ends on the target exactly.

use super::stop::{Motion, way};
use crate::kernel::sqrt;

/// What may be used of acceleration and jerk, per frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Budget {
    pub change: f32,
    pub jerk: f32,
}

/// Frames in which the acceleration goes evenly to one value, to another, and to 0; at least one each. Speed and distance from the target
/// are to end at 0 too, which gives the two values: the rest of a way is solved anew in every frame, so that nothing adds up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Way {
    first: u16,
    second: u16,
    third: u16,
}

impl Way {
    /// The way that begins with a brake from here, as short as the budget allows, and the next change of step. `None` if this way does not end on the target: it is
    /// too early, or too late. Cost: about 250 multiply-adds, a root, 15 divisions.
    pub fn begin(from: &Motion, aim: &Budget, most: &Budget) -> Option<(Self, f32)> {
        // Rounding of what follows needs some room.
        let most = &Budget { change: 0.98 * most.change, jerk: 0.98 * most.jerk };
        let Brake { ramp, hold, release, .. } = Brake::new(from.step, from.change, aim);
        let short = ramp + hold + release < 30_000.0;
        if !short {
            return None;
        }
        let [ramp, hold, release] = [ramp, hold, release].map(|x| x as u16);
        [(0, 1, 0), (1, 1, 0), (0, 1, 1), (1, 1, 1), (1, 2, 1)].into_iter().find_map(|(first, second, third)| {
            let way = Self { first: (ramp + first).max(1), second: hold + second, third: (release + third).max(1) };
            Some((way, way.solve(from, most, true)?))
        })
    }

    /// The next change of step on this way; `None` if it takes more than there is. Cost: about 40 multiply-adds, three divisions.
    pub fn change(self, from: &Motion, most: &Budget) -> Option<f32> {
        self.solve(from, most, false)
    }

    fn solve(self, from: &Motion, most: &Budget, brakes: bool) -> Option<f32> {
        let [first, second, third] = [self.first, self.second, self.third].map(f32::from);
        // The sums of a unit of each value over all frames, and of the same times the frames before it.
        let (one, two) = (0.5 * (first + second), 0.5 * (second + third));
        let late_one =
            (first * first - 1.0) * (1.0 / 3.0) + (second - 1.0) * (3.0 * first + second - 2.0) * (1.0 / 6.0);
        let late_two = 0.5 * first * (second + 1.0)
            + (second * second - 1.0) * (1.0 / 3.0)
            + (third - 1.0) * (3.0 * (first + second) + third - 2.0) * (1.0 / 6.0);
        let speed = -(from.step + 0.5 * from.change * (first - 1.0));
        let place = from.at - from.change * (first - 1.0) * (first - 2.0) * (1.0 / 6.0);
        let share = 1.0 / (one * late_two - two * late_one);
        let (a, b) = ((speed * late_two - two * place) * share, (one * place - speed * late_one) * share);
        let within = |x: f32, frames: f32| x.abs() <= most.jerk * frames;
        let fits = within(a - from.change, first) && within(b - a, second) && within(b, third);
        let fits = fits && a.abs() <= most.change && b.abs() <= most.change && (!brakes || a * b >= 0.0);
        fits.then(|| from.change + (a - from.change) / first)
    }

    /// What is left of it after a frame; `None` at its end.
    pub fn next(self) -> Option<Self> {
        let Self { first, second, third } = self;
        match (first, second, third) {
            (2.., _, _) => Some(Self { first: first - 1, ..self }),
            (_, 2.., _) => Some(Self { second: second - 1, ..self }),
            (_, _, 2..) => Some(Self { third: third - 1, ..self }),
            _ => None,
        }
    }
}

/// A brake from a step and its change: frames in which it loses its acceleration or gains what it needs, keeps that, and loses it. They are
/// not whole, so that where it ends is a smooth function.
struct Brake {
    sign: f32,
    brake: f32,
    ramp: f32,
    hold: f32,
    release: f32,
}

impl Brake {
    fn new(step: f32, change: f32, budget: &Budget) -> Self {
        let Budget { change: most, jerk } = *budget;
        let per_jerk = 1.0 / jerk;
        // The step in the middle between two frames makes the sums those of smooth time.
        let middle = step - 0.5 * change;
        let end = middle + 0.5 * change * change.abs() * per_jerk;
        let sign = if end < 0.0 { -1.0 } else { 1.0 };
        let change = sign * change;
        let square = (jerk * sign * middle + 0.5 * change * change).max(0.0);
        let (brake, hold) =
            if square > most * most { (most, (square - most * most) / (jerk * most)) } else { (sqrt(square), 0.0) };
        Self { sign, brake, ramp: (change + brake) * per_jerk, hold, release: brake * per_jerk }
    }
}

/// Where it stands when it brakes from here. Cost: about 40 multiply-adds, a root, three divisions.
pub(super) fn end(from: &Motion, budget: &Budget) -> f32 {
    let Brake { sign, brake, ramp, hold, release } = Brake::new(from.step, from.change, budget);
    let slow = 0.5 * brake * (release - 1.0);
    let held = hold * slow + 0.5 * brake * hold * (hold - 1.0);
    let released = brake * (release - 1.0) * (release - 2.0) * (1.0 / 6.0);
    from.at + sign * (way(ramp, sign * from.step, sign * from.change, -budget.jerk) + held + released)
}
