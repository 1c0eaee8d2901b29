//! The links of a description.

use std::collections::HashMap;
use std::path::Path;

use kinesic::rig::JointKind;
use nalgebra::{Isometry3, Vector3};

use super::solid::thinned;
use super::{Drive, Link, Look, Solid, Way, mesh};
use crate::robot::shape::Form;
use crate::robot::{Machine, Motion, POSE, Robot, RobotError, RobotJoint};

/// Triangles of a robot at most: a page draws several robots, sixty times a second, without a graphics processor.
pub const TRIANGLES: usize = 4500;

/// What is larger, m, is in another unit.
const FAR: f64 = 20.0;

/// What a machine moves in a description that calls it otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Drives {
    /// A pose or a joint of the machine.
    pub name: String,
    /// The link that the pose moves, or the joint.
    pub what: String,
}

impl Look {
    /// The robot of a description, moved by a machine's coordinates. Meshes are files around `folder`; what of them cannot be read is noted.
    /// Loops are not kept: rods between a platform and its motors stand still. Refuses a description that lacks joints of the machine, and
    /// names that neither has.
    pub fn of_robot(machine: &Machine, robot: &Robot, folder: &Path, drives: &[Drives]) -> Result<Self, RobotError> {
        let plain = Self::plain(machine);
        let poses = poses(machine);
        let mut look = Self { links: Vec::new(), joints: vec![0; plain.joints.len()], notes: robot.notes.clone() };
        look.links.push(Link { solids: Vec::new(), ..plain.links[0].clone() });
        // What poses move comes first: links hang on it.
        let (mut first, mut last): (HashMap<&str, usize>, HashMap<&str, usize>) = (HashMap::new(), HashMap::new());
        for &(joint, pose) in &poses {
            first.entry(pose).or_insert(look.links.len());
            let parent = plain.links[joint].parent.map(|parent| look.joints[parent]);
            look.joints[joint] = look.links.len();
            look.links.push(Link { parent, solids: Vec::new(), ..plain.links[joint].clone() });
            last.insert(pose, look.joints[joint]);
        }
        let named = Named::new(machine, robot, &last, drives)?;
        for (pose, centre) in &named.centres {
            look.links[first[pose]].at.translation.vector += centre;
        }
        let mut place: HashMap<usize, usize> = HashMap::new();
        for at in robot.depth_first() {
            let joint = &robot.joints[at];
            let way = match joint.motion {
                Motion::Revolute | Motion::Continuous => Way::Turns,
                Motion::Prismatic => Way::Slides,
                Motion::Fixed | Motion::Other(_) => Way::Fixed,
            };
            let (parent, from, way) = match named.carried.get(&at) {
                Some((carrier, from)) => (*carrier, *from, Way::Fixed),
                None => (joint.parent.map_or(0, |parent| place[&parent]), joint.origin, way),
            };
            place.insert(at, look.links.len());
            look.links.push(Link {
                parent: Some(parent),
                at: from,
                way,
                axis: joint.axis,
                drive: None,
                solids: Vec::new(),
                tip: None,
            });
        }
        look.drive(machine, robot, &place, |joint| poses.iter().any(|(pose, _)| *pose == joint), &named.joints)?;
        look.shape(robot, folder, &place);
        for (pose, link) in last.into_iter().filter(|(pose, _)| !drives.iter().any(|one| one.name == *pose)) {
            look.links[link].solids.push(Solid::cuboid(&Vector3::repeat(0.05)));
            look.notes
                .push(format!("pose '{pose}' is drawn as a box: say which link it moves, with --drives {pose}=LINK"));
        }
        Ok(look.standing())
    }

