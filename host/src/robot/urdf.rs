//! Reads a URDF: joints, where they are, what they may do.
//!
//! <http://wiki.ros.org/urdf/XML/joint>: metres, radians; an origin is `Rz(yaw) Ry(pitch) Rx(roll)`, the axis is in the joint's frame and
//! (1, 0, 0) unless given.

use std::collections::{HashMap, HashSet};

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use roxmltree::Node;

use super::xml::{Xml, child, numbers};
use super::{Mimic, Motion, Robot, RobotError, RobotJoint};

/// Reads the text of a URDF.
pub(super) fn read(xml: &Xml) -> Result<Robot, RobotError> {
    let root = xml.document.root_element();
    let line = |node: Node| xml.line(node);
    let elements = |name: &'static str| root.children().filter(move |node| node.has_tag_name(name));
    let links: HashSet<&str> = elements("link").filter_map(|node| node.attribute("name")).collect();
    let centres: HashMap<&str, Vector3<f64>> = elements("link").filter_map(centre).collect();
    let mut lines: HashMap<String, u32> = HashMap::new();
    let mut joints: Vec<(RobotJoint, [&str; 2])> = Vec::new();
    for node in elements("joint") {
        let joint = joint(node, line(node), &centres)?;
        let place = format!("line {}, joint '{}'", joint.line, joint.name);
        if let Some(before) = lines.insert(joint.name.clone(), joint.line) {
            let what = format!("the name is taken by the joint of line {before}, expected one of its own");
            return Err(RobotError::new(place, what, "rename one of the two"));
        }
        let mut ends = [""; 2];
        for (end, tag) in ends.iter_mut().zip(["parent", "child"]) {
            let link = child(node, tag).and_then(|node| node.attribute("link")).ok_or_else(|| {
                let what = format!("found no <{tag} link=\"...\"/>, expected the link's name");
                RobotError::new(&place, what, "a joint stands between two links: name both")
            })?;
            if !links.contains(link) {
                let what = format!("its {tag} link '{link}' is not in the file, which has {} links", links.len());
                return Err(RobotError::new(place, what, format!("add <link name=\"{link}\"/> or correct the name")));
            }
            *end = link;
        }
        joints.push((joint, ends));
    }
    if joints.is_empty() {
        return Err(RobotError::new("<robot>", "found no joint, expected at least one", "is this the whole file?"));
    }
    let name = root.attribute("name").unwrap_or("robot").to_owned();
    let movers: HashSet<&str> = joints.iter().map(|(_, [_, child])| *child).collect();
    let mut roots: Vec<&str> =
        joints.iter().map(|(_, [parent, _])| *parent).filter(|link| !movers.contains(link)).collect();
    roots.dedup();
    let mut notes = Vec::new();
    if roots.len() > 1 {
        notes.push(format!(
            "{} links hang on nothing ({}): all are taken to be at the origin",
            roots.len(),
            roots.join(", ")
        ));
    }
    let root = roots.first().copied().unwrap_or_default().to_owned();
    Ok(Robot { name, root, joints: tree(joints)?, notes })
}

/// Name of a link and its centre of mass. One that is not given, or not in numbers, moves nothing.
fn centre<'a>(link: Node<'a, '_>) -> Option<(&'a str, Vector3<f64>)> {
    let at = child(child(link, "inertial")?, "origin").and_then(|origin| origin.attribute("xyz"));
    let at: [f64; 3] = numbers(at.unwrap_or("0 0 0"))?.try_into().ok()?;
    Some((link.attribute("name")?, at.into()))
}

