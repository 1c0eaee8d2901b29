//! The map: which joints of a robot are which joint of the skeleton, and what a URDF does not say.

use nalgebra::Vector3;
use toml::{Table, Value};

use crate::robot::RobotError;
use crate::robot::keys::{facing, known, number, table};
use kinesic::model::LimitsMeta;

/// Which coordinates a map asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapKind {
    /// A ball with rates only.
    Free,
    /// One angle.
    Hinge,
    /// Two or three angles in order.
    Chain,
    /// A box of rotation vectors along the joint's own axes.
    Ball,
}

impl MapKind {
    const ALL: [Self; 4] = [Self::Free, Self::Hinge, Self::Chain, Self::Ball];

    /// Its name in a map.
    pub fn name(self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Hinge => "hinge",
            Self::Chain => "chain",
            Self::Ball => "ball",
        }
    }
}

/// What the map says of one joint of the skeleton. Lists have one entry per robot joint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Entry {
    /// Name in the skeleton, or canonical name.
    pub joint: String,
    /// Robot joints from the trunk outwards.
    pub urdf: Vec<String>,
    /// Which coordinates; else what the number of robot joints says.
    pub kind: Option<MapKind>,
    /// Bounds instead of the URDF's, rad.
    pub lower: Option<Vec<f64>>,
    /// See `lower`.
    pub upper: Option<Vec<f64>>,
    /// Speeds instead of the URDF's, rad/s.
    pub velocity: Option<Vec<f64>>,
    /// Accelerations, rad/s^2.
    pub acceleration: Option<Vec<f64>>,
    /// Jerks, rad/s^3; 0 for no limit.
    pub jerk: Option<Vec<f64>>,
    /// Angles at rest, rad.
    pub rest: Option<Vec<f64>>,
    /// Direction of the bone in the root link's frame, all angles zero.
    pub bone: Option<Vector3<f64>>,
}

/// A whole map.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotMap {
    /// Acceleration of joints for which the map has none of their own, rad/s^2.
    pub acceleration: Option<f64>,
    /// Jerk of joints for which the map has none of their own, rad/s^3; none or 0 for no limit.
    pub jerk: Option<f64>,
    /// Speed of joints for which neither the URDF nor the map has one, rad/s.
    pub velocity: Option<f64>,
    /// Where the robot faces, and where up is, in its root link's frame.
    pub forward: Vector3<f64>,
    /// See `forward`.
    pub up: Vector3<f64>,
    /// The robot at zero stands as the skeleton rests: bones are not compared.
    pub zero_is_rest: bool,
    /// Skeleton joints without an entry cannot move.
    pub others_fixed: bool,
    /// Rates of the root, and what happens when frames fail to come.
    pub meta: LimitsMeta,
    /// Least and greatest height of the root, m; else what the skeleton says.
    pub height: Option<[f64; 2]>,
    /// The joints, in the file's order.
    pub entries: Vec<Entry>,
}

const KEYS: [&str; 15] = [
    "acceleration",
    "jerk",
    "velocity",
    "forward",
    "up",
    "zero",
    "unmapped",
    "root_velocity",
    "root_acceleration",
    "heading_velocity",
    "heading_acceleration",
    "height",
    "hold",
    "decay",
    "joints",
];
const ENTRY: [&str; 9] = ["urdf", "kind", "lower", "upper", "velocity", "acceleration", "jerk", "rest", "bone"];
const SAMPLE: &str =
    "as in  l_shoulder = [\"l_shoulder_pitch\", \"l_shoulder_roll\", \"l_shoulder_yaw\"]  below [joints]";

