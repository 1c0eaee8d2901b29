//! What each robot joint may do: its bounds and rates, and those of the joints that follow it.

use std::f64::consts::{PI, TAU};

use super::{Entry, Rates};
use crate::clip::map::nearest;
use crate::robot::{Mimic, Motion, Robot, RobotError, RobotJoint};

/// Bounds beyond this mean that there are none, rad: no robot counts 160 turns, and degrees stay below.
const UNLIMITED: f64 = 1e3;

/// Bounds and rates of one coordinate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub lower: f64,
    pub upper: f64,
    pub velocity: f64,
    pub acceleration: f64,
    pub jerk: f64,
    pub rest: Option<f64>,
}

pub(super) fn no_acceleration(place: &str) -> RobotError {
    let help =
        "a URDF has none: give --acceleration 20, or acceleration = 20.0 in the map, from the servo's torque and load";
    RobotError::new(place, "found no acceleration, expected rad/s^2", help)
}

/// The joints that follow one, also by way of others, each as `multiplier x + offset` of its angle `x`.
fn followers<'r>(robot: &'r Robot, leader: &RobotJoint) -> Vec<(&'r RobotJoint, Mimic)> {
    let mut found: Vec<(&RobotJoint, Mimic)> = Vec::new();
    let mut open = vec![Mimic { joint: leader.name.clone(), multiplier: 1.0, offset: 0.0 }];
    while let Some(up) = open.pop() {
        for follower in &robot.joints {
            let Some(own) = follower.mimic.as_ref().filter(|own| own.joint == up.joint && own.multiplier != 0.0) else {
                continue;
            };
            // A ring of followers ends where it began.
            if follower.name == leader.name || found.iter().any(|(known, _)| known.name == follower.name) {
                continue;
            }
            let multiplier = own.multiplier * up.multiplier;
            let offset = own.multiplier * up.offset + own.offset;
            found.push((follower, Mimic { joint: leader.name.clone(), multiplier, offset }));
            open.push(Mimic { joint: follower.name.clone(), multiplier, offset });
        }
    }
    found
}

/// Followers of nothing: whose leader is not in the file, or who follow themselves, if by way of others.
pub(super) fn note_leaders(robot: &Robot, notes: &mut Vec<String>) {
    for joint in &robot.joints {
        let Some(mimic) = joint.mimic.as_ref() else { continue };
        let place = format!("{} (line {})", joint.name, joint.line);
        match robot.find(&mimic.joint) {
            None => {
                let near = nearest(&mimic.joint, robot.joints.iter().map(|j| j.name.as_str()));
                let near = near.map_or(String::new(), |near| format!("; did you mean '{near}'?"));
                notes.push(format!(
                    "{place}: follows '{}', which is not in the file{near}: its limits are not kept for it",
                    mimic.joint
                ));
            }
            Some(_) if robot.leader(joint).is_none() => {
                notes.push(format!(
                    "{place}: follows itself, by way of '{}': it is taken to move by itself",
                    mimic.joint
                ));
            }
            Some(_) => {}
        }
    }
}

