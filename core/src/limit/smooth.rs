//! One coordinate under position, velocity, acceleration and jerk limits.
//!
//! Every step leaves a [plan](Plan) to stop within all limits. A step that leaves none is not made: the plan of the step before goes on
//! instead, so that there always is one. Which of the other steps is made decides how well the target is followed, not what is guaranteed.

use super::axis::{Along, Axis, Bounds, CATCH_UP, Plain, within};
use super::land::{Budget, Way, end};
use super::stop::{Motion, Plan, end as stop_end};
use crate::kernel::sqrt;

/// Share of the rates that catches up with a target that stands still.
const STILL: f32 = 0.95;

/// Share of the rates that the last part of the way to a moving target may take: some room beside the share that it is made for.
const LANDING: f32 = 0.6;

/// Rounds of the searches for a step.
const ROUNDS: usize = 10;

/// A coordinate that may have a jerk limit: where it is, and what it has in mind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smooth {
    axis: Plain,
    /// Last change of its step.
    change: f32,
    /// The last target, its last step and the last change of that.
    target: Motion,
    plan: Plan,
    /// The way to the target, once it brakes for it.
    way: Option<Way>,
}

impl Axis for Smooth {}

impl Along for Smooth {
    const JERK: bool = true;
    const REST: Self = Self {
        axis: Plain::REST,
        change: 0.0,
        target: Motion { at: 0.0, step: 0.0, change: 0.0 },
        plan: Plan::REST,
        way: None,
    };

    fn standing(at: f32) -> Self {
        Self { axis: Plain::standing(at), target: Motion { at, ..Self::REST.target }, ..Self::REST }
    }

    fn at(&self) -> f32 {
        self.axis.at
    }

    fn left(&self) -> f32 {
        self.axis.left
    }

    fn advance(&mut self, target: f32, bounds: &Bounds) {
        if bounds.jerk > 0.0 {
            self.axis = self.smoothly(target, bounds);
            return;
        }
        // Another table may limit its jerk from here on.
        let axis = self.axis.gone(target, bounds);
        *self = Self { change: axis.went - self.axis.went, axis, ..Self::standing(target) };
    }
}

impl Smooth {
    /// One frame towards `target`, which lies within the bounds. Cost: about 100 multiply-adds, three roots and ten divisions where the
    /// target can be followed, up to twenty times as much where it has to be caught up with.
    fn smoothly(&mut self, target: f32, bounds: &Bounds) -> Plain {
        let axis = self.axis;
        let last = self.target;
        self.target = followed(last, target);
        let own = self.own(&last, bounds);
        let here = Motion { at: axis.at, step: axis.went, change: self.change };
        let step = target - here.at;
        let exact = Motion { at: target, step, change: step - here.step };
        let (motion, plan) = match self.lands(&here, &exact, &own, bounds) {
            Some(plan) => (exact, plan),
            None => self.chase(&here, &own, bounds),
        };
        let at = within(motion.at, bounds.lower, bounds.upper);
        let rounding = 4.0 * f32::EPSILON * bounds.upper.max(-bounds.lower);
        if (at - motion.at).abs() > 1e-4 * bounds.speed + 1e-6 + rounding {
            // Other limits than a frame ago: it stands at the bound.
            *self = Self { target: self.target, ..Self::REST };
            return Plain { at, went: 0.0, left: target - at };
        }
        (self.change, self.plan) = (motion.change, plan);
        Plain { at, went: motion.step, left: target - at }
    }

    /// The target's own motion, if it is one that could be followed; else it counts as standing.
    fn own(&self, last: &Motion, bounds: &Bounds) -> Motion {
        let Motion { at, step, change } = self.target;
        let jerk = (change - last.change).abs();
        let smooth = step.abs() <= bounds.speed && change.abs() <= bounds.change && jerk <= bounds.jerk;
        if smooth { self.target } else { Motion { at, step: 0.0, change: 0.0 } }
    }

