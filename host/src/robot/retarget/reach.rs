//! Where a robot's limbs point, as functions of its joints.

use std::collections::{HashMap, HashSet};

use nalgebra::{Isometry3, Vector3};

use super::map::{End, Limb, LimbEntry, direction};
use crate::robot::{Motion, Robot, RobotError, RobotJoint};

/// Joints of limbs at most: the work grows with the third power.
const COLUMNS: usize = 200;
/// Followers of followers at most.
const LONGEST: usize = 32;
/// Speed of a joint for which the description has none, rad/s: two turns a second.
const SPEED: f64 = 2.0 * std::f64::consts::TAU;
/// Weight of a foot: a shin of people twists, one of robots does not, and thigh and shin shall not pay for it.
const FOOT: f64 = 0.05;
/// Joints that one note names at most.
const NAMED: usize = 4;
/// Points nearer than this show no direction, m.
const SHORTEST: f64 = 1e-4;

/// What a joint's value is: `gain q + offset` of a column's q, or fixed at `offset`.
#[derive(Clone, Copy)]
struct Drive {
    column: Option<usize>,
    gain: f64,
    offset: f64,
}

/// One limb on the robot.
struct Line {
    begin: Option<usize>,
    end: Option<usize>,
    /// Of an axis of the frame where it begins.
    axis: Option<Vector3<f64>>,
    /// Of its error, against those of others.
    weight: f64,
    /// Joints that turn it: whether they carry its begin and its end.
    movers: Vec<(usize, bool, bool)>,
}

/// The robot's limbs, and the joints that turn them.
pub(super) struct Reach<'a> {
    robot: &'a Robot,
    lines: Vec<Line>,
    drives: Vec<Drive>,
    /// The joint of each column.
    pub columns: Vec<usize>,
    /// Bounds of each column, rad; infinite where there are none.
    pub bounds: Vec<[f64; 2]>,
    /// Largest speed of each column, rad/s.
    pub speeds: Vec<f64>,
    /// Value of every joint of the robot that no column drives: 0, or the bound nearest to it.
    pub rest: Vec<f64>,
}

impl<'a> Reach<'a> {
    pub fn new(robot: &'a Robot, entries: &[&LimbEntry], notes: &mut Vec<String>) -> Result<Self, RobotError> {
        let index: HashMap<&str, usize> = robot.joints.iter().zip(0..).map(|(j, at)| (j.name.as_str(), at)).collect();
        let point = |name: &str| super::point(robot, name).flatten();
        let mut lines: Vec<Line> = Vec::new();
        for entry in entries {
            let begin = point(&entry.begin);
            let (end, axis) = match &entry.end {
                End::At(name) => (point(name), None),
                End::Axis(axis, sign) => (begin, Some(direction(*axis, *sign))),
            };
            let chain = |at: Option<usize>| at.map_or(Vec::new(), |at| robot.chain(at).collect::<Vec<_>>());
            let (inner, outer) = (chain(begin), chain(end));
            let sets = [&inner, &outer].map(|chain| chain.iter().copied().collect::<HashSet<usize>>());
            let mut movers: Vec<(usize, bool, bool)> =
                outer.iter().map(|at| (*at, sets[0].contains(at), true)).collect();
            movers.extend(inner.iter().filter(|at| !sets[1].contains(at)).map(|at| (*at, true, false)));
            let weight = if matches!(entry.limb, Limb::LFoot | Limb::RFoot) { FOOT } else { 1.0 };
            lines.push(Line { begin, end, axis, weight, movers });
        }
        let rest: Vec<f64> = robot.joints.iter().map(|joint| within(0.0, own_bounds(joint))).collect();
        let mut reach = Self {
            robot,
            lines,
            drives: Vec::new(),
            columns: Vec::new(),
            bounds: Vec::new(),
            speeds: Vec::new(),
            rest,
        };
        reach.drive(&index, notes)?;
        reach.check(entries)?;
        Ok(reach)
    }

