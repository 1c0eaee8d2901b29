//! Reads an MJCF (MuJoCo): bodies in bodies, with joints in them, to the joints of a [`Robot`].
//!
//! <https://mujoco.readthedocs.io/en/stable/XMLreference.html>: metres, degrees unless the compiler says radian, quaternions w first. A
//! body with several joints becomes joints in a row, with links `BODY/JOINT` between them; a joint that is not at its body's origin is
//! followed by a fixed one, so that every link's frame is its body's. A body without joints hangs on a fixed joint with the body's name.

mod defaults;
mod equality;
mod geom;
mod joint;
mod pose;
mod source;

use std::collections::HashSet;
use std::path::Path;

use nalgebra::{Isometry3, Translation3, Vector3};

use self::defaults::Defaults;
use self::geom::Geoms;
use self::joint::Axis;
use self::pose::Angles;
use self::source::Source;
use super::shape::Shape;
use super::{Motion, Robot, RobotError, RobotJoint};

/// Root link of a description that has no single robot.
const WORLD: &str = "world";

/// Reads the text of an MJCF; included files are those of `folder`.
pub(super) fn parse(text: &str, folder: Option<&Path>) -> Result<Robot, RobotError> {
    let source = Source::read(text, folder)?;
    let reader = Reader {
        angles: Angles::read(&source)?,
        defaults: Defaults::read(&source, "joint", &joint::ATTRIBUTES)?,
        geoms: Geoms::read(&source)?,
        source: &source,
    };
    let mut found = reader.bodies()?;
    let (root, mut notes) = found.root(&source);
    notes.append(&mut found.notes);
    let name = source.get(0, "model").filter(|name| !name.is_empty()).unwrap_or("robot").to_owned();
    let (mut joints, references) = found.joints(&source, root)?;
    if joints.is_empty() {
        return Err(RobotError::new("<worldbody>", "found no joint, expected at least one", "is this the whole file?"));
    }
    equality::follow(&source, &mut joints, &references, &mut notes)?;
    for tag in ["tendon", "composite", "flexcomp"] {
        if !source.sections(tag).is_empty() {
            notes.push(format!("<{tag}>: what it couples is not kept"));
        }
    }
    Ok(Robot { name, joints, shapes: found.shapes, notes })
}

struct Reader<'a> {
    source: &'a Source,
    angles: Angles,
    defaults: Defaults,
    geoms: Geoms,
}

/// A body on its way into the tree.
struct Body {
    name: String,
    element: usize,
    parent: Option<usize>,
    frame: Isometry3<f64>,
    axes: Vec<Axis>,
    /// Whether it, or a body in it, has a joint of one coordinate.
    moves: bool,
    notes: Vec<String>,
}

/// An element whose children are still to be looked at: it, its body, the frame within that, the class around it.
type Open<'a> = (usize, Option<usize>, Isometry3<f64>, Option<&'a str>);

struct Found {
    bodies: Vec<Body>,
    /// How they look.
    shapes: Vec<Shape>,
    /// What is not drawn.
    notes: Vec<String>,
}

