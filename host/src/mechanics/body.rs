//! What the features need to know about a rig.

use kinesic::mechanics::Body;

use crate::clip::{Canonical, Clip};
use crate::rig::Rig;

/// Why a skeleton has no body mechanics.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "the skeleton has no known {missing}: body mechanics needs hips, knees and ankles. Give a skeleton map (--map FILE) that \
     names them"
)]
pub struct BodyError {
    /// Names of the canonical joints.
    pub missing: String,
}

/// Part of the frames in which a point is taken to be at its lowest.
const LOW: f64 = 0.1;

/// Sizes, feet and thighs of a rig. Heights are those of standing straight, legs vertical; a flat foot's ankle is taken to be
/// as high over the toes as in the rest pose, until [`measured`].
pub fn body(rig: &Rig) -> Result<Body, BodyError> {
    use Canonical::*;
    let needed = [LHip, LKnee, LAnkle, RHip, RKnee, RAnkle];
    let missing: Vec<_> = needed.into_iter().filter(|c| rig.map.joint(*c).is_none()).map(Canonical::name).collect();
    if !missing.is_empty() {
        return Err(BodyError { missing: missing.join(", ") });
    }
    let joint = |c: Canonical| rig.map.joint(c).unwrap_or(0);
    let rest = rig.skeleton.rest_positions();
    let toe = |toe: Canonical, ankle: Canonical| rig.map.joint(toe).unwrap_or(joint(ankle));
    let feet = [[joint(LAnkle), toe(LToe, LAnkle)], [joint(RAnkle), toe(RToe, RAnkle)]];
    let above = |[ankle, toe]: [usize; 2]| (rest[ankle].y - rest[toe].y).max(0.0);
    let leg = |hip: Canonical, knee: Canonical, foot: [usize; 2]| {
        let bone = |a: usize, b: usize| (rest[a] - rest[b]).norm();
        let below = (rest[0].y - rest[joint(hip)].y).max(0.0);
        below + bone(joint(hip), joint(knee)) + bone(joint(knee), foot[0]) + above(foot)
    };
    let hip_height = 0.5 * (leg(LHip, LKnee, feet[0]) + leg(RHip, RKnee, feet[1]));
    let tips = rig.skeleton.joints.iter().zip(&rest).map(|(j, p)| p.y + j.end.map_or(0.0, |end| end.y.max(0.0)));
    let upper = tips.fold(0.0, f64::max) - rest[0].y;
    Ok(Body {
        feet: feet.map(|foot| foot.map(|j| j as u16)),
        clearance: feet.map(|foot| [above(foot) as f32, 0.0]),
        thighs: [joint(LHip) as u16, joint(RHip) as u16],
        height: (hip_height + upper) as f32,
        hip_height: hip_height as f32,
    })
}

/// The body with its ankles as high over its toes as they are in clips of the rig: the median over the clips of how the lowest
/// tenths of the heights differ.
pub fn measured(body: &Body, clips: &[&Clip]) -> Body {
    let mut body = *body;
    for (clearance, foot) in body.clearance.iter_mut().zip(body.feet) {
        let mut found: Vec<f64> = clips
            .iter()
            .filter_map(|clip| {
                let heights = foot.map(|joint| {
                    let mut heights: Vec<f64> =
                        (0..clip.frames()).map(|f| clip.positions(f)[usize::from(joint)].y).collect();
                    heights.sort_by(f64::total_cmp);
                    heights.get((LOW * heights.len() as f64) as usize).copied()
                });
                Some(heights[0]? - heights[1]?)
            })
            .collect();
        found.sort_by(f64::total_cmp);
        if let Some(middle) = found.get(found.len() / 2) {
            *clearance = [middle.max(0.0) as f32, 0.0];
        }
    }
    body
}
