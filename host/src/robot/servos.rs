//! The table of servos (TOML): what a description of the robot does not say, or all there is where there is none.

use kinesic::servo::Unit;
use nalgebra::Vector3;
use toml::{Table, Value};

use super::RobotError;
use super::keys::{known, number, table};
use crate::moves::{UNITS, unit_name};

/// What the table says of one servo. Numbers are in the servo's own unit.
#[derive(Clone, Debug, PartialEq)]
pub struct ServoEntry {
    /// Name of the joint that it turns.
    pub name: String,
    /// Its id on the bus, or its channel.
    pub id: Option<u16>,
    /// What its values are counted in.
    pub unit: Option<Unit>,
    /// Ticks or microseconds in a whole turn.
    pub per_turn: Option<f64>,
    /// Its value where the joint's angle or length is 0.
    pub zero: f64,
    /// -1 for one that counts the other way.
    pub sign: f64,
    /// Least value.
    pub min: Option<f64>,
    /// Greatest value.
    pub max: Option<f64>,
    /// Largest speed, per second.
    pub speed: Option<f64>,
    /// Largest acceleration, per second squared.
    pub acceleration: Option<f64>,
    /// Largest jerk, per second cubed; 0 for no limit.
    pub jerk: Option<f64>,
    /// Value at rest.
    pub rest: Option<f64>,
    /// The joint that carries it; the base unless given. Only for a robot without a description.
    pub parent: Option<String>,
    /// Where it sits on that joint, m; Z up, X forward.
    pub offset: Option<Vector3<f64>>,
    /// The axis about which it turns, or along which it slides.
    pub axis: Option<Vector3<f64>>,
}

/// A virtual joint of six coordinates: a head on a platform whose legs its own firmware solves.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseEntry {
    /// Its name; the coordinates are `NAME_x`, `NAME_y`, `NAME_z` (m), `NAME_roll`, `NAME_pitch`, `NAME_yaw` (rad).
    pub name: String,
    /// Least values, in that order.
    pub min: [f64; 6],
    /// Greatest values.
    pub max: [f64; 6],
    /// Largest speeds, m/s and rad/s.
    pub speed: Option<f64>,
    /// Largest accelerations, m/s^2 and rad/s^2.
    pub acceleration: Option<f64>,
    /// Largest jerks, m/s^3 and rad/s^3; 0 for no limit.
    pub jerk: Option<f64>,
}

/// The names of a pose's coordinates, in order. The rotation is `Rz(yaw) Ry(pitch) Rx(roll)`.
pub const POSE: [&str; 6] = ["x", "y", "z", "roll", "pitch", "yaw"];

/// A whole table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ServoTable {
    /// Name of the robot.
    pub name: Option<String>,
    /// The servos, in the file's order.
    pub servos: Vec<ServoEntry>,
    /// The poses.
    pub poses: Vec<PoseEntry>,
}

const KEYS: [&str; 3] = ["name", "servo", "pose"];
const SERVO: [&str; 15] = [
    "name",
    "id",
    "unit",
    "per_turn",
    "zero",
    "sign",
    "min",
    "max",
    "speed",
    "acceleration",
    "jerk",
    "rest",
    "parent",
    "offset",
    "axis",
];
const POSE_KEYS: [&str; 6] = ["name", "min", "max", "speed", "acceleration", "jerk"];
const SAMPLE: &str = "as in  [[servo]]  name = \"pan\"  id = 1  unit = \"deg\"  min = -90  max = 90";
const POSE_SAMPLE: &str = "as in  [[pose]]  name = \"head\"  min = [-0.02, -0.02, -0.02, -0.7, -0.7, -3.1]  max = [0.02, 0.02, 0.02, 0.7, 0.7, 3.1]";

/// A pose goes no farther, m and rad: a little more than a turn.
const FARTHEST: [f64; 2] = [10.0, 7.0];

