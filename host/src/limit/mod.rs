//! Joint limits: how they go into a pack, and where they come from. The device side, and what the tables mean, is [`kinesic::limit`].
//!
//! | file | holds |
//! |---|---|
//! | `joint` | [`JointLimit`]: the limits of one joint |
//! | `rows` | [`Tables`]: the limits of every coordinate, as the device reads them |
//! | `onto` | limits in the coordinates of a pack that has engines |
//! | `play` | a motion through the limits of its pack |
//! | `table` | [`Table`]: for people and other programs |
//! | `onto_body` | limits of a body from a robot's description |

mod joint;
mod onto;
pub mod onto_body;
mod play;
mod rows;
mod table;

pub use joint::{HeightLimit, JointLimit};
pub use onto::Mismatch;
pub use play::{Clamps, JointClamps, play};
pub use rows::Tables;
pub use table::{Entry, Height, Table};

use kinesic::limit::{Smooth, SmoothLimiter};
use kinesic::model::{Kind, LimitsMeta, LoadError, ModelMeta, Pack};

use crate::pack::{PackWriter, Provenance};
use crate::rig::{JointCoordinates, MAX_ROWS, Rig, RigError};

/// The limiter as the host steps it.
pub type HostLimiter<'a> = SmoothLimiter<'a, MAX_ROWS>;

/// Limits of every joint of a rig, in its order.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitsModel {
    /// Name of the robot or of the table.
    pub name: String,
    /// Frames per second at which the limiter is stepped.
    pub frame_rate: f64,
    /// Rates of the root, and what happens when frames fail to come.
    pub meta: LimitsMeta,
    /// Height of the root; it counts for a rig that travels.
    pub height: HeightLimit,
    /// One entry per joint.
    pub joints: Vec<JointLimit>,
}

impl LimitsModel {
    /// Every joint of `rig` free, at the given rates (rad/s, rad/s^2): a table to start from. Its balls keep their references. The
    /// root's height is [`standing`](Self::standing).
    pub fn free(name: &str, frame_rate: f64, rig: &Rig, velocity: f32, acceleration: f32) -> Self {
        let free = JointLimit::free(velocity, acceleration);
        let joint = |own: JointCoordinates| JointLimit {
            coordinates: JointCoordinates { kind: free.coordinates.kind, ..own },
            ..free
        };
        let joints = rig.joint_coordinates().into_iter().map(joint).collect();
        let meta = LimitsMeta::default();
        Self { name: name.to_owned(), frame_rate, meta, height: Self::standing(rig, &meta), joints }
    }

    /// From the ground to twice the height at which the skeleton stands, at the root's rates; at rest it stands.
    pub fn standing(rig: &Rig, meta: &LimitsMeta) -> HeightLimit {
        let rest = rig.skeleton.rest_positions();
        let lowest = rest.iter().map(|joint| joint.y).fold(f64::INFINITY, f64::min);
        let height = (rest.first().map_or(0.0, |root| root.y) - lowest).clamp(0.0, 50.0) as f32;
        HeightLimit {
            lower: 0.0,
            upper: 2.0 * height,
            velocity: meta.root_velocity,
            acceleration: meta.root_acceleration,
            jerk: 0.0,
            rest: height,
        }
    }

    /// The coordinates of every joint.
    pub fn coordinates(&self) -> Vec<JointCoordinates> {
        self.joints.iter().map(|joint| joint.coordinates).collect()
    }

    /// The rig with the coordinates that are limited.
    pub fn rig(&self, rig: &Rig) -> Result<Rig, LoadError> {
        let (found, expected) = (self.joints.len(), rig.joints());
        if found != expected {
            return Err(LoadError::Shape { tensor: "limits", found, expected });
        }
        rig.with_coordinates(self.coordinates())
    }

    /// The tables as the device reads them, for a limiter without a pack.
    pub fn tables(&self, rig: &Rig) -> Result<Tables, LoadError> {
        Tables::new(self, self.rig(rig)?)
    }