    /// Gives links their coordinates: joints of the machine, and what follows them.
    fn drive(
        &mut self,
        machine: &Machine,
        robot: &Robot,
        place: &HashMap<usize, usize>,
        is_pose: impl Fn(usize) -> bool,
        renamed: &HashMap<&str, usize>,
    ) -> Result<(), RobotError> {
        let places: Vec<_> = machine.rig.frames().places().collect();
        let mut coordinates: HashMap<usize, usize> = HashMap::new();
        let mut missing = Vec::new();
        for (at, joint) in machine.rig.skeleton.joints.iter().enumerate().skip(1) {
            if is_pose(at) {
                continue;
            }
            let Some(own) = renamed.get(joint.name.as_str()).copied().or_else(|| robot.find(&joint.name)) else {
                missing.push(joint.name.as_str());
                continue;
            };
            let expected = match places[at].0 {
                JointKind::Slider => Way::Slides,
                JointKind::Hinge => Way::Turns,
                _ => Way::Fixed,
            };
            let found = &robot.joints[own];
            if expected != Way::Fixed && (self.links[place[&own]].way != expected || found.mimic.is_some()) {
                let kind = if found.mimic.is_some() { "follower" } else { found.kind.as_str() };
                let kinds = if expected == Way::Slides { "slider" } else { "hinge" };
                let what =
                    format!("found a joint of type {kind}, expected a {kinds} that moves by itself, as in the pack");
                let help = "give the description from which `kinesic robot import` made the pack";
                return Err(RobotError::new(format!("line {}, joint '{}'", found.line, found.name), what, help));
            }
            self.joints[at] = place[&own];
            if places[at].0.coordinates() > 0 {
                coordinates.insert(own, places[at].1);
            }
        }
        if !missing.is_empty() {
            let what = format!("it has no joint {}, expected all joints of the robot's pack", missing.join(", "));
            let help = format!(
                "where it calls them otherwise, say so: --drives {}=ITS-NAME; kinesic robot show lists its joints",
                missing[0]
            );
            return Err(RobotError::new(format!("robot '{}'", robot.name), what, help));
        }
        // What a value of 1 of each coordinate, and what none, makes of every joint: followers are linear.
        let value = |own: &dyn Fn(usize) -> f64| robot.followed(&(0..robot.joints.len()).map(own).collect::<Vec<_>>());
        let none = value(&|_| 0.0);
        for (joint, coordinate) in &coordinates {
            let one = value(&|at| f64::from(u8::from(at == *joint)));
            for (at, link) in place {
                let multiplier = one[*at] - none[*at];
                if multiplier != 0.0 {
                    self.links[*link].drive = Some(Drive { coordinate: *coordinate, multiplier, offset: none[*at] });
                }
            }
        }
        Ok(())
    }

    /// Gives links their solids.
    fn shape(&mut self, robot: &Robot, folder: &Path, place: &HashMap<usize, usize>) {
        let link_of: HashMap<&str, usize> =
            robot.joints.iter().enumerate().map(|(at, joint)| (joint.child.as_str(), place[&at])).collect();
        let root = robot.root();
        let mut solids: Vec<(usize, Solid)> = Vec::new();
        let (mut unread, mut why) = (Vec::new(), None);
        for shape in &robot.shapes {
            let at = match link_of.get(shape.link.as_str()) {
                Some(at) => *at,
                None if root.as_deref() == Some(&shape.link) => 0,
                // It is not the robot's.
                None => continue,
            };
            let parts = match &shape.form {
                Form::Cuboid(size) => vec![Solid::cuboid(size)],
                Form::Ellipsoid(half) => vec![Solid::ellipsoid(half)],
                Form::Cylinder(radius, length) => vec![Solid::cylinder(*radius, *length)],
                Form::Capsule(radius, length) => vec![Solid::capsule(*radius, *length)],
                Form::Mesh(file, scale) => mesh::read(file, scale, folder).unwrap_or_else(|error| {
                    unread.push(at);
                    why.get_or_insert(error);
                    Vec::new()
                }),
            };
            if parts.iter().any(|part| part.size() > FAR) {
                let help = "a mesh in mm takes scale=\"0.001 0.001 0.001\"";
                self.notes.push(format!("a part of '{}' is larger than {FAR} m: {help}", shape.link));
            }
            let own = |part: Solid| {
                let colour = shape.colour.or(part.colour);
                (at, part.placed(&shape.at).coloured(colour))
            };
            solids.extend(parts.into_iter().map(own));
        }
        let triangles: usize = solids.iter().map(|(_, solid)| solid.triangles.len()).sum();
        let (links, solids): (Vec<usize>, Vec<Solid>) = solids.into_iter().unzip();
        for (at, solid) in links.into_iter().zip(thinned(solids, TRIANGLES)) {
            self.links[at].solids.push(solid);
        }
        if let Some(why) = why {
            let count = unread.len();
            let meshes = if count == 1 { "1 mesh is".to_owned() } else { format!("{count} meshes are") };
            let first = if count == 1 { "" } else { "the first: " };
            self.notes.push(format!("{meshes} not drawn, bones stand in: {first}{why}"));
        }
        if triangles > TRIANGLES {
            self.notes.push(format!(
                "drawn with at most {TRIANGLES} of its {triangles} triangles: small parts lose their shape"
            ));
        }
        if self.links.iter().all(|link| link.solids.is_empty()) {
            if unread.is_empty() {
                self.notes.push("the description says nothing of how its links look: bones show them".to_owned());
            }
            unread = (0..self.links.len()).collect();
        }
        self.bones(&unread);
    }

