//! One skeleton for all clips: a motion is put on the rig's bones before anything is learned or compared.
//!
//! So a style is a manner and not a body size: an adult and a child who do the same have the same motion on the rig.

use kinesic::Skeleton as DeviceSkeleton;
use kinesic::pose::{World, forward, solve};
use nalgebra::{UnitQuaternion, Vector3};

use crate::clip::solve::turn;
use crate::clip::{Canonical, Clip, JointMap, Skeleton};
use crate::rig::{MAX_JOINTS, Rig};

/// Why a clip cannot be put on a rig.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RetargetError {
    /// Joints that the rig needs are unknown in the clip.
    #[error(
        "the clip's skeleton differs from the pack's and lacks a joint for: {missing}. Give a skeleton map (--map FILE) \
         that names them; the clip's joints are: {joints}"
    )]
    Missing {
        /// Canonical names.
        missing: String,
        /// The clip's joints.
        joints: String,
    },
}

/// The clip's motion on the rig's skeleton, frame for frame.
///
/// Where the skeletons are equal (names, parents and directions of the bones), rotations are copied. Where names and parents are the same
/// and the rest pose is another, every rotation is corrected by what turns the rig's bones into the clip's, tips included. Else every bone
/// of the rig takes the direction that the clip's joints have, found through the two joint maps. The root's path is that of the pelvis,
/// scaled by the length of the legs.
pub fn retarget(clip: &Clip, map: &JointMap, rig: &Rig) -> Result<Clip, RetargetError> {
    let scale = leg_scale(clip, map, rig);
    let pelvis = map.joint(Canonical::Pelvis).filter(|&p| p > 0 && rig.map.joint(Canonical::Pelvis) == Some(0));
    let root = match pelvis {
        Some(pelvis) => (0..clip.frames()).map(|f| clip.positions(f)[pelvis] * scale).collect(),
        None => clip.root.iter().map(|p| p * scale).collect(),
    };
    let mut notes = clip.notes.clone();
    let rotations = if !same_joints(&clip.skeleton, &rig.skeleton) {
        Bones::new(clip, map, rig)?.rotations(clip)
    } else if same_rest(&clip.skeleton, &rig.skeleton) {
        clip.rotations.clone()
    } else {
        notes
            .push("The rest pose differs from the pack's: directions of bones were transferred, not rotations.".into());
        corrected(clip, &rig.skeleton)
    };
    Ok(Clip { skeleton: rig.skeleton.clone(), frame_time: clip.frame_time, root, rotations, coordinates: None, notes })
}

/// Whether two skeletons have the same joints: names and parents.
pub(crate) fn same_joints(a: &Skeleton, b: &Skeleton) -> bool {
    a.joints.len() == b.joints.len()
        && a.joints.iter().zip(&b.joints).all(|(a, b)| a.name == b.name && a.parent == b.parent)
}

/// Bones of two skeletons that differ in direction by less rest alike, rad.
const ALIKE: f64 = 2e-3;
/// Bones shorter than this have no direction, m.
const NO_BONE: f64 = 1e-4;

/// Whether the bones of two skeletons with the same joints point the same way at rest.
fn same_rest(a: &Skeleton, b: &Skeleton) -> bool {
    let alike = |a: &Vector3<f64>, b: &Vector3<f64>| a.norm() < NO_BONE || b.norm() < NO_BONE || a.angle(b) < ALIKE;
    a.joints
        .iter()
        .zip(&b.joints)
        .all(|(a, b)| alike(&a.offset, &b.offset) && a.end.zip(b.end).is_none_or(|(a, b)| alike(&a, &b)))
}

