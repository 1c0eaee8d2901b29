//! How a coordinate with a jerk limit comes to rest: a plan that is checked, and a way that is only estimated.

use super::axis::{Bounds, within};
use crate::kernel::sqrt;

/// Largest step, change of a step, and change of that, a frame: `velocity dt`, `acceleration dt^2`, `jerk dt^3`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    pub speed: f32,
    pub change: f32,
    pub jerk: f32,
}

impl Pace {
    /// That of a coordinate. No range allows a greater step than itself, nor more of the change and its change.
    pub fn of(&Bounds { lower, upper, speed, change }: &Bounds, jerk: f32) -> Self {
        let least = |a: f32, b: f32| if a < b { a } else { b };
        let speed = least(speed, upper - lower);
        let change = least(change, 2.0 * speed);
        Self { speed, change, jerk: least(jerk, 2.0 * change) }
    }

    /// True if single precision and the counts of a plan can hold it: stopping takes a few thousand frames at most.
    pub fn is_sound(&self, farthest: f32) -> bool {
        let &Self { speed, change, jerk } = self;
        jerk >= 2.0 * f32::EPSILON * farthest && speed <= 1e6 * jerk && speed <= 4e3 * change
    }
}

/// How a coordinate moves: its step, and the change of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moving {
    pub step: f32,
    pub change: f32,
}

/// Frames of easing out: `ease` with one jerk, `hold` without, `rest` with one jerk. Whole numbers.
#[derive(Clone, Copy, Debug)]
struct Phases {
    ease: f32,
    hold: f32,
    rest: f32,
}

/// Frames that bring a coordinate to rest: all brakes on for `turn` of them (down if positive, up if negative), then `ease` with one
/// jerk, `hold` without, `rest` with one jerk. The jerks follow from where the coordinate is: see [`Plan::next`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Plan {
    turn: i16,
    ease: u16,
    hold: u16,
    rest: u16,
}

/// Relative slack of whole numbers and of rates in a plan: rounding.
const SLACK: f32 = 1e-5;

/// No phase has as many frames.
const LONGEST: f32 = 32_767.0;

/// Least whole number that is not below `x`.
fn up(x: f32) -> f32 {
    let whole = down(x);
    if x > whole + SLACK { whole + 1.0 } else { whole }
}

/// Greatest whole number that is not above `x`, and not below 0. No phase is longer than 32767 frames.
fn down(x: f32) -> f32 {
    let x = if x < LONGEST { x } else { LONGEST };
    x as u16 as f32
}

/// Ways of arriving that are tried: how many frames more than the shortest phases.
const SLOWER: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [2.0, 0.0, 1.0],
    [2.0, 0.0, 2.0],
];

/// Jerks beyond the limit from which no slower way leads back.
const FAR_OFF: f32 = 8.0;

/// Way and gain of speed in `n` frames with one jerk.
fn phase(Moving { step, change }: Moving, jerk: f32, n: f32) -> (f32, f32) {
    let (two, three) = (0.5 * n * (n + 1.0), n * (n + 1.0) * (n + 2.0) * (1.0 / 6.0));
    (n * step + change * two + jerk * three, n * change + jerk * two)
}

/// The way until rest by jerks of full size, as far as whole frames do not matter, rad or m. It is smooth, so that a root can be
/// sought; it is exact where phases last whole frames. Cost: 30 multiply-adds, a root, four divisions.
pub(super) fn way_to_rest(moving: Moving, pace: &Pace) -> f32 {
    let &Pace { change: most, jerk, .. } = pace;
    let per = 1.0 / jerk;
    let (aligned, peak) = peak(moving, pace);
    let sign = if aligned == moving { 1.0 } else { -1.0 };
    let (first, last) = ((aligned.change + peak) * per, peak * per);
    let (frames, push) = if first < 0.0 { (-first, jerk) } else { (first, -jerk) };
    let (way, gain) = phase(aligned, push, frames);
    let step = aligned.step + gain;
    let held = if peak < most { 0.0 } else { (step - 0.5 * peak * (last - 1.0)) / most };
    let (hold, _) = phase(Moving { step, change: -peak }, 0.0, if held > 0.0 { held } else { 0.0 });
    sign * (way + hold + jerk * last * (last - 1.0) * (last - 2.0) * (1.0 / 6.0))
}

/// How far it may go down (not above 0) and up (not below 0).
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    pub below: f32,
    pub above: f32,
}

impl Moving {
    fn mirrored(self) -> Self {
        Self { step: -self.step, change: -self.change }
    }
}

/// The same motion with the sign that has to be pushed down, and the change of full size until which full jerks have to push.
fn peak(moving: Moving, &Pace { change: most, jerk, .. }: &Pace) -> (Moving, f32) {
    let wound = |Moving { step, change }: Moving, back: f32| step + 0.5 * change * (back / jerk - 1.0);
    // The speed that is left when the change is wound down at once says which way to push.
    let moving = if wound(moving, moving.change.abs()) < 0.0 { moving.mirrored() } else { moving };
    let square = jerk * wound(moving, moving.change);
    let peak = if square > 0.0 { sqrt(square) } else { 0.0 };
    (moving, if peak < most { peak } else { most })
}

