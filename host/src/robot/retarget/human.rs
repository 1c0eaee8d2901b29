//! Where a person's limbs point, in a frame of the person.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::map::{Base, Limb};
use crate::clip::{Canonical, Clip, JointMap};

/// A rest pose whose trunk leans by more than this (cosine) does not stand upright: its trunk is its up.
const UPRIGHT: f64 = 0.85;
/// Bones shorter than this show no direction, m.
const SHORTEST: f64 = 1e-3;

/// The person of a clip.
pub(super) struct Human<'a> {
    clip: &'a Clip,
    map: &'a JointMap,
    /// Columns: forward, left and up of the resting person, in the clip's world.
    rest: Matrix3<f64>,
}

/// How one limb's direction is found.
#[derive(Clone, Copy)]
enum Way {
    /// From joint to joint.
    Bone(usize, usize),
    /// A direction at rest that turns with a joint.
    Turns(usize, Vector3<f64>),
}

impl<'a> Human<'a> {
    /// Needs pelvis and hips; without them nothing says where the person faces.
    pub fn new(clip: &'a Clip, map: &'a JointMap) -> Option<Self> {
        let places = clip.skeleton.rest_positions();
        let at = |joint| map.joint(joint).and_then(|at| places.get(at)).copied();
        let left = at(Canonical::LHip)? - at(Canonical::RHip)?;
        let trunk = (at(Canonical::Neck).or(at(Canonical::Head))? - at(Canonical::Pelvis)?).try_normalize(SHORTEST)?;
        let up = if trunk.y > UPRIGHT { Vector3::y() } else { trunk };
        let left = (left - up * up.dot(&left)).try_normalize(SHORTEST)?;
        Some(Self { clip, map, rest: Matrix3::from_columns(&[left.cross(&up), left, up]) })
    }

    /// Whether the clip shows this limb.
    pub fn has(&self, limb: Limb) -> bool {
        self.way(limb).is_some()
    }

    fn way(&self, limb: Limb) -> Option<Way> {
        use Canonical::*;
        let joint = |joint| self.map.joint(joint);
        let bone = |from, to| Some(Way::Bone(joint(from)?, joint(to)?));
        let turns = |at: Option<usize>, column: usize| Some(Way::Turns(at?, self.rest.column(column).into_owned()));
        let hand = |wrist| {
            let at = joint(wrist)?;
            let child = self.clip.skeleton.children(at).next().map(|child| self.clip.skeleton.joints[child].offset);
            let tip = child.or(self.clip.skeleton.joints[at].end)?;
            Some(Way::Turns(at, tip.try_normalize(SHORTEST)?))
        };
        let chest = joint(Chest).or(joint(Spine));
        match limb {
            Limb::Trunk => turns(chest, 2),
            Limb::Shoulders => turns(chest, 1),
            Limb::Gaze => turns(joint(Head), 0),
            Limb::Crown => turns(joint(Head), 2),
            Limb::LUpperArm => bone(LShoulder, LElbow),
            Limb::LForearm => bone(LElbow, LWrist),
            Limb::LHand => hand(LWrist),
            Limb::RUpperArm => bone(RShoulder, RElbow),
            Limb::RForearm => bone(RElbow, RWrist),
            Limb::RHand => hand(RWrist),
            Limb::LThigh => bone(LHip, LKnee),
            Limb::LShin => bone(LKnee, LAnkle),
            Limb::LFoot => turns(joint(LAnkle), 0),
            Limb::RThigh => bone(RHip, RKnee),
            Limb::RShin => bone(RKnee, RAnkle),
            Limb::RFoot => turns(joint(RAnkle), 0),
        }
    }

    /// Direction of each limb in one frame: components forward, left and up in the frame of the base. None where a bone has no length.
    pub fn directions(&self, frame: usize, base: Base, limbs: &[Limb]) -> Vec<Option<Vector3<f64>>> {
        let places = self.clip.positions(frame);
        let turned = self.clip.skeleton.world_rotations(self.clip.pose(frame));
        let turn = |joint: Option<usize>| joint.and_then(|at| turned.get(at)).copied().unwrap_or_default();
        let pelvis = turn(self.map.joint(Canonical::Pelvis));
        let axes = match base {
            Base::Pelvis => pelvis.to_rotation_matrix() * self.rest,
            Base::Chest => {
                let chest = self.map.joint(Canonical::Chest).or(self.map.joint(Canonical::Spine));
                chest.map_or(pelvis, |at| turn(Some(at))).to_rotation_matrix() * self.rest
            }
            Base::Heading => self.heading(pelvis),
        };
        let one = |limb: &Limb| {
            let way = match self.way(*limb)? {
                Way::Bone(from, to) => (places.get(to)? - places.get(from)?).try_normalize(SHORTEST)?,
                Way::Turns(joint, rest) => turned.get(joint)? * rest,
            };
            Some(axes.tr_mul(&way))
        };
        limbs.iter().map(one).collect()
    }

    /// Level, towards where the pelvis faces.
    fn heading(&self, pelvis: UnitQuaternion<f64>) -> Matrix3<f64> {
        let up = Vector3::y();
        let forward = pelvis * self.rest.column(0).into_owned();
        let level = (forward - up * up.dot(&forward)).try_normalize(SHORTEST);
        let forward = level.unwrap_or_else(Vector3::z);
        Matrix3::from_columns(&[forward, up.cross(&forward), up])
    }
}