/// Rotations that lay the rig's bones where the clip's are: `G_rig = G_clip A`, where `A` turns the rig's bones at a joint into the clip's
/// by the smallest turn. A joint without bones goes with its parent.
fn corrected(clip: &Clip, rig: &Skeleton) -> Vec<UnitQuaternion<f64>> {
    let mut turns: Vec<UnitQuaternion<f64>> = Vec::new();
    for (index, joint) in rig.joints.iter().enumerate() {
        let own = &clip.skeleton.joints;
        let tips = joint.end.zip(own[index].end);
        let bones = rig.children(index).map(|c| (rig.joints[c].offset, own[c].offset)).chain(tips);
        let pairs: Vec<_> = bones.filter(|(a, b)| a.norm() > NO_BONE && b.norm() > NO_BONE).collect();
        let above = joint.parent.map_or_else(UnitQuaternion::identity, |p| turns[p]);
        // From the parent's turn on: a straight limb that hangs otherwise turns as a whole.
        let started: Vec<_> = pairs.iter().map(|(a, b)| (above * a, *b)).collect();
        turns.push(if pairs.is_empty() { above } else { nearest(&pairs, &started, above) });
    }
    let n = rig.len();
    let mut out = Vec::with_capacity(clip.rotations.len());
    for frame in 0..clip.frames() {
        for (index, local) in clip.pose(frame).iter().enumerate().take(n) {
            let above = rig.joints[index].parent.map_or_else(UnitQuaternion::identity, |p| turns[p]);
            out.push(above.inverse() * local * turns[index]);
        }
    }
    out
}

/// The turn of a joint: none where its own bones rest alike, else what its parent's turn leaves to do.
fn nearest(
    pairs: &[(Vector3<f64>, Vector3<f64>)],
    started: &[(Vector3<f64>, Vector3<f64>)],
    above: UnitQuaternion<f64>,
) -> UnitQuaternion<f64> {
    match pairs.iter().all(|(a, b)| a.angle(b) < ALIKE) {
        true => UnitQuaternion::identity(),
        false => turn(started) * above,
    }
}

/// Length of the rig's legs over that of the clip's: the root's path is so many times as long.
pub(crate) fn leg_scale(clip: &Clip, map: &JointMap, rig: &Rig) -> f64 {
    let scale = leg_length(&rig.skeleton, &rig.map) / leg_length(&clip.skeleton, map);
    // Legs that differ by less than a tenth of a millimetre in a metre are the same legs.
    if scale.is_finite() && (scale - 1.0).abs() > 1e-4 { scale } else { 1.0 }
}

/// Thighs and shins of both legs, m.
fn leg_length(skeleton: &Skeleton, map: &JointMap) -> f64 {
    let rest = skeleton.rest_positions();
    let legs = [
        (Canonical::LHip, Canonical::LKnee),
        (Canonical::LKnee, Canonical::LAnkle),
        (Canonical::RHip, Canonical::RKnee),
        (Canonical::RKnee, Canonical::RAnkle),
    ];
    let bone = |(a, b)| Some((rest[map.joint(b)?] - rest[map.joint(a)?]).norm());
    legs.into_iter().filter_map(bone).sum()
}

/// Directions of the clip's bones, as targets for the rig's.
struct Bones<'r> {
    rig: &'r Rig,
    /// Rig joint <- clip joint, with the rig's nearest ancestor that has a partner too and the rest distance to it.
    links: Vec<Link>,
    aims: Vec<[u16; 2]>,
    parents: Vec<u16>,
    offsets: Vec<[f32; 3]>,
    hips: [usize; 2],
}

struct Link {
    joint: usize,
    partner: usize,
    above: Option<usize>,
    rest: f64,
}

/// Without these no motion can be transferred; collars, toes, neck and spine may be missing.
const NEEDED: [Canonical; 15] = [
    Canonical::Pelvis,
    Canonical::Chest,
    Canonical::Head,
    Canonical::LShoulder,
    Canonical::LElbow,
    Canonical::LWrist,
    Canonical::RShoulder,
    Canonical::RElbow,
    Canonical::RWrist,
    Canonical::LHip,
    Canonical::LKnee,
    Canonical::LAnkle,
    Canonical::RHip,
    Canonical::RKnee,
    Canonical::RAnkle,
];

