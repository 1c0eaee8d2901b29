//! The limiter: a checked, immutable view of the tables.

use core::f32::consts::{PI, TAU};

use nalgebra::{Quaternion, UnitQuaternion};

use super::axis::{Bounds, CATCH_UP, reach};
use super::chart::Frame;
use crate::model::{LimitsMeta, LoadError, ModelMeta, Pack};
use crate::pose::unit;

/// Which coordinates a joint has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum JointKind {
    /// Any rotation; rates only.
    Free = 0,
    /// One angle, about the first axis.
    Hinge = 1,
    /// Two or three hinges in order, at right angles: `R(axis 0) R(axis 1) R(axis 2)`. Two have a third of range zero.
    Chain = 2,
    /// Twist about the first axis, then a swing whose rotation vector lies in the plane of the other two.
    Ball = 3,
}

impl JointKind {
    /// The kind with this number in the tensor `limit/kinds`.
    pub fn from_code(code: u16) -> Option<Self> {
        match code {
            0 => Some(Self::Free),
            1 => Some(Self::Hinge),
            2 => Some(Self::Chain),
            3 => Some(Self::Ball),
            _ => None,
        }
    }

    /// Number of coordinates with limits.
    pub fn coordinates(self) -> usize {
        match self {
            Self::Free => 0,
            Self::Hinge => 1,
            Self::Chain | Self::Ball => 3,
        }
    }
}

/// The limits of every joint, as a pack holds them or as given. All slices have one entry a joint.
#[derive(Clone, Copy, Debug)]
pub struct LimitTable<'a> {
    /// [`JointKind`] of each joint.
    pub kinds: &'a [u16],
    /// Three axes, of length one and at right angles, in the frame that `neutral` turns; a hinge uses the first alone.
    pub axes: &'a [[[f32; 3]; 3]],
    /// Local rotation `[i, j, k, w]` of the joint where its coordinates are zero; where a free joint rests.
    pub neutral: &'a [[f32; 4]],
    /// Least coordinates, rad; no more than a turn below the greatest. A coordinate that the joint does not have is zero.
    pub lower: &'a [[f32; 3]],
    /// Greatest coordinates, rad.
    pub upper: &'a [[f32; 3]],
    /// Largest speed of each coordinate, rad/s; of a free joint the first alone, for the whole angular velocity.
    pub velocity: &'a [[f32; 3]],
    /// Largest acceleration of each coordinate, rad/s^2; of a free joint the first alone.
    pub acceleration: &'a [[f32; 3]],
    /// Coordinates at rest, rad, where a joint starts and where it goes when frames fail to come.
    pub rest: &'a [[f32; 3]],
}

/// The last stage: limits for up to `JOINTS` joints, borrowed from a pack or from given tables.
#[derive(Clone, Copy, Debug)]
pub struct Limiter<'a, const JOINTS: usize> {
    meta: LimitsMeta,
    table: LimitTable<'a>,
    frame_time: f32,
    pub(super) root_speed: f32,
    pub(super) root_change: f32,
    pub(super) hold_frames: u32,
    pub(super) frozen_frames: u32,
    /// Share of the way to rest in a frame.
    pub(super) decay: f32,
}

/// One joint's row.
pub(super) struct Row<'a> {
    pub kind: JointKind,
    pub frame: Frame,
    pub neutral: UnitQuaternion<f32>,
    pub lower: &'a [f32; 3],
    pub upper: &'a [f32; 3],
    pub speed: [f32; 3],
    pub change: [f32; 3],
    pub rest: &'a [f32; 3],
}

impl Row<'_> {
    pub fn bounds(&self) -> impl Iterator<Item = Bounds> {
        let ranges = self.lower.iter().zip(self.upper);
        let rates = self.speed.iter().zip(&self.change);
        ranges.zip(rates).map(|((lower, upper), (speed, change))| Bounds {
            lower: *lower,
            upper: *upper,
            speed: *speed,
            change: *change,
        })
    }
}

/// Steps a frame, rad or m, that single precision can still tell apart, and that are still numbers.
const STEPS: core::ops::Range<f32> = 1e-6..1e6;

