//! Joint limits: how they go into a pack, and where they come from. The device side, and what the tables mean, is [`kinesic::limit`].

mod joint;
pub mod robot;
mod table;

pub use joint::JointLimit;
pub use table::{Entry, Table};

use kinesic::limit::{LimitTable, Limiter};
use kinesic::model::{Kind, LimitsMeta, LoadError, ModelMeta, Pack};

use crate::pack::{PackWriter, Provenance};
use crate::rig::{MAX_JOINTS, Rig};

/// The limiter as the host steps it.
pub type HostLimiter<'a> = Limiter<'a, MAX_JOINTS>;

/// Limits of every joint of a rig, in its order.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitsModel {
    /// Name of the robot or of the table.
    pub name: String,
    /// Frames per second at which the limiter is stepped.
    pub frame_rate: f64,
    /// Rates of the root, and what happens when frames fail to come.
    pub meta: LimitsMeta,
    /// One entry a joint.
    pub joints: Vec<JointLimit>,
}

impl LimitsModel {
    /// Everything free, at the given rates (rad/s, rad/s^2): a table to start from.
    pub fn free(name: &str, frame_rate: f64, joints: usize, velocity: f32, acceleration: f32) -> Self {
        let joints = vec![JointLimit::free(velocity, acceleration); joints];
        Self { name: name.to_owned(), frame_rate, meta: LimitsMeta::default(), joints }
    }

    /// The same checks as on the device, before anything is written.
    pub fn check(&self) -> Result<(), LoadError> {
        let tables = self.tables();
        Limiter::<MAX_JOINTS>::new(tables.view(), self.meta, self.frame_rate as f32).map(|_| ())
    }

    /// See [`Limiter::recovery_frames`].
    pub fn recovery_frames(&self) -> Result<u32, LoadError> {
        let tables = self.tables();
        Ok(HostLimiter::new(tables.view(), self.meta, self.frame_rate as f32)?.recovery_frames())
    }

    /// The tables of a pack of this or another kind.
    pub fn from_pack(pack: &Pack) -> Result<Self, LoadError> {
        let limiter = HostLimiter::load(pack)?;
        Ok(Self {
            name: pack.metadata().name.to_owned(),
            frame_rate: f64::from(pack.metadata().frame_rate),
            meta: *limiter.meta(),
            joints: joint::rows(limiter.table()),
        })
    }

    /// Adds the model and its tensors to a pack whose joints are these, in this order.
    pub fn write(&self, pack: &mut PackWriter) {
        let Tables { kinds, axes, neutral, lower, upper, velocity, acceleration, rest } = self.tables();
        pack.model(&ModelMeta::Limits(self.meta));
        pack.u16s("limit/kinds", 1, &kinds);
        pack.f32s("limit/axes", 9, axes.as_flattened().as_flattened());
        pack.f32s("limit/neutral", 4, neutral.as_flattened());
        for (name, values) in [
            ("limit/lower", lower),
            ("limit/upper", upper),
            ("limit/velocity", velocity),
            ("limit/acceleration", acceleration),
            ("limit/rest", rest),
        ] {
            pack.f32s(name, 3, values.as_flattened());
        }
    }

    /// A pack of these limits alone, for `rig`.
    pub fn pack(&self, rig: &Rig, provenance: &Provenance) -> Vec<u8> {
        let mut pack = PackWriter::new(Kind::Limits, &self.name, self.frame_rate as f32);
        rig.write(&mut pack);
        self.write(&mut pack);
        pack.finish(provenance)
    }

    /// A style pack: everything that `base` holds, and these limits instead of its own if it has some. Its joints must be these.
    pub fn pack_with(&self, base: &Pack, rig: &Rig, provenance: &Provenance) -> Result<Vec<u8>, LoadError> {
        let metadata = base.metadata();
        let mut pack = PackWriter::new(Kind::Style, metadata.name, metadata.frame_rate);
        rig.write(&mut pack);
        pack.copy_models(base)?;
        self.write(&mut pack);
        Ok(pack.finish(provenance))
    }

    /// The tables as the device reads them, for a limiter without a pack.
    pub fn tables(&self) -> Tables {
        let mut tables = Tables::default();
        for joint in &self.joints {
            tables.kinds.push(joint.kind as u16);
            tables.axes.push(joint.axes);
            tables.neutral.push(joint.neutral);
            tables.lower.push(joint.lower);
            tables.upper.push(joint.upper);
            tables.velocity.push(joint.velocity);
            tables.acceleration.push(joint.acceleration);
            tables.rest.push(joint.rest);
        }
        tables
    }
}

/// Owned columns of a [`LimitTable`].
#[derive(Clone, Debug, Default, PartialEq)]
#[expect(missing_docs, reason = "the fields of `LimitTable`, which says what they are")]
pub struct Tables {
    pub kinds: Vec<u16>,
    pub axes: Vec<[[f32; 3]; 3]>,
    pub neutral: Vec<[f32; 4]>,
    pub lower: Vec<[f32; 3]>,
    pub upper: Vec<[f32; 3]>,
    pub velocity: Vec<[f32; 3]>,
    pub acceleration: Vec<[f32; 3]>,
    pub rest: Vec<[f32; 3]>,
}

impl Tables {
    /// The device's view.
    pub fn view(&self) -> LimitTable<'_> {
        LimitTable {
            kinds: &self.kinds,
            axes: &self.axes,
            neutral: &self.neutral,
            lower: &self.lower,
            upper: &self.upper,
            velocity: &self.velocity,
            acceleration: &self.acceleration,
            rest: &self.rest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait;
    use crate::pack::PackFile;
    use kinesic::limit::JointKind;

    #[test]
    fn a_pack_gives_the_table_back() {
        let skeleton = gait::skeleton();
        let map = crate::clip::JointMap::detect(&skeleton).unwrap();
        let rig = Rig::new(&skeleton, &map).unwrap();
        let mut model = LimitsModel::free("robot", 60.0, rig.joints(), 10.0, 100.0);
        model.joints[2] = JointLimit::hinge([1.0, 0.0, 0.0], [-0.1, 2.4], 6.0, 60.0);
        model.joints[3] =
            JointLimit::ball([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]], [-0.5; 3], [0.5; 3], 6.0, 60.0);
        model.check().unwrap();
        let file = PackFile::from_bytes(&model.pack(&rig, &Provenance::default()));
        let pack = file.pack().unwrap();
        assert_eq!(pack.kind(), Kind::Limits);
        assert_eq!(LimitsModel::from_pack(&pack).unwrap(), model);
        assert_eq!(HostLimiter::load(&pack).unwrap().joints(), rig.joints());
        // What the device would refuse is refused here, with the joint.
        model.joints[2].upper[0] = f32::NAN;
        assert!(matches!(model.check(), Err(LoadError::Value { index: 2, .. })), "{:?}", model.check());
        assert_eq!(model.joints[3].kind, JointKind::Ball);
    }
}
