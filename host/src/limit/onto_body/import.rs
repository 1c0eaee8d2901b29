//! A robot and its map as limits of a skeleton's joints.

use kinesic::model::LoadError;
use kinesic::rig::JointKind;
use nalgebra::{UnitQuaternion, Vector3};

use super::rows::{Row, no_acceleration, note_leaders, rows};
use super::zero_pose::{rig_joint, world, zero};
use super::{Entry, MapKind, RobotMap};
use crate::clip::Canonical;
use crate::clip::map::nearest;
use crate::limit::{HeightLimit, JointLimit, LimitsModel};
use crate::rig::{JointCoordinates, Rig};
use crate::robot::{Motion, Robot, RobotError};

/// Axes of a chain may be this far from a right angle (cosine; half a degree): a `rpy` of 1.57 is meant to be a quarter turn.
const SQUARE: f64 = 1e-2;

/// Rates that stand in where the map has none of its own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rates {
    /// rad/s.
    pub velocity: Option<f64>,
    /// rad/s^2.
    pub acceleration: Option<f64>,
    /// rad/s^3; none or 0 for no limit.
    pub jerk: Option<f64>,
}

/// Limits, and how they came about.
#[derive(Clone, Debug, PartialEq)]
pub struct Import {
    /// The limits of every joint of the rig.
    pub model: LimitsModel,
    /// Names of the robot's joints, one list per joint of the rig, in the order of its coordinates.
    pub urdf: Vec<Vec<String>>,
    /// What was assumed or changed, one sentence each.
    pub notes: Vec<String>,
}

/// Limits of a rig's joints at `frame_rate` steps a second. `rates` go before the map's own defaults.
pub fn import(
    robot: &Robot,
    map: &RobotMap,
    rig: &Rig,
    name: &str,
    frame_rate: f64,
    rates: Rates,
) -> Result<Import, RobotError> {
    let entries = entries(map, rig)?;
    let mut joints = robot_joints(robot, rig, &entries)?;
    let frames = robot.frames();
    let turned = zero(robot, &frames, map, rig, &joints);
    let to_world = world(map, rig);
    let mut notes = Vec::new();
    note_leaders(robot, &mut notes);
    let acceleration = rates.acceleration.or(map.acceleration);
    let velocity = rates.velocity.or(map.velocity);
    let jerk = rates.jerk.or(map.jerk).unwrap_or(0.0);
    let defaults = Rates { velocity, acceleration, jerk: Some(jerk) };
    let mut limits = Vec::new();
    for (joint, entry) in entries.iter().enumerate() {
        let bone = &rig.skeleton.joints[joint];
        let parent = bone.parent.map_or_else(UnitQuaternion::identity, |parent| turned[parent]);
        let reference = (parent.inverse() * turned[joint]).coords.map(|x| x as f32).into();
        let limit = match entry {
            Some(entry) if entry.kind != Some(MapKind::Free) => {
                let axis =
                    |at: &usize| turned[joint].inverse() * (to_world * (frames[*at].rotation * robot.joints[*at].axis));
                let axes: Vec<Vector3<f64>> = joints[joint].iter().map(axis).collect();
                let rows = rows(robot, &joints[joint], entry, defaults, &mut notes)?;
                let mut limit = limit(entry, &axes, &rows, robot, &mut joints[joint], &mut notes)?;
                limit.coordinates.reference = reference;
                Some(limit)
            }
            _ => None,
        };
        limits.push((limit, reference));
    }
    // A free joint without rates of its own is as fast as the fastest servo.
    let fastest = limits.iter().filter_map(|(limit, _)| Some(limit.as_ref()?.velocity[0])).fold(0.0, f32::max);
    let rate = velocity.map_or(fastest, |x| x as f32);
    let change = |own: Option<&Vec<f64>>| {
        own.map(|own| own[0])
            .or(acceleration)
            .map(|x| x as f32)
            .ok_or_else(|| no_acceleration("joints without an entry"))
    };
    let joints_of = |joint: usize| joints[joint].iter().map(|at| robot.joints[*at].name.clone()).collect::<Vec<_>>();
    let own = rig.joint_coordinates();
    let mut all = Vec::new();
    for (joint, (limit, reference)) in limits.into_iter().enumerate() {
        let entry = entries[joint];
        all.push(match limit {
            Some(limit) => limit,
            None if map.others_fixed && entry.is_none() && joint > 0 => {
                let coordinates = JointCoordinates { reference, ..JointCoordinates::new(JointKind::Fixed) };
                JointLimit { coordinates, ..JointLimit::fixed() }
            }
            None => {
                let speed = entry.and_then(|entry| entry.velocity.as_ref());
                let free = JointLimit::free(
                    speed.map_or(rate, |speed| speed[0] as f32),
                    change(entry.and_then(|e| e.acceleration.as_ref()))?,
                );
                // About the skeleton's own middle, unless the map says where the bone is at rest.
                let own =
                    if entry.is_some_and(|entry| entry.bone.is_some()) { reference } else { own[joint].reference };
                let smooth = entry.and_then(|entry| entry.jerk.as_ref()).map_or(jerk, |own| own[0]);
                JointLimit { coordinates: JointCoordinates { reference: own, ..free.coordinates }, ..free }
                    .with_jerk(smooth as f32)
            }
        });
    }
    let mut height = LimitsModel::standing(rig, &map.meta);
    if let Some([lower, upper]) = map.height.map(|range| range.map(|x| x as f32)) {
        height = HeightLimit { lower, upper, rest: height.rest.max(lower).min(upper), ..height };
    }
    let model = LimitsModel { name: name.to_owned(), frame_rate, meta: map.meta, height, joints: all };
    model.tables(rig).map_err(|error| refused(&error, &model, rig))?;
    Ok(Import { model, urdf: (0..entries.len()).map(joints_of).collect(), notes })
}

