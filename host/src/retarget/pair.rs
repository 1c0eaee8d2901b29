//! Skeletons of other joints: which joint is whose partner, and what turns one's axes into the other's.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

use super::stance::{BENDS, Stance};
use super::{NO_BONE, RetargetError, swing};
use crate::clip::{Canonical, Clip, JointMap, Skeleton};
use crate::rig::Rig;

use Canonical::*;

/// Without these no motion can be transferred; collars, toes, neck and spine may be missing.
const NEEDED: [Canonical; 15] = [
    Pelvis, Chest, Head, LShoulder, LElbow, LWrist, RShoulder, RElbow, RWrist, LHip, LKnee, LAnkle, RHip, RKnee, RAnkle,
];

/// Where a joint of the rig takes its world rotation from.
#[derive(Clone, Debug)]
pub(super) enum Base {
    /// That of the clip's joint, times what turns the rig's axes into the clip's.
    Partner { joint: usize, align: UnitQuaternion<f64> },
    /// A share of what two joints of the clip have turned by since the stance.
    Between { above: usize, below: usize, share: f64, stance: UnitQuaternion<f64> },
    /// The parent's, times this.
    Follow(UnitQuaternion<f64>),
}

/// Joints that turn together until the last one lies in the direction from one joint of the clip to another.
#[derive(Clone, Debug)]
pub(super) struct Aim {
    /// Joints with the bone to the next, in their own axes; the last bone ends at the joint that is aimed, or at the tip.
    pub chain: Vec<(usize, Vector3<f64>)>,
    /// The first joint of the chain stays as it is.
    pub fixed: bool,
    /// The clip's joint at the start, and what is aimed at.
    pub from: usize,
    pub to: Target,
}

/// What a limb of the clip ends at.
#[derive(Clone, Debug)]
pub(super) enum Target {
    Joint(usize),
    /// The mean of these joints, or of points in the axes of a joint.
    Tip(Tip),
}

/// The tip of a leaf, such as a hand: the mean of the joints that hang on it, else a point in its axes.
#[derive(Clone, Debug)]
pub(super) enum Tip {
    Joints(Vec<usize>),
    Point(usize, Vector3<f64>),
}

/// A collar that carries a shoulder.
#[derive(Clone, Debug)]
pub(super) struct Collar {
    /// The joint that turns, its place in the chest, and the bone from it to the shoulder, each in the upper joint's axes.
    pub joint: usize,
    pub start: Vector3<f64>,
    pub bone: Vector3<f64>,
}

/// Both shoulders.
#[derive(Clone, Debug)]
pub(super) struct Shoulders {
    pub chest: usize,
    /// Left and right.
    pub collars: [Collar; 2],
    /// The middle of the shoulders in the chest, in the stance, and how far they are apart there.
    pub middle: Vector3<f64>,
    pub width: f64,
    /// The clip's chest and shoulders, and the same of them.
    pub from: [usize; 3],
    pub from_middle: Vector3<f64>,
    pub from_width: f64,
    /// How far the middle goes for what the clip's goes: in parts of the width, and no further than the collars turn.
    pub scale: f64,
}

/// A joint that carries a pair of limbs: the pelvis, and a chest without collars. The line of hips or shoulders in it, and the bone of the
/// spine, the neck or the head that is rigid in it.
#[derive(Clone, Debug)]
pub(super) struct Lay {
    pub joint: usize,
    pub line: Vector3<f64>,
    pub from: [usize; 2],
    pub bone: Option<(Vector3<f64>, [usize; 2])>,
}

/// Two skeletons, and all that does not change from frame to frame.
pub(super) struct Pair<'r> {
    pub rig: &'r Skeleton,
    pub bases: Vec<Base>,
    pub aims: Vec<Aim>,
    pub lays: Vec<Lay>,
    pub shoulders: Option<Shoulders>,
    /// The clip's stance, inverted: what a joint has turned by since is `G * rested`.
    pub rested: Vec<UnitQuaternion<f64>>,
}

impl<'r> Pair<'r> {
    pub fn new(clip: &Clip, map: &JointMap, rig: &'r Rig) -> Result<Self, RetargetError> {
        let lacking = |c: &&Canonical| rig.map.joint(**c).is_some() && map.joint(**c).is_none();
        let missing: Vec<_> = NEEDED.iter().filter(lacking).map(|c| c.name()).collect();
        if !missing.is_empty() || map.joint(LHip).is_none() || map.joint(RHip).is_none() {
            return Err(RetargetError::Missing {
                missing: missing.join(", "),
                joints: clip.skeleton.joints.iter().map(|j| j.name.as_str()).collect::<Vec<_>>().join(", "),
            });
        }
        Ok(Builder::new(clip, map, rig).build())
    }
}

