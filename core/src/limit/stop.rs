//! How a coordinate comes to rest: the plan that every step of a coordinate with a jerk limit leaves open.

use super::axis::Bounds;
use super::land::Budget;
use crate::kernel::sqrt;

/// Rounding that a plan's rates may be beyond their bounds, as a share.
const SLACK: f32 = 1.0 + 1e-5;

/// Longer plans are not made: their sums would lose digits.
const LONGEST: f32 = 60_000.0;

/// Frames in which the acceleration goes to a middle value, in which it stays there, and in which it goes to 0, each evenly. The middle value
/// is the one with which the speed ends at 0 too, so that three counts are the whole plan.
///
/// At least one frame is left of the first phase. A plan without its next frame is a plan again: what follows it needs no new one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plan {
    ramp: u16,
    hold: u16,
    release: u16,
}

/// Position, last step and last change of step, rad or m per frame and per frame^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion {
    pub at: f32,
    pub step: f32,
    pub change: f32,
}

impl Plan {
    pub const REST: Self = Self { ramp: 1, hold: 0, release: 0 };

    /// The change of step of the next frame. Cost: two divisions.
    pub fn change(self, motion: &Motion) -> f32 {
        if self == Self::REST {
            return -motion.step;
        }
        let ramp = f32::from(self.ramp);
        motion.change + (self.middle(motion) - motion.change) / ramp
    }

    /// What is left of the plan after a frame.
    pub fn next(self) -> Self {
        let Self { ramp, hold, release } = self;
        match (ramp, hold) {
            (2.., _) => Self { ramp: ramp - 1, ..self },
            (_, 1..) => Self { ramp: 1, hold: hold - 1, release },
            _ => Self { ramp: 1, hold: 0, release: release.saturating_sub(1) },
        }
    }

    fn middle(self, motion: &Motion) -> f32 {
        let [ramp, hold, release] = [self.ramp, self.hold, self.release].map(f32::from);
        -(motion.step + 0.5 * motion.change * (ramp - 1.0)) / (0.5 * (ramp + release) + hold)
    }

    /// A plan to stop within the bounds and all rates; `None` if there is none of this form. Cost: about 60 multiply-adds, two roots
    /// and six divisions, up to three times.
    pub fn stop(motion: &Motion, bounds: &Bounds) -> Option<Self> {
        let Bounds { speed, change, jerk, .. } = *bounds;
        // The step in the middle between two frames makes the sums those of smooth time.
        let middle = motion.step - 0.5 * motion.change;
        let per_jerk = 1.0 / jerk;
        let end = middle + 0.5 * motion.change * motion.change.abs() * per_jerk;
        let sign = if end < 0.0 { -1.0 } else { 1.0 };
        let from = sign * motion.change;
        let square = (jerk * sign * middle + 0.5 * from * from).max(0.0);
        let (most, hold) = if square > change * change {
            (change, (square - change * change) / (jerk * change))
        } else {
            (sqrt(square), 0.0)
        };
        let (ramp, release) = ((from + most) * per_jerk, most * per_jerk);
        if !(ramp < LONGEST && hold < LONGEST && motion.step.abs() <= speed * SLACK) {
            return None;
        }
        let (ramp, hold, release) = (above(ramp).max(1), hold as u16, above(release));
        // Whole frames are not those of smooth time: mostly the first counts do, else others near them, or one even way in two halves.
        let less = release.saturating_sub(1);
        let near = [(0, 0, 1), (0, 0, 0), (0, 1, 1), (0, 1, 0), (1, 0, 1), (0, 0, 2), (1, 0, 2), (1, 1, 2)];
        let near = near.map(|(first, second, third)| (ramp + first, hold + second, less + third));
        let all = ramp.saturating_add(less);
        let even =
            [(all / 2, 0, all - all / 2), (all.saturating_sub(1), 0, 1), (all, 0, 1), (all / 2, 0, all - all / 2 + 1)];
        let mut plans =
            near.into_iter().chain(even).map(|(ramp, hold, release)| Self { ramp: ramp.max(1), hold, release });
        plans.find(|plan| plan.holds(motion, bounds))
    }

    /// How far it goes on the plan.
    fn way(self, motion: &Motion, middle: f32) -> f32 {
        let [ramp, hold, release] = [self.ramp, self.hold, self.release].map(f32::from);
        let slow = -0.5 * middle * (release - 1.0).max(0.0);
        let held = hold * slow - 0.5 * middle * hold * (hold - 1.0);
        let released = -middle * ((release - 1.0) * (release - 2.0)).max(0.0) * (1.0 / 6.0);
        way(ramp, motion.step, motion.change, (middle - motion.change) / ramp) + held + released
    }