impl RobotMap {
    /// Reads the text of a map.
    ///
    /// ```
    /// let map = kinesic_host::limit::onto_body::RobotMap::parse(r#"
    ///     acceleration = 20.0
    ///     [joints]
    ///     l_elbow = "left_elbow"
    ///     l_shoulder = { urdf = ["left_shoulder_pitch", "left_shoulder_roll"], acceleration = 15.0 }
    /// "#)?;
    /// assert_eq!(map.entries.len(), 2);
    /// # Ok::<(), kinesic_host::robot::RobotError>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self, RobotError> {
        let table = table(text, "the map", SAMPLE)?;
        known("the map", &table, &KEYS)?;
        let positive = |key: &str| match table.get(key) {
            None => Ok(None),
            Some(value) => match number(value) {
                Some(x) if x >= 0.0 => Ok(Some(x)),
                _ => Err(RobotError::new(key, format!("found {value}, expected a number from 0 up"), "as in 20.0")),
            },
        };
        let word = |key: &str, choices: &[&str]| match table.get(key) {
            None => Ok(0),
            Some(value) => value.as_str().and_then(|word| choices.iter().position(|c| *c == word)).ok_or_else(|| {
                let expected = choices.join("\", \"");
                RobotError::new(
                    key,
                    format!("found {value}, expected one of \"{expected}\""),
                    "correct it, or leave it out",
                )
            }),
        };
        let time = |key, default: f32| Ok::<_, RobotError>(positive(key)?.map_or(default, |x| x as f32));
        let meta = LimitsMeta::default();
        let [forward, up] = facing(&table)?;
        let Some(Value::Table(joints)) = table.get("joints") else {
            return Err(RobotError::new("the map", "found no table [joints]", format!("add it: {SAMPLE}")));
        };
        let entries = joints.iter().map(|(name, value)| entry(name, value)).collect::<Result<Vec<_>, _>>()?;
        if entries.is_empty() {
            return Err(RobotError::new("[joints]", "found no joint, expected at least one", SAMPLE));
        }
        Ok(Self {
            acceleration: positive("acceleration")?,
            jerk: positive("jerk")?,
            velocity: positive("velocity")?,
            forward,
            up,
            zero_is_rest: word("zero", &["bones", "rest"])? == 1,
            others_fixed: word("unmapped", &["free", "fixed"])? == 1,
            meta: LimitsMeta {
                root_velocity: time("root_velocity", meta.root_velocity)?,
                root_acceleration: time("root_acceleration", meta.root_acceleration)?,
                heading_velocity: time("heading_velocity", meta.heading_velocity)?,
                heading_acceleration: time("heading_acceleration", meta.heading_acceleration)?,
                hold: time("hold", meta.hold)?,
                decay: time("decay", meta.decay)?,
            },
            height: height(&table)?,
            entries,
        })
    }
}

fn height(table: &Table) -> Result<Option<[f64; 2]>, RobotError> {
    let Some(value) = table.get("height") else { return Ok(None) };
    match numbers(value).as_deref() {
        Some(&[lower, upper]) if lower <= upper => Ok(Some([lower, upper])),
        _ => Err(RobotError::new(
            "height",
            format!("found {value}, expected the least and the greatest height of the root, m"),
            "as in [0.3, 0.8]",
        )),
    }
}

/// A number, or a list of numbers.
fn numbers(value: &Value) -> Option<Vec<f64>> {
    match value {
        Value::Array(values) => values.iter().map(number).collect(),
        one => Some(vec![number(one)?]),
    }
}

/// A name, or a list of names.
fn names(value: &Value) -> Option<Vec<String>> {
    match value {
        Value::Array(values) => values.iter().map(|name| Some(name.as_str()?.to_owned())).collect(),
        one => Some(vec![one.as_str()?.to_owned()]),
    }
}

fn entry(joint: &str, value: &Value) -> Result<Entry, RobotError> {
    let place = format!("[joints] {joint}");
    let refuse = |key: &str, found: &Value, expected: &str| {
        RobotError::new(format!("{place}, {key}"), format!("found {found}, expected {expected}"), SAMPLE)
    };
    let mut entry = Entry { joint: joint.to_owned(), ..Entry::default() };
    let Value::Table(table) = value else {
        entry.urdf =
            names(value).ok_or_else(|| refuse("urdf", value, "the name of a robot joint, or a list of names"))?;
        return Ok(entry);
    };
    known(&place, table, &ENTRY)?;
    if let Some(value) = table.get("urdf") {
        entry.urdf =
            names(value).ok_or_else(|| refuse("urdf", value, "the name of a robot joint, or a list of names"))?;
    }
    if let Some(value) = table.get("kind") {
        let kind = value.as_str().and_then(|word| MapKind::ALL.into_iter().find(|kind| kind.name() == word));
        entry.kind = Some(kind.ok_or_else(|| refuse("kind", value, "free, hinge, chain or ball"))?);
    }
    let count = entry.urdf.len().max(1);
    let list = |key: &str| match table.get(key) {
        None => Ok(None),
        Some(value) => match numbers(value) {
            Some(all) if all.len() == count => Ok(Some(all)),
            Some(all) if all.len() == 1 => Ok(Some(vec![all[0]; count])),
            _ => Err(refuse(key, value, &format!("a number, or {count} of them, one a robot joint"))),
        },
    };
    entry.lower = list("lower")?;
    entry.upper = list("upper")?;
    entry.velocity = list("velocity")?;
    entry.acceleration = list("acceleration")?;
    entry.jerk = list("jerk")?;
    entry.rest = list("rest")?;
    if let Some(value) = table.get("bone") {
        let bone = numbers(value).and_then(|all| Vector3::from(<[f64; 3]>::try_from(all).ok()?).try_normalize(1e-6));
        entry.bone = Some(bone.ok_or_else(|| refuse("bone", value, "a direction, as in [0, 0, -1]"))?);
    }
    Ok(entry)
}