impl ServoTable {
    /// Reads the text of a table.
    ///
    /// ```
    /// let table = kinesic_host::robot::ServoTable::parse(r#"
    ///     name = "desk robot"
    ///     [[servo]]
    ///     name = "pan"
    ///     id = 1
    ///     unit = "ticks"
    ///     per_turn = 4096
    ///     zero = 2048
    ///     min = 1024
    ///     max = 3072
    /// "#)?;
    /// assert_eq!(table.servos[0].id, Some(1));
    /// # Ok::<(), kinesic_host::robot::RobotError>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self, RobotError> {
        let table = table(text, "the table of servos", SAMPLE)?;
        known("the table of servos", &table, &KEYS)?;
        let name = match table.get("name") {
            None => None,
            Some(Value::String(name)) => Some(name.clone()),
            Some(other) => {
                return Err(RobotError::new(
                    "name",
                    format!("found {other}, expected a text"),
                    "as in  name = \"desk robot\"",
                ));
            }
        };
        let servos = entries(&table, "servo")?.into_iter().map(|(place, table)| servo(&place, table));
        let poses = entries(&table, "pose")?.into_iter().map(|(place, table)| pose(&place, table));
        let found = Self { name, servos: servos.collect::<Result<_, _>>()?, poses: poses.collect::<Result<_, _>>()? };
        if found.servos.is_empty() && found.poses.is_empty() {
            return Err(RobotError::new("the table of servos", "found no [[servo]] and no [[pose]]", SAMPLE));
        }
        found.check_twice()?;
        Ok(found)
    }

    fn check_twice(&self) -> Result<(), RobotError> {
        for (index, servo) in self.servos.iter().enumerate() {
            let place = || format!("[[servo]] '{}'", servo.name);
            if self.servos[..index].iter().any(|other| other.name == servo.name) {
                return Err(RobotError::new(place(), "found a second servo of this name", "name each once"));
            }
            let twin = self.servos[..index].iter().find(|other| other.id.is_some() && other.id == servo.id);
            if let Some(other) = twin {
                let what = format!("found the id {} again, which '{}' has", servo.id.unwrap_or_default(), other.name);
                return Err(RobotError::new(place(), what, "two servos with one id cannot be told apart"));
            }
        }
        Ok(())
    }
}

/// The tables of an array, each with its place for messages.
fn entries<'t>(table: &'t Table, key: &str) -> Result<Vec<(String, &'t Table)>, RobotError> {
    let sample = if key == "pose" { POSE_SAMPLE } else { SAMPLE };
    let list = match table.get(key) {
        None => return Ok(Vec::new()),
        Some(Value::Array(list)) => list,
        Some(other) => {
            return Err(RobotError::new(key, format!("found {other}, expected [[{key}]]"), sample));
        }
    };
    let entry = |(index, value): (usize, &'t Value)| match value {
        Value::Table(entry) => {
            let number = format!("[[{key}]] {}", index + 1);
            let name = entry.get("name").and_then(Value::as_str);
            Ok((name.map_or(number, |name| format!("[[{key}]] '{name}'")), entry))
        }
        other => Err(RobotError::new(key, format!("found {other}, expected [[{key}]]"), sample)),
    };
    list.iter().enumerate().map(entry).collect()
}

/// Reads keys of one entry.
struct Keys<'t> {
    place: &'t str,
    table: &'t Table,
}

