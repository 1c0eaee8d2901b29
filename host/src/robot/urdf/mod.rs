//! Reads a URDF: joints, where they are, what they may do; in `visual` how links look.
//!
//! <http://wiki.ros.org/urdf/XML/joint>: metres, radians; an origin is `Rz(yaw) Ry(pitch) Rx(roll)`, the axis is in the joint's frame and
//! (1, 0, 0) unless given.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use roxmltree::{Document, Node};

mod visual;

use super::{Mimic, Motion, Robot, RobotError, RobotJoint, mjcf};
use crate::files;

impl Robot {
    /// Reads a robot's description: a URDF or an MJCF, told by its root element. An MJCF may include files of its folder.
    pub fn read(path: &Path) -> Result<Self, RobotError> {
        let text = files::read_text(path).map_err(|error| {
            let help = "check the path; the file is text in UTF-8";
            RobotError::new(path.display().to_string(), format!("cannot be read: {error}"), help)
        })?;
        let folder = path.parent().filter(|_| path != Path::new("-"));
        Self::parse_in(&text, folder).map_err(|error| error.in_file(path))
    }

    /// As [`read`](Self::read), of a text without a folder: an MJCF that includes files is refused.
    pub fn parse(text: &str) -> Result<Self, RobotError> {
        Self::parse_in(text, None)
    }

    fn parse_in(text: &str, folder: Option<&Path>) -> Result<Self, RobotError> {
        crowded(text)?;
        let document = Document::parse(text).map_err(|error| {
            RobotError::new(
                format!("line {}", error.pos().row),
                format!("not XML: {error}"),
                "expected a URDF; `check_urdf FILE` of liburdfdom-tools finds the same error",
            )
        })?;
        let root = document.root_element();
        if root.tag_name().name() == "mujoco" {
            return mjcf::parse(text, folder);
        }
        let ends: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
        let line = |node: Node| 1 + ends.partition_point(|end| *end < node.range().start) as u32;
        if let Some(node) = root.descendants().find(|node| node.tag_name().namespace().is_some_and(is_xacro)) {
            return Err(RobotError::new(
                format!("line {}", line(node)),
                format!("found <xacro:{}>, expected a URDF without macros", node.tag_name().name()),
                "expand it: xacro robot.urdf.xacro > robot.urdf",
            ));
        }
        if root.tag_name().name() != "robot" {
            return Err(RobotError::new(
                format!("line {}", line(root)),
                format!("found <{}>, expected <robot> of a URDF or <mujoco> of an MJCF", root.tag_name().name()),
                "a URDF is one <robot> element with links and joints; an SDF can be converted to it",
            ));
        }
        let elements = |name: &'static str| root.children().filter(move |node| node.has_tag_name(name));
        let links: HashSet<&str> = elements("link").filter_map(|node| node.attribute("name")).collect();
        let centres: HashMap<&str, Vector3<f64>> = elements("link").filter_map(centre).collect();
        let mut lines: HashMap<String, u32> = HashMap::new();
        let mut joints: Vec<(RobotJoint, [&str; 2])> = Vec::new();
        for node in elements("joint") {
            let joint = read(node, line(node))?;
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
                    return Err(RobotError::new(
                        place,
                        what,
                        format!("add <link name=\"{link}\"/> or correct the name"),
                    ));
                }
                *end = link;
            }
            joints.push((RobotJoint { centre: centres.get(ends[1]).copied(), ..joint }, ends));
        }
        if joints.is_empty() {
            return Err(RobotError::new("<robot>", "found no joint, expected at least one", "is this the whole file?"));
        }
        let name = root.attribute("name").unwrap_or("robot").to_owned();
        let (shapes, notes) = visual::read(root, &line);
        Ok(Self { name, joints: tree(joints)?, shapes, notes })
    }
}

/// A larger velocity means that there is none, rad/s or m/s: no motor turns as fast.
const FASTEST: f64 = 1e4;

/// Attributes of an element at most. The XML reader compares each with all others of its element.
const ATTRIBUTES: usize = 1000;

