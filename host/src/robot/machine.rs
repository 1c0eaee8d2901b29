//! A machine: servos in a tree, with limits and with the numbers that its servos take. What packs of robots hold.

use kinesic::Pack;
use kinesic::model::{Kind, LimitsMeta, LoadError};
use kinesic::rig::JointKind;
use kinesic::servo::{NO_SERVO, Servos, Unit};
use nalgebra::{UnitQuaternion, Vector3};

use super::bounds::{Assumed, limit};
use super::servos::{POSE, PoseEntry, ServoEntry, ServoTable};
use super::{Motion, Robot, RobotError};
use crate::clip::{Joint, Skeleton};
use crate::limit::{JointLimit, LimitsModel};
use crate::pack::{PackWriter, Provenance};
use crate::rig::{MAX_JOINTS, Rig, RigError};

/// Length of a bone that shows a leaf in pictures, m.
const TIP: f64 = 0.08;

/// One coordinate's servo.
#[derive(Clone, Debug, PartialEq)]
pub struct Servo {
    /// Name of its joint.
    pub name: String,
    /// Id on the bus, or channel; none for a virtual joint.
    pub id: Option<u16>,
    /// What its values are counted in.
    pub unit: Unit,
    /// Units per rad or m, negative where it turns the other way.
    pub scale: f32,
    /// Its value where the coordinate is 0.
    pub zero: f32,
}

/// A machine that stands: every movable joint is one coordinate.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Name of the robot.
    pub name: String,
    /// Joint 0 is the base, which does not move.
    pub rig: Rig,
    /// What the coordinates may do.
    pub limits: LimitsModel,
    /// Of every coordinate, in order.
    pub servos: Vec<Servo>,
    /// What was assumed, one sentence each.
    pub notes: Vec<String>,
}

/// What stands in where neither description nor table says it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Defaults {
    /// rad/s.
    pub velocity: Option<f64>,
    /// rad/s^2.
    pub acceleration: Option<f64>,
    /// rad/s^3; none for no limit.
    pub jerk: Option<f64>,
}

/// One joint on its way into a machine.
pub(super) struct Part {
    pub joint: Joint,
    /// Rotation in its parent's frame where the coordinate is 0.
    pub reference: UnitQuaternion<f64>,
    pub axis: Vector3<f64>,
    pub kind: JointKind,
    pub bounds: [Option<f64>; 2],
    pub speed: Option<f64>,
    pub servo: ServoEntry,
    /// A virtual joint has no servo.
    pub has_servo: bool,
}

impl Machine {
    /// A machine of all movable joints of a description. `table` says what their servos are, and gives tighter bounds; it may be empty.
    pub fn of_robot(robot: &Robot, table: &ServoTable, fps: f64, defaults: Defaults) -> Result<Self, RobotError> {
        let mut notes = robot.notes.clone();
        let mut parts = vec![base(robot.root().as_deref().unwrap_or("base"))];
        let mut of_joint = vec![0; robot.joints.len()];
        for at in robot.depth_first() {
            let joint = &robot.joints[at];
            let place = format!("line {}, joint '{}'", joint.line, joint.name);
            let kind = match joint.motion {
                Motion::Revolute | Motion::Continuous => JointKind::Hinge,
                Motion::Prismatic => JointKind::Slider,
                Motion::Fixed => JointKind::Fixed,
                Motion::Other(what) if joint.parent.is_none() => {
                    notes.push(format!("{place} is {what}: the base is taken to stand still"));
                    JointKind::Fixed
                }
                Motion::Other(what) => {
                    let help = "describe it as revolute or prismatic joints in a row";
                    return Err(RobotError::new(place, format!("found a joint that is {what}"), help));
                }
            };
            let follows = joint.mimic.as_ref().filter(|mimic| robot.find(&mimic.joint).is_some_and(|of| of != at));
            if let Some(mimic) = follows {
                notes.push(format!("{}: follows '{}', and has no coordinate of its own", joint.name, mimic.joint));
            } else if joint.mimic.is_some() {
                notes
                    .push(format!("{}: follows a joint that is not there, and is taken to move by itself", joint.name));
            }
            let kind = if follows.is_some() { JointKind::Fixed } else { kind };
            let parent = joint.parent.map_or(0, |parent| of_joint[parent]);
            of_joint[at] = parts.len();
            notes.extend(joint.notes.iter().cloned());
            let known = table.servos.iter().find(|servo| servo.name == joint.name);
            if let (Some(_), JointKind::Fixed) = (known, kind) {
                let what = "found a joint that does not move by itself, expected one that a servo turns";
                return Err(RobotError::new(format!("[[servo]] '{}'", joint.name), what, "take it out of the table"));
            }
            notes.extend(known.and_then(unused));
            let limited = joint.motion != Motion::Continuous;
            parts.push(Part {
                joint: Joint {
                    name: joint.name.clone(),
                    parent: Some(parent),
                    offset: joint.origin.translation.vector,
                    end: None,
                },
                reference: joint.origin.rotation,
                axis: joint.axis,
                kind,
                bounds: [joint.lower.filter(|_| limited), joint.upper.filter(|_| limited)],
                speed: joint.velocity.filter(|speed| *speed > 0.0 && *speed < 1e4),
                servo: known.cloned().unwrap_or_else(|| ServoEntry::named(&joint.name)),
                has_servo: true,
            });
        }
        if let Some(unknown) = table.servos.iter().find(|servo| robot.find(&servo.name).is_none()) {
            let names = robot.joints.iter().map(|joint| joint.name.as_str());
            let near = crate::clip::map::nearest(&unknown.name, names);
            let near = near.map_or(String::new(), |near| format!("; did you mean '{near}'?"));
            let what = format!("the robot has no joint of this name{near}");
            return Err(RobotError::new(
                format!("[[servo]] '{}'", unknown.name),
                what,
                "kinesic robot show lists them",
            ));
        }
        let parts = folded(parts);
        let name = table.name.clone().unwrap_or_else(|| robot.name.clone());
        Self::build(&name, parts, &table.poses, fps, defaults, notes)
    }