impl Keys<'_> {
    fn refuse<T>(&self, key: &str, expected: &str) -> Result<T, RobotError> {
        let found = self.table.get(key).map_or_else(|| "nothing".to_owned(), Value::to_string);
        let what = format!("found {found}, expected {expected}");
        Err(RobotError::new(format!("{}, {key}", self.place), what, self.sample(key)))
    }

    /// The key as it is written.
    fn sample(&self, key: &str) -> String {
        let pose = self.place.starts_with("[[pose]]");
        let value = match key {
            "name" if pose => return POSE_SAMPLE.to_owned(),
            "min" | "max" if pose => return POSE_SAMPLE.to_owned(),
            "speed" | "acceleration" | "jerk" if pose => "2.0, in m and rad, per second",
            "name" => return SAMPLE.to_owned(),
            "id" => "1",
            "unit" => "\"deg\"",
            "per_turn" => "4096",
            "zero" => "2048, its value where the joint is at 0",
            "sign" => "-1, where it counts the other way",
            "min" => "-90, in its own unit",
            "max" => "90, in its own unit",
            "speed" => "300, in its own unit a second",
            "acceleration" => "2000, in its own unit a second squared",
            "jerk" => "40000, in its own unit a second cubed; 0 for no limit",
            "rest" => "0, in its own unit",
            "parent" => "\"pan\", the name of a servo before it",
            "offset" => "[0, 0, 0.1], in m, Z up",
            "axis" => "[0, 1, 0], Z up",
            _ => return SAMPLE.to_owned(),
        };
        format!("as in  {key} = {value}")
    }

    fn number(&self, key: &str) -> Result<Option<f64>, RobotError> {
        let Some(value) = self.table.get(key) else { return Ok(None) };
        match number(value) {
            Some(x) => Ok(Some(x)),
            None => self.refuse(key, "a number from -1e9 to 1e9"),
        }
    }

    fn positive(&self, key: &str) -> Result<Option<f64>, RobotError> {
        self.above(key, |x| x > 0.0, "a number above 0, at most 1e9")
    }

    /// 0 stands for no limit.
    fn jerk(&self) -> Result<Option<f64>, RobotError> {
        self.above("jerk", |x| x >= 0.0, "0 for no limit, or a number above 0, at most 1e9")
    }

    fn above(&self, key: &str, allowed: fn(f64) -> bool, expected: &str) -> Result<Option<f64>, RobotError> {
        let Some(value) = self.table.get(key) else { return Ok(None) };
        match number(value) {
            Some(x) if allowed(x) => Ok(Some(x)),
            _ => self.refuse(key, expected),
        }
    }

    fn text(&self, key: &str) -> Result<Option<String>, RobotError> {
        match self.table.get(key) {
            None => Ok(None),
            Some(Value::String(text)) if !text.trim().is_empty() => Ok(Some(text.trim().to_owned())),
            Some(_) => self.refuse(key, "a name"),
        }
    }

    fn six(&self, key: &str) -> Result<[f64; 6], RobotError> {
        let expected = "six numbers: x, y, z in m, roll, pitch, yaw in rad";
        let found = self.numbers(key).or_else(|_| self.refuse(key, expected))?;
        found.map_or_else(|| self.refuse(key, expected), Ok)
    }

    fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>, RobotError> {
        let Some(value) = self.table.get(key) else { return Ok(None) };
        let all: Option<Vec<f64>> = value.as_array().and_then(|list| list.iter().map(number).collect());
        match all.and_then(|all| <[f64; N]>::try_from(all).ok()) {
            Some(all) => Ok(Some(all)),
            None => self.refuse(key, &format!("{N} numbers")),
        }
    }
}

