//! The robot as the solver sees it: variables with bounds, arrows on links, and how the arrows move with the variables.

use nalgebra::{Isometry3, Vector3};

use crate::rig::MAX_JOINTS;
use crate::robot::description::LONGEST;
use crate::robot::{Motion, Robot, RobotError, RobotJoint};

/// What a joint's value is: `multiplier` times a variable, plus `offset`.
#[derive(Clone, Copy)]
struct Driven {
    variable: Option<usize>,
    multiplier: f64,
    offset: f64,
}

/// Furthest value of a hinge: two turns, as far as motions in radians go. Of a slider, m.
const FURTHEST: [f64; 2] = [4.0 * std::f64::consts::PI, 100.0];

/// A joint that leads, with the bounds and speeds of those that follow it, seen from it.
#[derive(Clone, Debug)]
pub(super) struct Variable {
    pub joint: usize,
    /// Rad or m.
    pub lower: f64,
    pub upper: f64,
    /// Rad/s or m/s; infinite where it is not given.
    pub velocity: f64,
}

impl Variable {
    /// Whether a value is at the lower bound.
    pub fn at_lower(&self, value: f64) -> bool {
        value <= self.lower + 1e-6
    }

    /// Whether it is at the upper one.
    pub fn at_upper(&self, value: f64) -> bool {
        value >= self.upper - 1e-6
    }
}

/// Something that points.
#[derive(Clone, Copy, Debug)]
pub(super) enum Arrow {
    /// From the origin of one joint's link to that of another (none: the root link), over a length, m, where that counts.
    Between(Option<usize>, Option<usize>, Option<f64>),
    /// Fixed in the link of a joint, in its frame.
    Along(Option<usize>, Vector3<f64>),
}

pub(super) struct Body<'r> {
    pub robot: &'r Robot,
    pub variables: Vec<Variable>,
    driven: Vec<Driven>,
    /// Joints, each after the one that carries it.
    order: Vec<usize>,
    /// What was assumed.
    pub notes: Vec<String>,
}

impl<'r> Body<'r> {
    /// Refuses rings of followers, bounds that leave nothing, and more joints than any robot has.
    pub fn new(robot: &'r Robot, hold: &[(String, f64)]) -> Result<Self, RobotError> {
        small(robot)?;
        let index: std::collections::HashMap<&str, usize> =
            robot.joints.iter().zip(0..).map(|(joint, at)| (joint.name.as_str(), at)).collect();
        let place = |at: usize| {
            let RobotJoint { line, name, .. } = &robot.joints[at];
            // A pack has no lines.
            if *line == 0 { format!("joint '{name}'") } else { format!("line {line}, joint '{name}'") }
        };
        let moves = |at: usize| !matches!(robot.joints[at].motion, Motion::Fixed | Motion::Other(_));
        // The joint that it follows; one that is not there leads nobody.
        let leader = |at: usize| {
            let mimic = robot.joints[at].mimic.as_ref()?;
            Some((mimic, index.get(mimic.joint.as_str()).copied().filter(|leader| *leader != at)?))
        };
        let mut notes = Vec::new();
        let mut variables = Vec::new();
        let mut of_joint = vec![None; robot.joints.len()];
        for (at, joint) in robot.joints.iter().enumerate() {
            if moves(at) && leader(at).is_none() {
                if joint.mimic.is_some() {
                    notes.push(format!(
                        "{}: follows a joint that is not there, and is taken to move by itself",
                        joint.name
                    ));
                }
                of_joint[at] = Some(variables.len());
                let endless = joint.motion == Motion::Continuous;
                let furthest = FURTHEST[usize::from(joint.motion == Motion::Prismatic)];
                variables.push(Variable {
                    joint: at,
                    lower: joint.lower.filter(|_| !endless).map_or(-furthest, |lower| lower.max(-furthest)),
                    upper: joint.upper.filter(|_| !endless).map_or(furthest, |upper| upper.min(furthest)),
                    velocity: joint.velocity.filter(|rate| *rate > 0.0).unwrap_or(f64::INFINITY),
                });
            }
        }
        for (name, value) in hold {
            let at = index.get(name.as_str()).and_then(|at| of_joint[*at]).ok_or_else(|| {
                RobotError::new(
                    format!("[hold] {name}"),
                    "the robot has no joint of this name that leads",
                    "kinesic robot show FILE lists them",
                )
            })?;
            let variable = &mut variables[at];
            if !(variable.lower..=variable.upper).contains(value) {
                let what = format!("found {value}, expected {} to {}", variable.lower, variable.upper);
                return Err(RobotError::new(format!("[hold] {name}"), what, "hold it within its limits"));
            }
            (variable.lower, variable.upper) = (*value, *value);
        }
        let mut driven = Vec::with_capacity(robot.joints.len());
        for at in 0..robot.joints.len() {
            let (mut multiplier, mut offset, mut first) = (1.0, 0.0, at);
            let mut steps = 0;
            while let Some((mimic, next)) = leader(first).filter(|_| moves(first)) {
                steps += 1;
                if steps > LONGEST {
                    let what = format!("it follows '{}', expected a joint that leads in the end", mimic.joint);
                    return Err(RobotError::new(place(at), what, "cut the ring of followers"));
                }
                offset += multiplier * mimic.offset;
                multiplier *= mimic.multiplier;
                first = next;
            }
            let variable = of_joint[first].filter(|_| moves(at));
            driven.push(Driven { variable, multiplier, offset: if moves(at) { offset } else { 0.0 } });
            if let Some(variable) = variable.filter(|_| first != at) {
                narrow(&mut variables[variable], &robot.joints[at], multiplier, offset);
            }
        }
        for variable in &variables {
            if variable.lower > variable.upper {
                let what = format!("found limits of {} and {}", variable.lower, variable.upper);
                return Err(RobotError::new(
                    place(variable.joint),
                    what,
                    "expected lower <= upper, with its followers' limits",
                ));
            }
        }
        Ok(Self { robot, variables, driven, order: robot.depth_first(), notes })
    }

