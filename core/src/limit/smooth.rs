//! One coordinate with a jerk limit beside the others.
//!
//! A step is only taken if a [`Plan`] is known that brings the coordinate to rest within all limits after it. So there is always a
//! step that may be taken: the next one of that plan.

use super::axis::{Bounds, CATCH_UP, Coordinate, reach, within};
use super::stop::{Moving, Pace, Plan, Room, way_to_rest};

/// What a coordinate with a jerk limit remembers beside where it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Smooth {
    /// Change of its last step.
    change: f32,
    /// The target's last step.
    own: f32,
    /// What brings it to rest from here.
    plan: Plan,
}

/// Secants in the search of a jerk.
const SECANTS: u32 = 8;

/// Shares of what was sought, the rest from the known plan, until one is certain.
const SHARES: [f32; 4] = [1.0, 0.5, 0.25, 0.125];

/// Narrower ranges, rad or m, are rounding: no limit of rates is needed within.
const NARROW: f32 = 1e-6;

impl Smooth {
    /// At rest.
    pub const REST: Self = Self { change: 0.0, own: 0.0, plan: Plan::REST };

    /// One frame towards `target`, which lies within the bounds; `jerk` is above 0. Cost: about 100 multiply-adds, two roots and ten
    /// divisions where it is on its target; about ten times as many where it catches up.
    #[inline(never)]
    pub fn advance(&mut self, axis: Coordinate, target: f32, bounds: &Bounds, jerk: f32) -> Coordinate {
        if bounds.upper - bounds.lower <= NARROW {
            *self = Self::REST;
            return axis.advance(target, bounds);
        }
        let pace = Pace::of(bounds, jerk);
        let (far, own_far) = (axis.at.abs(), target.abs());
        let fine = 3.0 * f32::EPSILON * if far > own_far { far } else { own_far };
        // How the target moves. One that no coordinate could follow is taken to stand where it is.
        let likely = |x: f32, most: f32| if x.abs() > fine && x.abs() <= 1.001 * most + fine { x } else { 0.0 };
        let own = likely(target - (axis.at + axis.left), pace.speed);
        let pull = likely(own - self.own, pace.change);
        let goal = Goal { gap: target - axis.at, own, pull };
        let moving = Moving { step: axis.went, change: self.change };
        let now = Now { moving, room: Room::around(axis.at, bounds), pace, plan: self.plan, fine };
        let Next { step, moving, plan } = now.next(&goal);
        let reached = axis.at + step;
        // On the target without the rounding of the sum.
        let wanted = if step == goal.gap { target } else { reached };
        let at = within(wanted, bounds.lower, bounds.upper);
        *self = Self { change: moving.change, own, plan };
        if (at - reached).abs() > fine + NARROW {
            // The limits have changed, or it came to be outside of them.
            *self = Self { own, ..Self::REST };
            return Coordinate { at, went: 0.0, left: target - at };
        }
        Coordinate { at, went: moving.step, left: target - at }
    }
}

/// Where the target is and how it goes on, as far as one knows.
struct Goal {
    /// The way to it.
    gap: f32,
    /// Its last step.
    own: f32,
    /// The change of that.
    pull: f32,
}

impl Goal {
    fn stands(&self) -> bool {
        self.own == 0.0 && self.pull == 0.0
    }

    /// The same place, standing.
    fn standing(&self) -> Self {
        Self { gap: self.gap, own: 0.0, pull: 0.0 }
    }

    /// Share of change and jerk that catch up; the rest follows the target's own.
    fn share(&self, jerk: f32) -> f32 {
        if self.pull.abs() <= 0.125 * jerk { 1.0 } else { CATCH_UP }
    }
}

/// Where a coordinate is before a step.
struct Now {
    moving: Moving,
    room: Room,
    pace: Pace,
    plan: Plan,
    /// Rounding of positions.
    fine: f32,
}

/// A step, how the coordinate moves after it, and what then brings it to rest.
struct Next {
    step: f32,
    moving: Moving,
    plan: Plan,
}

