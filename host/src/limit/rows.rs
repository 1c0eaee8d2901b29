//! The limits of every coordinate, as the device reads them.

use kinesic::limit::{Axis, LimitTable, LimiterOf, Smooth};
use kinesic::model::{LimitsMeta, LoadError};

use super::{HeightLimit, JointLimit, LimitsModel};
use crate::pack::PackWriter;
use crate::rig::{JointCoordinates, Rig};

/// Owned columns of a [`LimitTable`], the rig whose coordinates they limit, and what else a limiter needs.
#[derive(Clone, Debug)]
pub struct Tables {
    rig: Rig,
    meta: LimitsMeta,
    frame_rate: f32,
    lower: Vec<[f32; 3]>,
    upper: Vec<[f32; 3]>,
    velocity: Vec<[f32; 3]>,
    acceleration: Vec<[f32; 3]>,
    /// Empty where nothing has a jerk limit.
    jerk: Vec<[f32; 3]>,
    rest: Vec<[f32; 3]>,
}

impl Tables {
    /// The tables of a model whose coordinates are those of `rig`, after the same checks as on the device.
    pub(super) fn new(model: &LimitsModel, rig: Rig) -> Result<Self, LoadError> {
        let device = rig.frames();
        let column = |height: fn(&HeightLimit) -> f32, joint: fn(&JointLimit) -> [f32; 3]| {
            let mut column = vec![[0.0; 3]; device.rows()];
            let flat = column.as_flattened_mut();
            if device.travels() {
                flat[1] = height(&model.height);
            }
            for ((kind, first), limit) in device.places().zip(&model.joints) {
                let own = joint(limit);
                flat[first..first + kind.coordinates()].copy_from_slice(&own[..kind.coordinates()]);
            }
            column
        };
        let mut jerk = column(|height| height.jerk, |joint| joint.jerk);
        if jerk.as_flattened().iter().all(|jerk| *jerk == 0.0) {
            jerk.clear();
        }
        let tables = Self {
            jerk,
            lower: column(|height| height.lower, |joint| joint.lower),
            upper: column(|height| height.upper, |joint| joint.upper),
            velocity: column(|height| height.velocity, |joint| joint.velocity),
            acceleration: column(|height| height.acceleration, |joint| joint.acceleration),
            rest: column(|height| height.rest, |joint| joint.rest),
            meta: model.meta,
            frame_rate: model.frame_rate as f32,
            rig,
        };
        tables.limiter::<{ crate::rig::MAX_ROWS }, Smooth>()?;
        Ok(tables)
    }

    /// The limiter of these tables, with jerk limits or without.
    pub fn limiter<const ROWS: usize, A: Axis>(&self) -> Result<LimiterOf<'_, ROWS, A>, LoadError> {
        LimiterOf::new(self.rig.frames(), self.view(), self.meta, self.frame_rate)
    }

    /// The rig whose coordinates are limited.
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// The device's view.
    pub fn view(&self) -> LimitTable<'_> {
        LimitTable {
            lower: &self.lower,
            upper: &self.upper,
            velocity: &self.velocity,
            acceleration: &self.acceleration,
            jerk: &self.jerk,
            rest: &self.rest,
        }
    }

    pub(super) fn write(&self, pack: &mut PackWriter) {
        for (name, values) in [
            ("limit/lower", &self.lower),
            ("limit/upper", &self.upper),
            ("limit/velocity", &self.velocity),
            ("limit/acceleration", &self.acceleration),
            ("limit/rest", &self.rest),
        ] {
            pack.f32s(name, 3, values.as_flattened());
        }
        if !self.jerk.is_empty() {
            pack.f32s("limit/jerk", 3, self.jerk.as_flattened());
        }
    }
}

/// The limits of the root's height, if the rig travels, and of every joint; what a joint does not use is 0.
pub(super) fn joints(table: &LimitTable, rig: &Rig) -> (Option<HeightLimit>, Vec<JointLimit>) {
    let device = rig.frames();
    let height = || {
        let of = |column: &[[f32; 3]]| column.as_flattened().get(1).copied().unwrap_or(0.0);
        HeightLimit {
            lower: of(table.lower),
            upper: of(table.upper),
            velocity: of(table.velocity),
            acceleration: of(table.acceleration),
            jerk: of(table.jerk),
            rest: of(table.rest),
        }
    };
    let joint = |(coordinates, (kind, first)): (JointCoordinates, (kinesic::rig::JointKind, usize))| {
        let own = |column: &[[f32; 3]]| {
            let mut own = [0.0; 3];
            let used = column.as_flattened().get(first..first + kind.coordinates()).unwrap_or(&[]);
            own[..used.len()].copy_from_slice(used);
            own
        };
        JointLimit {
            coordinates,
            lower: own(table.lower),
            upper: own(table.upper),
            velocity: own(table.velocity),
            acceleration: own(table.acceleration),
            jerk: own(table.jerk),
            rest: own(table.rest),
        }
    };
    (device.travels().then(height), rig.joint_coordinates().into_iter().zip(device.places()).map(joint).collect())
}