/// A joint but for its place in the tree.
fn joint(node: Node, line: u32, centres: &HashMap<&str, Vector3<f64>>) -> Result<RobotJoint, RobotError> {
    let name = node.attribute("name").filter(|name| !name.is_empty()).ok_or_else(|| {
        RobotError::new(format!("line {line}"), "found a <joint> without a name, expected name=\"...\"", "name it")
    })?;
    let place = format!("line {line}, joint '{name}'");
    let number = |tag: &str, attribute: &str| -> Result<Option<f64>, RobotError> {
        let Some(text) = child(node, tag).and_then(|node| node.attribute(attribute)) else { return Ok(None) };
        match text.trim().parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            _ => {
                let what = format!("<{tag} {attribute}=\"{text}\">: expected a finite number");
                Err(RobotError::new(&place, what, "angles are in radians, lengths in metres, as 1.5708"))
            }
        }
    };
    let three = |tag: &str, attribute: &str| -> Result<Option<Vector3<f64>>, RobotError> {
        let Some(text) = child(node, tag).and_then(|node| node.attribute(attribute)) else { return Ok(None) };
        match numbers(text).as_deref() {
            Some(&[x, y, z]) => Ok(Some(Vector3::new(x, y, z))),
            _ => {
                let what = format!("<{tag} {attribute}=\"{text}\">: expected three numbers");
                Err(RobotError::new(&place, what, "as in \"0 0 1\""))
            }
        }
    };
    let motion = match node.attribute("type") {
        Some("revolute") => Motion::Revolute,
        Some("continuous") => Motion::Continuous,
        Some("fixed") => Motion::Fixed,
        Some("prismatic") => Motion::Prismatic,
        Some("planar") => Motion::Other("planar"),
        Some("floating") => Motion::Other("floating"),
        // Refused where a map names it.
        Some(_) => Motion::Other("of an unknown type"),
        None => {
            let help = "expected revolute, continuous, fixed, prismatic, planar or floating";
            return Err(RobotError::new(place, "found no type", help));
        }
    };
    let place_of = three("origin", "xyz")?.unwrap_or_default();
    let turn = three("origin", "rpy")?.unwrap_or_default();
    let axis = three("axis", "xyz")?.unwrap_or_else(Vector3::x).try_normalize(1e-6);
    let axis = match (axis, motion) {
        (Some(axis), _) => axis,
        (None, Motion::Fixed | Motion::Other(_)) => Vector3::x(),
        (None, _) => {
            let what = "<axis>: found a vector of length zero, expected a direction";
            return Err(RobotError::new(place, what, "as in <axis xyz=\"0 1 0\"/>"));
        }
    };
    let bound = |tag: &str, attribute: &str| -> Result<Option<f64>, RobotError> {
        let text = child(node, tag).and_then(|node| node.attribute(attribute)).map(str::trim);
        // Infinity stands for a joint without bounds.
        match text.and_then(|text| text.parse::<f64>().ok()).filter(|value| value.is_infinite()) {
            Some(value) => Ok(Some(value)),
            None => number(tag, attribute),
        }
    };
    let mut notes = Vec::new();
    let mut soft = [bound("safety_controller", "soft_lower_limit")?, bound("safety_controller", "soft_upper_limit")?];
    let hard = [bound("limit", "lower")?, bound("limit", "upper")?];
    if soft[0].is_some() && soft[0] == soft[1] && hard[0] != hard[1] {
        notes.push(format!(
            "{name}: soft limits of {} and {} would lock it, place holders: left out",
            soft[0].unwrap_or(0.0),
            soft[1].unwrap_or(0.0)
        ));
        soft = [None, None];
    }
    let both = |end: usize, pick: fn(f64, f64) -> f64| {
        hard[end].zip(soft[end]).map(|(hard, soft)| pick(hard, soft)).or(hard[end]).or(soft[end])
    };
    let (lower, upper) = (both(0, f64::max), both(1, f64::min));
    if motion == Motion::Revolute && lower == Some(0.0) && upper == Some(0.0) {
        notes.push(format!(
            "{name}: bounds of 0 and 0 lock it; if they are place holders, write lower and upper into the map's entry"
        ));
    }
    let mimic = match child(node, "mimic") {
        None => None,
        Some(mimic) => Some(Mimic {
            joint: mimic.attribute("joint").unwrap_or_default().to_owned(),
            multiplier: number("mimic", "multiplier")?.unwrap_or(1.0),
            offset: number("mimic", "offset")?.unwrap_or(0.0),
        }),
    };
    let moves = child(node, "child").and_then(|node| node.attribute("link")).unwrap_or_default();
    Ok(RobotJoint {
        name: name.to_owned(),
        line,
        motion,
        kind: node.attribute("type").unwrap_or_default().to_owned(),
        child: moves.to_owned(),
        centre: centres.get(moves).copied(),
        parent: None,
        origin: Isometry3::from_parts(
            Translation3::from(place_of),
            UnitQuaternion::from_euler_angles(turn.x, turn.y, turn.z),
        ),
        axis,
        lower,
        upper,
        velocity: number("limit", "velocity")?,
        mimic,
        notes,
    })
}

/// Finds every joint's parent. Every link has one joint at most that moves it, and every way inwards ends at a root.
fn tree(joints: Vec<(RobotJoint, [&str; 2])>) -> Result<Vec<RobotJoint>, RobotError> {
    let mut mover: HashMap<&str, usize> = HashMap::new();
    for (index, (joint, [_, child])) in joints.iter().enumerate() {
        if let Some(other) = mover.insert(child, index) {
            let (place, other) = (format!("line {}, joint '{}'", joint.line, joint.name), &joints[other].0);
            let what = format!("its child '{child}' is that of '{}' (line {}) already", other.name, other.line);
            return Err(RobotError::new(place, what, "expected a tree: a link has one parent; cut the loop open"));
        }
    }
    let parents: Vec<Option<usize>> = joints.iter().map(|(_, [parent, _])| mover.get(parent).copied()).collect();
    // Every way inwards is walked once, up to where an earlier one passed; a loop leads back into the present one.
    let mut passed: Vec<Option<usize>> = vec![None; joints.len()];
    for (index, (joint, _)) in joints.iter().enumerate() {
        let mut at = Some(index);
        while let Some(open) = at.filter(|at| passed[*at].is_none()) {
            passed[open] = Some(index);
            at = parents[open];
        }
        if let Some(inside) = at.filter(|at| passed[*at] == Some(index)) {
            let ring = std::iter::successors(parents[inside], |at| parents[*at]).take_while(|at| *at != inside);
            let names: Vec<&str> = ring.chain([inside]).map(|at| joints[at].0.name.as_str()).collect();
            let place = format!("line {}, joint '{}'", joint.line, joint.name);
            let what = format!("it hangs on a loop of joints: {}", names.join(", "));
            return Err(RobotError::new(place, what, "expected a tree with one root link; cut the loop open"));
        }
    }
    Ok(joints.into_iter().zip(parents).map(|((joint, _), parent)| RobotJoint { parent, ..joint }).collect())
}