impl Now {
    fn next(&self, goal: &Goal) -> Next {
        self.keep(goal)
            .or_else(|| self.land(goal))
            .or_else(|| self.arrive(goal))
            .or_else(|| self.approach(goal))
            .or_else(|| if goal.stands() { None } else { self.approach(&goal.standing()) })
            .unwrap_or_else(|| self.go_on(goal))
    }

    /// A step after which a plan is known.
    fn certain(&self, moving: Moving) -> Option<Next> {
        let plan = Plan::find(moving, self.room.after(moving.step), &self.pace)?;
        Some(Next { step: moving.step, moving, plan })
    }

    fn after(&self, jerk: f32) -> Moving {
        let change = self.moving.change + jerk;
        Moving { step: self.moving.step + change, change }
    }

    /// On along a plan that ends on a target that stands.
    fn keep(&self, goal: &Goal) -> Option<Next> {
        let slack = 0.02 * self.pace.jerk + self.fine + 32.0 * f32::EPSILON * goal.gap.abs();
        let arrives = goal.stands() && self.plan.arrives(self.moving, goal.gap, slack);
        arrives.then(|| self.go_on(goal))
    }

    /// On the target in this frame. In the two after it the rest of the difference in speed is taken away.
    fn land(&self, goal: &Goal) -> Option<Next> {
        let &Pace { speed, change: most, jerk } = &self.pace;
        let step = goal.gap;
        let change = step - self.moving.step;
        let (ahead, more) = (step - goal.own, change - goal.pull);
        let later = goal.share(jerk) * jerk;
        let fits = |x: f32, most: f32| x.abs() <= most + self.fine;
        let fits = fits(step, speed)
            && fits(change, most)
            && fits(change - self.moving.change, jerk)
            && fits(ahead, later)
            && fits(ahead + more, later);
        if fits { self.certain(Moving { step, change }) } else { None }
    }

    /// Onto a way that ends on a target that stands, without overshoot.
    fn arrive(&self, goal: &Goal) -> Option<Next> {
        if !goal.stands() {
            return None;
        }
        let range = self.range();
        let (jerk, plan) =
            Plan::arrive(self.moving, goal.gap, self.seek(goal, range), range, self.room, &self.pace)?;
        let moving = self.after(jerk);
        Some(Next { step: moving.step, moving, plan })
    }

    /// As fast as possible towards where the target will be.
    fn approach(&self, goal: &Goal) -> Option<Next> {
        let (safe, _) = self.plan.next(self.moving, &self.pace);
        let wanted = self.seek(goal, self.range());
        SHARES.into_iter().find_map(|share| self.certain(self.after(safe + share * (wanted - safe))))
    }

    /// The next step of the plan. Where the limits have changed it may be no more than the best that can be done.
    fn go_on(&self, goal: &Goal) -> Next {
        let &Pace { speed, change: most, jerk } = &self.pace;
        let lost = self.plan == Plan::REST && self.moving != (Moving { step: 0.0, change: 0.0 });
        let (push, plan) = match lost {
            true => (self.seek(&goal.standing(), self.range()), self.plan),
            false => self.plan.next(self.moving, &self.pace),
        };
        let change = within(self.moving.change + within(push, -jerk, jerk), -most, most);
        let step = within(self.moving.step + change, -speed, speed);
        Next { step, moving: Moving { step, change: step - self.moving.step }, plan }
    }

    /// Least and greatest jerk that leave change and speed within their limits.
    fn range(&self) -> (f32, f32) {
        let &Pace { speed, change: most, jerk } = &self.pace;
        let Moving { step, change } = self.moving;
        let (up, down) = (reach(speed - step, jerk), reach(speed + step, jerk));
        let high = if up < most { up } else { most } - change;
        let low = -if down < most { down } else { most } - change;
        (within(low, -jerk, jerk), within(high, -jerk, jerk))
    }