    /// A bone from each of these links, if nothing else shows it, to all that hang on it.
    fn bones(&mut self, of: &[usize]) {
        let bare: Vec<bool> = self.links.iter().map(|link| link.solids.is_empty()).collect();
        for at in 1..self.links.len() {
            let (to, parent) = (self.links[at].at.translation.vector, self.links[at].parent);
            if let Some(parent) = parent.filter(|parent| of.contains(parent) && bare[*parent] && to.norm() > 1e-3) {
                self.links[parent].solids.push(Solid::bone(&to, 0.08 * to.norm()));
            }
        }
    }
}

/// What a caller says of names.
#[derive(Default)]
struct Named<'a> {
    /// Where poses turn, in the base's frame at 0, m.
    centres: Vec<(&'a str, Vector3<f64>)>,
    /// Joints whose link hangs on the last link of a pose, and its frame in that.
    carried: HashMap<usize, (usize, Isometry3<f64>)>,
    /// Joints of the machine and of the description.
    joints: HashMap<&'a str, usize>,
}

impl<'a> Named<'a> {
    /// `last`: every pose's last link.
    fn new(
        machine: &Machine,
        robot: &Robot,
        last: &HashMap<&str, usize>,
        drives: &'a [Drives],
    ) -> Result<Self, RobotError> {
        let mut named = Self::default();
        let zero = robot.frames();
        let names = |of: fn(&RobotJoint) -> &str| robot.joints.iter().map(of).collect::<Vec<_>>();
        let links = names(|joint| joint.child.as_str());
        for (at, Drives { name, what }) in drives.iter().enumerate() {
            let place = format!("{name}={what}");
            if drives[..at].iter().any(|before| before.name == *name) {
                return Err(RobotError::new(place, format!("'{name}' is given twice"), "give each name once"));
            }
            if let Some(carrier) = last.get(name.as_str()) {
                let link = known(&place, what, "link that a joint carries", &links)?;
                // A pose turns about the link's origin, with the axes of the base, and moves all that is fixed to the link.
                let centre = zero[link].translation;
                let moves = |joint: &usize| robot.joints[*joint].motion != Motion::Fixed;
                let whole = robot.chain(link).find(moves).unwrap_or(link);
                named.centres.push((name, centre.vector));
                named.carried.insert(whole, (*carrier, centre.inverse() * zero[whole]));
                continue;
            }
            let own = machine.rig.skeleton.joints.iter().map(|joint| joint.name.as_str());
            known(&place, name, "pose or joint of the pack", &own.chain(last.keys().copied()).collect::<Vec<_>>())?;
            // The link that a joint moves means the joint too.
            let moved = links.iter().position(|link| link == what);
            let joint = known(&place, what, "joint of the description", &names(|joint| joint.name.as_str()));
            named.joints.insert(name, joint.or_else(|error| moved.ok_or(error))?);
        }
        Ok(named)
    }
}

/// Joints of the rig that belong to poses, and the names of those.
fn poses(machine: &Machine) -> Vec<(usize, &str)> {
    let moving = machine.rig.frames().places().enumerate().filter(|(_, (kind, _))| kind.coordinates() > 0);
    let poses = moving.zip(&machine.servos).filter(|(_, servo)| servo.id.is_none());
    let name = |name: &'_ str| POSE.iter().find_map(|end| name.strip_suffix(end)?.strip_suffix('_').map(str::len));
    poses.filter_map(|((joint, _), servo)| Some((joint, &servo.name[..name(&servo.name)?]))).collect()
}

/// The index of a name.
fn known(place: &str, name: &str, kind: &str, names: &[&str]) -> Result<usize, RobotError> {
    names.iter().position(|known| *known == name).ok_or_else(|| {
        let near = crate::clip::map::nearest(name, names.iter().copied());
        let near = near.map_or(String::new(), |near| format!("; did you mean '{near}'?"));
        let what = format!("'{name}' is no {kind}{near}");
        RobotError::new(
            place,
            what,
            "`kinesic inspect` lists the joints of a pack, `kinesic robot show` those of a description",
        )
    })
}