struct Builder<'a, 'r> {
    clip: &'a Skeleton,
    map: &'a JointMap,
    rig: &'r Rig,
    theirs: Stance,
    own: Stance,
    partner: Vec<Option<usize>>,
}

impl<'a, 'r> Builder<'a, 'r> {
    fn new(clip: &'a Clip, map: &'a JointMap, rig: &'r Rig) -> Self {
        let mut partner = vec![None; rig.skeleton.len()];
        for canonical in Canonical::ALL {
            if let (Some(to), Some(from)) = (rig.map.joint(canonical), map.joint(canonical)) {
                // A Kinect's chest is its neck: it turns as a chest.
                partner[to] = partner[to].or(Some(from));
            }
        }
        partner[0] = partner[0].or(map.joint(Pelvis));
        let (theirs, own) = (Stance::of_clip(clip, map), Stance::of_rig(rig));
        Self { clip: &clip.skeleton, map, rig, theirs, own, partner }
    }

    fn parent(&self, joint: usize) -> Option<usize> {
        self.rig.skeleton.joints[joint].parent
    }

    /// The nearest ancestor with a partner.
    fn above(&self, joint: usize) -> Option<usize> {
        let mut up = self.parent(joint);
        while let Some(p) = up.filter(|p| self.partner[*p].is_none()) {
            up = self.parent(p);
        }
        up
    }

    fn is(&self, joint: usize, among: &[Canonical]) -> bool {
        among.iter().any(|c| self.rig.map.joint(*c) == Some(joint))
    }

    /// From one joint of the rig to one below it, in the axes of the upper one, in the stance.
    fn bone(&self, from: usize, to: usize) -> Vector3<f64> {
        self.own.worlds[from].inverse() * (self.own.positions[to] - self.own.positions[from])
    }

    /// Joints without a partner between a joint of the trunk and its nearest ancestor with one: they share the turn.
    fn between(&self, joint: usize) -> Vec<usize> {
        let mut found = Vec::new();
        if self.is(joint, &[Spine, Chest, Neck, Head]) {
            let mut up = self.parent(joint);
            while let Some(p) = up.filter(|p| self.partner[*p].is_none()) {
                found.insert(0, p);
                up = self.parent(p);
            }
        }
        found
    }