impl<'a, const JOINTS: usize> Limiter<'a, JOINTS> {
    /// The limits of a pack, after every check that makes [`step`](Self::step) infallible.
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        let metadata = pack.metadata();
        let meta = metadata
            .models
            .iter()
            .find_map(ModelMeta::limits)
            .ok_or(LoadError::NoModel { expected: "joint limits" })?;
        let joints = metadata.joints.len();
        let table = LimitTable {
            kinds: pack.slice("limit/kinds", joints)?,
            axes: pack.slice("limit/axes", joints)?,
            neutral: pack.slice("limit/neutral", joints)?,
            lower: pack.slice("limit/lower", joints)?,
            upper: pack.slice("limit/upper", joints)?,
            velocity: pack.slice("limit/velocity", joints)?,
            acceleration: pack.slice("limit/acceleration", joints)?,
            rest: pack.slice("limit/rest", joints)?,
        };
        Self::new(table, meta, metadata.frame_rate)
    }

    /// The limits of given tables, stepped `frame_rate` times a second.
    ///
    /// Refused with the table's name and the joint: other numbers of entries, ranges of more than a turn or without the rest pose in
    /// it, axes or rotations not of length one, rates so low that a frame's step, `velocity dt` or `acceleration dt^2`, is below
    /// 1e-6, times that are negative.
    pub fn new(table: LimitTable<'a>, meta: LimitsMeta, frame_rate: f32) -> Result<Self, LoadError> {
        let joints = table.kinds.len();
        if joints > JOINTS {
            return Err(LoadError::Capacity { parameter: "JOINTS", found: joints, capacity: JOINTS });
        }
        let frame_time = 1.0 / frame_rate;
        let (root_speed, root_change) =
            (meta.root_velocity * frame_time, meta.root_acceleration * (frame_time * frame_time));
        let times = [meta.hold, meta.decay, meta.frozen];
        let sound = (1.0..1e4).contains(&frame_rate)
            && STEPS.contains(&root_speed)
            && STEPS.contains(&root_change)
            && times.iter().all(|time| (0.0..1e5).contains(time));
        if joints == 0 || !sound {
            return Err(LoadError::Metadata);
        }
        let frames = |time: f32| (time * frame_rate + 0.5) as u32;
        let limiter = Self {
            meta,
            table,
            frame_time,
            root_speed,
            root_change,
            hold_frames: frames(meta.hold),
            frozen_frames: if meta.frozen > 0.0 { frames(meta.frozen).max(1) } else { 0 },
            decay: if meta.decay > frame_time { frame_time / meta.decay } else { 1.0 },
        };
        limiter.check_table(joints)?;
        Ok(limiter)
    }

    fn check_table(&self, joints: usize) -> Result<(), LoadError> {
        let table = &self.table;
        let counts = [
            ("limit/axes", table.axes.len()),
            ("limit/neutral", table.neutral.len()),
            ("limit/lower", table.lower.len()),
            ("limit/upper", table.upper.len()),
            ("limit/velocity", table.velocity.len()),
            ("limit/acceleration", table.acceleration.len()),
            ("limit/rest", table.rest.len()),
        ];
        if let Some((tensor, found)) = counts.into_iter().find(|(_, count)| *count != joints) {
            return Err(LoadError::Shape { tensor, found, expected: joints });
        }
        if let Some(index) = table.kinds.iter().position(|code| JointKind::from_code(*code).is_none()) {
            return Err(LoadError::Value { tensor: "limit/kinds", index });
        }
        if let Some(index) = table.neutral.iter().position(|q| !is_one(q.iter().map(|x| x * x).sum())) {
            return Err(LoadError::Value { tensor: "limit/neutral", index });
        }
        let axes = table.axes.iter().zip(table.kinds);
        if let Some(index) = axes.into_iter().position(|(axes, kind)| !are_axes(axes, *kind)) {
            return Err(LoadError::Value { tensor: "limit/axes", index });
        }
        for (index, row) in self.rows().enumerate() {
            let refuse = |tensor| Err(LoadError::Value { tensor, index });
            let used = row.kind.coordinates();
            let steps = used.max(1);
            if !row.speed.iter().take(steps).all(|x| STEPS.contains(x)) {
                return refuse("limit/velocity");
            }
            if !row.change.iter().take(steps).all(|x| STEPS.contains(x)) {
                return refuse("limit/acceleration");
            }
            for (axis, ((lower, upper), rest)) in row.lower.iter().zip(row.upper).zip(row.rest).enumerate() {
                let (range, inside) = if axis < used { (TAU, upper - lower <= TAU) } else { (0.0, true) };
                if !(lower.abs() <= 2.0 * range && lower <= upper) {
                    return refuse("limit/lower");
                }
                if !(upper.abs() <= 2.0 * range && inside) {
                    return refuse("limit/upper");
                }
                if !(lower..=upper).contains(&rest) {
                    return refuse("limit/rest");
                }
            }
        }
        Ok(())
    }

    /// The rows, one a joint.
    pub(super) fn rows(&self) -> impl Iterator<Item = Row<'a>> + use<'a, JOINTS> {
        let (table, time) = (self.table, self.frame_time);
        let shapes = table.kinds.iter().zip(table.axes).zip(table.neutral);
        let ranges = table.lower.iter().zip(table.upper).zip(table.rest);
        let rates = table.velocity.iter().zip(table.acceleration);
        shapes.zip(ranges).zip(rates).map(
            move |((((kind, axes), [i, j, k, w]), ((lower, upper), rest)), (velocity, acceleration))| Row {
                // Checked at load time.
                kind: JointKind::from_code(*kind).unwrap_or(JointKind::Free),
                frame: Frame::new(axes),
                neutral: unit(Quaternion::new(*w, *i, *j, *k)),
                lower,
                upper,
                speed: velocity.map(|x| x * time),
                change: acceleration.map(|x| x * (time * time)),
                rest,
            },
        )
    }

    /// Rates of the root, and what happens when frames fail to come.
    pub fn meta(&self) -> &LimitsMeta {
        &self.meta
    }

    /// The limits of every joint.
    pub fn table(&self) -> &LimitTable<'a> {
        &self.table
    }

    /// How far the root may go in a frame, m.
    pub(crate) fn root_step(&self) -> f32 {
        self.root_speed
    }

    /// Time of a frame, s.
    pub(crate) fn frame_time(&self) -> f32 {
        self.frame_time
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.table.kinds.len()
    }

    /// Frames after which every coordinate, and the rotation of every free joint, has reached a target that stands still, whatever
    /// happened before: full speed the wrong way, and the whole range to go. The time that a recovery takes at most.
    pub fn recovery_frames(&self) -> u32 {
        let mut most = 0.0f32;
        for row in self.rows() {
            let free = Bounds { lower: 0.0, upper: PI, speed: row.speed[0], change: row.change[0] };
            let free = (row.kind == JointKind::Free).then_some(free);
            for Bounds { lower, upper, speed, change } in row.bounds().take(row.kind.coordinates()).chain(free) {
                let range = upper - lower;
                let speed = speed.min(reach(range, CATCH_UP * change));
                if speed > 0.0 {
                    most = most.max(range / speed + 5.0 * speed / change + 5.0);
                }
            }
        }
        most as u32
    }
}

fn is_one(square: f32) -> bool {
    (square - 1.0).abs() < 1e-3
}

/// The axes that a kind uses have length one and stand at right angles.
fn are_axes([a, b, c]: &[[f32; 3]; 3], kind: u16) -> bool {
    let dot = |a: &[f32; 3], b: &[f32; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
    let square = |a: &[f32; 3], b: &[f32; 3]| dot(a, b).abs() < 1e-3;
    match JointKind::from_code(kind) {
        Some(JointKind::Hinge) => is_one(dot(a, a)),
        Some(JointKind::Chain | JointKind::Ball) => {
            [a, b, c].into_iter().all(|a| is_one(dot(a, a))) && square(a, b) && square(b, c) && square(c, a)
        }
        _ => true,
    }
}
