//! Foot contacts: low over the running ground estimate, and slow, with hysteresis in value and in time.

use nalgebra::Vector3;

use crate::kernel::sqrt;

/// When a foot stands. A foot has two points, ankle and toes; one is enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thresholds {
    /// A point slower than this, m/s, ...
    pub land_speed: f32,
    /// ... and lower than this over the ground, m, lands.
    pub land_height: f32,
    /// A standing foot lifts when no point is slower than this, m/s, ...
    pub lift_speed: f32,
    /// ... and lower than this, m.
    pub lift_height: f32,
    /// Time for which landing or lifting must be seen, s.
    pub dwell: f32,
    /// A foot slower than this, m/s, ...
    pub still_speed: f32,
    /// ... for this long, s, ...
    pub still_time: f32,
    /// ... at most this high over the ground, m, has found a higher ground (a step).
    pub step_height: f32,
    /// Time constant of the ground under a standing foot, s.
    pub settle: f32,
}

impl Default for Thresholds {
    fn default() -> Self {
        Self {
            land_speed: 0.7,
            land_height: 0.06,
            lift_speed: 1.0,
            lift_height: 0.1,
            dwell: 0.03,
            still_speed: 0.2,
            still_time: 0.1,
            step_height: 0.25,
            settle: 0.15,
        }
    }
}

/// Longest time in the air that is counted, s.
const LONGEST_AIR: f32 = 1.0;

/// One foot between frames.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub(crate) struct Foot {
    /// Ankle and toes, world, m.
    points: [Vector3<f32>; 2],
    /// Height of the ground under it, world, m.
    ground: f32,
    stands: bool,
    /// How long the other state has been seen, s.
    pending: f32,
    /// How long it has been still, s.
    still: f32,
    /// How long it has been in the air, s.
    air: f32,
}

/// Both feet as they are now: left, right.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Contacts {
    /// Whether the foot stands.
    pub stands: [bool; 2],
    /// Time in the air, s, at most 1.
    pub air: [f32; 2],
    /// Height of the ground under the foot, world, m.
    pub ground: [f32; 2],
}

/// Height of the sole: the lower of ankle and toes, each less its height in a flat foot.
fn sole(points: &[Vector3<f32>; 2], clearance: &[f32; 2]) -> f32 {
    let [ankle, toe] = points;
    let [over_ankle, over_toe] = clearance;
    (ankle.y - over_ankle).min(toe.y - over_toe)
}

/// The first frame: the lower foot stands, the other too if it is as low.
pub(crate) fn start(
    feet: &mut [Foot; 2],
    points: &[[Vector3<f32>; 2]; 2],
    clearance: &[[f32; 2]; 2],
    limits: &Thresholds,
) {
    let mut ground = f32::MAX;
    for (points, clearance) in points.iter().zip(clearance) {
        ground = ground.min(sole(points, clearance));
    }
    for ((foot, points), clearance) in feet.iter_mut().zip(points).zip(clearance) {
        let stands = sole(points, clearance) - ground < limits.land_height;
        *foot = Foot { points: *points, ground, stands, ..Foot::default() };
    }
}

/// One frame, `elapsed` seconds after the last.
pub(crate) fn advance(
    feet: &mut [Foot; 2],
    points: &[[Vector3<f32>; 2]; 2],
    clearance: &[[f32; 2]; 2],
    limits: &Thresholds,
    elapsed: f32,
) {
    let [left, right] = *feet;
    let others = [right, left];
    for (((foot, points), clearance), other) in feet.iter_mut().zip(points).zip(clearance).zip(others) {
        foot.advance(points, clearance, limits, elapsed, &other);
    }
}

impl Foot {
    /// Nothing seen yet.
    pub(crate) const fn new() -> Self {
        let nowhere = Vector3::new(0.0, 0.0, 0.0);
        Self { points: [nowhere; 2], ground: 0.0, stands: false, pending: 0.0, still: 0.0, air: 0.0 }
    }

    pub(crate) fn stands(&self) -> bool {
        self.stands
    }

    /// Height of the ground under it, world, m.
    pub(crate) fn ground(&self) -> f32 {
        self.ground
    }

    fn advance(
        &mut self,
        points: &[Vector3<f32>; 2],
        clearance: &[f32; 2],
        limits: &Thresholds,
        elapsed: f32,
        other: &Foot,
    ) {
        let sole = sole(points, clearance);
        if self.stands {
            self.ground += (sole - self.ground) * (elapsed / limits.settle).min(1.0);
        } else {
            // In the air it is over the ground on which the other foot stands, or lower.
            let below = if other.stands { other.ground } else { self.ground };
            self.ground = below.min(sole);
        }
        let (mut lands, mut stays, mut slowest) = (false, false, f32::MAX);
        for ((now, before), clearance) in points.iter().zip(&self.points).zip(clearance) {
            let moved = now - before;
            let speed = sqrt(moved.dot(&moved)) / elapsed;
            let height = now.y - clearance - self.ground;
            lands |= speed < limits.land_speed && height < limits.land_height;
            stays |= speed < limits.lift_speed && height < limits.lift_height;
            slowest = slowest.min(speed);
        }
        let climbed = slowest < limits.still_speed && sole - self.ground < limits.step_height;
        self.still = if climbed { (self.still + elapsed).min(LONGEST_AIR) } else { 0.0 };
        if !self.stands && self.still >= limits.still_time {
            self.ground = sole;
            lands = true;
        }
        let changes = if self.stands { !stays } else { lands };
        self.pending = if changes { self.pending + elapsed } else { 0.0 };
        if self.pending > limits.dwell {
            self.stands = !self.stands;
            self.pending = 0.0;
        }
        self.air = if self.stands { 0.0 } else { (self.air + elapsed).min(LONGEST_AIR) };
        self.points = *points;
    }
}

impl Contacts {
    pub(super) fn of(feet: &[Foot; 2]) -> Self {
        Self {
            stands: feet.map(|foot| foot.stands),
            air: feet.map(|foot| foot.air),
            ground: feet.map(|foot| foot.ground),
        }
    }
}