impl<'r> Bones<'r> {
    fn new(clip: &Clip, map: &JointMap, rig: &'r Rig) -> Result<Self, RetargetError> {
        let lacking = |c: &&Canonical| rig.map.joint(**c).is_some() && map.joint(**c).is_none();
        let missing: Vec<_> = NEEDED.iter().filter(lacking).map(|c| c.name()).collect();
        let (Some(left), Some(right), true) =
            (map.joint(Canonical::LHip), map.joint(Canonical::RHip), missing.is_empty())
        else {
            return Err(RetargetError::Missing {
                missing: missing.join(", "),
                joints: clip.skeleton.joints.iter().map(|j| j.name.as_str()).collect::<Vec<_>>().join(", "),
            });
        };
        let joints = &rig.skeleton.joints;
        let rest = rig.skeleton.rest_positions();
        let mut partner = vec![None; joints.len()];
        for canonical in Canonical::ALL {
            if let (Some(to), Some(from)) = (rig.map.joint(canonical), map.joint(canonical)) {
                partner[to] = Some(from);
            }
        }
        partner[0] = partner[0].or(map.joint(Canonical::Pelvis));
        let above = |joint: usize| {
            let mut up = joints[joint].parent;
            while let Some(p) = up.filter(|p| partner[*p].is_none()) {
                up = joints[p].parent;
            }
            up
        };
        let links = (0..joints.len()).filter_map(|joint| {
            let above = above(joint);
            let rest = above.map_or(0.0, |a| (rest[joint] - rest[a]).norm());
            Some(Link { joint, partner: partner[joint]?, above, rest })
        });
        let links: Vec<Link> = links.collect();
        // Every joint between two partners aims at the lower one.
        let mut aims: Vec<[u16; 2]> = Vec::new();
        for link in &links {
            let mut up = joints[link.joint].parent;
            while let Some(p) = up {
                aims.push([p as u16, link.joint as u16]);
                up = if partner[p].is_some() { None } else { joints[p].parent };
            }
        }
        aims.sort_unstable();
        Ok(Self {
            rig,
            links,
            aims,
            parents: joints.iter().map(|j| j.parent.unwrap_or(0) as u16).collect(),
            offsets: joints.iter().map(|j| j.offset.map(|x| x as f32).into()).collect(),
            hips: [left, right],
        })
    }

    fn rotations(&self, clip: &Clip) -> Vec<UnitQuaternion<f64>> {
        let joints = self.rig.joints();
        let skeleton = DeviceSkeleton::new(&self.parents, &self.offsets, &self.aims, &[])
            .unwrap_or_else(|error| unreachable!("the rig's own tables are refused: {error}"));
        let mut rotations = Vec::with_capacity(clip.frames() * joints);
        let (mut rest, mut solved) = (kinesic::Pose::<MAX_JOINTS>::identity(), kinesic::Pose::identity());
        let mut world = World::identity();
        for frame in 0..clip.frames() {
            let from = clip.positions(frame);
            // The rest pose, turned into the clip's heading: from there no joint has to turn by half a circle.
            let across = from[self.hips[0]] - from[self.hips[1]];
            let heading = f64::atan2(-across.z, across.x);
            rest.rotations[0] = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), heading).cast();
            forward(&skeleton, &rest, &mut world);
            let mut targets = world.positions;
            for link in &self.links {
                if let Some(above) = link.above {
                    let top = self.links.iter().find(|l| l.joint == above).map_or(link.partner, |l| l.partner);
                    let bone = from[link.partner] - from[top];
                    let direction = bone.try_normalize(1e-9).unwrap_or_else(Vector3::zeros);
                    targets[link.joint] = targets[above] + (direction * link.rest).cast();
                }
            }
            solve(&skeleton, &rest, &world, &targets, &mut solved);
            rotations.extend(
                solved
                    .rotations
                    .iter()
                    .take(joints)
                    .map(|q| UnitQuaternion::new_normalize(q.into_inner().cast::<f64>())),
            );
        }
        rotations
    }
}
