//! Reads an MJCF: MuJoCo's description of a robot.
//!
//! <https://mujoco.readthedocs.io/en/stable/XMLreference.html>: metres; degrees unless the compiler says radians; z up. Joints turn a body
//! about points of its own frame, one after the other.
//!
//! | file | holds |
//! |---|---|
//! | `include` | files beside the model, put in their places |
//! | `settings` | units, order of angles, defaults by class; frames |
//! | `joint` | one joint: type, axis, range |

mod include;
mod joint;
mod settings;

use std::collections::{HashMap, HashSet};

use nalgebra::Isometry3;
use roxmltree::Node;

pub(super) use include::included;
use joint::Kind;
use settings::Settings;

use super::xml::{Xml, numbers};
use super::{Mimic, Motion, Robot, RobotError, RobotJoint};

/// Elements that make bodies when MuJoCo compiles them.
const MADE: [&str; 3] = ["replicate", "attach", "composite"];
const FLAT: &str = "write the model flat, as MuJoCo compiles it: mj_saveLastXML";

/// Reads the text of an MJCF without includes.
pub(super) fn read(xml: &Xml) -> Result<Robot, RobotError> {
    let root = xml.document.root_element();
    if let Some(node) = root.descendants().find(|node| node.has_tag_name("include")) {
        let help = "read it by its path, so that the files beside it are found; or write it flat: mj_saveLastXML";
        return Err(RobotError::new(
            format!("line {}", xml.line(node)),
            "found an <include>, expected the whole model",
            help,
        ));
    }
    let settings = Settings::read(xml)?;
    let mut reading =
        Reading { xml, settings, joints: Vec::new(), names: HashSet::new(), refs: HashMap::new(), notes: Vec::new() };
    let world: Vec<Node> = root.children().filter(|node| node.has_tag_name("worldbody")).collect();
    let mut open = Vec::new();
    let mut base = "world".to_owned();
    let mut top = Vec::new();
    for node in world {
        let (joints, bodies) = reading.contents(node, None, "line of <worldbody>")?;
        if let Some(joint) = joints.first() {
            let place = format!("line {}", xml.line(joint.0));
            return Err(RobotError::new(
                place,
                "found a joint of the world, expected it in a body",
                "put it into a <body>",
            ));
        }
        top.extend(bodies);
    }
    let single = top.len() == 1;
    for body in top.into_iter().rev() {
        open.push((body, None, Isometry3::identity(), true));
    }
    while let Some((body, carrier, from, first)) = open.pop() {
        let (at, link, bodies) = reading.body(&body, (carrier, from), first, single)?;
        if let Some(root) = link {
            base = root;
        }
        open.extend(bodies.into_iter().rev().map(|body| (body, at.0, at.1, false)));
    }
    if reading.joints.is_empty() {
        return Err(RobotError::new("<mujoco>", "found no joint, expected at least one", "is this the whole file?"));
    }
    reading.equalities(root)?;
    let name = root.attribute("model").unwrap_or("robot").to_owned();
    Ok(Robot { name, root: base, joints: reading.joints, notes: reading.notes })
}

/// A body or a joint of a body: element, frame in which it stands, class for it.
type Part<'a> = (Node<'a, 'a>, Isometry3<f64>, Option<&'a str>);
/// The joint that carries a body's children, and their frame in that joint's.
type Carrier = (Option<usize>, Isometry3<f64>);

struct Reading<'a, 't> {
    xml: &'a Xml<'t>,
    settings: Settings<'a>,
    joints: Vec<RobotJoint>,
    names: HashSet<String>,
    /// Values at which the model stands as written, rad or m.
    refs: HashMap<String, f64>,
    notes: Vec<String>,
}