impl Room {
    /// That of a coordinate at `at`.
    pub fn around(at: f32, &Bounds { lower, upper, .. }: &Bounds) -> Self {
        Self { below: lower - at, above: upper - at }
    }

    fn mirrored(self) -> Self {
        Self { below: -self.above, above: -self.below }
    }

    /// What is left of it after a way.
    pub fn after(self, way: f32) -> Self {
        Self { below: self.below - way, above: self.above - way }
    }
}

impl Phases {
    /// The shortest that full jerks allow, in whole frames; `more` of them on either side.
    fn of(moving: Moving, pace: &Pace, more: f32) -> Self {
        let &Pace { change: most, jerk, .. } = pace;
        let per = 1.0 / jerk;
        let (Moving { step, change }, peak) = peak(moving, pace);
        let long = |frames: f32| if frames < 1.0 { 1.0 } else { frames };
        let (ease, rest) = (long(up((change + peak) * per) + more), long(up(peak * per) + more));
        let held = (step + 0.5 * change * (ease - 1.0)) / most - 0.5 * (ease + rest);
        Self { ease, hold: if peak < most { 0.0 } else { up(held) }, rest }
    }

    /// The change of the middle phase, by which the speed ends at nothing.
    fn level(self, Moving { step, change }: Moving) -> f32 {
        -(step + 0.5 * change * (self.ease - 1.0)) / (self.hold + 0.5 * (self.ease + self.rest))
    }

    /// The way until rest.
    fn way(self, moving: Moving) -> f32 {
        let eased = self.ease > 0.0;
        let level = if eased { self.level(moving) } else { moving.change };
        let push = if eased { (level - moving.change) / self.ease } else { 0.0 };
        let (eased, gain) = phase(moving, push, self.ease);
        let step = moving.step + gain;
        let (held, gain) = phase(Moving { step, change: level }, 0.0, self.hold);
        let (rest, _) = phase(Moving { step: step + gain, change: level }, -level / self.rest, self.rest);
        eased + held + rest
    }

    /// True if nothing on the way is beyond a limit.
    fn is_sound(self, moving: Moving, room: Room, pace: &Pace) -> bool {
        let &Pace { speed, change: most, jerk } = pace;
        let level = self.level(moving);
        // So that the speed is taken away downwards.
        let (level, Moving { step, change }, room) =
            if level > 0.0 { (-level, moving.mirrored(), room.mirrored()) } else { (level, moving, room) };
        let fits = |found: f32, most: f32| found.abs() <= most * (1.0 + SLACK);
        let short = |frames: f32| frames < LONGEST;
        if !(fits(level, most)
            && fits(level - change, self.ease * jerk)
            && fits(level, self.rest * jerk)
            && short(self.ease)
            && short(self.hold)
            && short(self.rest))
        {
            return false;
        }
        let start = Moving { step, change };
        let slack = SLACK * jerk;
        // It ends at its highest place. If it still gains speed, it may first go down, and be fastest on the way.
        if self.way(start) > room.above + slack {
            return false;
        }
        if change <= 0.0 {
            return true;
        }
        let push = (level - change) / self.ease;
        let (_, gain) = phase(start, push, down(change / -push));
        if step + gain > speed * (1.0 + SLACK) {
            return false;
        }
        let middle = change + 0.5 * push;
        let square = middle * middle - 2.0 * push * step;
        let turns = down(-2.0 * step / (middle + if square > 0.0 { sqrt(square) } else { 0.0 }));
        let (dip, _) = phase(start, push, if turns < self.ease { turns } else { self.ease });
        step >= 0.0 || dip >= room.below - slack
    }

    fn plan(self) -> Plan {
        Plan { turn: 0, ease: self.ease as u16, hold: self.hold as u16, rest: self.rest as u16 }
    }
}

impl Plan {
    /// Nothing to do.
    pub const REST: Self = Self { turn: 0, ease: 0, hold: 0, rest: 0 };

    /// A plan that brings the coordinate to rest within all limits, if one is found: by easing out at once, or after turning round.
    /// Cost: at most 300 multiply-adds, nine roots, thirty divisions; mostly a third of it.
    pub fn find(moving: Moving, room: Room, pace: &Pace) -> Option<Self> {
        if moving.step == 0.0 && moving.change == 0.0 {
            return Some(Self::REST);
        }
        Self::ease_out(moving, room, pace).or_else(|| Self::turn_round(moving, room, pace))
    }

    /// Easing out. Whole frames may ask for a little more than the shortest phases.
    fn ease_out(moving: Moving, room: Room, pace: &Pace) -> Option<Self> {
        let all = [0.0, 1.0, 2.0].into_iter().map(|more| Phases::of(moving, pace, more));
        all.into_iter().find(|phases| phases.is_sound(moving, room, pace)).map(Phases::plan)
    }