    /// A machine without a description: the servos of a table.
    pub fn of_table(table: &ServoTable, fps: f64, defaults: Defaults) -> Result<Self, RobotError> {
        let mut parts = vec![base("base")];
        let mut notes = Vec::new();
        for (index, servo) in table.servos.iter().enumerate() {
            let place = format!("[[servo]] '{}'", servo.name);
            let Some(unit) = servo.unit else {
                let help = "write unit = \"deg\", or rad, m, mm, ticks, us";
                return Err(RobotError::new(place, "found no unit", help));
            };
            let parent = match &servo.parent {
                None => 0,
                Some(name) => {
                    1 + table.servos[..index].iter().position(|other| other.name == *name).ok_or_else(|| {
                        let what = format!("parent: found '{name}', expected a servo that comes before this one");
                        RobotError::new(&place, what, "list servos from the base outwards")
                    })?
                }
            };
            let slider = matches!(unit, Unit::Metres | Unit::Millimetres);
            // Side by side where nobody says where they are.
            let beside = if parent == 0 { Vector3::x() * 0.15 * index as f64 } else { Vector3::z() * 0.1 };
            parts.push(Part {
                joint: Joint {
                    name: servo.name.clone(),
                    parent: Some(parent),
                    offset: servo.offset.unwrap_or(beside),
                    end: None,
                },
                reference: UnitQuaternion::identity(),
                axis: servo.axis.unwrap_or_else(Vector3::z),
                kind: if slider { JointKind::Slider } else { JointKind::Hinge },
                bounds: [None, None],
                speed: None,
                servo: servo.clone(),
                has_servo: true,
            });
        }
        if table.servos.iter().any(|servo| servo.axis.is_none()) {
            notes.push(
                "servos without an axis are drawn turning about Z: pictures show angles, not the robot".to_owned(),
            );
        }
        let name = table.name.as_deref().unwrap_or("robot");
        Self::build(name, parts, &table.poses, fps, defaults, notes)
    }

    fn build(
        name: &str,
        mut parts: Vec<Part>,
        poses: &[PoseEntry],
        fps: f64,
        defaults: Defaults,
        mut notes: Vec<String>,
    ) -> Result<Self, RobotError> {
        poses.iter().for_each(|pose| virtual_joints(&mut parts, pose));
        named_once(&parts)?;
        if parts.iter().all(|part| part.kind == JointKind::Fixed) {
            return Err(RobotError::new("the robot", "found no joint that moves", "is this the right file?"));
        }
        if parts.len() > MAX_JOINTS {
            let what = format!("found {} joints, at most {MAX_JOINTS} are supported", parts.len());
            return Err(RobotError::new("the robot", what, "take fingers out of the description"));
        }
        let bare: Vec<bool> =
            (0..parts.len()).map(|at| parts.iter().all(|part| part.joint.parent != Some(at))).collect();
        for (part, bare) in parts.iter_mut().zip(bare) {
            if bare {
                let across = if part.axis.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
                part.joint.end = Some(across.cross(&part.axis).normalize() * TIP);
            }
        }
        let (mut joints, mut servos, mut assumed) = (Vec::new(), Vec::new(), Assumed::default());
        for part in &parts {
            let limit = limit(part, fps, defaults, &mut assumed)?;
            if part.kind != JointKind::Fixed {
                let slider = part.kind == JointKind::Slider;
                let otherwise = if slider { Unit::Metres } else { Unit::Radians };
                servos.push(Servo {
                    name: part.joint.name.clone(),
                    id: part.servo.id,
                    unit: part.servo.unit.unwrap_or(otherwise),
                    scale: part.servo.scale(slider)? as f32,
                    zero: part.servo.zero as f32,
                });
            }
            joints.push(limit);
        }
        notes.extend(assumed.notes());
        numbered(&parts, &mut servos, &mut notes);
        let skeleton = Skeleton { joints: parts.into_iter().map(|part| part.joint).collect() };
        let coordinates: Vec<_> = joints.iter().map(|limit: &JointLimit| limit.coordinates).collect();
        let refused = |error: String| RobotError::new("the robot", error, "check bounds, rest and rates of its joints");
        let rig = Rig::machine(&skeleton, &coordinates).map_err(|error| refused(error.to_string()))?;
        let meta = LimitsMeta::default();
        let height = LimitsModel::standing(&rig, &meta);
        let limits = LimitsModel { name: name.to_owned(), frame_rate: fps, meta, height, joints };
        limits.tables(&rig).map_err(|error| refused(error.to_string()))?;
        Ok(Self { name: name.to_owned(), rig, limits, servos, notes })
    }

