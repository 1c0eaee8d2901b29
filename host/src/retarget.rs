//! One skeleton for all clips: a motion is put on the rig's bones before anything is learned or compared.
//!
//! So a style is a manner and not a body size: an adult and a child who do the same have the same motion on the rig.

use kinesic::Skeleton as DeviceSkeleton;
use kinesic::pose::{World, forward, solve};
use nalgebra::{UnitQuaternion, Vector3};

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
/// Where the joints are the same (by name and parent), rotations are copied; else every bone of the rig takes the direction
/// that the clip's joints have, found through the two joint maps. The root's path is scaled by the length of the legs.
pub fn retarget(clip: &Clip, map: &JointMap, rig: &Rig) -> Result<Clip, RetargetError> {
    let scale = leg_length(&rig.skeleton, &rig.map) / leg_length(&clip.skeleton, map);
    // Legs that differ by less than a tenth of a millimetre in a metre are the same legs.
    let scale = if scale.is_finite() && (scale - 1.0).abs() > 1e-4 { scale } else { 1.0 };
    let root = clip.root.iter().map(|p| p * scale).collect();
    let rotations = if same_joints(&clip.skeleton, &rig.skeleton) {
        clip.rotations.clone()
    } else {
        Bones::new(clip, map, rig)?.rotations(clip)
    };
    Ok(Clip { skeleton: rig.skeleton.clone(), frame_time: clip.frame_time, root, rotations, notes: clip.notes.clone() })
}

fn same_joints(a: &Skeleton, b: &Skeleton) -> bool {
    a.joints.len() == b.joints.len()
        && a.joints.iter().zip(&b.joints).all(|(a, b)| a.name == b.name && a.parent == b.parent)
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
