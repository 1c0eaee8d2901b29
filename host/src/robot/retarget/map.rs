//! The map: where each limb of a person begins and ends on a robot.

use nalgebra::Vector3;
use toml::{Table, Value};

use crate::clip::map::nearest;
use crate::robot::{Robot, RobotError};

/// A direction of a person that a robot can show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // L and R are the person's own sides; the rest is told by `Limb::means`.
pub enum Limb {
    Trunk,
    Shoulders,
    Gaze,
    Crown,
    LUpperArm,
    LForearm,
    LHand,
    RUpperArm,
    RForearm,
    RHand,
    LThigh,
    LShin,
    LFoot,
    RThigh,
    RShin,
    RFoot,
}

use Limb::*;

impl Limb {
    /// All of them.
    pub const ALL: [Limb; 16] = [
        Trunk, Shoulders, Gaze, Crown, LUpperArm, LForearm, LHand, RUpperArm, RForearm, RHand, LThigh, LShin, LFoot,
        RThigh, RShin, RFoot,
    ];

    /// Its name in a map.
    pub fn name(self) -> &'static str {
        const NAMES: [&str; 16] = [
            "trunk",
            "shoulders",
            "gaze",
            "crown",
            "l_upper_arm",
            "l_forearm",
            "l_hand",
            "r_upper_arm",
            "r_forearm",
            "r_hand",
            "l_thigh",
            "l_shin",
            "l_foot",
            "r_thigh",
            "r_shin",
            "r_foot",
        ];
        NAMES[self as usize]
    }

    /// The limb with this name.
    pub fn from_name(name: &str) -> Option<Limb> {
        Self::ALL.into_iter().find(|limb| limb.name() == name)
    }
}

/// The frame of the person that stands for the robot's root link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    /// The pelvis, as it leans and turns.
    Pelvis,
    /// Level, towards where the pelvis faces.
    Heading,
    /// The chest.
    Chest,
}

impl Base {
    const ALL: [(Base, &str); 3] = [(Base::Pelvis, "pelvis"), (Base::Heading, "heading"), (Base::Chest, "chest")];
}

/// Where a limb ends.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// At a joint or link.
    At(String),
    /// Nowhere: it is an axis of the frame in which it begins, 0 to 2, forwards or backwards.
    Axis(usize, f64),
}

/// One limb: the joint or link where it begins, and where it ends.
#[derive(Clone, Debug, PartialEq)]
pub struct LimbEntry {
    /// Which limb of the person.
    pub limb: Limb,
    /// Name of a joint or link of the robot.
    pub begin: String,
    /// See [`End`].
    pub end: End,
}

/// A whole map.
#[derive(Clone, Debug, PartialEq)]
pub struct LimbMap {
    /// Where the robot faces, and where up is, in its root link's frame.
    pub forward: Vector3<f64>,
    /// See `forward`.
    pub up: Vector3<f64>,
    /// What the root link goes with; else the pelvis for a robot with legs or a waist, and the chest for one without.
    pub base: Option<Base>,
    /// The limbs.
    pub limbs: Vec<LimbEntry>,
}

const AXES: [&str; 6] = ["x", "y", "z", "-x", "-y", "-z"];
const SAMPLE: &str =
    "as in  l_upper_arm = [\"left_shoulder_roll\", \"left_elbow\"]  or  gaze = [\"head\", \"x\"]  below [limbs]";

/// The axis with this name: its number, and its sign.
fn axis(word: &str) -> Option<(usize, f64)> {
    let at = AXES.iter().position(|axis| *axis == word)?;
    Some((at % 3, if at < 3 { 1.0 } else { -1.0 }))
}

/// The axis as a direction.
pub(super) fn direction(axis: usize, sign: f64) -> Vector3<f64> {
    Vector3::ith(axis.min(2), sign)
}