    /// Frames of all links.
    pub fn placed(&self, values: &[f64]) -> Vec<Isometry3<f64>> {
        self.robot.placed_along(&self.order, &|at| self.joint_value(at, values))
    }

    fn place(frames: &[Isometry3<f64>], joint: Option<usize>) -> Vector3<f64> {
        joint.map_or_else(Vector3::zeros, |at| frames[at].translation.vector)
    }

    /// Where an arrow points: length one, or its share of the length that counts.
    pub fn arrow(&self, frames: &[Isometry3<f64>], arrow: Arrow) -> Vector3<f64> {
        match arrow {
            Arrow::Along(joint, local) => joint.map_or(local, |at| frames[at].rotation * local),
            Arrow::Between(from, to, reach) => {
                let way = Self::place(frames, to) - Self::place(frames, from);
                reach.map_or_else(|| way.try_normalize(1e-9).unwrap_or_default(), |reach| way / reach)
            }
        }
    }

    /// The variable that a joint goes with.
    pub fn variable(&self, joint: usize) -> Option<usize> {
        self.driven[joint].variable
    }

    /// Joints that move an arrow, and how: +1 by its outer end, -1 by its inner one, 0 by both.
    pub fn movers(&self, arrow: Arrow) -> Vec<(usize, i8)> {
        let chain = |joint: Option<usize>| joint.map_or(Vec::new(), |at| self.robot.chain(at).collect::<Vec<_>>());
        let (outer, inner) = match arrow {
            Arrow::Along(joint, _) => (chain(joint), Vec::new()),
            Arrow::Between(from, to, _) => (chain(to), chain(from)),
        };
        // A hinge does not move its own place.
        let slides = |at: &usize| self.robot.joints[*at].motion == Motion::Prismatic;
        let ends = match arrow {
            Arrow::Between(from, to, _) => [from, to],
            Arrow::Along(..) => [None; 2],
        };
        let moves = |at: &usize| slides(at) || !ends.contains(&Some(*at));
        let both = outer.iter().filter(|at| inner.contains(at) || moves(at));
        let both = both.map(|at| (*at, if inner.contains(at) { 0 } else { 1 }));
        let own = inner.iter().filter(|at| !outer.contains(at) && moves(at)).map(|at| (*at, -1));
        both.chain(own).filter(|(at, _)| self.driven[*at].variable.is_some()).collect()
    }