/// The map's entry of each joint of the rig.
fn entries<'m>(map: &'m RobotMap, rig: &Rig) -> Result<Vec<Option<&'m Entry>>, RobotError> {
    let mut found: Vec<Option<&Entry>> = vec![None; rig.joints()];
    for entry in &map.entries {
        let place = format!("[joints] {}", entry.joint);
        let names: Vec<&str> = rig.skeleton.joints.iter().map(|joint| joint.name.as_str()).collect();
        let joint = rig_joint(rig, &entry.joint).ok_or_else(|| {
            let canonical = Canonical::ALL.map(Canonical::name);
            let near = nearest(&entry.joint, names.iter().copied().chain(canonical));
            let near = near.map_or(String::new(), |near| format!("; did you mean '{near}'?"));
            let help = format!(
                "its joints are: {}; or canonical names that it has: {}",
                names.join(", "),
                canonical.join(", ")
            );
            RobotError::new(&place, format!("the skeleton has no joint of this name{near}"), help)
        })?;
        if let Some(other) = found[joint] {
            let what = format!("the skeleton's joint '{}' has the entry '{}' already", names[joint], other.joint);
            return Err(RobotError::new(place, what, "keep one of the two"));
        }
        let free = entry.kind == Some(MapKind::Free);
        if entry.urdf.is_empty() && !free {
            let help = "leave the entry out, or write  { kind = \"free\" }";
            return Err(RobotError::new(place, "found no robot joint, expected one to three", help));
        }
        if joint == 0 && !free && rig.frames().travels() {
            let what = "found robot joints for the root, expected none: it turns freely against the heading";
            return Err(RobotError::new(
                place,
                what,
                "give them to the skeleton's next joint, as in  spine = \"waist\"",
            ));
        }
        found[joint] = Some(entry);
    }
    Ok(found)
}