    /// See [`LimiterOf::recovery_frames`](kinesic::limit::LimiterOf::recovery_frames).
    pub fn recovery_frames(&self, rig: &Rig) -> Result<u32, LoadError> {
        Ok(self.tables(rig)?.limiter::<MAX_ROWS, Smooth>()?.recovery_frames())
    }

    /// The tables of a pack of this or another kind.
    pub fn from_pack(pack: &Pack) -> Result<Self, RigError> {
        let limiter = HostLimiter::load(pack)?;
        let rig = Rig::from_pack(pack)?;
        let (height, joints) = rows::joints(limiter.table(), &rig);
        Ok(Self {
            name: pack.metadata().name.to_owned(),
            frame_rate: f64::from(pack.metadata().frame_rate),
            meta: *limiter.meta(),
            height: height.unwrap_or_else(|| Self::standing(&rig, limiter.meta())),
            joints,
        })
    }

    /// A pack of these limits alone: its rig is `rig` with the coordinates that are limited.
    pub fn pack(&self, rig: &Rig, provenance: &Provenance) -> Result<Vec<u8>, LoadError> {
        let tables = self.tables(rig)?;
        let mut pack = PackWriter::new(Kind::Limits, &self.name, self.frame_rate as f32);
        tables.rig().write(&mut pack);
        self.write(&tables, &mut pack);
        Ok(pack.finish(provenance))
    }

    /// A style pack: everything that `base` holds, and these limits instead of its own if it has some. `rig` is that of `base`, and
    /// these limits are in its coordinates: see [`onto`](Self::onto).
    pub fn pack_with(&self, base: &Pack, rig: &Rig, provenance: &Provenance) -> Result<Vec<u8>, LoadError> {
        let tables = Tables::new(self, rig.clone())?;
        let metadata = base.metadata();
        let mut pack = PackWriter::new(Kind::Style, metadata.name, metadata.frame_rate);
        rig.write(&mut pack);
        pack.copy_models(base)?;
        self.write(&tables, &mut pack);
        Ok(pack.finish(provenance))
    }

