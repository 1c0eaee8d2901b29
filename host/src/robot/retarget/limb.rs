//! The limbs of a person, and where they point in every frame.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use crate::clip::{Canonical, Clip, JointMap};

/// A limb. Its direction is from its inner joint to its outer one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // Anatomy; L and R are the person's own sides.
pub enum Limb {
    /// From pelvis to neck, and where the shoulders face.
    Torso,
    /// Where the head faces, and where its top is.
    Head,
    LUpperArm,
    LForearm,
    LHand,
    /// Shoulder to wrist, with its length: for arms that have a slider or no elbow.
    LArm,
    RUpperArm,
    RForearm,
    RHand,
    /// See `LArm`.
    RArm,
    LThigh,
    LShin,
    /// Where the foot faces.
    LFoot,
    /// Hip to ankle, with its length.
    LLeg,
    RThigh,
    RShin,
    /// See `LFoot`.
    RFoot,
    /// See `LLeg`.
    RLeg,
}

use Limb::*;

impl Limb {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 18] = [
        Torso, Head, LUpperArm, LForearm, LHand, LArm, RUpperArm, RForearm, RHand, RArm, LThigh, LShin, LFoot, LLeg,
        RThigh, RShin, RFoot, RLeg,
    ];

    /// Name in maps: `l_upper_arm`, ...
    pub fn name(self) -> &'static str {
        const NAMES: [&str; 18] = [
            "torso",
            "head",
            "l_upper_arm",
            "l_forearm",
            "l_hand",
            "l_arm",
            "r_upper_arm",
            "r_forearm",
            "r_hand",
            "r_arm",
            "l_thigh",
            "l_shin",
            "l_foot",
            "l_leg",
            "r_thigh",
            "r_shin",
            "r_foot",
            "r_leg",
        ];
        NAMES[self as usize]
    }

    /// The limb of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|limb| limb.name() == name)
    }

    /// Whether the limb is a part that faces somewhere, rather than a bone between two joints.
    pub fn faces(self) -> bool {
        matches!(self, Torso | Head | LFoot | RFoot)
    }

    /// Whether its length counts too.
    pub fn reaches(self) -> bool {
        matches!(self, LArm | RArm | LLeg | RLeg)
    }

    /// The joints between which it is.
    fn ends(self) -> Option<Vec<Canonical>> {
        use Canonical::{
            LAnkle, LElbow, LHip, LKnee, LShoulder, LWrist, RAnkle, RElbow, RHip, RKnee, RShoulder, RWrist,
        };
        Some(match self {
            LUpperArm => vec![LShoulder, LElbow],
            LForearm => vec![LElbow, LWrist],
            LArm => vec![LShoulder, LElbow, LWrist],
            RUpperArm => vec![RShoulder, RElbow],
            RForearm => vec![RElbow, RWrist],
            RArm => vec![RShoulder, RElbow, RWrist],
            LThigh => vec![LHip, LKnee],
            LShin => vec![LKnee, LAnkle],
            LLeg => vec![LHip, LKnee, LAnkle],
            RThigh => vec![RHip, RKnee],
            RShin => vec![RKnee, RAnkle],
            RLeg => vec![RHip, RKnee, RAnkle],
            Torso | Head | LHand | RHand | LFoot | RFoot => return None,
        })
    }
}

/// Where limbs point: one arrow a frame, in the frame of the pelvis' heading: x forward, y left, z up. `None` where the clip does not say.
pub(super) struct Person<'c> {
    clip: &'c Clip,
    map: &'c JointMap,
    /// Where head and feet face, and the head's top is, in their own frames: `[head, top, left foot, right foot]`.
    facing: [Vector3<f64>; 4],
    stands: bool,
    /// Positions and world rotations of the present frame.
    positions: Vec<Vector3<f64>>,
    rotations: Vec<UnitQuaternion<f64>>,
    /// World to heading.
    to_heading: Matrix3<f64>,
}

impl<'c> Person<'c> {
    pub fn new(clip: &'c Clip, map: &'c JointMap) -> Self {
        let rest = clip.skeleton.rest_positions();
        let left = across(map, &rest).unwrap_or_else(Vector3::x);
        let forward = left.cross(&Vector3::y());
        let to_heading = Matrix3::from_rows(&[forward.transpose(), left.transpose(), Vector3::y().transpose()]);
        let facing = [forward, Vector3::y(), forward, forward];
        let stands = stands(map, &rest);
        let mut person = Self { clip, map, facing, stands, positions: Vec::new(), rotations: Vec::new(), to_heading };
        if !stands {
            person.face_on_average();
        }
        person
    }

    /// Takes for forward of head and feet what faces forward on average: a rest pose that does not stand says nothing of it.
    fn face_on_average(&mut self) {
        let mut sums = [Vector3::zeros(); 4];
        for frame in 0..self.clip.frames() {
            self.look(frame);
            let forward = self.to_heading.row(0).transpose();
            let ways = [forward, Vector3::y(), forward, forward];
            for ((sum, way), joint) in sums.iter_mut().zip(ways).zip(FACING) {
                let rotation = self.map.joint(joint).and_then(|at| self.rotations.get(at));
                *sum += rotation.map_or_else(Vector3::zeros, |rotation| rotation.inverse() * way);
            }
        }
        for (facing, sum) in self.facing.iter_mut().zip(sums) {
            *facing = sum.try_normalize(1e-9).unwrap_or(*facing);
        }
        let [head, top, ..] = &mut self.facing;
        *top = (*top - *head * head.dot(top)).try_normalize(1e-6).unwrap_or(*top);
    }

