//! One skeleton for all clips: a motion is put on the rig's bones before anything is learned or compared.
//!
//! So a style is a manner and not a body size: an adult and a child who do the same have the same motion on the rig.
//!
//! | file | holds |
//! |---|---|
//! | `alike` | skeletons of the same joints: what turns the bones of one rest pose into those of the other |
//! | `stance` | an upright pose of any skeleton, to compare rest poses in |
//! | `pair` | skeletons of other joints: which joint is whose partner, and what turns one's axes into the other's |
//! | `frame` | one frame of that: rotations of the source, then the small turns that make every limb point exactly where it does |
//! | `ground` | the root's path, and the height at which the feet stand |

use nalgebra::{UnitQuaternion, Vector3};

use crate::clip::{Canonical, Clip, JointMap, Skeleton};
use crate::rig::Rig;

mod alike;
mod frame;
mod ground;
mod pair;
mod stance;

pub(crate) use alike::same_joints;
pub(crate) use ground::longer;

/// Bones shorter than this have no direction, m.
const NO_BONE: f64 = 1e-4;

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
/// Where the skeletons are equal (names, parents and directions of the bones), rotations are copied and the root's path is scaled by the
/// length of the legs. Where names and parents are the same and the rest pose is another, every rotation is corrected by what turns the
/// rig's bones into the clip's, tips included.
///
/// Else joints are found through the two joint maps. Each takes the turn of its partner, and its bone the exact direction that the
/// partner's has; hands, feet and heads aim their tips. Joints of the rig between two partners share what the partners turn by.
/// Shoulders stay as far apart as the rig's, and move in the chest as the clip's do.
///
/// Where the skeletons differ, the middle of the hips takes the path of the clip's, scaled by the length of the legs from the clip's floor
/// up. One height is then added for the whole clip, such that feet stand on the clip's floor when the clip's feet do, and none is more than 1 cm
/// under it (where that lifts the clip by 3.5 cm at most).
pub fn retarget(clip: &Clip, map: &JointMap, rig: &Rig) -> Result<Clip, RetargetError> {
    let mut notes = clip.notes.clone();
    let same = same_joints(&clip.skeleton, &rig.skeleton);
    let equal = same && alike::same_rest(&clip.skeleton, &rig.skeleton);
    let rotations = if equal {
        clip.rotations.clone()
    } else if same {
        notes
            .push("The rest pose differs from the pack's: directions of bones were transferred, not rotations.".into());
        alike::corrected(clip, &rig.skeleton)
    } else {
        pair::Pair::new(clip, map, rig)?.rotations(clip)
    };
    let root = if equal { ground::scaled(clip, map, rig) } else { ground::standing(clip, map, rig, &rotations) };
    Ok(Clip { skeleton: rig.skeleton.clone(), frame_time: clip.frame_time, root, rotations, coordinates: None, notes })
}

/// The smallest rotation from one direction to another; none where a direction is missing.
fn swing(from: &Vector3<f64>, to: &Vector3<f64>) -> UnitQuaternion<f64> {
    crate::clip::solve::turn(&[(*from, *to)])
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

#[cfg(test)]
mod tests;