impl<'a, 't> Reading<'a, 't> {
    /// Joints and bodies directly in a body, also by way of frames.
    fn contents(
        &mut self,
        body: Node<'a, 'a>,
        class: Option<&'a str>,
        place: &str,
    ) -> Result<(Vec<Part<'a>>, Vec<Part<'a>>), RobotError> {
        let (mut joints, mut bodies) = (Vec::new(), Vec::new());
        let within = |node: Node<'a, 'a>, from: Isometry3<f64>, class: Option<&'a str>| -> Vec<Part<'a>> {
            let inner: Vec<Part> = node.children().filter(Node::is_element).map(|child| (child, from, class)).collect();
            inner.into_iter().rev().collect()
        };
        let mut open = within(body, Isometry3::identity(), body.attribute("childclass").or(class));
        while let Some((node, from, class)) = open.pop() {
            match node.tag_name().name() {
                "joint" | "freejoint" => joints.push((node, from, class)),
                "body" => bodies.push((node, from, class)),
                "frame" => {
                    let from = from * self.settings.frame(node, &format!("line {}, <frame>", self.xml.line(node)))?;
                    open.extend(within(node, from, node.attribute("childclass").or(class)));
                }
                made if MADE.contains(&made) => {
                    let what = format!("found <{made}>, expected bodies as they are ({place})");
                    return Err(RobotError::new(format!("line {}", self.xml.line(node)), what, FLAT));
                }
                "flexcomp" => self.notes.push(format!("line {}: <flexcomp> is soft and left out", self.xml.line(node))),
                _ => {}
            }
        }
        Ok((joints, bodies))
    }

    /// Adds the joints of a body. Gives what carries its children, its name if it is the root link, and the bodies on it.
    fn body(
        &mut self,
        body: &Part<'a>,
        (carrier, from): Carrier,
        first: bool,
        single: bool,
    ) -> Result<(Carrier, Option<String>, Vec<Part<'a>>), RobotError> {
        let &(node, inside, class) = body;
        let line = self.xml.line(node);
        let name = node.attribute("name").map_or_else(|| format!("body_{line}"), str::to_owned);
        let place = format!("line {line}, body '{name}'");
        let frame = inside * self.settings.frame(node, &place)?;
        let (parts, bodies) = self.contents(node, class, &place)?;
        let mut joints = Vec::new();
        let free = !parts.is_empty();
        for part in parts {
            joints.extend(self.read_joint(&part, &name, first)?);
        }
        let centre = super::xml::child(node, "inertial").and_then(|inertial| inertial.attribute("pos"));
        let centre = centre.and_then(numbers).and_then(|at| <[f64; 3]>::try_from(at).ok()).map(Into::into);
        if first && single && joints.is_empty() {
            if frame != Isometry3::identity() && !free {
                self.notes.push(format!("{name} is the root link: where it stands in the world is left out"));
            }
            return Ok(((None, Isometry3::identity()), Some(name), bodies));
        }
        // Every joint stands at its own point of the body; the next one starts from where that leaves the body.
        let (mut on, mut origin) = (carrier, from * frame);
        let count = joints.len();
        for (index, (mut joint, point)) in joints.into_iter().enumerate() {
            let to = Isometry3::translation(point.x, point.y, point.z);
            joint.origin = origin * to * joint.origin;
            joint.parent = on;
            origin = to.inverse();
            let last = index + 1 == count && origin == Isometry3::identity();
            joint.child = if last { name.clone() } else { format!("{name}_{}", index + 1) };
            joint.centre = centre.filter(|_| last);
            on = Some(self.joints.len());
            self.joints.push(joint);
        }
        if count == 0 || origin != Isometry3::identity() {
            let joint = RobotJoint {
                name: self.unused(&format!("{name}_frame")),
                line,
                motion: Motion::Fixed,
                kind: "fixed".to_owned(),
                child: name,
                centre,
                parent: on,
                origin,
                axis: nalgebra::Vector3::x(),
                lower: None,
                upper: None,
                velocity: None,
                mimic: None,
                notes: Vec::new(),
            };
            on = Some(self.joints.len());
            self.joints.push(joint);
        }
        Ok(((on, Isometry3::identity()), None, bodies))
    }