    /// True if the whole way is within the bounds.
    fn holds(self, motion: &Motion, bounds: &Bounds) -> bool {
        let Bounds { lower, upper, speed, change, jerk } = *bounds;
        let (ramp, release) = (f32::from(self.ramp), f32::from(self.release));
        let middle = self.middle(motion);
        // Seen so that it brakes: at first it may go back, then it goes on until it stands.
        let sign = if middle > 0.0 { -1.0 } else { 1.0 };
        let [middle, step, from] = [middle, motion.step, motion.change].map(|x| sign * x);
        let rate = (middle - from) / ramp;
        if !(rate.abs() <= jerk * SLACK && -middle <= change * SLACK && -middle <= jerk * release * SLACK) {
            return false;
        }
        let (mut back, mut fastest) = (0.0, step);
        if from > 0.0 && rate < 0.0 {
            let frames = whole((-from / rate).min(ramp));
            fastest = step + from * frames + 0.5 * rate * frames * (frames + 1.0);
            if step < 0.0 {
                let half = from + 0.5 * rate;
                let root = sqrt((half * half - 2.0 * rate * step).max(0.0));
                let frames = whole((-2.0 * step / (half + root).max(1e-12)).min(ramp));
                back = way(frames, step, from, rate);
            }
        }
        let on = self.way(&Motion { at: 0.0, step, change: from }, middle);
        let (low, high) = (back.min(on).min(0.0), back.max(on).max(0.0));
        let (low, high) = if sign < 0.0 { (-high, -low) } else { (low, high) };
        fastest <= speed * SLACK && motion.at + low >= lower && motion.at + high <= upper
    }
}

/// Where a stop within these rates ends, frames counted whole; `None` if no plan is found. See [`Plan::stop`] for the cost.
pub(super) fn end(motion: &Motion, budget: &Budget) -> Option<f32> {
    const FAR: f32 = 1e30;
    let bounds = Bounds { lower: -FAR, upper: FAR, speed: FAR, change: budget.change, jerk: budget.jerk };
    let plan = Plan::stop(motion, &bounds)?;
    Some(motion.at + plan.way(motion, plan.middle(motion)))
}

/// How far it goes in so many frames, from a step and its change, at a constant jerk.
pub(super) fn way(frames: f32, step: f32, change: f32, jerk: f32) -> f32 {
    frames * (step + (frames + 1.0) * (0.5 * change + (frames + 2.0) * jerk * (1.0 / 6.0)))
}

/// The whole part of a number from 0 up.
fn whole(x: f32) -> f32 {
    x as u32 as f32
}

/// The least whole number that is not below `x`, but for rounding.
fn above(x: f32) -> u16 {
    let whole = x as u16;
    whole + u16::from(x - f32::from(whole) > 1e-3)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every state on a grid, as far as its rates allow; and the plan, walked frame by frame, is what was promised.
    #[test]
    fn there_is_always_a_plan_and_it_stops_within_the_rates() {
        const FAR: f32 = 1e6;
        for change in [5.3f32, 1.7, 40.0] {
            let bounds = Bounds { lower: -FAR, upper: FAR, speed: 1e5, change, jerk: 1.0 };
            for at in 0..120 * 120 {
                let (step, turn) = ((at % 120 - 60) as f32 * 0.37, (at / 120 - 60) as f32 * 0.173);
                if turn.abs() > change {
                    continue;
                }
                let mut motion = Motion { at: 0.0, step, change: turn };
                let end = end(&motion, &Budget { change, jerk: 1.0 }).unwrap();
                let mut plan = Plan::stop(&motion, &bounds).unwrap();
                for _ in 0..100 {
                    let next = plan.change(&motion);
                    assert!((next - motion.change).abs() < 1.001 && next.abs() < 1.001 * change, "{step} {turn}");
                    motion = Motion { at: motion.at + motion.step + next, step: motion.step + next, change: next };
                    plan = plan.next();
                }
                let stands = motion.step.abs() < 1e-4 && motion.change.abs() < 1e-4;
                assert!(stands && (motion.at - end).abs() < 1e-2, "{step} {turn}: {motion:?} {end}");
            }
        }
    }
}