    /// The jerk after which coming to rest beside the target ends on it: the sign of what is missing says which way to push.
    fn seek(&self, goal: &Goal, (mut low, mut high): (f32, f32)) -> f32 {
        let share = goal.share(self.pace.jerk);
        let pace = Pace { change: share * self.pace.change, jerk: share * self.pace.jerk, ..self.pace };
        let beyond = |jerk: f32| {
            let Moving { step, change } = self.after(jerk);
            step - goal.gap + way_to_rest(Moving { step: step - goal.own, change: change - goal.pull }, &pace)
        };
        if low >= high {
            return within(0.0, high, low);
        }
        let (mut under, mut over) = (beyond(low), beyond(high));
        if over <= 0.0 {
            return high;
        }
        if under >= 0.0 {
            return low;
        }
        // False position, by the Illinois rule: an end that stays counts half.
        let (mut jerk, mut side) = (low, 0i8);
        for _ in 0..SECANTS {
            jerk = low + (high - low) * (under / (under - over));
            let found = beyond(jerk);
            if found > 0.0 {
                (high, over) = (jerk, found);
                under *= if side > 0 { 0.5 } else { 1.0 };
                side = 1;
            } else {
                (low, under) = (jerk, found);
                over *= if side < 0 { 0.5 } else { 1.0 };
                side = -1;
            }
        }
        jerk
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    struct Random(u64);

    impl Random {
        fn between(&mut self, a: f64, b: f64) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            a + (b - a) * (self.0 >> 33) as f64 / (1u64 << 31) as f64
        }

        /// Limits of all shapes, with their jerk.
        fn limits(&mut self, [lower, upper]: [f64; 2]) -> (Bounds, f32) {
            let mut power = |low, high| libm::exp2(self.between(low, high)) as f32;
            let (speed, change, jerk) = (0.2 * power(-4.0, 0.0), 0.1 * power(-6.0, 0.0), 0.05 * power(-8.0, 0.0));
            (Bounds { lower: lower as f32, upper: upper as f32, speed, change }, jerk)
        }
    }

    fn at(at: f32) -> (Coordinate, Smooth) {
        (Coordinate { at, went: 0.0, left: 0.0 }, Smooth::REST)
    }