    fn build(self) -> Pair<'r> {
        let n = self.rig.skeleton.len();
        let mut aims = Vec::new();
        let mut shared: Vec<Option<(usize, usize, f64)>> = vec![None; n];
        let pelvis = self.rig.map.joint(Pelvis).unwrap_or(0);
        let mut aimed = vec![false; n];
        aimed[pelvis] = true;
        let (mut spine, mut head) = (None, None);
        let rigid = self.collar(LShoulder).is_none() && self.collar(RShoulder).is_none();
        for joint in 0..n {
            let (Some(partner), Some(above)) = (self.partner[joint], self.above(joint)) else { continue };
            let trunk = [Spine, Chest, Neck, Head];
            let limb = [LElbow, LWrist, LKnee, LAnkle, LToe, RElbow, RWrist, RKnee, RAnkle, RToe];
            let from = self.partner[above].unwrap_or(partner);
            if from == partner || !(self.is(joint, &trunk) || self.is(joint, &limb)) {
                continue;
            }
            let between = self.between(joint);
            for (at, k) in between.iter().enumerate() {
                shared[*k] = Some((from, partner, (at + 1) as f64 / (between.len() + 1) as f64));
            }
            let nodes: Vec<usize> = [above].into_iter().chain(between).chain([joint]).collect();
            let chain: Vec<_> = nodes.windows(2).map(|w| (w[0], self.bone(w[0], w[1]))).collect();
            let carries = rigid && self.is(above, &[Chest]);
            if above == pelvis && chain.len() == 1 && spine.is_none() {
                spine = Some((chain[0].1, [from, partner]));
            } else if carries && chain.len() == 1 && self.is(joint, &[Head]) {
                let neck = self.map.joint(Neck).filter(|neck| self.is(above, &[Neck]) && *neck != partner);
                head = Some((chain[0].1, [neck.unwrap_or(from), partner]));
            } else {
                // The pelvis lies along the hips, the chest carries the shoulders: they do not follow what only the next joint does.
                let fixed = std::mem::replace(&mut aimed[above], true) || self.is(above, &[Chest]);
                aims.push(Aim { chain, fixed, from, to: Target::Joint(partner) });
            }
        }
        let tips = [LWrist, RWrist, LAnkle, RAnkle, Head, LToe, RToe];
        for canonical in tips {
            let (Some(joint), Some(from)) = (self.rig.map.joint(canonical), self.map.joint(canonical)) else {
                continue;
            };
            let own = tip(&self.rig.skeleton, joint, canonical == Head);
            let theirs = tip(self.clip, from, canonical == Head);
            // Two heads in rest poses that are upright look ahead in both.
            let straight = match canonical {
                LWrist | RWrist => true,
                Head => !(self.own.rests && self.theirs.rests),
                _ => false,
            };
            let guess = |stance: &Stance, skeleton: &Skeleton, joint: usize| {
                straight.then(|| Tip::Point(joint, stance.straight(skeleton, joint, canonical == Head)))
            };
            let own = own.or_else(|| guess(&self.own, &self.rig.skeleton, joint));
            let theirs = theirs.or_else(|| guess(&self.theirs, self.clip, from));
            if let (Some(own), Some(tip), false) = (own, theirs, aimed[joint]) {
                aimed[joint] = true;
                let bone = Target::Tip(own).place(&self.own.positions, &self.own.worlds) - self.own.positions[joint];
                let chain = vec![(joint, self.own.worlds[joint].inverse() * bone)];
                aims.push(Aim { chain, fixed: false, from, to: Target::Tip(tip) });
            }
        }
        let turns = self.turns(&aims, pelvis);
        let base = |joint: usize| {
            let stance = turns[joint] * self.own.worlds[joint];
            match (self.partner[joint], shared[joint]) {
                (Some(partner), _) => {
                    Base::Partner { joint: partner, align: self.theirs.worlds[partner].inverse() * stance }
                }
                (None, Some((above, below, share))) => Base::Between { above, below, share, stance },
                (None, None) => {
                    let above = self.parent(joint).map_or_else(UnitQuaternion::identity, |p| self.own.worlds[p]);
                    Base::Follow(above.inverse() * self.own.worlds[joint])
                }
            }
        };
        let chest = self.rig.map.joint(Chest).filter(|_| rigid);
        let lays = [
            self.lay(pelvis, [LHip, RHip], spine),
            chest.and_then(|chest| self.lay(chest, [LShoulder, RShoulder], head)),
        ];
        Pair {
            bases: (0..n).map(base).collect(),
            lays: lays.into_iter().flatten().collect(),
            shoulders: self.shoulders(),
            rested: self.theirs.worlds.iter().map(UnitQuaternion::inverse).collect(),
            rig: &self.rig.skeleton,
            aims,
        }
    }

    /// What turns every joint of the rig, in the stance, until its bones lie as the clip's do there.
    fn turns(&self, aims: &[Aim], pelvis: usize) -> Vec<UnitQuaternion<f64>> {
        let n = self.rig.skeleton.len();
        let mut turns = vec![UnitQuaternion::identity(); n];
        for joint in 0..n {
            let above = self.parent(joint).map_or_else(UnitQuaternion::identity, |p| turns[p]);
            // Limbs go on from what is above them: a straight arm that hangs turns as a whole, and feet roll with shins. The trunk does not.
            let goes_on = joint != pelvis && !self.is(joint, &[Spine, Chest, Neck, Head]);
            let start = if goes_on { above } else { UnitQuaternion::identity() };
            let aim = aims.iter().find(|aim| joint != pelvis && aim.chain[0].0 == joint);
            turns[joint] = match aim {
                Some(aim) => {
                    let bones = aim.chain.iter().map(|(k, bone)| self.own.worlds[*k] * bone);
                    let own: Vector3<f64> = bones.sum();
                    let theirs =
                        aim.to.place(&self.theirs.positions, &self.theirs.worlds) - self.theirs.positions[aim.from];
                    match self.axes(joint) {
                        Some((axis, bends)) => {
                            across(&own, &axis).zip(across(&theirs, &bends)).map_or(start, |(a, b)| b * a.inverse())
                        }
                        None => swing(&(start * own), &theirs) * start,
                    }
                }
                None => start,
            };
        }
        turns
    }

    /// The axes about which the limb below a joint bends, in the rig's stance and in the clip's, where the clip's rest pose does not say.
    fn axes(&self, joint: usize) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let at = BENDS.iter().position(|(limb, _)| self.rig.map.joint(limb[0]) == Some(joint))?;
        Some((self.own.axes[at].unwrap_or_else(|| BENDS[at].1.into()), self.theirs.axes[at]?))
    }

    fn lay(&self, joint: usize, pair: [Canonical; 2], bone: Option<(Vector3<f64>, [usize; 2])>) -> Option<Lay> {
        let own = pair.map(|side| self.rig.map.joint(side).filter(|side| self.above(*side) == Some(joint)));
        let from = pair.map(|side| self.map.joint(side));
        let ([Some(l), Some(r)], [Some(left), Some(right)]) = (own, from) else { return None };
        Some(Lay { joint, line: self.bone(joint, l) - self.bone(joint, r), from: [left, right], bone })
    }

    /// Nothing where the shoulders are rigid in the chest.
    fn shoulders(&self) -> Option<Shoulders> {
        let [left, right] = [self.collar(LShoulder)?, self.collar(RShoulder)?];
        let own = [self.rig.map.joint(LShoulder)?, self.rig.map.joint(RShoulder)?];
        let [l, r] = [self.map.joint(LShoulder)?, self.map.joint(RShoulder)?];
        let chest = left.0;
        let partner = self.partner[chest].filter(|_| right.0 == chest)?;
        let theirs = &self.theirs.positions;
        let middle = (theirs[l] + theirs[r]) * 0.5 - theirs[partner];
        let (width, from_width) =
            ((self.own.positions[own[0]] - self.own.positions[own[1]]).norm(), (theirs[l] - theirs[r]).norm());
        let above = self.clip.joints[l].parent.filter(|p| *p != partner);
        let reach = above.map_or(0.0, |p| (theirs[l] - theirs[p]).norm());
        let collars = if reach > NO_BONE { left.1.bone.norm() / reach } else { f64::INFINITY };
        (width > NO_BONE && from_width > NO_BONE).then(|| Shoulders {
            middle: (self.bone(chest, own[0]) + self.bone(chest, own[1])) * 0.5,
            from: [partner, l, r],
            from_middle: self.theirs.worlds[partner].inverse() * middle,
            scale: (width / from_width).min(collars),
            collars: [left.1, right.1],
            chest,
            width,
            from_width,
        })
    }

    /// What turns to move a shoulder, and in which joint it stands.
    fn collar(&self, side: Canonical) -> Option<(usize, Collar)> {
        let own = self.rig.map.joint(side)?;
        let mut chest = self.above(own)?;
        if self.is(chest, &[LCollar, RCollar]) {
            chest = self.above(chest)?;
        }
        let mut joint = self.parent(own).filter(|joint| *joint != chest)?;
        while let Some(up) = self.parent(joint).filter(|up| *up != chest) {
            joint = up;
        }
        let bone = self.bone(joint, own);
        (bone.norm() > NO_BONE).then(|| (chest, Collar { joint, start: self.bone(chest, joint), bone }))
    }
}