    /// A jerk near `guess`, within `range`, after which easing out ends `gap` from here, and the plan for it.
    pub fn arrive(
        Moving { step, change }: Moving,
        gap: f32,
        guess: f32,
        range: (f32, f32),
        room: Room,
        pace: &Pace,
    ) -> Option<(f32, Self)> {
        let after = |push: f32| Moving { step: step + change + push, change: change + push };
        let shortest = Phases::of(after(guess), pace, 0.0);
        for [ease, hold, rest] in SLOWER {
            let phases = Phases { ease: shortest.ease + ease, hold: shortest.hold + hold, rest: shortest.rest + rest };
            // The way is linear in the jerk.
            let way = |push: f32| after(push).step + phases.way(after(push));
            let (from, to) = (way(0.0), way(pace.jerk));
            let push = pace.jerk * ((gap - from) / (to - from));
            if push > FAR_OFF * pace.jerk {
                // No way is so much slower.
                return None;
            }
            let moving = after(push);
            // Not from beyond: the last push takes the speed of the way away.
            let ahead = phases.level(moving) * (gap - moving.step) <= 0.0;
            if ahead && range.0 <= push && push <= range.1 && phases.is_sound(moving, room.after(moving.step), pace) {
                return Some((push, phases.plan()));
            }
        }
        None
    }

    /// True if this plan has more than three frames, and ends `gap` from here, to `slack`.
    pub fn arrives(self, moving: Moving, gap: f32, slack: f32) -> bool {
        let phases = self.phases();
        let frames = phases.ease + phases.hold + phases.rest;
        self.turn == 0 && frames > 3.0 && (phases.way(moving) - gap).abs() <= slack
    }

    /// Turning round: all brakes on until it has turned, then easing out. No other way goes less far ahead.
    fn turn_round(moving: Moving, room: Room, pace: &Pace) -> Option<Self> {
        let &Pace { speed, change: most, jerk } = pace;
        let back = moving.step < 0.0;
        let (start, room) = if back { (moving.mirrored(), room.mirrored()) } else { (moving, room) };
        let Moving { step, change } = start;
        if change > 0.0 {
            let (_, gain) = phase(start, -jerk, down(change / jerk));
            if step + gain > speed * (1.0 + SLACK) {
                return None;
            }
        }
        // All brakes on for some frames: the change grows to its most, and stays there.
        let full = down((change + most) / jerk);
        let braked = |frames: f32| {
            let (grows, stays) = if frames < full { (frames, 0.0) } else { (full, frames - full) };
            let (way, gain) = phase(start, -jerk, grows);
            let change = if stays > 0.0 { -most } else { change - grows * jerk };
            let (ahead, fall) = phase(Moving { step: step + gain, change }, 0.0, stays);
            (way + ahead, Moving { step: step + gain + fall, change })
        };
        let middle = change - 0.5 * jerk;
        let stands = down((middle + sqrt(middle * middle + 2.0 * jerk * step)) / jerk);
        let stands = if stands < full { stands } else { full + down(braked(full).1.step / most) };
        let (ahead, _) = braked(stands);
        if ahead > room.above + SLACK * jerk {
            return None;
        }
        // One frame more, and it goes back; where there is no room behind, half of what easing out would do without.
        let eases = Phases::of(start, pace, 0.0).ease;
        [stands + 1.0, down(0.5 * (eases + stands))].into_iter().find_map(|turn| {
            let (way, now) = braked(turn);
            let rest = Self::ease_out(now, room.after(way), pace).filter(|_| (1.0..LONGEST).contains(&turn))?;
            Some(Self { turn: if back { -(turn as i16) } else { turn as i16 }, ..rest })
        })
    }

    /// The jerk of the next frame, and the plan after it. A plan that is over leaves everything as it is.
    pub fn next(self, moving: Moving, pace: &Pace) -> (f32, Self) {
        let change = moving.change;
        if self.turn != 0 {
            let down = self.turn > 0;
            let to = if down { -pace.change } else { pace.change };
            return (within(to - change, -pace.jerk, pace.jerk), Self { turn: if down { self.turn - 1 } else { self.turn + 1 }, ..self });
        }
        if self.ease > 0 {
            let ease = f32::from(self.ease);
            return ((self.phases().level(moving) - change) / ease, Self { ease: self.ease - 1, ..self });
        }
        if self.hold > 0 {
            return (0.0, Self { hold: self.hold - 1, ..self });
        }
        match self.rest {
            0 => (0.0, self),
            rest => (-change / f32::from(rest), Self { rest: rest - 1, ..self }),
        }
    }

    fn phases(self) -> Phases {
        Phases { ease: f32::from(self.ease), hold: f32::from(self.hold), rest: f32::from(self.rest) }
    }
}