impl Reader<'_> {
    /// All bodies, each after the one that holds it.
    fn bodies(&self) -> Result<Found, RobotError> {
        let mut bodies: Vec<Body> = Vec::new();
        let (mut shapes, mut undrawn) = (Vec::new(), Vec::new());
        let mut names = HashSet::new();
        let mut unnamed = 0;
        let mut open: Vec<Open> = Vec::new();
        let worlds = self.source.sections("worldbody").into_iter().rev();
        open.extend(worlds.map(|at| (at, None, Isometry3::identity(), self.source.get(at, "childclass"))));
        while let Some((at, body, frame, class)) = open.pop() {
            let mut inner = Vec::new();
            for &child in &self.source.at(at).children {
                let around = || self.source.get(child, "childclass").or(class);
                match self.source.at(child).tag.as_str() {
                    "frame" => inner.push((child, body, frame * self.angles.pose(self.source, child)?, around())),
                    "body" => {
                        let name = self.source.get(child, "name").filter(|name| !name.is_empty());
                        let name = name.map(str::to_owned).unwrap_or_else(|| {
                            unnamed += 1;
                            format!("body{unnamed}")
                        });
                        if !names.insert(name.clone()) {
                            let what = format!("the name '{name}' is taken by another body, expected one of its own");
                            return Err(RobotError::new(self.source.place(child), what, "rename one of the two"));
                        }
                        let frame = frame * self.angles.pose(self.source, child)?;
                        inner.push((child, Some(bodies.len()), Isometry3::identity(), around()));
                        bodies.push(Body {
                            name,
                            element: child,
                            parent: body,
                            frame,
                            axes: Vec::new(),
                            moves: false,
                            notes: Vec::new(),
                        });
                    }
                    "joint" | "freejoint" => {
                        let axis = joint::read(self.source, &self.angles, &self.defaults, child, class, &frame)?;
                        if let Some(body) = body.and_then(|body| bodies.get_mut(body)) {
                            body.axes.push(axis);
                        }
                    }
                    "geom" => {
                        let link = body.and_then(|body| bodies.get(body)).map_or(WORLD, |body| body.name.as_str());
                        match self.geoms.shape(self.source, &self.angles, child, class, &frame) {
                            Ok(shape) => shapes.extend(shape.map(|shape| Shape { link: link.to_owned(), ..shape })),
                            Err(RobotError { place, what, .. }) => {
                                undrawn.push(format!("{place}: {what}: this part of '{link}' is not drawn"));
                            }
                        }
                    }
                    tag @ ("replicate" | "attach" | "composite" | "flexcomp") => self.made(child, tag)?,
                    _ => {}
                }
            }
            open.extend(inner.into_iter().rev());
        }
        for at in (0..bodies.len()).rev() {
            bodies[at].moves |= bodies[at].axes.iter().any(|axis| axis.kind.moves());
            if let (true, Some(parent)) = (bodies[at].moves, bodies[at].parent) {
                bodies[parent].moves = true;
            }
        }
        Ok(Found { bodies, shapes, notes: undrawn })
    }

    /// Refuses what MuJoCo itself would make bodies or joints of; geometry may be made as it likes.
    fn made(&self, at: usize, tag: &str) -> Result<(), RobotError> {
        let mut open = vec![at];
        while let Some(at) = open.pop() {
            if tag != "replicate" || ["body", "joint", "freejoint"].contains(&self.source.at(at).tag.as_str()) {
                let what = format!("<{tag}> makes bodies, expected them written out");
                let help = "write them out: python -c \"import mujoco; m = mujoco.MjModel.from_xml_path('robot.xml'); \
                            mujoco.mj_saveLastXML('whole.xml', m)\"";
                return Err(RobotError::new(self.source.place(at), what, help));
            }
            open.extend(&self.source.at(at).children);
        }
        Ok(())
    }
}

impl Found {
    /// The body that is the root link, and what was left out for it; none where the world is.
    fn root(&self, source: &Source) -> (Option<usize>, Vec<String>) {
        let tops = || (0..self.bodies.len()).filter(|at| self.bodies[*at].parent.is_none());
        let moving: Vec<usize> = tops().filter(|at| self.bodies[*at].moves).collect();
        let mut notes = Vec::new();
        // A body that is itself hinged to the world moves against a root link.
        let &[root] = &moving[..] else { return (None, notes) };
        if self.bodies[root].axes.iter().any(|axis| axis.kind.moves()) {
            return (None, notes);
        }
        for at in tops().filter(|at| *at != root) {
            notes.push(format!(
                "{}: it has no joint beside the robot's, left out",
                source.place(self.bodies[at].element)
            ));
        }
        if self.bodies[root].frame != Isometry3::identity() {
            notes.push(format!("{}: where it stands in the world is left out", self.bodies[root].name));
        }
        (Some(root), notes)
    }