/// What each robot joint of an entry may do, its followers' limits included.
pub(super) fn rows(
    robot: &Robot,
    joints: &[usize],
    entry: &Entry,
    defaults: Rates,
    notes: &mut Vec<String>,
) -> Result<Vec<Row>, RobotError> {
    let mut rows = Vec::new();
    for (index, at) in joints.iter().enumerate() {
        let joint = &robot.joints[*at];
        let place = format!("joint '{}' (line {})", joint.name, joint.line);
        let own = |list: &Option<Vec<f64>>| list.as_ref().map(|list| list[index]);
        let (mut lower, mut upper) = bounds(joint, own(&entry.lower), own(&entry.upper), &place, notes)?;
        let mut speed = own(&entry.velocity)
            .or(joint.velocity.filter(|speed| *speed > 0.0))
            .or(defaults.velocity)
            .ok_or_else(|| {
                let found = joint.velocity.map_or("no velocity".to_owned(), |speed| format!("velocity=\"{speed}\""));
                let help = format!("write velocity = 6.0 into the map's entry '{}', or give --velocity 6", entry.joint);
                RobotError::new(&place, format!("found {found}, expected rad/s above 0"), help)
            })?;
        notes.extend(joint.notes.iter().cloned());
        for (follower, mimic) in followers(robot, joint) {
            notes.extend(follower.notes.iter().cloned());
            let ends = [follower.lower, follower.upper].map(|end| Some((end? - mimic.offset) / mimic.multiplier));
            let [low, high] = if mimic.multiplier < 0.0 { [ends[1], ends[0]] } else { ends };
            let tighter = (lower.max(low.unwrap_or(lower)), upper.min(high.unwrap_or(upper)));
            let slower =
                follower.velocity.filter(|v| *v > 0.0).map_or(speed, |v| speed.min(v / mimic.multiplier.abs()));
            if tighter.0 > tighter.1 && lower <= upper {
                let (name, low, high) = (&follower.name, low.unwrap_or(lower), high.unwrap_or(upper));
                let what = format!(
                    "found bounds {lower} and {upper}, expected some within the {low} and {high} that its follower '{name}' allows"
                );
                return Err(RobotError::new(place, what, "correct <mimic>, or the follower's <limit>"));
            }
            if tighter != (lower, upper) || slower != speed {
                notes.push(format!("{}: tighter, for '{}' that follows it", joint.name, follower.name));
            }
            ((lower, upper), speed) = (tighter, slower);
        }
        if lower > upper {
            let what = format!("found lower {lower} above upper {upper}, expected the other way round");
            return Err(RobotError::new(place, what, "correct <limit>, or write lower and upper into the map's entry"));
        }
        rows.push(Row {
            lower,
            upper,
            velocity: speed,
            acceleration: own(&entry.acceleration).or(defaults.acceleration).ok_or_else(|| no_acceleration(&place))?,
            jerk: own(&entry.jerk).or(defaults.jerk).unwrap_or(0.0),
            rest: own(&entry.rest),
        });
    }
    Ok(rows)
}

/// A joint's bounds, no more than a turn apart.
fn bounds(
    joint: &RobotJoint,
    lower: Option<f64>,
    upper: Option<f64>,
    place: &str,
    notes: &mut Vec<String>,
) -> Result<(f64, f64), RobotError> {
    if joint.motion == Motion::Continuous && lower.is_none() && upper.is_none() {
        notes.push(format!("{}: continuous, kept within half a turn to either side", joint.name));
        return Ok((-PI, PI));
    }
    let (low, high) = (lower.or(joint.lower), upper.or(joint.upper));
    if low.is_none() && high.is_none() {
        let help = "a revolute joint needs <limit lower=\"...\" upper=\"...\"/>; or write lower and upper, rad, into the map's entry";
        return Err(RobotError::new(place, "found no bounds, expected lower and upper", help));
    }
    // What a <limit> leaves out is 0.
    let (low, high) = (low.unwrap_or(0.0), high.unwrap_or(0.0));
    if low <= -UNLIMITED && high >= UNLIMITED {
        notes.push(format!(
            "{}: bounds of {low:e} and {high:e} are none, kept within half a turn to either side",
            joint.name
        ));
        return Ok((-PI, PI));
    }
    if low <= -UNLIMITED || high >= UNLIMITED {
        // One end is none: half a turn from 0, or a turn from the other end where that is further.
        let low = if low <= -UNLIMITED { if high > -PI { -PI } else { high - TAU } } else { low };
        let high = if high >= UNLIMITED { if low < PI { PI } else { low + TAU } } else { high };
        notes.push(format!("{}: one bound is none, kept to {low:.3} .. {high:.3}", joint.name));
        return Ok((low, high));
    }
    if low.abs().max(high.abs()) > 4.0 * PI {
        let what = format!("found bounds {low} and {high}, expected radians");
        return Err(RobotError::new(place, what, "these look like degrees: a half turn is 3.1416"));
    }
    if high - low <= TAU {
        return Ok((low, high));
    }
    let cut_low = low.max(-PI);
    let cut = (cut_low.min(high - TAU).max(low), (cut_low + TAU).min(high));
    notes.push(format!(
        "{}: {low:.3} .. {high:.3} is more than a turn, kept to {:.3} .. {:.3}",
        joint.name, cut.0, cut.1
    ));
    Ok(cut)
}