/// Axes of which the first lies along a bone, and the second as near as can be to another axis.
fn across(bone: &Vector3<f64>, axis: &Vector3<f64>) -> Option<UnitQuaternion<f64>> {
    let along = bone.try_normalize(NO_BONE)?;
    let second = (axis - along * axis.dot(&along)).try_normalize(NO_BONE)?;
    let axes = Matrix3::from_columns(&[along, second, along.cross(&second)]);
    Some(UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes)))
}

impl Target {
    /// Where it is in a pose.
    pub fn place(&self, positions: &[Vector3<f64>], worlds: &[UnitQuaternion<f64>]) -> Vector3<f64> {
        match self {
            Self::Joint(joint) => positions[*joint],
            Self::Tip(Tip::Point(joint, point)) => positions[*joint] + worlds[*joint] * point,
            Self::Tip(Tip::Joints(joints)) => {
                joints.iter().map(|j| positions[*j]).sum::<Vector3<f64>>() / joints.len().max(1) as f64
            }
        }
    }
}

/// The tip of a joint: the mean of what hangs on it, seen through joints at no distance; else its end site. What hangs on a head are eyes
/// and hair.
fn tip(skeleton: &Skeleton, joint: usize, head: bool) -> Option<Tip> {
    let (mut at, mut found) = (vec![joint], Vec::new());
    while let Some(up) = at.pop().filter(|_| !head) {
        for child in skeleton.children(up) {
            if skeleton.joints[child].offset.norm() > NO_BONE { found.push(child) } else { at.push(child) }
        }
    }
    if !found.is_empty() {
        return Some(Tip::Joints(found));
    }
    let end = skeleton.joints[joint].end.filter(|end| end.norm() > NO_BONE);
    end.map(|end| Tip::Point(joint, end))
}