    /// The machine of a pack; `None` for a pack of a body.
    pub fn from_pack(pack: &Pack) -> Result<Option<Self>, RigError> {
        let Ok(table) = Servos::load(pack) else { return Ok(None) };
        let (rig, limits, count) = (Rig::from_pack(pack)?, LimitsModel::from_pack(pack)?, table.coordinates());
        let units = pack.slice::<u16>("servo/units", count)?;
        // A machine stands, and every joint that moves is one servo: a body's pack may not say that it has servos.
        let single = rig.frames().places().filter(|(kind, _)| kind.coordinates() == 1).count();
        if single == 0 || single != count {
            let refused = LoadError::Shape { tensor: "servo/ids", found: count, expected: single };
            return Err(RigError::Refused(refused));
        }
        let (scale, zero) = (pack.slice::<f32>("servo/scale", count)?, pack.slice::<f32>("servo/zero", count)?);
        let moving =
            rig.skeleton.joints.iter().zip(rig.frames().places()).filter(|(_, (kind, _))| *kind != JointKind::Fixed);
        let servo = |(joint, (_, first)): (&Joint, (JointKind, usize))| Servo {
            name: joint.name.clone(),
            id: table.command(first, 0.0).map(|command| command.id),
            // The device's view has checked it.
            unit: Unit::from_code(units[first]).unwrap_or(Unit::Radians),
            scale: scale[first],
            zero: zero[first],
        };
        let servos = moving.map(servo).collect();
        Ok(Some(Self { name: limits.name.clone(), rig, limits, servos, notes: Vec::new() }))
    }

    /// A pack of this machine: its rig, its limits and its servos, beside the models of `base` if there is one.
    pub fn pack(&self, base: Option<&Pack>, provenance: &Provenance) -> Result<Vec<u8>, LoadError> {
        let tables = self.limits.tables(&self.rig)?;
        let metadata = base.map(Pack::metadata);
        let (kind, name) = metadata.map_or((Kind::Limits, self.name.as_str()), |data| (Kind::Style, data.name));
        let rate = metadata.map_or(self.limits.frame_rate as f32, |data| data.frame_rate);
        let mut pack = PackWriter::new(kind, name, rate);
        self.rig.write(&mut pack);
        if let Some(base) = base {
            pack.copy_models(base)?;
        }
        self.limits.write(&tables, &mut pack);
        let column = |of: fn(&Servo) -> f32| self.servos.iter().map(of).collect::<Vec<f32>>();
        let ids: Vec<u16> = self.servos.iter().map(|servo| servo.id.unwrap_or(NO_SERVO)).collect();
        let units: Vec<u16> = self.servos.iter().map(|servo| servo.unit as u16).collect();
        pack.u16s("servo/ids", 1, &ids);
        pack.u16s("servo/units", 1, &units);
        pack.f32s("servo/scale", 1, &column(|servo| servo.scale));
        pack.f32s("servo/zero", 1, &column(|servo| servo.zero));
        Ok(pack.finish(provenance))
    }

    /// Least and greatest value of every coordinate, rad or m.
    pub fn ranges(&self) -> Vec<[f64; 2]> {
        let moving = self.limits.joints.iter().filter(|joint| joint.count() > 0);
        moving.map(|joint| [f64::from(joint.lower[0]), f64::from(joint.upper[0])]).collect()
    }
}

/// What stands on the table, Z up as robots are described.
fn base(name: &str) -> Part {
    Part {
        joint: Joint { name: name.to_owned(), parent: None, offset: Vector3::zeros(), end: None },
        reference: UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -std::f64::consts::FRAC_PI_2),
        axis: Vector3::z(),
        kind: JointKind::Fixed,
        bounds: [None, None],
        speed: None,
        servo: ServoEntry::named(name),
        has_servo: false,
    }
}

