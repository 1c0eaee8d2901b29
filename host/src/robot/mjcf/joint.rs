//! One joint of an MJCF.

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use super::super::xml::numbers;
use super::super::{Motion, RobotError, RobotJoint};
use super::Part;
use super::settings::Settings;

/// How a joint of MuJoCo moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Hinge,
    Slide,
    Ball,
    Free,
}

/// A joint with the point of its body about which it turns, m; a ball is three hinges. `origin` undoes the value at rest.
pub(super) struct Found {
    pub kind: Kind,
    pub joints: Vec<(RobotJoint, Vector3<f64>)>,
    /// Value at which the body stands as written, rad or m.
    pub rest: f64,
}

pub(super) fn read<'a>(part: Part<'a>, settings: &Settings<'a>, name: String, line: u32) -> Result<Found, RobotError> {
    let (node, from, class) = part;
    let place = format!("line {line}, joint '{name}'");
    let free = Found { kind: Kind::Free, joints: Vec::new(), rest: 0.0 };
    if node.has_tag_name("freejoint") {
        return Ok(free);
    }
    let [kind, at, axis, range, rest, limited] = settings.joint(node, class, &place)?;
    let kind = match kind.unwrap_or("hinge") {
        "hinge" => Kind::Hinge,
        "slide" => Kind::Slide,
        "ball" => Kind::Ball,
        "free" => return Ok(free),
        other => {
            let what = format!("type=\"{other}\": expected hinge, slide, ball or free");
            return Err(RobotError::new(place, what, "MuJoCo refuses it too; correct it"));
        }
    };
    let list = |key: &str, text: Option<&str>, count: usize| -> Result<Option<Vec<f64>>, RobotError> {
        let Some(text) = text else { return Ok(None) };
        let found = numbers(text).filter(|found| found.len() == count).ok_or_else(|| {
            RobotError::new(
                &place,
                format!("{key}=\"{text}\": expected {count} finite numbers"),
                "as MuJoCo writes them",
            )
        })?;
        Ok(Some(found))
    };
    let three = |found: Option<Vec<f64>>, or: Vector3<f64>| found.map_or(or, Vector3::from_iterator);
    let point = from * nalgebra::Point3::from(three(list("pos", at, 3)?, Vector3::zeros()));
    let axis = three(list("axis", axis, 3)?, Vector3::z());
    let axis = from.rotation * if kind == Kind::Ball { Vector3::x() } else { axis };
    let axis = axis.try_normalize(1e-9).ok_or_else(|| {
        RobotError::new(&place, "axis: found a vector of length zero, expected a direction", "as in axis=\"0 1 0\"")
    })?;
    let unit = if kind == Kind::Slide { 1.0 } else { settings.angle };
    let rest = list("ref", rest, 1)?.map_or(0.0, |rest| rest[0] * unit);
    let range = list("range", range, 2)?.map(|range| [range[0] * unit, range[1] * unit]);
    let is_limited = match limited.unwrap_or("auto") {
        "true" => true,
        "false" => false,
        _ => settings.autolimits && range.is_some(),
    };
    if let Some([lower, upper]) = range.filter(|[lower, upper]| is_limited && lower > upper) {
        let what = format!("range: found {lower} to {upper}, expected the lower bound first");
        return Err(RobotError::new(place, what, "exchange the two"));
    }
    let mut notes = Vec::new();
    let mut bounds = range.filter(|_| is_limited);
    if is_limited && range.is_none() {
        notes.push(format!("{name}: limited without a range, taken to be free"));
    }
    if let (Kind::Ball, Some([_, upper])) = (kind, bounds) {
        bounds = Some([-upper, upper]);
    }
    let joint = |name: String, axis: Vector3<f64>, notes: Vec<String>| RobotJoint {
        name,
        line,
        motion: match (kind, bounds) {
            (Kind::Slide, _) => Motion::Prismatic,
            (_, Some(_)) => Motion::Revolute,
            (_, None) => Motion::Continuous,
        },
        kind: match kind {
            Kind::Slide => "slide",
            Kind::Ball => "ball",
            Kind::Hinge | Kind::Free => "hinge",
        }
        .to_owned(),
        child: String::new(),
        centre: None,
        parent: None,
        // The body stands as written where the value is `ref`.
        origin: match kind {
            Kind::Slide => Isometry3::from_parts(Translation3::from(axis * -rest), UnitQuaternion::identity()),
            _ => Isometry3::rotation(axis * -rest),
        },
        axis,
        lower: bounds.map(|bounds| bounds[0]),
        upper: bounds.map(|bounds| bounds[1]),
        velocity: None,
        mimic: None,
        notes,
    };
    if kind == Kind::Ball {
        notes.push(format!(
            "{name}: a ball, taken as three hinges {name}_x, {name}_y and {name}_z, each with its range"
        ));
        let axes = [("x", Vector3::x()), ("y", Vector3::y()), ("z", Vector3::z())];
        let hinges =
            axes.map(|(end, axis)| (joint(format!("{name}_{end}"), from.rotation * axis, Vec::new()), point.coords));
        let mut joints = hinges.to_vec();
        joints[0].0.notes = notes;
        // A ball has no single value at rest.
        joints.iter_mut().for_each(|(joint, _)| joint.origin = Isometry3::identity());
        return Ok(Found { kind, joints, rest: 0.0 });
    }
    Ok(Found { kind, joints: vec![(joint(name, axis, notes), point.coords)], rest })
}
