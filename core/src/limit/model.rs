//! The limiter: a checked, immutable view of the tables.

use core::marker::PhantomData;

use super::axis::{Axis, Bounds, CATCH_UP, Plain, reach, stop_frames};
use super::smooth::Smooth;
use crate::engine::FromPack;
use crate::kernel::sqrt;
use crate::model::{LimitsMeta, LoadError, ModelMeta, Pack};
use crate::rig::Rig;

/// The limits of every coordinate, as a pack holds them or as given. All slices have one entry per row of coordinates; what a row
/// does not use is 0.
#[derive(Clone, Copy, Debug)]
pub struct LimitTable<'a> {
    /// Least coordinates, rad or m.
    pub lower: &'a [[f32; 3]],
    /// Greatest coordinates, rad or m.
    pub upper: &'a [[f32; 3]],
    /// Largest speed of each coordinate, rad/s or m/s.
    pub velocity: &'a [[f32; 3]],
    /// Largest acceleration of each coordinate, rad/s^2 or m/s^2.
    pub acceleration: &'a [[f32; 3]],
    /// Largest jerk of each coordinate, rad/s^3 or m/s^3; 0 for one without a jerk limit. May be empty: then none has one.
    pub jerk: &'a [[f32; 3]],
    /// Coordinates at rest, where a joint starts and where it goes when frames fail to come.
    pub rest: &'a [[f32; 3]],
}

/// Limits of position, velocity and acceleration. A pack that limits jerk too is refused.
pub type Limiter<'a, const ROWS: usize> = LimiterOf<'a, ROWS, Plain>;

/// Limits of position, velocity, acceleration and, where the table has them, jerk. Code and state are larger than a [`Limiter`]'s; what
/// has no jerk limit goes the same way, to the bit.
pub type SmoothLimiter<'a, const ROWS: usize> = LimiterOf<'a, ROWS, Smooth>;

/// The last stage: limits for up to `ROWS` rows of coordinates, borrowed from a pack or from given tables. `A` is what it remembers of each
/// coordinate.
#[derive(Clone, Copy, Debug)]
pub struct LimiterOf<'a, const ROWS: usize, A> {
    meta: LimitsMeta,
    table: LimitTable<'a>,
    rig: Rig<'a>,
    frame_time: f32,
    pub(super) root: Rates,
    pub(super) heading: Rates,
    pub(super) hold_frames: u32,
    /// Share of the way to rest in a frame.
    pub(super) decay: f32,
    axis: PhantomData<A>,
}

/// Largest step, and largest change of a step, per frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rates {
    pub speed: f32,
    pub change: f32,
}

/// One coordinate's limits.
pub(super) struct Limit {
    pub bounds: Bounds,
    pub rest: f32,
}

/// Steps a frame, rad or m, that single precision can still tell apart, and that are still numbers.
pub const STEPS: core::ops::Range<f32> = 1e-6..1e6;

/// A stop that takes more frames than this is not planned.
pub const LONGEST_STOP: f32 = 1e4;

/// Coordinates lie within this, rad or m.
const FARTHEST: f32 = 100.0;