/// Joints that do not move become part of what carries them. Followers stay: something may hang on them.
fn folded(parts: Vec<Part>) -> Vec<Part> {
    let count = parts.len();
    let mut kept: Vec<Part> = Vec::with_capacity(count);
    // Of every part: which kept part carries what hangs on it, and where it is on that.
    let mut at: Vec<(usize, nalgebra::Isometry3<f64>)> = Vec::with_capacity(count);
    for mut part in parts {
        let Some(parent) = part.joint.parent else {
            at.push((0, nalgebra::Isometry3::identity()));
            kept.push(part);
            continue;
        };
        let (carrier, place) = at[parent];
        let own = place * nalgebra::Isometry3::from_parts(part.joint.offset.into(), part.reference);
        if part.kind == JointKind::Fixed {
            at.push((carrier, own));
            continue;
        }
        (part.joint.parent, part.joint.offset, part.reference) = (Some(carrier), own.translation.vector, own.rotation);
        at.push((kept.len(), nalgebra::Isometry3::identity()));
        kept.push(part);
    }
    kept
}

/// Six joints in a row: `R = Rz(yaw) Ry(pitch) Rx(roll)`, in the base's frame, Z up.
fn virtual_joints(parts: &mut Vec<Part>, pose: &PoseEntry) {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    // Lengths first, then yaw, pitch, roll: the order in which they turn.
    for coordinate in [0, 1, 2, 5, 4, 3] {
        let slider = coordinate < 3;
        let parent = if coordinate == 0 { 0 } else { parts.len() - 1 };
        let axis = axes[coordinate % 3];
        let mut servo = ServoEntry::named(&pose.name);
        (servo.speed, servo.acceleration, servo.jerk) = (pose.speed, pose.acceleration, pose.jerk);
        parts.push(Part {
            joint: Joint {
                name: format!("{}_{}", pose.name, POSE[coordinate]),
                parent: Some(parent),
                offset: Vector3::zeros(),
                end: None,
            },
            reference: UnitQuaternion::identity(),
            axis,
            kind: if slider { JointKind::Slider } else { JointKind::Hinge },
            bounds: [Some(pose.min[coordinate]), Some(pose.max[coordinate])],
            speed: pose.speed,
            servo,
            has_servo: false,
        });
    }
}

/// Says which keys of a servo mean nothing beside a description.
fn unused(servo: &ServoEntry) -> Option<String> {
    let given = [servo.parent.is_some(), servo.offset.is_some(), servo.axis.is_some()];
    let names = ["parent", "offset", "axis"].into_iter().zip(given).filter(|(_, given)| *given);
    let names: Vec<&str> = names.map(|(name, _)| name).collect();
    let list = names.join(", ");
    (!names.is_empty()).then(|| format!("{}: {list} of its servo: not used, the description says it", servo.name))
}

/// Refuses two coordinates of one name: a pose's may be those of a joint, or of another pose.
fn named_once(parts: &[Part]) -> Result<(), RobotError> {
    let moving = || parts.iter().filter(|part| part.kind != JointKind::Fixed);
    let mut known = std::collections::HashSet::new();
    let Some(twin) = moving().find(|part| !known.insert(part.joint.name.as_str())) else { return Ok(()) };
    let other = moving().find(|part| part.joint.name == twin.joint.name).filter(|part| !part.has_servo);
    let whose = match other {
        Some(pose) => format!("a coordinate of another [[pose]] '{}'", pose.servo.name),
        None => "the name of a joint".to_owned(),
    };
    let what = format!("found '{}', which is {whose} already, expected names of its own", twin.joint.name);
    Err(RobotError::new(format!("[[pose]] '{}'", twin.servo.name), what, "give the pose another name"))
}

/// Servos without an id are numbered in order, past those that have one.
fn numbered(parts: &[Part], servos: &mut [Servo], notes: &mut Vec<String>) {
    let used: Vec<u16> = servos.iter().filter_map(|servo| servo.id).collect();
    let mut free = (0..NO_SERVO).filter(|id| !used.contains(id));
    let moving = parts.iter().filter(|part| part.kind != JointKind::Fixed);
    let mut given = 0;
    for (servo, part) in servos.iter_mut().zip(moving) {
        if servo.id.is_none() && part.has_servo {
            servo.id = free.next();
            given += 1;
        }
    }
    if given > 0 {
        notes.push(format!(
            "{given} {}: give ids in a table of servos (--servos)",
            if given == 1 {
                "servo has no id, and gets the next one"
            } else {
                "servos have no id, and are numbered in order"
            }
        ));
    }
}