    /// The plan after a step onto the target, if it may be made.
    fn lands(&self, here: &Motion, exact: &Motion, own: &Motion, bounds: &Bounds) -> Option<Plan> {
        let Bounds { lower, upper, speed, change, jerk } = *bounds;
        let rounding = 2.0 * f32::EPSILON * upper.max(-lower);
        // What is left of the way to the target is lost in the next two frames.
        let (step, turn) = (exact.step - own.step, exact.change - own.change);
        let (step, left) = (step.abs(), (step + turn).abs().max(step.abs()));
        let share = if stands(own) { 1.0 } else { LANDING };
        let fits = exact.step.abs() <= speed + rounding
            && exact.change.abs() <= change + rounding
            && (exact.change - here.change).abs() <= jerk + rounding
            && step <= share * change + rounding
            && left <= share * jerk + rounding;
        if fits { Plan::stop(exact, bounds) } else { None }
    }

    /// A step that can still come to the target without going beyond it, as fast as it may.
    fn chase(&mut self, here: &Motion, own: &Motion, bounds: &Bounds) -> (Motion, Plan) {
        let after = |change: f32| {
            let step = here.step + change;
            Motion { at: here.at + step, step, change }
        };
        // Seen from the target, which goes on as it does now.
        let from = |motion: &Motion, own: &Motion| Motion {
            at: motion.at - own.at,
            step: motion.step - own.step,
            change: motion.change - own.change,
        };
        let (aim, most) = if stands(own) { (STILL, 1.0) } else { (CATCH_UP, LANDING) };
        let budget = |share: f32| Budget { change: share * bounds.change, jerk: share * bounds.jerk };
        let (aim, most) = (budget(aim), budget(most));
        let before = Motion { at: own.at - own.step, step: own.step - own.change, change: own.change };
        let start = from(here, &before);
        let known = self.way.and_then(|way| Some((way, way.change(&start, &most)?)));
        if let Some((way, change)) = known.or_else(|| Way::begin(&start, &aim, &most)) {
            let change = own.change + change;
            let fits = change.abs() <= bounds.change && (change - here.change).abs() <= bounds.jerk;
            if let Some(plan) = fits.then(|| Plan::stop(&after(change), bounds)).flatten() {
                self.way = way.next();
                return (after(change), plan);
            }
        }
        self.way = None;
        let stands = |change: f32| {
            let motion = from(&after(change), own);
            stop_end(&motion, &aim).unwrap_or_else(|| end(&motion, &aim))
        };
        let mut wanted = crossing(stands, ends(here, bounds), here.at < own.at);
        if let Some(plan) = Plan::stop(&after(wanted), bounds) {
            return (after(wanted), plan);
        }
        let planned = self.plan.change(here);
        let (mut safe, mut found) = (planned, (after(planned), self.plan.next()));
        for _ in 0..ROUNDS {
            let between = 0.5 * (safe + wanted);
            match Plan::stop(&after(between), bounds) {
                Some(plan) => (safe, found) = (between, (after(between), plan)),
                None => wanted = between,
            }
        }
        found
    }
}

/// True for a target that stands.
fn stands(own: &Motion) -> bool {
    own.step == 0.0 && own.change == 0.0
}

/// The target one frame on.
fn followed(last: Motion, at: f32) -> Motion {
    let step = at - last.at;
    Motion { at, step, change: step - last.step }
}

/// The changes of step that acceleration, jerk and speed allow: with the greatest one it can just go back to 0 before it is too fast.
fn ends(here: &Motion, bounds: &Bounds) -> (f32, f32) {
    let Bounds { speed, change, jerk, .. } = *bounds;
    // The root less half the jerk, without their difference.
    let most = |room: f32| {
        let room = room.max(-0.125 * jerk);
        2.0 * jerk * room / (sqrt((0.25 * jerk * jerk + 2.0 * jerk * room).max(0.0)) + 0.5 * jerk)
    };
    let low = (here.change - jerk).max(-change).max(-most(speed + here.step));
    let high = (here.change + jerk).min(change).min(most(speed - here.step));
    (low.min(high), high)
}

/// Where a rising function becomes positive between two ends, or the end that is nearest to it; from below, or from above. Stops count whole
/// frames, so that it may jump.
fn crossing(function: impl Fn(f32) -> f32, (mut low, mut high): (f32, f32), below: bool) -> f32 {
    if function(low) >= 0.0 {
        return low;
    }
    if function(high) <= 0.0 {
        return high;
    }
    for _ in 0..ROUNDS {
        let middle = 0.5 * (low + high);
        if function(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    if below { low } else { high }
}

#[cfg(test)]
mod tests;