impl LimbMap {
    /// Reads the text of a map, and checks its names against the robot's.
    pub fn parse(text: &str, robot: &Robot) -> Result<Self, RobotError> {
        let table: Table = text
            .parse()
            .map_err(|error: toml::de::Error| RobotError::new("the map", format!("not TOML: {error}"), SAMPLE))?;
        known("the map", table.keys(), &["forward", "up", "base", "limbs"])?;
        let word = |key: &str, default: &str| -> Result<Vector3<f64>, RobotError> {
            let found = table.get(key).map_or(Some(default), Value::as_str).and_then(axis);
            let (at, sign) = found.ok_or_else(|| {
                let what = format!("found {}, expected one of \"{}\"", table[key], AXES.join("\", \""));
                RobotError::new(key, what, "name an axis of the root link")
            })?;
            Ok(direction(at, sign))
        };
        let (forward, up) = (word("forward", "x")?, word("up", "z")?);
        if forward.dot(&up) != 0.0 {
            return Err(RobotError::new(
                "forward",
                "found the axis of up, expected one square to it",
                "correct one of the two",
            ));
        }
        let base = match table.get("base") {
            None => None,
            Some(value) => {
                let found = Base::ALL.into_iter().find(|(_, name)| value.as_str() == Some(name));
                Some(found.map(|(base, _)| base).ok_or_else(|| {
                    let what = format!("found {value}, expected \"pelvis\", \"heading\" or \"chest\"");
                    RobotError::new("base", what, "correct it, or leave it out")
                })?)
            }
        };
        let Some(Value::Table(limbs)) = table.get("limbs") else {
            return Err(RobotError::new("the map", "found no table [limbs]", format!("add it: {SAMPLE}")));
        };
        let names: Vec<&str> = Limb::ALL.into_iter().map(Limb::name).collect();
        known("[limbs]", limbs.keys(), &names)?;
        let mut entries = Vec::new();
        for limb in Limb::ALL {
            let Some(value) = limbs.get(limb.name()) else { continue };
            entries.push(entry(limb, value, robot)?);
        }
        if entries.is_empty() {
            return Err(RobotError::new("[limbs]", "found no limb, expected at least one", SAMPLE));
        }
        Ok(Self { forward, up, base, limbs: entries })
    }

    /// The map as a file.
    pub fn to_toml(&self) -> String {
        let name = |v: &Vector3<f64>| {
            let at = (0..6).find(|at| direction(at % 3, if *at < 3 { 1.0 } else { -1.0 }) == *v);
            AXES[at.unwrap_or(0)]
        };
        let mut text = format!("forward = \"{}\"\nup = \"{}\"\n", name(&self.forward), name(&self.up));
        if let Some((_, name)) = Base::ALL.into_iter().find(|(base, _)| Some(*base) == self.base) {
            text.push_str(&format!("base = \"{name}\"\n"));
        }
        text.push_str("\n[limbs]\n");
        let quoted = |name: &str| Value::String(name.to_owned()).to_string();
        for entry in &self.limbs {
            let end = match &entry.end {
                End::At(name) => quoted(name),
                End::Axis(at, sign) => quoted(AXES[at + if *sign < 0.0 { 3 } else { 0 }]),
            };
            text.push_str(&format!("{} = [{}, {end}]\n", entry.limb.name(), quoted(&entry.begin)));
        }
        text
    }
}

fn entry(limb: Limb, value: &Value, robot: &Robot) -> Result<LimbEntry, RobotError> {
    let place = format!("[limbs] {}", limb.name());
    let both = value.as_array().and_then(|all| match &all[..] {
        [begin, end] => Some((begin.as_str()?, end.as_str()?)),
        _ => None,
    });
    let (begin, end) = both.ok_or_else(|| {
        let what = format!(
            "found {value}, expected where it begins and where it ends: two joints or links, or a link and its axis"
        );
        RobotError::new(&place, what, SAMPLE)
    })?;
    let missing = |name: &str| {
        let all = robot.joints.iter().flat_map(|joint| [joint.name.as_str(), joint.child.as_str()]);
        let near = nearest(name, all).map_or(String::new(), |near| format!("; did you mean '{near}'?"));
        let what = format!("the robot has no joint or link '{name}'{near}");
        RobotError::new(&place, what, "kinesic robot show ROBOT lists them")
    };
    super::point(robot, begin).ok_or_else(|| missing(begin))?;
    let end = match (super::point(robot, end), axis(end)) {
        (Some(_), _) => End::At(end.to_owned()),
        (None, Some((at, sign))) => End::Axis(at, sign),
        (None, None) => return Err(missing(end)),
    };
    Ok(LimbEntry { limb, begin: begin.to_owned(), end })
}

/// Refuses a key that means nothing.
fn known<'a>(place: &str, keys: impl Iterator<Item = &'a String>, all: &[&str]) -> Result<(), RobotError> {
    for key in keys {
        if !all.contains(&key.as_str()) {
            let near =
                nearest(key, all.iter().copied()).map_or(String::new(), |near| format!("; did you mean '{near}'?"));
            return Err(RobotError::new(
                place,
                format!("found the key '{key}'{near}"),
                format!("expected: {}", all.join(", ")),
            ));
        }
    }
    Ok(())
}