/// Indices of the robot's joints of each joint of the rig, checked: each a hinge of its own, used once, from the trunk outwards.
fn robot_joints(robot: &Robot, rig: &Rig, entries: &[Option<&Entry>]) -> Result<Vec<Vec<usize>>, RobotError> {
    let mut all: Vec<Vec<usize>> = Vec::new();
    let mut used: Vec<Option<&str>> = vec![None; robot.joints.len()];
    for (joint, entry) in entries.iter().enumerate() {
        let mut chosen = Vec::new();
        for name in entry.iter().flat_map(|entry| &entry.urdf) {
            let place = format!("[joints] {}", entry.map_or("", |entry| &entry.joint));
            let refuse = |what: String, help: String| Err(RobotError::new(&place, what, help));
            let names = || robot.joints.iter().map(|joint| joint.name.as_str());
            let Some(at) = robot.find(name) else {
                let near = nearest(name, names()).map_or(String::new(), |near| format!("; did you mean '{near}'?"));
                let moving = robot.joints.iter().filter(|j| matches!(j.motion, Motion::Revolute | Motion::Continuous));
                let moving: Vec<&str> = moving.map(|joint| joint.name.as_str()).collect();
                return refuse(
                    format!("the robot has no joint '{name}'{near}"),
                    format!("its hinges are: {}", moving.join(", ")),
                );
            };
            let found = &robot.joints[at];
            if let Motion::Fixed | Motion::Prismatic | Motion::Other(_) = found.motion {
                let kind = &found.kind;
                let what =
                    format!("'{name}' (line {}) is of the type '{kind}', expected revolute or continuous", found.line);
                return refuse(what, "leave it out of the map: only hinges have angles".to_owned());
            }
            if let Some(mimic) = robot.leader(found) {
                let what =
                    format!("'{name}' (line {}) follows '{}' and has no angle of its own", found.line, mimic.joint);
                return refuse(
                    what,
                    format!("map '{}' instead; its limits are kept for its followers too", mimic.joint),
                );
            }
            if let Some(other) = used[at].replace(entry.map_or("", |entry| &entry.joint)) {
                return refuse(
                    format!("'{name}' belongs to '{other}' already"),
                    "name every robot joint once".to_owned(),
                );
            }
            // The joints that must carry this one: those named before it, and those of the skeleton joints further in.
            let before = std::iter::successors(rig.skeleton.joints[joint].parent, |at| rig.skeleton.joints[*at].parent);
            let inner = chosen.last().copied().or_else(|| before.flat_map(|at| all[at].iter().rev()).copied().next());
            if let Some(inner) = inner.filter(|inner| !robot.chain(at).skip(1).any(|at| at == *inner)) {
                let what = format!("'{name}' is not carried by '{}', which comes before it", robot.joints[inner].name);
                return refuse(
                    what,
                    "list robot joints from the trunk outwards, each on the limb of its skeleton joint".to_owned(),
                );
            }
            chosen.push(at);
        }
        all.push(chosen);
    }
    Ok(all)
}