    /// Frames of the fastest way between two places of rest, in continuous time.
    fn ideal(way: f64, &Bounds { speed, change, .. }: &Bounds, jerk: f32) -> f64 {
        let [v, a, j] = [speed, change, jerk].map(f64::from);
        let ramp = |v: f64| if v * j <= a * a { 2.0 * libm::sqrt(v / j) } else { v / a + a / j };
        if v * ramp(v) <= way {
            return ramp(v) + way / v;
        }
        let (mut low, mut high) = (0.0, v);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if middle * ramp(middle) < way { low = middle } else { high = middle }
        }
        2.0 * ramp(low)
    }

    #[test]
    fn a_jump_is_caught_up_with_at_once_and_without_overshoot() {
        let mut random = Random(7);
        let (mut latest, mut farthest, mut sum) = (0.0f64, 0.0f32, 0.0);
        const CASES: usize = 5_000;
        for _ in 0..CASES {
            let (bounds, jerk) = random.limits([-3.0, 3.0]);
            let from = random.between(-1.5, 1.0) as f32;
            // Steps of about one jerk look like a target that goes on.
            let to = (from + 2.0 * jerk + random.between(0.0, 1.0) as f32).min(3.0);
            let (mut x, mut smooth) = at(from);
            let mut frames = 0;
            while (x.left, x.went, smooth.change) != (0.0, 0.0, 0.0) || frames == 0 {
                x = smooth.advance(x, to, &bounds, jerk);
                farthest = farthest.max((x.at - to) / jerk);
                frames += 1;
                assert!(frames < 2_000, "{bounds:?} {jerk}: {x:?} {smooth:?}, to {to}");
            }
            let late = f64::from(frames) - ideal(f64::from(to - from), &bounds, jerk);
            (latest, sum) = (latest.max(late), sum + late);
        }
        std::println!("later than continuous time: {:.2} frames, at most {latest:.2}", sum / CASES as f64);
        std::println!("overshoot: {farthest} jerk dt^3");
        assert!(latest < 8.0 && farthest < 0.5);
    }

    #[test]
    fn motion_within_the_limits_passes_up_to_its_bounds() {
        let mut random = Random(5);
        for _ in 0..300 {
            // An S-curve from bound to bound and between frames, a thousandth within all rates.
            let (v, a, j) = (0.05, 0.004, random.between(1e-4, 1.2e-3));
            let (ease, ramp) = (f64::min(a / j, libm::sqrt(v / j)), f64::max(v / a, libm::sqrt(v / j)));
            let third = |t: f64| if t > 0.0 { j * t * t * t / 6.0 } else { 0.0 };
            let speeds_up = |t: f64| third(t) - third(t - ease) - third(t - ramp) + third(t - ramp - ease);
            let (whole, start) = (2.6 / v + ramp + ease, random.between(0.0, 1.0));
            let path = |t: f64| -1.3 + speeds_up(t) - speeds_up(t - (whole - ramp - ease));
            let [speed, change, jerk] = [v, a, j].map(|most| (1.001 * most) as f32);
            let bounds = Bounds { lower: -1.3, upper: 1.3, speed, change };
            let (mut x, mut smooth) = at(-1.3);
            for frame in 0..whole as i32 + 5 {
                let target = within(path(f64::from(frame) + start) as f32, bounds.lower, bounds.upper);
                x = smooth.advance(x, target, &bounds, jerk);
                assert!(x.left.abs() < 2e-6, "{j} frame {frame} of {whole}: {x:?}");
            }
            assert!((x.at - 1.3).abs() < 1e-5, "{x:?}");
        }
    }

    #[test]
    fn a_moving_target_is_caught_up_with() {
        let mut random = Random(11);
        for _ in 0..500 {
            let (rate, size) = (libm::exp2(random.between(-5.0, -2.0)), libm::exp2(random.between(-3.0, 0.5)));
            let spare = random.between(1.3, 2.0);
            let [_, v, a, j] = core::array::from_fn(|power| (spare * size * libm::pow(rate, power as f64)) as f32);
            let bounds = Bounds { lower: -3.0, upper: 3.0, speed: v, change: a };
            let (mut x, mut smooth) = at(random.between(-2.0, 2.0) as f32);
            for frame in 0..2_000 {
                x = smooth.advance(x, (size * libm::sin(rate * f64::from(frame))) as f32, &bounds, j);
                assert!(frame < 1_000 || x.left.abs() < 2e-6, "{rate} {size} {spare} frame {frame}: {x:?}");
            }
        }
    }

    #[test]
    fn limits_hold_after_anything() {
        let mut random = Random(1);
        let mut worst = [0.0f64; 3];
        for case in 0..2_000 {
            let (middle, half) = (random.between(-1.0, 1.0), libm::exp2(random.between(-6.0, 1.5)));
            let (bounds, jerk) = random.limits([middle - half, middle + half]);
            let ((mut x, mut smooth), mut target) = (at(middle as f32), middle);
            let (mut went, mut change) = (0.0, 0.0);
            for frame in 0..300 {
                match (case + frame / 60) % 4 {
                    0 if random.between(0.0, 1.0) > 0.03 => {}
                    0 => target = middle + half * random.between(-1.2, 1.2),
                    1 => target = middle + half * random.between(-1.2, 1.2),
                    kind => target = middle + half * 1.05 * libm::sin(f64::from(frame * kind * (case % 7)) * 0.04),
                }
                let before = f64::from(x.at);
                x = smooth.advance(x, within(target as f32, bounds.lower, bounds.upper), &bounds, jerk);
                assert!((bounds.lower..=bounds.upper).contains(&x.at));
                let step = f64::from(x.at) - before;
                let found = [step, step - went, step - went - change];
                (change, went) = (step - went, step);
                for ((worst, found), most) in worst.iter_mut().zip(found).zip([bounds.speed, bounds.change, jerk]) {
                    *worst = worst.max(found.abs() - f64::from(most));
                }
            }
        }
        std::println!("most beyond the limits of speed, change, jerk: {worst:?}");
        assert!(worst.iter().all(|excess| *excess < 1.5e-6), "{worst:?}");
    }
}
