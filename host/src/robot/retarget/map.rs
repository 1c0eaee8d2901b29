//! The map: which parts of a robot are which limbs of a person.

use nalgebra::Vector3;
use toml::Value;

use super::Limb;
use crate::clip::map::nearest;
use crate::robot::RobotError;
use crate::robot::keys::{facing, known, number, table};

/// What the map says of one limb. Names are those of joints or of links.
#[derive(Clone, Debug, PartialEq)]
pub struct LimbEntry {
    /// Which limb.
    pub limb: Limb,
    /// Where it begins, or the part that carries it where there is no `to`.
    pub from: String,
    /// Where it ends.
    pub to: Option<String>,
    /// Its direction in the root link's axes, all values zero; instead of `to`.
    pub bone: Option<Vector3<f64>>,
    /// Of an arm or a leg as a whole: its length where the person's is stretched, m; else that of the chain.
    pub length: Option<f64>,
    /// How much its error counts: 1 unless given, 0.3 of feet.
    pub weight: f64,
}

/// A whole map.
#[derive(Clone, Debug, PartialEq)]
pub struct RetargetMap {
    /// Where the robot faces at zero, in its root link's axes.
    pub forward: Vector3<f64>,
    /// Where up is.
    pub up: Vector3<f64>,
    /// The limbs, in the order of [`Limb::ALL`].
    pub limbs: Vec<LimbEntry>,
    /// Joints that stay at a value, rad or m.
    pub hold: Vec<(String, f64)>,
}

const KEYS: [&str; 4] = ["forward", "up", "limbs", "hold"];
const ENTRY: [&str; 5] = ["from", "to", "bone", "length", "weight"];
/// Weight of a foot: a leg that is nearly stretched would turn out at the knee for it.
const FEET: f64 = 0.3;
const SAMPLE: &str =
    "as in  l_upper_arm = [\"left_shoulder_roll\", \"left_elbow\"]  below [limbs]; --suggest-map writes one";

impl RetargetMap {
    /// Reads the text of a map.
    ///
    /// ```
    /// let map = kinesic_host::robot::retarget::RetargetMap::parse(r#"
    ///     [limbs]
    ///     l_upper_arm = ["left_shoulder_roll", "left_elbow"]
    ///     l_forearm = { from = "left_elbow", bone = [0, 0, -1] }
    ///     head = "head_link"
    /// "#)?;
    /// assert_eq!(map.limbs.len(), 3);
    /// # Ok::<(), kinesic_host::robot::RobotError>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self, RobotError> {
        let table = table(text, "the map", SAMPLE)?;
        known("the map", &table, &KEYS)?;
        let [forward, up] = facing(&table)?;
        let Some(Value::Table(limbs)) = table.get("limbs") else {
            return Err(RobotError::new("the map", "found no table [limbs]", format!("add it: {SAMPLE}")));
        };
        let mut limbs = limbs.iter().map(|(name, value)| entry(name, value)).collect::<Result<Vec<_>, _>>()?;
        limbs.sort_by_key(|entry| entry.limb as usize);
        if limbs.is_empty() {
            return Err(RobotError::new("[limbs]", "found no limb, expected at least one", SAMPLE));
        }
        let hold = match table.get("hold") {
            None => Vec::new(),
            Some(Value::Table(hold)) => hold
                .iter()
                .map(|(name, value)| match number(value) {
                    Some(value) => Ok((name.clone(), value)),
                    None => {
                        let what = format!("found {value}, expected a number, rad or m");
                        Err(RobotError::new(format!("[hold] {name}"), what, "as in 0.5"))
                    }
                })
                .collect::<Result<_, _>>()?,
            Some(value) => {
                return Err(RobotError::new(
                    "hold",
                    format!("found {value}, expected a table [hold]"),
                    "as in  waist = 0.0",
                ));
            }
        };
        Ok(Self { forward, up, limbs, hold })
    }
}

fn entry(name: &str, value: &Value) -> Result<LimbEntry, RobotError> {
    let place = format!("[limbs] {name}");
    let limb = Limb::from_name(name).ok_or_else(|| {
        let all = Limb::ALL.map(Limb::name);
        let near = nearest(name, all).map_or(String::new(), |near| format!("; did you mean '{near}'?"));
        RobotError::new(&place, format!("found no limb of this name{near}"), format!("expected: {}", all.join(", ")))
    })?;
    let refuse = |key: &str, found: &Value, expected: &str| {
        RobotError::new(format!("{place}{key}"), format!("found {found}, expected {expected}"), SAMPLE)
    };
    let mut entry = LimbEntry {
        limb,
        from: String::new(),
        to: None,
        bone: None,
        length: None,
        weight: if matches!(limb, Limb::LFoot | Limb::RFoot) { FEET } else { 1.0 },
    };
    match value {
        Value::String(one) => entry.from.clone_from(one),
        Value::Array(two) => match &two[..] {
            [Value::String(from), Value::String(to)] => (entry.from, entry.to) = (from.clone(), Some(to.clone())),
            _ => return Err(refuse("", value, "two names: where the limb begins and where it ends")),
        },
        Value::Table(table) => {
            known(&place, table, &ENTRY)?;
            let name = |key: &str| match table.get(key) {
                None => Ok(None),
                Some(Value::String(name)) => Ok(Some(name.clone())),
                Some(other) => Err(refuse(&format!(", {key}"), other, "a name")),
            };
            entry.from = name("from")?.ok_or_else(|| refuse("", value, "a key `from`"))?;
            entry.to = name("to")?;
            if let Some(weight) = table.get("weight") {
                let found = number(weight).filter(|weight| (0.0..=1e3).contains(weight));
                entry.weight = found.ok_or_else(|| refuse(", weight", weight, "a number from 0 to 1000"))?;
            }
            if let Some(length) = table.get("length") {
                let found = number(length).filter(|length| *length > 0.0 && limb.reaches());
                let expected = "a number above 0, m, and only of arms and legs as a whole";
                entry.length = Some(found.ok_or_else(|| refuse(", length", length, expected))?);
            }
            if let Some(bone) = table.get("bone") {
                let list = bone.as_array().map(|list| list.iter().map(number).collect::<Option<Vec<f64>>>());
                let way =
                    list.flatten().and_then(|list| Vector3::from(<[f64; 3]>::try_from(list).ok()?).try_normalize(1e-6));
                entry.bone = Some(way.ok_or_else(|| refuse(", bone", bone, "a direction, as in [0, 0, -1]"))?);
            }
        }
        other => return Err(refuse("", other, "a name, or two names")),
    }
    Ok(entry)
}
