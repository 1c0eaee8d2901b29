//! A person's motion on a robot: every limb of the robot points where the person's does, as far as its joints let it.
//!
//! Directions are those in the frame of the pelvis' heading (forward, left, up), laid on the root link's; the root itself stays upright
//! and turns with the heading, or stands still. Inverse kinematics is of the whole robot at once, so axes may lie as they like.
//!
//! 1. One frame from several starts, and outwards from there, frame by frame; the best whole path stays. So from the first frame, and from
//!    those where the path is worst.
//! 2. Once back and once forth, every frame between its neighbours: no flip where a direction says nothing.
//! 3. Where a joint would be too quick, the same within reach of the neighbours. Limits of position hold throughout.
//!
//! | file | holds |
//! |---|---|
//! | `limb` | limbs of a person, and where they point |
//! | `map` | [`RetargetMap`]: which parts of the robot are which limbs |
//! | `suggest` | [`suggest`]: a map from names and geometry |
//! | `body` | variables, bounds, followers; arrows and how they move |
//! | `path` | poses of all frames: from several frames outwards, then between neighbours, within speed limits |
//! | `solve` | damped least squares within a box |
//! | `speed` | one joint's path within its speed limit |
//! | `report` | [`Report`]: errors of limbs, shares of limits |
//! | `cannot` | why a limb is off |
//! | `table` | the values as [`Moves`](crate::moves::Moves) |

mod body;
mod cannot;
mod limb;
mod map;
mod path;
mod report;
mod solve;
mod speed;
mod suggest;
mod table;

use nalgebra::{Isometry3, Matrix3, Vector3};

use super::{Motion, Robot, RobotError};
use crate::clip::{Clip, JointMap};
use body::{Arrow, Body};
pub use limb::Limb;
use limb::Person;
pub use map::{LimbEntry, RetargetMap};
use path::Course;
pub use report::{AtLimit, LimbReport, Quickest, Report};
use solve::{Solver, Term};
pub use suggest::suggest;

/// Steps of values in a rad or m: tables have few digits.
const STEPS: f64 = 1e9;

/// Points nearer than this to each other show no direction, m.
const SHORTEST: f64 = 0.01;

/// A robot's motion.
#[derive(Clone, Debug)]
pub struct Retargeted {
    /// Joints with a value of their own, in the description's order: index into [`Robot::joints`].
    pub joints: Vec<usize>,
    /// Value of each in every frame, rad or m, row-major `[frames x joints]`.
    pub values: Vec<f64>,
    /// Seconds between frames.
    pub frame_time: f64,
    /// How near the robot comes to the person.
    pub report: Report,
}

/// One arrow of a limb: the term of the solver, and which of the limb's arrows it is.
struct Aim {
    limb: Limb,
    name: String,
    second: bool,
}

/// Puts a person's motion on a robot. Linear in frames; values never leave the limits, followers' neither.
///
/// `joints` says which joint of the clip is which.
pub fn retarget(robot: &Robot, map: &RetargetMap, clip: &Clip, joints: &JointMap) -> Result<Retargeted, RobotError> {
    let body = Body::new(robot, &map.hold)?;
    let (aims, terms) = aims(&body, map)?;
    let solver = Solver::new(&body, terms);
    // Person's heading frame to the root link's.
    let onto = Matrix3::from_columns(&[map.forward, map.up.cross(&map.forward), map.up]);
    let mut person = Person::new(clip, joints);
    let targets: Vec<Vec<Option<Vector3<f64>>>> = (0..clip.frames())
        .map(|frame| {
            person.look(frame);
            let arrow = |aim: &Aim| person.arrows(aim.limb)[usize::from(aim.second)].map(|arrow| onto * arrow);
            aims.iter().map(arrow).collect()
        })
        .collect();
    if targets.iter().flatten().all(Option::is_none) {
        let what = "found none of the map's limbs in the clip, expected one at least";
        return Err(RobotError::new(
            "[limbs]",
            what,
            "kinesic inspect CLIP says which joints are known; --skeleton-map names them",
        ));
    }
    let zero: Vec<f64> = body.variables.iter().map(|variable| 0f64.clamp(variable.lower, variable.upper)).collect();
    let course = Course { solver: &solver, targets: &targets, zero: &zero, frame_time: clip.frame_time };
    let reachable = course.free();
    let most: Vec<f64> = body
        .variables
        .iter()
        .map(|variable| speed::a_frame(variable.velocity * clip.frame_time, 2.0 / STEPS))
        .collect();
    let quick = |at: &usize| reachable.windows(2).any(|pair| (pair[1][*at] - pair[0][*at]).abs() > most[*at]);
    let hurried: Vec<usize> = (0..most.len()).filter(quick).collect();
    let mut path = if hurried.is_empty() { reachable.clone() } else { course.limited(&reachable, &most) };
    for values in &mut path {
        for (value, variable) in values.iter_mut().zip(&body.variables) {
            *value = ((*value * STEPS).round() / STEPS).clamp(variable.lower, variable.upper);
        }
    }
    let paths = report::Paths { zero: &zero, reachable: &reachable, played: &path };
    let mut report = report::make(&solver, &aims, &targets, &paths, &hurried, clip.frame_time);
    report.notes.extend(person.note());
    Ok(Retargeted {
        joints: body.variables.iter().map(|variable| variable.joint).collect(),
        values: path.concat(),
        frame_time: clip.frame_time,
        report,
    })
}