/// The limit of a skeleton joint that one to three robot joints turn. Puts `joints` into the order of its coordinates.
fn limit(
    entry: &Entry,
    axes: &[Vector3<f64>],
    rows: &[Row],
    robot: &Robot,
    joints: &mut [usize],
    notes: &mut Vec<String>,
) -> Result<JointLimit, RobotError> {
    let place = format!("[joints] {}", entry.joint);
    let kind = entry.kind.unwrap_or(if axes.len() == 1 { MapKind::Hinge } else { MapKind::Chain });
    let (fits, expected) = match kind {
        MapKind::Hinge => (axes.len() == 1, "one"),
        MapKind::Ball => (axes.len() == 3, "three"),
        _ => ((2..=3).contains(&axes.len()), "two or three"),
    };
    if !fits {
        let what = format!("found {} robot joints for the kind {}, expected {expected}", axes.len(), kind.name());
        let help =
            "one is a hinge, two or three at right angles are a chain; give further ones to a neighbouring joint";
        return Err(RobotError::new(place, what, help));
    }
    let mut square: Vec<Vector3<f64>> = Vec::new();
    for (index, axis) in axes.iter().enumerate() {
        let mut straight = *axis;
        for (before, other) in square.iter().enumerate() {
            let cosine = axis.dot(other);
            if cosine.abs() > SQUARE {
                let name = |index: usize| &robot.joints[joints[index]].name;
                let angle = cosine.clamp(-1.0, 1.0).acos().to_degrees();
                let what =
                    format!("'{}' and '{}' are {angle:.1} degrees apart, expected 90", name(before), name(index));
                let help = format!(
                    "hinges of one joint stand at right angles: give '{}' to the neighbouring joint of the skeleton",
                    name(index)
                );
                return Err(RobotError::new(place, what, help));
            }
            straight -= other * straight.dot(other);
        }
        let straight = straight.normalize();
        let off = axis.dot(&straight).clamp(-1.0, 1.0).acos().to_degrees();
        if off > 0.01 {
            notes.push(format!(
                "{}: axis turned by {off:.2} degrees to a right angle",
                robot.joints[joints[index]].name
            ));
        }
        square.push(straight);
    }
    if let [a, b] = square[..] {
        square.push(a.cross(&b));
    }
    let mut rows = rows.to_vec();
    if kind == MapKind::Ball {
        let along = along(&square).ok_or_else(|| {
            let what = "its robot joints do not turn about the skeleton joint's own axes, as a ball's coordinates do";
            RobotError::new(&place, what, "leave kind out: a chain turns about any axes")
        })?;
        let turned = |(at, sign): (usize, f64)| {
            let Row { lower, upper, rest, .. } = rows[at];
            let (lower, upper) = if sign < 0.0 { (-upper, -lower) } else { (lower, upper) };
            Row { lower, upper, rest: rest.map(|rest| sign * rest), ..rows[at] }
        };
        let order = along.map(|(at, _)| joints[at]);
        rows = along.map(turned).to_vec();
        joints.copy_from_slice(&order);
    }
    let row = |index: usize| rows.get(index).copied().unwrap_or(Row { lower: 0.0, upper: 0.0, rest: None, ..rows[0] });
    let three = |of: &dyn Fn(Row) -> f32| std::array::from_fn(|index| of(row(index)));
    let axis = |index: usize| square.get(index).map_or([0.0; 3], |axis| axis.map(|x| x as f32).into());
    let coordinates = match kind {
        MapKind::Hinge => JointCoordinates { axes: [0, 1, 2].map(axis), ..JointCoordinates::new(JointKind::Hinge) },
        MapKind::Chain => JointCoordinates { axes: [0, 1, 2].map(axis), ..JointCoordinates::new(JointKind::Chain) },
        MapKind::Ball | MapKind::Free => JointCoordinates::new(JointKind::Ball),
    };
    let limit = JointLimit {
        coordinates,
        velocity: three(&|row| row.velocity as f32),
        acceleration: three(&|row| row.acceleration as f32),
        jerk: three(&|row| row.jerk as f32),
        ..JointLimit::free(1.0, 1.0)
    };
    let (lower, mut upper) = (three(&|row| row.lower as f32), three(&|row| row.upper as f32));
    // A whole turn must not become more by rounding.
    for (upper, lower) in upper.iter_mut().zip(lower) {
        while *upper - lower > std::f32::consts::TAU {
            *upper = upper.next_down();
        }
    }
    let mut limit = limit.within(lower, upper);
    for (rest, index) in limit.rest.iter_mut().zip(0..) {
        if let Some(given) = row(index).rest {
            *rest = given as f32;
        }
    }
    Ok(limit)
}

/// Which of three axes lies along x, y and z, and the sign of each; `None` if one is off by more than half a degree.
fn along(axes: &[Vector3<f64>]) -> Option<[(usize, f64); 3]> {
    let find = |own: usize| {
        let at = axes.iter().position(|axis| axis.norm_squared() - axis[own] * axis[own] < SQUARE * SQUARE)?;
        Some((at, axes[at][own].signum()))
    };
    Some([find(0)?, find(1)?, find(2)?])
}

/// The device's refusal, with the joint's name.
fn refused(error: &LoadError, model: &LimitsModel, rig: &Rig) -> RobotError {
    let help = "the range must hold the rest angle; velocity / rate, acceleration / rate^2 and jerk / rate^3 must be above 1e-6";
    let of_joint = |name: &str, column: &str| {
        RobotError::new(format!("joint '{name}'"), format!("its {column} is not what a limiter takes"), help)
    };
    match (error, model.rig(rig)) {
        (LoadError::Value { tensor, index }, Ok(limited)) => {
            let column = tensor.trim_start_matches("limit/");
            let device = limited.frames();
            if device.travels() && *index == 0 {
                let height = "height and the root's rates must be what a limiter takes";
                return RobotError::new("the map", format!("the {column} of the root's height is refused"), height);
            }
            let joints = rig.skeleton.joints.iter().zip(device.places());
            let named = joints.filter(|(_, (kind, first))| kind.coordinates() > 0 && first / 3 == *index);
            of_joint(&named.map(|(joint, _)| joint.name.as_str()).collect::<Vec<_>>().join("' or '"), column)
        }
        (LoadError::Value { tensor, index }, Err(_)) => {
            of_joint(rig.skeleton.joints.get(*index).map_or("", |joint| &joint.name), tensor.trim_start_matches("rig/"))
        }
        (other, _) => {
            RobotError::new("the table", other.to_string(), "check frame rate, root rates and times of the map")
        }
    }
}