fn servo(place: &str, table: &Table) -> Result<ServoEntry, RobotError> {
    known(place, table, &SERVO)?;
    let keys = Keys { place, table };
    let Some(name) = keys.text("name")? else { return keys.refuse("name", "the name of a joint") };
    let id = match keys.number("id")? {
        None => None,
        Some(id) if (0.0..f64::from(u16::MAX)).contains(&id) && id.fract() == 0.0 => Some(id as u16),
        Some(_) => return keys.refuse("id", "a whole number from 0 to 65534"),
    };
    let unit = match keys.text("unit")? {
        None => None,
        Some(text) => match UNITS.iter().find(|(name, _)| *name == text) {
            Some((_, unit)) => Some(*unit),
            None => return keys.refuse("unit", "rad, deg, m, mm, ticks or us"),
        },
    };
    let per_turn = keys.positive("per_turn")?;
    if unit.is_some_and(Unit::is_whole) && per_turn.is_none() {
        return keys.refuse("per_turn", "the ticks or microseconds of a whole turn, as in 4096");
    }
    if per_turn.is_some() && !unit.is_some_and(Unit::is_whole) {
        let unit = unit.map_or_else(|| "no unit".to_owned(), |unit| format!("unit = \"{}\"", unit_name(unit)));
        return keys.refuse("per_turn", &format!("it with unit = \"ticks\" or \"us\" only, and here is {unit}"));
    }
    let sign = match keys.number("sign")? {
        None => 1.0,
        Some(sign) if sign == 1.0 || sign == -1.0 => sign,
        Some(_) => return keys.refuse("sign", "1 or -1"),
    };
    let (min, max) = (keys.number("min")?, keys.number("max")?);
    if let (Some(min), Some(max)) = (min, max)
        && min >= max
    {
        return keys.refuse("max", &format!("more than min, which is {min}"));
    }
    let axis = match keys.numbers::<3>("axis")? {
        None => None,
        Some(axis) => match Vector3::from(axis).try_normalize(1e-6) {
            Some(axis) => Some(axis),
            None => return keys.refuse("axis", "a direction"),
        },
    };
    Ok(ServoEntry {
        name,
        id,
        unit,
        per_turn,
        zero: keys.number("zero")?.unwrap_or(0.0),
        sign,
        min,
        max,
        speed: keys.positive("speed")?,
        acceleration: keys.positive("acceleration")?,
        jerk: keys.jerk()?,
        rest: keys.number("rest")?,
        parent: keys.text("parent")?,
        offset: keys.numbers::<3>("offset")?.map(Vector3::from),
        axis,
    })
}

fn pose(place: &str, table: &Table) -> Result<PoseEntry, RobotError> {
    known(place, table, &POSE_KEYS)?;
    let keys = Keys { place, table };
    let Some(name) = keys.text("name")? else { return keys.refuse("name", "a name") };
    let (min, max) = (keys.six("min")?, keys.six("max")?);
    if let Some(at) = (0..6).find(|at| min[*at] >= max[*at]) {
        return keys.refuse("max", &format!("more than min for {}", POSE[at]));
    }
    let far = |at: usize| FARTHEST[usize::from(at >= 3)];
    for (key, values) in [("min", min), ("max", max)] {
        if let Some(at) = (0..6).find(|at| values[*at].abs() > far(*at)) {
            let unit = if at < 3 { "m" } else { "rad" };
            let what = format!("found {} for {}, expected at most {} {unit}", values[at], POSE[at], far(at));
            return Err(RobotError::new(format!("{place}, {key}"), what, "lengths are in m, angles in rad"));
        }
    }
    Ok(PoseEntry {
        name,
        min,
        max,
        speed: keys.positive("speed")?,
        acceleration: keys.positive("acceleration")?,
        jerk: keys.jerk()?,
    })
}

impl ServoEntry {
    /// A servo of which nothing is known but its name.
    pub fn named(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            id: None,
            unit: None,
            per_turn: None,
            zero: 0.0,
            sign: 1.0,
            min: None,
            max: None,
            speed: None,
            acceleration: None,
            jerk: None,
            rest: None,
            parent: None,
            offset: None,
            axis: None,
        }
    }

    /// Units per rad or m; `slider` says which of the two.
    pub fn scale(&self, slider: bool) -> Result<f64, RobotError> {
        let unit = self.unit.unwrap_or(if slider { Unit::Metres } else { Unit::Radians });
        let turn = std::f64::consts::TAU;
        let size = match unit {
            Unit::Radians if !slider => 1.0,
            Unit::Degrees if !slider => 360.0 / turn,
            Unit::Metres if slider => 1.0,
            Unit::Millimetres if slider => 1000.0,
            // Of a slider: in a metre.
            Unit::Ticks | Unit::Microseconds => self.per_turn.unwrap_or(turn) / if slider { 1.0 } else { turn },
            _ => {
                let what = format!(
                    "found the unit {}, expected one of {}",
                    unit_name(unit),
                    if slider { "lengths: m, mm" } else { "angles: rad, deg" }
                );
                return Err(RobotError::new(format!("[[servo]] '{}'", self.name), what, "or ticks, us with per_turn"));
            }
        };
        Ok(self.sign * size)
    }
}