/// The arrows that the map asks for.
fn aims(body: &Body, map: &RetargetMap) -> Result<(Vec<Aim>, Vec<Term>), RobotError> {
    let robot = body.robot;
    let zero = vec![0.0; body.variables.len()];
    let frames = body.placed(&zero);
    let (root, mut aims, mut terms) = (robot.root(), Vec::new(), Vec::new());
    for entry in &map.limbs {
        let place = format!("[limbs] {}", entry.limb.name());
        let find = |name: &str| -> Result<Option<usize>, RobotError> {
            let joint = robot.find(name).or_else(|| robot.joints.iter().position(|joint| joint.child == name));
            if joint.is_some() || Some(name) == root.as_deref() {
                return Ok(joint);
            }
            let names = robot.joints.iter().flat_map(|joint| [joint.name.as_str(), joint.child.as_str()]);
            let near = crate::clip::map::nearest(name, names)
                .map_or(String::new(), |near| format!("; did you mean '{near}'?"));
            let what = format!("the robot has no joint and no link '{name}'{near}");
            Err(RobotError::new(&place, what, "kinesic robot show FILE lists them"))
        };
        let from = find(&entry.from)?;
        let to = entry.to.as_deref().map(find).transpose()?;
        let fixed = |way: Vector3<f64>| Arrow::Along(from, from.map_or(way, |at| frames[at].rotation.inverse() * way));
        let mut add = |arrow: Arrow, second: bool, weight: f64| {
            let name = entry.limb.name().to_owned();
            let name = match (entry.limb, second) {
                (Limb::Torso, true) => "torso_facing".to_owned(),
                (Limb::Head, true) => "head_top".to_owned(),
                _ => name,
            };
            aims.push(Aim { limb: entry.limb, name, second });
            terms.push(Term { arrow, movers: body.movers(arrow), weight });
        };
        let way = |arrow: Arrow| body.arrow(&frames, arrow).norm();
        match (to, entry.bone) {
            (None, None) if entry.limb.faces() => match entry.limb {
                Limb::Torso => {
                    add(fixed(map.up), false, entry.weight);
                    add(fixed(map.forward), true, entry.weight);
                }
                Limb::Head => {
                    add(fixed(map.forward), false, entry.weight);
                    add(fixed(map.up), true, 0.5 * entry.weight);
                }
                _ => add(fixed(map.forward), false, entry.weight),
            },
            (Some(to), None) => {
                let reach = entry.limb.reaches().then(|| entry.length.unwrap_or_else(|| length(robot, from, to)));
                let far = way(Arrow::Between(from, to, Some(1.0)));
                if from == to || (far < SHORTEST && reach.is_none_or(|reach| reach < SHORTEST)) {
                    let what = format!(
                        "'{}' and '{}' are {far:.4} m apart, expected {SHORTEST} m or more",
                        entry.from,
                        entry.to.as_deref().unwrap_or_default()
                    );
                    return Err(RobotError::new(&place, what, "name a joint further out, or give bone = [x, y, z]"));
                }
                match reach.is_none().then(|| in_plane(robot, &frames, from, to)).flatten() {
                    Some(way) => add(fixed(way), false, entry.weight),
                    None => add(Arrow::Between(from, to, reach), false, entry.weight),
                }
            }
            (None, Some(bone)) => add(fixed(bone), false, entry.weight),
            (None, None) => {
                let centre = from.and_then(|at| robot.joints[at].centre).filter(|centre| centre.norm() > SHORTEST);
                let Some((centre, at)) = centre.zip(from) else {
                    let what = format!("'{}' alone shows no direction, expected two names", entry.from);
                    return Err(RobotError::new(
                        &place,
                        what,
                        "name where it ends, or give { from = ..., bone = [x, y, z] }",
                    ));
                };
                add(Arrow::Along(Some(at), centre.normalize()), false, entry.weight);
            }
            (Some(_), Some(_)) => {
                return Err(RobotError::new(&place, "found `to` and `bone`", "expected one of the two"));
            }
        }
    }
    Ok((aims, terms))
}

/// Direction of a bone between two parallel hinges, in the root link's axes: square to them. Where along its axis a description puts a
/// hinge says nothing of the bone. `None` for other bones.
fn in_plane(robot: &Robot, frames: &[Isometry3<f64>], from: Option<usize>, to: Option<usize>) -> Option<Vector3<f64>> {
    let (from, to) = (from?, to?);
    let hinge = |at: usize| matches!(robot.joints[at].motion, Motion::Revolute | Motion::Continuous);
    let mut between = robot.chain(to).skip(1).take_while(|at| *at != from);
    if !hinge(from)
        || !hinge(to)
        || !robot.chain(to).any(|at| at == from)
        || between.any(|at| robot.joints[at].motion != Motion::Fixed)
    {
        return None;
    }
    let axis = |at: usize| frames[at].rotation * robot.joints[at].axis;
    let way = frames[to].translation.vector - frames[from].translation.vector;
    let square = way - axis(to) * way.dot(&axis(to));
    (axis(from).dot(&axis(to)).abs() > 0.999).then(|| square.try_normalize(SHORTEST)).flatten()
}

/// Length of the stretched chain from one joint out to another, m.
fn length(robot: &Robot, from: Option<usize>, to: Option<usize>) -> f64 {
    let chain = to.map_or(Vec::new(), |to| robot.chain(to).take_while(|at| Some(*at) != from).collect());
    let link = |at: usize| {
        let joint = &robot.joints[at];
        let slide = if joint.motion == Motion::Prismatic { joint.upper.unwrap_or(0.0).max(0.0) } else { 0.0 };
        joint.origin.translation.vector.norm() + slide
    };
    chain.into_iter().map(link).sum::<f64>().max(1e-3)
}