    /// The joints between the bodies below the root, and the coordinate of each at which it was drawn.
    fn joints(&mut self, source: &Source, root: Option<usize>) -> Result<(Vec<RobotJoint>, Vec<f64>), RobotError> {
        let mut names = Names::of(&self.bodies);
        let (mut joints, mut references): (Vec<RobotJoint>, Vec<f64>) = (Vec::new(), Vec::new());
        // The joint that moves each body, and whether the body is the robot's.
        let mut mover: Vec<Option<usize>> = vec![None; self.bodies.len()];
        let mut kept: Vec<bool> = vec![false; self.bodies.len()];
        for at in 0..self.bodies.len() {
            let parent = self.bodies[at].parent;
            kept[at] = Some(at) == root || parent.map_or(root.is_none(), |parent| kept[parent]);
            if !kept[at] {
                continue;
            }
            let is_root = Some(at) == root;
            let axes = std::mem::take(&mut self.bodies[at].axes);
            let body = &self.bodies[at];
            let mut notes = body.notes.clone();
            let (mut carrier, mut base) = (
                parent.and_then(|parent| mover[parent]),
                match parent {
                    Some(parent) => self.bodies[parent].name.clone(),
                    None => WORLD.to_owned(),
                },
            );
            // Frame of the next joint in that of the one before.
            let mut origin = body.frame;
            let movable: Vec<Axis> = joint::of_one_coordinate(source, axes, parent.is_none(), &mut notes)?;
            if is_root {
                continue;
            }
            let last = movable.len();
            let centre = source.children(body.element, "inertial").first().copied();
            let centre = centre.and_then(|at| source.exactly::<3>(at, "pos").ok().flatten()).map(Vector3::from);
            let shift = movable.last().map(|axis| axis.place).filter(|place| *place != Vector3::zeros());
            let fixed = |base: String, name: String, origin, carrier| RobotJoint {
                name,
                line: source.at(body.element).line,
                motion: Motion::Fixed,
                kind: "fixed".to_owned(),
                base,
                child: body.name.clone(),
                centre,
                parent: carrier,
                origin,
                axis: Vector3::x(),
                lower: None,
                upper: None,
                velocity: None,
                mimic: None,
                notes: Vec::new(),
            };
            if last == 0 {
                joints.push(RobotJoint { notes, ..fixed(base, names.free(&body.name), origin, carrier) });
                references.push(0.0);
                mover[at] = Some(joints.len() - 1);
                continue;
            }
            for (index, axis) in movable.into_iter().enumerate() {
                let name = match source.get(axis.element, "name").filter(|name| !name.is_empty()) {
                    Some(name) => names.own(source, axis.element, name)?,
                    None => names.free(&format!("{}_joint", body.name)),
                };
                let ends = index + 1 == last && shift.is_none();
                let child = if ends { body.name.clone() } else { format!("{}/{name}", body.name) };
                let to = Translation3::from(axis.place);
                let origin_here = origin * to * axis.back();
                origin = Isometry3::from_parts(to.inverse(), nalgebra::UnitQuaternion::identity());
                references.push(axis.reference);
                joints.push(RobotJoint {
                    motion: axis.kind.motion(axis.bounds.is_some()),
                    kind: axis.kind.name().to_owned(),
                    axis: axis.axis,
                    lower: axis.bounds.map(|[lower, _]| lower),
                    upper: axis.bounds.map(|[_, upper]| upper),
                    line: source.at(axis.element).line,
                    child: child.clone(),
                    centre: centre.filter(|_| ends),
                    notes: axis
                        .notes
                        .into_iter()
                        .chain(notes.drain(..))
                        .map(|note| format!("{name}: {note}"))
                        .collect(),
                    ..fixed(base, name, origin_here, carrier)
                });
                (carrier, base) = (Some(joints.len() - 1), child);
            }
            if shift.is_some() {
                joints.push(fixed(base, names.free(&format!("{}_frame", body.name)), origin, carrier));
                references.push(0.0);
                carrier = Some(joints.len() - 1);
            }
            mover[at] = carrier;
        }
        Ok((joints, references))
    }
}

/// Names of joints, each once.
struct Names {
    taken: HashSet<String>,
    /// Names that the file gives to joints: ours keep clear of them.
    theirs: HashSet<String>,
}

impl Names {
    fn of(bodies: &[Body]) -> Self {
        let theirs = bodies.iter().flat_map(|body| &body.axes).filter_map(|axis| axis.name.clone()).collect();
        Self { taken: HashSet::new(), theirs }
    }

    fn own(&mut self, source: &Source, element: usize, name: &str) -> Result<String, RobotError> {
        if !self.taken.insert(name.to_owned()) {
            let what = format!("the name '{name}' is taken by another joint, expected one of its own");
            return Err(RobotError::new(source.place(element), what, "rename one of the two"));
        }
        Ok(name.to_owned())
    }

    fn free(&mut self, wish: &str) -> String {
        let free = |name: &String| !self.taken.contains(name) && !self.theirs.contains(name);
        let name = (1..).map(|n| if n == 1 { wish.to_owned() } else { format!("{wish}{n}") }).find(free);
        let name = name.unwrap_or_default();
        self.taken.insert(name.clone());
        name
    }
}
