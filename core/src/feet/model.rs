//! The legs of a skeleton.

use nalgebra::Vector3;

use super::leg::norm;
use crate::mechanics::Thresholds;
use crate::model::{LoadError, Pack};
use crate::pose::{Pose, Skeleton, is_number};
use crate::rig::REACH;

/// Canonical joints: see `docs/pack.md`.
const CANONICAL: usize = 21;
/// Where the left hip stands among them; then come knee, ankle and toe, and the right ones.
const LEFT_HIP: usize = 13;
/// Stands for a joint that the skeleton does not have.
const NONE: u16 = u16::MAX;
/// Length of an adult's leg, m: speeds and heights are those of an adult, times the length of a leg over this.
const ADULT: f32 = 0.85;

/// A leg, and the point of its foot that is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    pub hip: u16,
    pub knee: u16,
    pub ankle: u16,
    /// The joint that touches the ground: the toe, or the ankle where there is none.
    pub joint: u16,
    /// Where on it, m: the tip of an ankle without a toe.
    pub tip: Vector3<f32>,
}

/// Holds the feet of a body where those of its source stand: see the [module](super).
#[derive(Clone, Copy, Debug)]
pub struct Feet<'a> {
    pub(super) skeleton: Skeleton<'a>,
    pub(super) legs: [Leg; 2],
    /// Length of the legs over that of an adult's.
    pub(super) size: f32,
    pub(super) frame_time: f32,
    pub(super) thresholds: Thresholds,
    /// How far the root may go from the source's over the ground, m, all in all: see [`Drift`](crate::rig::Drift).
    pub reach: f32,
}

impl<'a> Feet<'a> {
    /// The legs of a pack's skeleton, at its frame rate. A pack whose skeleton has no two whole legs is refused: the tensor
    /// `skeleton/canonical` says where hips, knees and ankles are (elements 13 to 15 and 17 to 19).
    pub fn load(pack: &Pack<'a>) -> Result<Self, LoadError> {
        const TENSOR: &str = "skeleton/canonical";
        let skeleton = Skeleton::load(pack)?;
        let refused = |index| LoadError::Value { tensor: TENSOR, index };
        let canonical = pack.slice::<u16>(TENSOR, CANONICAL)?;
        let ends = pack.slice::<[f32; 3]>("skeleton/ends", skeleton.joints())?;
        let leg = |first: usize| {
            let [hip, knee, ankle, toe] = core::array::from_fn(|at| canonical.get(first + at).copied().unwrap_or(NONE));
            let chain = [(first, 0, hip), (first + 1, hip, knee), (first + 2, knee, ankle)];
            for (index, above, joint) in chain {
                if usize::from(joint) >= skeleton.joints() || joint == 0 || !skeleton.is_above(above, joint) {
                    return Err(refused(index));
                }
            }
            let joint = if toe != NONE && skeleton.is_above(ankle, toe) { toe } else { ankle };
            let tip = ends
                .get(usize::from(joint))
                .filter(|_| joint == ankle)
                .map_or_else(Vector3::zeros, |tip| Vector3::from(*tip));
            Ok(Leg { hip, knee, ankle, joint, tip })
        };
        let legs = [leg(LEFT_HIP)?, leg(LEFT_HIP + 4)?];
        let mut length = 0.0;
        for leg in &legs {
            length += 0.5 * length_of(&skeleton, leg)?;
        }
        Self::sized(skeleton, legs, length / ADULT, pack.metadata().frame_rate)
    }

    fn sized(skeleton: Skeleton<'a>, legs: [Leg; 2], size: f32, frame_rate: f32) -> Result<Self, LoadError> {
        if !(1.0..1e4).contains(&frame_rate) {
            return Err(LoadError::Metadata);
        }
        let adult = Thresholds::default();
        let thresholds = Thresholds {
            land_speed: adult.land_speed * size,
            land_height: adult.land_height * size,
            lift_speed: adult.lift_speed * size,
            lift_height: adult.lift_height * size,
            still_speed: adult.still_speed * size,
            step_height: adult.step_height * size,
            ..adult
        };
        Ok(Self { skeleton, legs, size, frame_time: 1.0 / frame_rate, thresholds, reach: REACH })
    }
}

/// Length of a leg, m. Far joints have no squares, and a leg of no length has no direction.
fn length_of(skeleton: &Skeleton, leg: &Leg) -> Result<f32, LoadError> {
    let refused = |joint| LoadError::Value { tensor: "skeleton/offsets", index: usize::from(joint) };
    let mut near = leg.tip.iter().all(|x| is_number(*x));
    skeleton.ancestors(leg.joint, |_, offset| near &= offset.iter().all(|x| is_number(*x)));
    if !near {
        return Err(refused(leg.joint));
    }
    let pose = Pose::<0>::identity();
    let [hip, knee, ankle] = [leg.hip, leg.knee, leg.ankle].map(|joint| skeleton.point(&pose, joint, Vector3::zeros()));
    let [thigh, shin] = [norm(knee - hip), norm(ankle - knee)];
    for (bone, joint) in [(thigh, leg.knee), (shin, leg.ankle)] {
        if !(1e-2..1e2).contains(&bone) {
            return Err(refused(joint));
        }
    }
    Ok(thigh + shin)
}