    /// Which joints are columns, and which follow them.
    fn drive(&mut self, index: &HashMap<&str, usize>, notes: &mut Vec<String>) -> Result<(), RobotError> {
        let joints = &self.robot.joints;
        // The leader of every joint that leads or follows one.
        let led: Vec<Option<(usize, f64, f64)>> = (0..joints.len())
            .map(|at| {
                let (mut at, mut gain, mut offset) = (at, 1.0, 0.0);
                for _ in 0..LONGEST {
                    let Some(mimic) = &joints[at].mimic else { return Some((at, gain, offset)) };
                    (gain, offset) = (gain * mimic.multiplier, offset + gain * mimic.offset);
                    at = *index.get(mimic.joint.as_str())?;
                }
                None
            })
            .collect();
        let hinge = |at: usize| matches!(joints[at].motion, Motion::Revolute | Motion::Continuous);
        let mut used = vec![false; joints.len()];
        for (at, _, _) in self.lines.iter().flat_map(|line| &line.movers) {
            if let Some((leader, ..)) = led[*at].filter(|_| hinge(*at)) {
                used[leader] |= hinge(leader);
            }
        }
        let mut columns = vec![None; joints.len()];
        let mut unsaid = Vec::new();
        for at in (0..joints.len()).filter(|at| used[*at]) {
            columns[at] = Some(self.columns.len());
            self.columns.push(at);
            self.bounds.push(own_bounds(&joints[at]));
            let speed = joints[at].velocity.filter(|speed| *speed > 0.0);
            if speed.is_none() {
                unsaid.push(joints[at].name.as_str());
            }
            self.speeds.push(speed.unwrap_or(SPEED));
        }
        if self.columns.len() > COLUMNS {
            let what = format!("its limbs have {} joints, expected at most {COLUMNS}", self.columns.len());
            return Err(RobotError::new("[limbs]", what, "name fewer limbs"));
        }
        if !unsaid.is_empty() {
            let more =
                if unsaid.len() > NAMED { format!(" and {} others", unsaid.len() - NAMED) } else { String::new() };
            let names = unsaid[..unsaid.len().min(NAMED)].join(", ");
            notes.push(format!("the description has no speed for {names}{more}: at most {SPEED:.1} rad/s is assumed"));
        }
        let drive = |(at, led): (usize, &Option<(usize, f64, f64)>)| match led {
            Some((leader, gain, offset)) => match columns[*leader] {
                Some(column) => Drive { column: Some(column), gain: *gain, offset: *offset },
                None => Drive { column: None, gain: 0.0, offset: gain * self.rest[*leader] + offset },
            },
            None => Drive { column: None, gain: 0.0, offset: self.rest[at] },
        };
        self.drives = led.iter().enumerate().map(drive).collect();
        // What a follower cannot do, its leader does not do either.
        for (at, drive) in self.drives.iter().enumerate().filter(|(at, _)| joints[*at].mimic.is_some()) {
            let (Some(column), true) = (drive.column, drive.gain != 0.0) else { continue };
            let ends = own_bounds(&joints[at]).map(|bound| (bound - drive.offset) / drive.gain);
            let bounds = &mut self.bounds[column];
            let tighter = [bounds[0].max(ends[0].min(ends[1])), bounds[1].min(ends[0].max(ends[1]))];
            match tighter[0] <= tighter[1] {
                true => *bounds = tighter,
                false => notes.push(format!(
                    "{}: its bounds and those of the joint that it follows exclude each other",
                    joints[at].name
                )),
            }
        }
        Ok(())
    }

    /// Refuses a limb without length.
    fn check(&self, entries: &[&LimbEntry]) -> Result<(), RobotError> {
        let directions = self.directions(&self.start());
        match directions.iter().position(Option::is_none) {
            None => Ok(()),
            Some(at) => {
                let place = format!("[limbs] {}", entries[at].limb.name());
                let what = "it begins and ends at one point, expected a direction";
                Err(RobotError::new(
                    place,
                    what,
                    "name a link farther out, or an axis of the link, as in [\"head\", \"x\"]",
                ))
            }
        }
    }