    /// A joint, or three of a ball; none where it is free.
    fn read_joint(
        &mut self,
        part: &Part<'a>,
        body: &str,
        outermost: bool,
    ) -> Result<Vec<(RobotJoint, nalgebra::Vector3<f64>)>, RobotError> {
        let line = self.xml.line(part.0);
        let given = part.0.attribute("name").filter(|name| !name.is_empty());
        let name = given.map_or_else(|| self.unused(&format!("{body}_joint")), str::to_owned);
        let place = format!("line {line}, joint '{name}'");
        let found = joint::read(*part, &self.settings, name, line)?;
        if found.kind == Kind::Free {
            if !outermost {
                let what = "found a free joint inside another body, expected it in a body of the world";
                return Err(RobotError::new(place, what, "MuJoCo refuses it too; move the body out"));
            }
            self.notes
                .push(format!("{body} moves freely in the world: its place is no joint of the robot and left out"));
            return Ok(Vec::new());
        }
        for (joint, _) in &found.joints {
            if !self.names.insert(joint.name.clone()) {
                let what = format!("the name '{}' is taken by an earlier joint, expected one of its own", joint.name);
                return Err(RobotError::new(place, what, "rename one of the two"));
            }
            self.refs.insert(joint.name.clone(), found.rest);
        }
        Ok(found.joints)
    }

    /// A name that no joint has yet.
    fn unused(&mut self, name: &str) -> String {
        let mut tried = name.to_owned();
        while self.names.contains(&tried) {
            tried.push('_');
        }
        self.names.insert(tried.clone());
        tried
    }

    /// Joints that follow others, and what else ties parts together.
    fn equalities(&mut self, root: Node<'a, 'a>) -> Result<(), RobotError> {
        let index: HashMap<String, usize> =
            self.joints.iter().enumerate().map(|(at, joint)| (joint.name.clone(), at)).collect();
        let mut loops = 0;
        let sections = root.children().filter(|node| node.has_tag_name("equality"));
        for node in sections.flat_map(|section| section.children()).filter(Node::is_element) {
            if node.attribute("active") == Some("false") {
                continue;
            }
            if !node.has_tag_name("joint") {
                loops += 1;
                continue;
            }
            let place = format!("line {}, <equality>", self.xml.line(node));
            let find = |key: &str| match node.attribute(key) {
                None => Ok(None),
                Some(name) => index.get(name).copied().map(Some).ok_or_else(|| {
                    let what = format!("{key}=\"{name}\" is no joint of the file, which has {}", index.len());
                    RobotError::new(&place, what, "correct the name")
                }),
            };
            let follower = find("joint1")?.ok_or_else(|| {
                RobotError::new(&place, "found no joint1, expected the joint that follows", "name it")
            })?;
            let text = node.attribute("polycoef").unwrap_or("0 1");
            let mut terms = numbers(text).filter(|terms| terms.len() <= 5).ok_or_else(|| {
                RobotError::new(
                    &place,
                    format!("polycoef=\"{text}\": expected up to five numbers"),
                    "as in \"0 1 0 0 0\"",
                )
            })?;
            let given = terms.len();
            terms.extend([0.0, 1.0, 0.0, 0.0, 0.0].iter().skip(given));
            let rest = |joint: usize, refs: &HashMap<String, f64>, joints: &[RobotJoint]| {
                refs.get(&joints[joint].name).copied().unwrap_or(0.0)
            };
            let own = rest(follower, &self.refs, &self.joints);
            match find("joint2")? {
                None => {
                    let value = own + terms[0];
                    let joint = &mut self.joints[follower];
                    joint.notes.push(format!("{}: an equality holds it at {value}", joint.name));
                    (joint.lower, joint.upper) = (Some(value), Some(value));
                }
                Some(leader) => {
                    let other = rest(leader, &self.refs, &self.joints);
                    let (joint, leader) = (follower, self.joints[leader].name.clone());
                    let joint = &mut self.joints[joint];
                    if terms[2..].iter().any(|term| *term != 0.0) {
                        joint
                            .notes
                            .push(format!("{}: it follows {leader} by a curve; only its line is kept", joint.name));
                    }
                    let offset = own + terms[0] - terms[1] * other;
                    joint.mimic = Some(Mimic { joint: leader, multiplier: terms[1], offset });
                }
            }
        }
        if loops > 0 {
            self.notes.push(format!(
                "{loops} equalities tie bodies or tendons into loops: the tree is read, the loops are left open"
            ));
        }
        Ok(())
    }
}