    /// What was assumed.
    pub fn note(&self) -> Option<String> {
        let note = "the clip's rest pose does not stand: head and feet are taken to face forward on average";
        (!self.stands).then(|| note.to_owned())
    }

    /// Goes to a frame. Where the hips stand one above the other, the heading stays.
    pub fn look(&mut self, frame: usize) {
        self.positions = self.clip.positions(frame);
        self.rotations = self.clip.skeleton.world_rotations(self.clip.pose(frame));
        if let Some(left) = across(self.map, &self.positions) {
            let forward = left.cross(&Vector3::y());
            self.to_heading = Matrix3::from_rows(&[forward.transpose(), left.transpose(), Vector3::y().transpose()]);
        }
    }

    fn at(&self, joint: Canonical) -> Option<Vector3<f64>> {
        self.positions.get(self.map.joint(joint)?).copied()
    }

    /// The limb's arrows in this frame: its direction (with its length between 0 and 1 where that counts), and for torso and head a second.
    pub fn arrows(&self, limb: Limb) -> [Option<Vector3<f64>>; 2] {
        let turned = |arrow: Option<Vector3<f64>>| arrow.map(|arrow| self.to_heading * arrow);
        let unit = |arrow: Vector3<f64>| arrow.try_normalize(1e-6);
        let facing = |joint: Canonical, way: Vector3<f64>| Some(self.rotations.get(self.map.joint(joint)?)? * way);
        match limb {
            Torso => {
                let up = || unit(self.at(Canonical::Neck).or(self.at(Canonical::Chest))? - self.at(Canonical::Pelvis)?);
                let left = || unit(self.at(Canonical::LShoulder)? - self.at(Canonical::RShoulder)?);
                let faces = || left()?.cross(&up()?).try_normalize(1e-3);
                [turned(up()), turned(faces())]
            }
            Head => [turned(facing(Canonical::Head, self.facing[0])), turned(facing(Canonical::Head, self.facing[1]))],
            LFoot => [turned(facing(Canonical::LAnkle, self.facing[2])), None],
            RFoot => [turned(facing(Canonical::RAnkle, self.facing[3])), None],
            LHand | RHand => {
                let wrist = self.map.joint(if limb == LHand { Canonical::LWrist } else { Canonical::RWrist });
                let tip = |wrist: usize| {
                    let joints = &self.clip.skeleton.joints;
                    let start = self.positions.get(wrist)?;
                    // The first bone that has a length.
                    let mut at = wrist;
                    while let Some(next) = self.clip.skeleton.children(at).next() {
                        at = next;
                        if joints[at].offset.norm() > 1e-4 {
                            return unit(self.positions.get(at)? - start);
                        }
                    }
                    unit(self.rotations.get(at)? * joints[at].end?)
                };
                [turned(wrist.and_then(tip)), None]
            }
            _ => {
                let Some(places) =
                    limb.ends().and_then(|ends| ends.into_iter().map(|end| self.at(end)).collect::<Option<Vec<_>>>())
                else {
                    return [None, None];
                };
                let (Some(first), Some(last)) = (places.first(), places.last()) else { return [None, None] };
                let length: f64 = places.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
                let way = last - first;
                let arrow = if limb.reaches() { (length > 1e-6).then(|| way / length) } else { unit(way) };
                [turned(arrow), None]
            }
        }
    }
}

/// Joints whose facing is kept.
const FACING: [Canonical; 4] = [Canonical::Head, Canonical::Head, Canonical::LAnkle, Canonical::RAnkle];

/// Whether thighs and shins of the rest pose point down, its head is up and its toes are in front.
fn stands(map: &JointMap, rest: &[Vector3<f64>]) -> bool {
    let at = |joint: Canonical| rest.get(map.joint(joint)?);
    let points = |from: Canonical, to: Canonical, way: Vector3<f64>, least: f64| {
        let bone = at(from).zip(at(to)).and_then(|(from, to)| (to - from).try_normalize(1e-6));
        bone.is_none_or(|bone| bone.dot(&way) > least)
    };
    let forward = across(map, rest).map_or_else(Vector3::z, |left| left.cross(&Vector3::y()));
    [
        (Canonical::LHip, Canonical::LKnee, -Vector3::y(), 0.8),
        (Canonical::RHip, Canonical::RKnee, -Vector3::y(), 0.8),
        (Canonical::LKnee, Canonical::LAnkle, -Vector3::y(), 0.8),
        (Canonical::RKnee, Canonical::RAnkle, -Vector3::y(), 0.8),
        (Canonical::Pelvis, Canonical::Head, Vector3::y(), 0.8),
        (Canonical::LAnkle, Canonical::LToe, forward, 0.1),
        (Canonical::RAnkle, Canonical::RToe, forward, 0.1),
    ]
    .into_iter()
    .all(|(from, to, way, least)| points(from, to, way, least))
}

/// Level direction from the right hip to the left, else between the shoulders.
fn across(map: &JointMap, positions: &[Vector3<f64>]) -> Option<Vector3<f64>> {
    let pairs = [(Canonical::LHip, Canonical::RHip), (Canonical::LShoulder, Canonical::RShoulder)];
    pairs.into_iter().find_map(|(left, right)| {
        let way = positions.get(map.joint(left)?)? - positions.get(map.joint(right)?)?;
        // A body that lies on its side has no heading by its hips.
        (way.xz().norm() > 0.2 * way.norm()).then(|| Vector3::new(way.x, 0.0, way.z).try_normalize(1e-4)).flatten()
    })
}