/// Refuses an element with more attributes than any robot's.
pub(super) fn crowded(text: &str) -> Result<(), RobotError> {
    let skipped = [("!--", "-->"), ("![CDATA[", "]]>"), ("?", "?>")];
    let mut at = 0;
    while let Some(open) = text[at..].find('<') {
        at += open + 1;
        let rest = &text[at..];
        if let Some((_, end)) = skipped.iter().find(|(begin, _)| rest.starts_with(begin)) {
            at += rest.find(end).unwrap_or(rest.len());
            continue;
        }
        let start = at;
        let (mut quote, mut values) = (None, 0);
        for byte in rest.bytes() {
            at += 1;
            match (quote, byte) {
                (None, b'>') => break,
                (None, b'"' | b'\'') => quote = Some(byte),
                (Some(open), byte) if open == byte => (quote, values) = (None, values + 1),
                _ => {}
            }
            if values > ATTRIBUTES {
                let line = 1 + text[..start].matches('\n').count();
                return Err(RobotError::new(
                    format!("line {line}"),
                    format!("found an element with more than {ATTRIBUTES} attributes, expected a robot's description"),
                    "its elements have ten attributes at most: is this the right file?",
                ));
            }
        }
    }
    Ok(())
}

fn is_xacro(namespace: &str) -> bool {
    namespace.contains("xacro")
}

fn child<'a, 'b>(node: Node<'a, 'b>, name: &str) -> Option<Node<'a, 'b>> {
    node.children().find(|node| node.has_tag_name(name))
}

/// Name of a link and its centre of mass. One that is not given, or not in numbers, moves nothing.
fn centre<'a>(link: Node<'a, '_>) -> Option<(&'a str, Vector3<f64>)> {
    let origin = child(child(link, "inertial")?, "origin");
    let at = origin.map_or(Ok(None), |origin| three(origin, "xyz")).ok()?.unwrap_or_default();
    Some((link.attribute("name")?, at))
}

/// Three numbers of an attribute; what is wrong with it.
fn three(node: Node, name: &str) -> Result<Option<Vector3<f64>>, String> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    let all: Option<Vec<f64>> = text.split_whitespace().map(|x| x.parse().ok()).collect();
    match all.as_deref() {
        Some(&[x, y, z]) if [x, y, z].iter().all(|x| x.abs() < 1e6) => Ok(Some(Vector3::new(x, y, z))),
        _ => Err(format!("<{} {name}=\"{text}\">: expected three numbers below a million", node.tag_name().name())),
    }
}

/// A joint but for its place in the tree.
fn read(node: Node, line: u32) -> Result<RobotJoint, RobotError> {
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
    let three = |tag: &str, attribute: &str| {
        let found = child(node, tag).map_or(Ok(None), |node| three(node, attribute));
        found.map_err(|what| RobotError::new(&place, what, "as in \"0 0 1\""))
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
    if let ([Some(low), Some(high)], true) = (soft, hard[0] != hard[1]) {
        let nothing = low > high || hard[1].is_some_and(|end| low > end) || hard[0].is_some_and(|end| high < end);
        if low == high || nothing {
            let why = if nothing { "leave nothing of its limits" } else { "would lock it, place holders" };
            notes.push(format!("{name}: soft limits of {low} and {high} {why}: left out"));
            soft = [None, None];
        }
    }
    let both = |end: usize, pick: fn(f64, f64) -> f64| {
        hard[end].zip(soft[end]).map(|(hard, soft)| pick(hard, soft)).or(hard[end]).or(soft[end])
    };
    let (lower, upper) = (both(0, f64::max), both(1, f64::min));
    if let (Motion::Revolute, Some(lower), Some(upper)) = (motion, lower, upper)
        && lower == upper
    {
        notes.push(format!(
            "{name}: bounds of {lower} and {upper} lock it; if they are place holders, write lower and upper into the map's entry"
        ));
    }
    let mut velocity = bound("limit", "velocity")?;
    if let Some(none) = velocity.take_if(|speed| *speed > FASTEST) {
        notes.push(format!("{name}: a velocity of {none:e} is none"));
    }
    let mimic = match child(node, "mimic") {
        None => None,
        Some(mimic) => Some(Mimic {
            joint: mimic.attribute("joint").unwrap_or_default().to_owned(),
            multiplier: number("mimic", "multiplier")?.unwrap_or(1.0),
            offset: number("mimic", "offset")?.unwrap_or(0.0),
        }),
    };
    let link = |tag| child(node, tag).and_then(|node| node.attribute("link")).unwrap_or_default().to_owned();
    Ok(RobotJoint {
        name: name.to_owned(),
        line,
        motion,
        kind: node.attribute("type").unwrap_or_default().to_owned(),
        base: link("parent"),
        child: link("child"),
        centre: None,
        parent: None,
        origin: Isometry3::from_parts(
            Translation3::from(place_of),
            UnitQuaternion::from_euler_angles(turn.x, turn.y, turn.z),
        ),
        axis,
        lower,
        upper,
        velocity,
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