    /// Derivatives of an arrow: a vector a variable, summed over the joints that it drives.
    pub fn slopes(
        &self,
        frames: &[Isometry3<f64>],
        arrow: Arrow,
        movers: &[(usize, i8)],
        mut each: impl FnMut(usize, Vector3<f64>),
    ) {
        for &(at, side) in movers {
            let driven = self.driven[at];
            let Some(variable) = driven.variable else { continue };
            let joint = &self.robot.joints[at];
            let axis = frames[at].rotation * joint.axis;
            let slides = joint.motion == Motion::Prismatic;
            let slope = match arrow {
                Arrow::Along(_, _) if slides => continue,
                Arrow::Along(_, _) => axis.cross(&self.arrow(frames, arrow)),
                Arrow::Between(from, to, reach) => {
                    let (start, end) = (Self::place(frames, from), Self::place(frames, to));
                    let hinge = frames[at].translation.vector;
                    let moved = match (slides, side) {
                        (true, 0) => continue,
                        (true, side) => axis * f64::from(side),
                        (false, 0) => axis.cross(&(end - start)),
                        (false, 1) => axis.cross(&(end - hinge)),
                        (false, _) => -axis.cross(&(start - hinge)),
                    };
                    let way = end - start;
                    let length = way.norm().max(1e-9);
                    match reach {
                        Some(reach) => moved / reach,
                        None => (moved - way * (way.dot(&moved) / (length * length))) / length,
                    }
                }
            };
            each(variable, slope * driven.multiplier);
        }
    }

    /// Value of a joint that leads or follows, rad or m; 0 of others.
    pub fn joint_value(&self, joint: usize, values: &[f64]) -> f64 {
        let driven = self.driven[joint];
        driven.variable.map_or(0.0, |variable| driven.multiplier * values[variable]) + driven.offset
    }
}

/// Joints at most, fixed ones too, and joints at most that lead: the work grows with their squares and cubes.
const MOST: [usize; 2] = [2000, MAX_JOINTS];

/// Refuses what has more joints than any robot.
pub(super) fn small(robot: &Robot) -> Result<(), RobotError> {
    let leads =
        |joint: &&RobotJoint| !matches!(joint.motion, Motion::Fixed | Motion::Other(_)) && joint.mimic.is_none();
    let found = [robot.joints.len(), robot.joints.iter().filter(leads).count()];
    for ((found, most), what) in found.into_iter().zip(MOST).zip(["joints", "joints that lead"]) {
        if found > most {
            let what = format!("found {found} {what}, at most {most} are supported");
            return Err(RobotError::new("the robot", what, "take fingers and sensors out of the description"));
        }
    }
    Ok(())
}

/// Takes a follower's bounds and speed into its leader's.
fn narrow(leader: &mut Variable, follower: &RobotJoint, multiplier: f64, offset: f64) {
    if multiplier == 0.0 || follower.motion == Motion::Continuous {
        return;
    }
    let seen = |bound: f64| (bound - offset) / multiplier;
    let (lower, upper) = (follower.lower.unwrap_or(f64::NEG_INFINITY), follower.upper.unwrap_or(f64::INFINITY));
    let (mut low, mut high) = (seen(lower), seen(upper));
    if multiplier < 0.0 {
        (low, high) = (high, low);
    }
    // A division rounds: a step or two inwards, so that the follower is within its own bounds to the last bit.
    let within = |x: f64| (lower..=upper).contains(&(multiplier * x + offset));
    for _ in 0..4 {
        if low.is_finite() && !within(low) {
            low = low.next_up();
        }
        if high.is_finite() && !within(high) {
            high = high.next_down();
        }
    }
    leader.lower = leader.lower.max(low);
    leader.upper = leader.upper.min(high);
    if let Some(rate) = follower.velocity.filter(|rate| *rate > 0.0) {
        leader.velocity = leader.velocity.min(rate / multiplier.abs());
    }
}
