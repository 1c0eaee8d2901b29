//! Which clips look non-expressive, by rules that can be measured: hands, head against travel, torso.

use serde::Serialize;

use crate::clip::{Canonical, Clip, JointMap};

/// What was measured on a clip, and the verdict.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Proposal {
    /// Whether it looks like body mechanics alone.
    pub plain: bool,
    /// Higher wrist over its shoulder, by the length of the arm: the 98 % quantile. Plain: below -0.15.
    pub hands_height: f64,
    /// Part of the frames in which a wrist is farther to the side of the pelvis than 0.75 arms (arms swing to and fro, not to
    /// the side). Plain: below 5 %.
    pub hands_far: f64,
    /// Angle between where the shoulders face (head joints of layouts differ in their axes) and where the body goes, degrees, mean while it goes. Plain: below 25.
    pub head_yaw_deg: f64,
    /// Lean of the trunk from the vertical, degrees, the 95 % quantile. Plain: below 30.
    pub torso_lean_deg: f64,
    /// Horizontal speed of the pelvis, m/s, mean. Plain: above 0.3 (who stands and gestures shows little mechanics).
    pub speed: f64,
}

/// Measures a clip. `None` where joints are unknown or it has fewer than two frames.
pub fn propose(clip: &Clip, map: &JointMap) -> Option<Proposal> {
    use Canonical::*;
    let joint = |c| map.joint(c);
    let (pelvis, neck) = (joint(Pelvis)?, joint(Neck).or(joint(Chest))?);
    let wrists = [(joint(LWrist)?, joint(LShoulder)?), (joint(RWrist)?, joint(RShoulder)?)];
    let rest = clip.skeleton.rest_positions();
    let arm = |(w, s): (usize, usize)| (rest[w] - rest[s]).norm();
    let (mut heights, mut leans) = (Vec::new(), Vec::new());
    let (mut far, mut turned, mut going, mut travelled) = (0usize, 0.0, 0usize, 0.0);
    let frames = clip.frames();
    for frame in 0..frames {
        let at = clip.positions(frame);
        let trunk = at[neck] - at[pelvis];
        let up = trunk.try_normalize(1e-9)?;
        leans.push(up.y.clamp(-1.0, 1.0).acos().to_degrees());
        let over = wrists.map(|side| (at[side.0].y - at[side.1].y) / arm(side));
        heights.push(over[0].max(over[1]));
        let across = at[wrists[0].1] - at[wrists[1].1];
        let aside = across.try_normalize(1e-9)?;
        let off = wrists.map(|side| (at[side.0] - at[pelvis]).dot(&aside).abs() / arm(side));
        far += usize::from(off[0].max(off[1]) > 0.75);
        let next = clip.root.get(frame + 1).or(clip.root.last())?;
        let travel = (next - clip.root[frame.min(frames - 1)]) / clip.frame_time;
        travelled += (travel.x * travel.x + travel.z * travel.z).sqrt() / frames as f64;
        let speed = (travel.x * travel.x + travel.z * travel.z).sqrt();
        if speed > 0.3 {
            let facing = (-across.z).atan2(across.x);
            let heading = travel.x.atan2(travel.z);
            let angle = (facing - heading).sin().atan2((facing - heading).cos());
            turned += angle.abs().to_degrees();
            going += 1;
        }
    }
    heights.sort_by(f64::total_cmp);
    leans.sort_by(f64::total_cmp);
    let quantile = |sorted: &[f64], q: f64| sorted.get((q * sorted.len() as f64) as usize).copied();
    let mut proposal = Proposal {
        plain: false,
        hands_height: quantile(&heights, 0.98)?,
        hands_far: far as f64 / frames as f64,
        head_yaw_deg: turned / going.max(1) as f64,
        torso_lean_deg: quantile(&leans, 0.95)?,
        speed: travelled,
    };
    proposal.plain = proposal.hands_height < -0.15
        && proposal.hands_far < 0.05
        && proposal.head_yaw_deg < 25.0
        && proposal.torso_lean_deg < 30.0
        && proposal.speed > 0.3;
    Some(proposal)
}