impl<'a, const ROWS: usize, A: Axis> LimiterOf<'a, ROWS, A> {
    /// The limits of a pack, after every check that makes [`step`](Self::step) infallible.
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        let metadata = pack.metadata();
        let meta = metadata
            .models
            .iter()
            .find_map(ModelMeta::limits)
            .ok_or(LoadError::NoModel { expected: "joint limits" })?;
        let rig = Rig::load(pack)?;
        let rows = rig.rows();
        let jerk = match pack.slice("limit/jerk", rows) {
            Err(LoadError::NoTensor { .. }) => &[][..],
            other => other?,
        };
        let table = LimitTable {
            lower: pack.slice("limit/lower", rows)?,
            upper: pack.slice("limit/upper", rows)?,
            velocity: pack.slice("limit/velocity", rows)?,
            acceleration: pack.slice("limit/acceleration", rows)?,
            jerk,
            rest: pack.slice("limit/rest", rows)?,
        };
        Self::new(rig, table, meta, metadata.frame_rate)
    }

    /// The limits of given tables on a rig, stepped `frame_rate` times a second.
    ///
    /// Refused with the table's name and the row: other numbers of entries, ranges without the rest position in them, rates so low that a
    /// frame's step, `velocity dt`, `acceleration dt^2` or `jerk dt^3`, is below 1e-6, jerks so low that a stop takes more than ten thousand frames,
    /// times that are negative.
    pub fn new(rig: Rig<'a>, table: LimitTable<'a>, meta: LimitsMeta, frame_rate: f32) -> Result<Self, LoadError> {
        let rows = rig.rows();
        if rows > ROWS {
            return Err(LoadError::Capacity { parameter: "ROWS", found: rows, capacity: ROWS });
        }
        let frame_time = 1.0 / frame_rate;
        let rates = |velocity, acceleration| Rates {
            speed: velocity * frame_time,
            change: acceleration * (frame_time * frame_time),
        };
        let root = rates(meta.root_velocity, meta.root_acceleration);
        let heading = rates(meta.heading_velocity, meta.heading_acceleration);
        let steps = [root.speed, root.change, heading.speed, heading.change];
        let sound = (1.0..1e4).contains(&frame_rate)
            && steps.iter().all(|step| STEPS.contains(step))
            && [meta.hold, meta.decay].iter().all(|time| (0.0..1e5).contains(time));
        if rows == 0 || !sound {
            return Err(LoadError::Metadata);
        }
        let limiter = Self {
            meta,
            table,
            rig,
            frame_time,
            root,
            heading,
            hold_frames: (meta.hold * frame_rate + 0.5) as u32,
            decay: if meta.decay > frame_time { frame_time / meta.decay } else { 1.0 },
            axis: PhantomData,
        };
        limiter.check_table(rows)?;
        Ok(limiter)
    }

    fn check_table(&self, rows: usize) -> Result<(), LoadError> {
        let table = &self.table;
        let counts = [
            ("limit/lower", table.lower.len()),
            ("limit/upper", table.upper.len()),
            ("limit/velocity", table.velocity.len()),
            ("limit/acceleration", table.acceleration.len()),
            ("limit/jerk", if table.jerk.is_empty() { rows } else { table.jerk.len() }),
            ("limit/rest", table.rest.len()),
        ];
        if let Some((tensor, found)) = counts.into_iter().find(|(_, count)| *count != rows) {
            return Err(LoadError::Shape { tensor, found, expected: rows });
        }
        if !A::JERK && table.jerk.as_flattened().iter().any(|jerk| *jerk != 0.0) {
            return Err(LoadError::Jerk);
        }
        let height = self.rig.travels().then_some(1);
        let joints = self.rig.places().flat_map(|(kind, first)| first..first + kind.coordinates());
        let mut used = height.into_iter().chain(joints).peekable();
        for (index, limit) in self.limits().enumerate() {
            let refuse = |tensor| Err(LoadError::Value { tensor, index: index / 3 });
            let used = used.next_if_eq(&index).is_some();
            let Some(Limit { bounds, rest }) = limit else {
                if used {
                    return refuse("limit/velocity");
                }
                continue;
            };
            let Bounds { lower, upper, speed, change, jerk } = bounds;
            if !used || !STEPS.contains(&speed) {
                return refuse("limit/velocity");
            }
            if !STEPS.contains(&change) {
                return refuse("limit/acceleration");
            }
            let given = table.jerk.as_flattened().get(index).is_some_and(|jerk| *jerk != 0.0);
            if given && !(STEPS.contains(&jerk) && stop_frames(speed, change, jerk) < LONGEST_STOP) {
                return refuse("limit/jerk");
            }
            if !(lower.abs() <= FARTHEST && lower <= upper) {
                return refuse("limit/lower");
            }
            if upper.abs() > FARTHEST {
                return refuse("limit/upper");
            }
            if !(lower..=upper).contains(&rest) {
                return refuse("limit/rest");
            }
        }
        Ok(())
    }

    /// The limits of every coordinate, in order; `None` for travel, and for what a row does not use. Cost: two products per coordinate.
    pub(super) fn limits(&self) -> impl Iterator<Item = Option<Limit>> + use<'a, ROWS, A> {
        let (table, time) = (self.table, self.frame_time);
        let flat = |rows: &'a [[f32; 3]]| rows.as_flattened().iter();
        let ranges = flat(table.lower).zip(flat(table.upper)).zip(flat(table.rest));
        let rates = flat(table.velocity).zip(flat(table.acceleration));
        let mut jerks = flat(table.jerk);
        ranges.zip(rates).map(move |(((lower, upper), rest), (velocity, acceleration))| {
            let (speed, change) = (velocity * time, acceleration * (time * time));
            let jerk = if A::JERK { jerks.next().map_or(0.0, |jerk| jerk * (time * time * time)) } else { 0.0 };
            let limit = Limit { bounds: Bounds { lower: *lower, upper: *upper, speed, change, jerk }, rest: *rest };
            (*velocity > 0.0).then_some(limit)
        })
    }

    /// The rig whose coordinates are limited.
    pub fn rig(&self) -> &Rig<'a> {
        &self.rig
    }

    /// Rates of the root, and what happens when frames fail to come.
    pub fn meta(&self) -> &LimitsMeta {
        &self.meta
    }

    /// The limits of every coordinate.
    pub fn table(&self) -> &LimitTable<'a> {
        &self.table
    }

    /// Frames after which every coordinate has reached a target that stands still, whatever happened before: full speed the wrong way, and
    /// the whole range to go. The time that a recovery takes at most.
    pub fn recovery_frames(&self) -> u32 {
        let mut most = 0.0f32;
        for Limit { bounds, .. } in self.limits().flatten() {
            let Bounds { lower, upper, speed, change, jerk } = bounds;
            let range = upper - lower;
            let speed = speed.min(reach(range, CATCH_UP * change));
            let smooth = if jerk > 0.0 {
                // The greatest change that is reached on the way to the speed, and how long its jerks take.
                let change = change.min(sqrt(speed * jerk));
                5.0 * speed / change + 10.0 * change / jerk + 10.0
            } else {
                0.0
            };
            if speed > 0.0 {
                most = most.max(range / speed + 5.0 * speed / change + 5.0 + smooth);
            }
        }
        most as u32
    }
}

impl<'a, const ROWS: usize, A: Axis> FromPack<'a> for LimiterOf<'a, ROWS, A> {
    fn from_pack(pack: &Pack<'a>) -> Result<Self, LoadError> {
        Self::load(pack)
    }
}
