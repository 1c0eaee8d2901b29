//! From a person to a robot: the robot's limbs are laid along the person's, within what its joints can do.
//!
//! | file | holds |
//! |---|---|
//! | `map` | [`LimbMap`]: where each limb begins and ends on the robot |
//! | `suggest` | [`LimbMap::suggest`]: a map from names and geometry |
//! | `human` | where the person's limbs point |
//! | `reach` | the robot's directions as functions of its joints, and their derivatives |
//! | `solve` | least squares within bounds, frame after frame |
//! | `moves` | [`Moves`]: what came of it, as a table and as figures |

mod human;
mod map;
mod moves;
mod reach;
mod solve;
mod suggest;

use nalgebra::Vector3;

use self::human::Human;
pub use self::map::{Base, End, Limb, LimbEntry, LimbMap};
use self::moves::Tally;
pub use self::moves::{LimbFigures, Moves};
use self::reach::Reach;
use super::{Robot, RobotError};
use crate::clip::{Clip, JointMap};

/// Index of the joint whose frame a joint's or link's name means; `Some(None)` is the root link.
fn point(robot: &Robot, name: &str) -> Option<Option<usize>> {
    let joint = robot.find(name).or_else(|| robot.joints.iter().position(|joint| joint.child == name));
    joint.map(Some).or_else(|| (robot.root().as_deref() == Some(name)).then_some(None))
}

/// Lays the robot's limbs along those of the person in a clip, at the clip's frame rate.
///
/// Directions alone are compared: sizes of robot and person do not matter. Joints never leave their bounds and, from one frame to the
/// next, never exceed their speeds. Sliders, and joints that move no mapped limb, stay at 0 or at the bound nearest to it. Linear in
/// frames, cubic in the joints of the limbs, of which there are at most 200.
pub fn retarget(robot: &Robot, clip: &Clip, joints: &JointMap, map: &LimbMap) -> Result<Moves, RobotError> {
    let human = Human::new(clip, joints).ok_or_else(|| {
        let what = "hips, pelvis, and neck or head are not all known: where the person faces is not known either";
        RobotError::new("the clip", what, "name them in a skeleton map: --skeleton-map FILE.toml")
    })?;
    let (entries, lost): (Vec<&LimbEntry>, Vec<&LimbEntry>) = map.limbs.iter().partition(|entry| human.has(entry.limb));
    let mut notes: Vec<String> =
        lost.iter().map(|entry| format!("{}: the clip does not show it, left out", entry.limb.name())).collect();
    if entries.is_empty() {
        let what = "none of the map's limbs is shown by the clip";
        return Err(RobotError::new("[limbs]", what, "name limbs whose joints the clip's skeleton has"));
    }
    let reach = Reach::new(robot, &entries, &mut notes)?;
    let limbs: Vec<Limb> = entries.iter().map(|entry| entry.limb).collect();
    let base = map.base.unwrap_or_else(|| {
        let lower = |limb: Limb| limb as usize >= Limb::LThigh as usize;
        let waist = |at: usize| [Limb::Trunk, Limb::Shoulders].contains(&limbs[at]) && reach.joints_of(at) > 0;
        let whole = (0..limbs.len()).any(|at| lower(limbs[at]) || waist(at));
        if whole { Base::Pelvis } else { Base::Chest }
    });
    if map.base.is_none() {
        let name = if base == Base::Pelvis { "pelvis" } else { "chest" };
        notes.push(format!("the root link goes with the person's {name}: write base into the map for another"));
    }
    let left = map.up.cross(&map.forward);
    let goals = |frame: usize| -> Vec<Option<Vector3<f64>>> {
        let found = human.directions(frame, base, &limbs).into_iter();
        found.map(|way| way.map(|way| map.forward * way.x + left * way.y + map.up * way.z)).collect()
    };
    let mut tally = Tally::new(&reach, &limbs);
    let mut now: Option<Vec<f64>> = None;
    for frame in 0..clip.frames() {
        let goals = goals(frame);
        let next = match &now {
            None => solve::first(&reach, &goals),
            Some(before) => solve::next(&reach, &goals, before, clip.frame_time),
        };
        tally.add(&reach, &goals, &next);
        now = Some(next);
    }
    Ok(tally.finish(robot, &reach, clip.frame_time, notes))
}