    /// Weight of a limb's squared error.
    pub fn weight(&self, line: usize) -> f64 {
        self.lines[line].weight
    }

    /// Joints that turn a limb.
    pub fn joints_of(&self, line: usize) -> usize {
        let turns = |at: usize| self.drives[at].column.is_some() && self.drives[at].gain != 0.0;
        self.lines[line].movers.iter().filter(|(at, inner, outer)| turns(*at) && (*inner || *outer)).count()
    }

    /// Values of the columns at the robot's zero, or nearest to it.
    pub fn start(&self) -> Vec<f64> {
        self.bounds.iter().map(|bounds| within(0.0, *bounds)).collect()
    }

    fn frames(&self, columns: &[f64]) -> Vec<Isometry3<f64>> {
        self.robot.placed(&|at| {
            let drive = self.drives[at];
            drive.column.map_or(0.0, |column| drive.gain * columns[column]) + drive.offset
        })
    }

    fn direction(&self, line: &Line, frames: &[Isometry3<f64>]) -> Option<(Vector3<f64>, f64)> {
        if let Some(axis) = line.axis {
            return Some((line.begin.map_or(axis, |at| frames[at].rotation * axis), 1.0));
        }
        let place = |at: Option<usize>| at.map_or_else(Vector3::zeros, |at| frames[at].translation.vector);
        let way = place(line.end) - place(line.begin);
        let length = way.norm();
        (length > SHORTEST).then(|| (way / length, length))
    }

    /// Direction of every limb in the root link's frame; none where it has no length.
    pub fn directions(&self, columns: &[f64]) -> Vec<Option<Vector3<f64>>> {
        let frames = self.frames(columns);
        self.lines.iter().map(|line| self.direction(line, &frames).map(|(way, _)| way)).collect()
    }

    /// The same, with the derivatives by the columns: row-major `[limbs x columns]`.
    pub fn derivatives(&self, columns: &[f64]) -> (Vec<Option<Vector3<f64>>>, Vec<Vector3<f64>>) {
        let frames = self.frames(columns);
        let width = self.columns.len();
        let mut slopes = vec![Vector3::zeros(); self.lines.len() * width];
        let mut ways = Vec::with_capacity(self.lines.len());
        for (row, line) in self.lines.iter().enumerate() {
            let found = self.direction(line, &frames);
            ways.push(found.map(|(way, _)| way));
            let Some((way, length)) = found else { continue };
            for &(joint, inner, outer) in &line.movers {
                let Drive { column: Some(column), gain, .. } = self.drives[joint] else { continue };
                let frame = &frames[joint];
                let axis = frame.rotation * self.robot.joints[joint].axis;
                let arm = |at: Option<usize>| {
                    at.map_or_else(Vector3::zeros, |at| frames[at].translation.vector) - frame.translation.vector
                };
                let slides = self.robot.joints[joint].motion == Motion::Prismatic;
                let moved = |at: Option<usize>| if slides { axis } else { axis.cross(&arm(at)) };
                let slope = if line.axis.is_some() {
                    if slides { Vector3::zeros() } else { axis.cross(&way) }
                } else {
                    let end = if outer { moved(line.end) } else { Vector3::zeros() };
                    let slope = if inner { end - moved(line.begin) } else { end };
                    (slope - way * way.dot(&slope)) / length
                };
                slopes[row * width + column] += slope * gain;
            }
        }
        (ways, slopes)
    }
}

/// A joint's own bounds; infinite where it has none, or where they exclude each other.
fn own_bounds(joint: &RobotJoint) -> [f64; 2] {
    let bounds = [joint.lower.unwrap_or(f64::NEG_INFINITY), joint.upper.unwrap_or(f64::INFINITY)];
    if joint.motion == Motion::Continuous || bounds[0] > bounds[1] {
        [f64::NEG_INFINITY, f64::INFINITY]
    } else {
        bounds
    }
}

fn within(value: f64, [lower, upper]: [f64; 2]) -> f64 {
    value.max(lower).min(upper)
}