    /// Writes the metadata and the tables.
    pub(crate) fn write(&self, tables: &Tables, pack: &mut PackWriter) {
        pack.model(&ModelMeta::Limits(self.meta));
        tables.write(pack);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait;
    use crate::pack::PackFile;

    const X: [f32; 3] = [1.0, 0.0, 0.0];
    const Y: [f32; 3] = [0.0, 1.0, 0.0];
    const Z: [f32; 3] = [0.0, 0.0, 1.0];

    fn rig() -> Rig {
        let skeleton = gait::skeleton();
        let map = crate::clip::JointMap::detect(&skeleton).unwrap();
        Rig::new(&skeleton, &map).unwrap()
    }

    #[test]
    fn a_pack_gives_the_table_back() {
        let rig = rig();
        let mut model = LimitsModel::free("robot", 60.0, &rig, 10.0, 100.0);
        // Two hinges share a row, and a chain begins the next.
        model.joints[2] = JointLimit::hinge(X, [-0.1, 2.4], 6.0, 60.0);
        model.joints[3] = JointLimit::hinge(Z, [-0.2, 0.3], 5.0, 50.0);
        model.joints[4] = JointLimit::chain([X, Y, Z], [-1.0, -0.5, 0.1], [0.5, 0.6, 0.7], 4.0, 40.0);
        model.joints[5] = JointLimit::ball([-0.5; 3], [0.5; 3], 6.0, 60.0);
        model.joints[6] = JointLimit::fixed();
        // Nothing has a jerk limit: no tensor.
        assert!(model.tables(&rig).unwrap().view().jerk.is_empty());
        model.joints[2].jerk[0] = 2000.0;
        model.joints[9] = model.joints[9].with_jerk(1500.0);
        model.height.jerk = 300.0;
        let tables = model.tables(&rig).unwrap();
        // Row 0 is the root's; joints 0 and 1 are balls.
        assert_eq!(tables.view().upper[3], [2.4, 0.3, 0.0]);
        assert_eq!((tables.view().jerk[0], tables.view().jerk[3]), ([0.0, 300.0, 0.0], [2000.0, 0.0, 0.0]));
        assert_eq!(tables.view().lower[4], [-1.0, -0.5, 0.1]);
        assert_eq!(tables.view().rest[4], [0.0, 0.0, 0.1]);
        let file = PackFile::from_bytes(&model.pack(&rig, &Provenance::default()).unwrap());
        let pack = file.pack().unwrap();
        assert_eq!(pack.kind(), Kind::Limits);
        assert_eq!(LimitsModel::from_pack(&pack).unwrap(), model);
        assert!(model.joints[1].is_free() && !model.joints[5].is_free());
        assert_eq!(HostLimiter::load(&pack).unwrap().rig().joints(), rig.joints());
    }

    #[test]
    fn what_the_device_would_refuse_is_refused_here() {
        let rig = rig();
        let mut model = LimitsModel::free("robot", 60.0, &rig, 10.0, 100.0);
        model.joints[2] = JointLimit::hinge(X, [-0.1, 2.4], 6.0, 60.0);
        let refused = |model: &LimitsModel| model.recovery_frames(&rig).unwrap_err();
        let mut broken = model.clone();
        broken.joints[2].upper[0] = f32::NAN;
        assert_eq!(refused(&broken), LoadError::Value { tensor: "limit/lower", index: 3 });
        let mut broken = model.clone();
        broken.joints[2].coordinates.axes[0] = [0.0; 3];
        assert_eq!(refused(&broken), LoadError::Value { tensor: "rig/axes", index: 2 });
        assert!(broken.pack(&rig, &Provenance::default()).is_err());
        // The root of a body that travels is a ball.
        let mut broken = model.clone();
        broken.joints[0] = JointLimit::hinge(Y, [-1.0, 1.0], 6.0, 60.0);
        assert_eq!(refused(&broken), LoadError::Value { tensor: "rig/kinds", index: 0 });
        model.joints.pop();
        assert!(matches!(refused(&model), LoadError::Shape { tensor: "limits", found: 18, expected: 19 }));
    }

    #[test]
    fn engines_keep_their_coordinates() {
        let plain = rig();
        let mut model = LimitsModel::free("robot", 60.0, &plain, 10.0, 100.0);
        model.joints[2] = JointLimit::hinge(X, [-0.1, 2.4], 6.0, 60.0);
        // A pack whose style was learned on other coordinates.
        let error = model.onto(&plain).unwrap_err().to_string();
        assert!(["LeftLeg", "ball", "hinge about [1, 0, 0]"].iter().all(|word| error.contains(word)), "{error}");
        // In the limits' own coordinates, but free joints about other references: these are taken over.
        let mut joints = model.coordinates();
        joints[9].reference = [0.0, 0.6, 0.0, 0.8];
        joints[10] = JointCoordinates::new(kinesic::rig::JointKind::Fixed);
        let learned = plain.with_coordinates(joints.clone()).unwrap();
        let onto = model.onto(&learned).unwrap();
        assert_eq!(onto.coordinates(), joints);
        assert_eq!(onto.joints[2], model.joints[2]);
        // A limited ball about another reference would be another box.
        model.joints[9] = JointLimit::ball([-0.5; 3], [0.5; 3], 6.0, 60.0);
        let error = model.onto(&learned).unwrap_err().to_string();
        assert!(error.contains("[0, 0.6, 0, 0.8]") && error.contains("[0, 0, 0, 1]"), "{error}");
        // So would a hinge with a limit on a joint that never moves.
        model.joints[9] = JointLimit::free(10.0, 100.0);
        model.joints[10] = JointLimit::hinge(X, [-0.1, 2.4], 6.0, 60.0);
        assert!(model.onto(&learned).unwrap_err().to_string().contains("fixed"));
    }
}
