//! Keys of TOML tables and maps about robots.

use nalgebra::Vector3;
use toml::{Table, Value};

use super::RobotError;
use crate::clip::map::nearest;

/// A text as a table; `what` names it.
pub(crate) fn table(text: &str, what: &str, sample: &str) -> Result<Table, RobotError> {
    text.parse().map_err(|error: toml::de::Error| RobotError::new(what, format!("not TOML: {error}"), sample))
}

/// Refuses a key that means nothing.
pub(crate) fn known(place: &str, table: &Table, all: &[&str]) -> Result<(), RobotError> {
    let Some(key) = table.keys().find(|key| !all.contains(&key.as_str())) else { return Ok(()) };
    let near = nearest(key, all.iter().copied()).map_or(String::new(), |near| format!("; did you mean '{near}'?"));
    Err(RobotError::new(place, format!("found the key '{key}'{near}"), format!("expected: {}", all.join(", "))))
}

/// Numbers are at most so large.
pub(crate) const LARGEST: f64 = 1e9;

/// A number, whole or not, from -1e9 to 1e9.
pub(crate) fn number(value: &Value) -> Option<f64> {
    let number = value.as_float().or_else(|| value.as_integer().map(|x| x as f64))?;
    (number.abs() <= LARGEST).then_some(number)
}

/// Where the root link faces and where its up is: the keys `forward` (x unless given) and `up` (z).
pub(crate) fn facing(table: &Table) -> Result<[Vector3<f64>; 2], RobotError> {
    const NAMES: [&str; 6] = ["x", "y", "z", "-x", "-y", "-z"];
    let ways = [Vector3::x(), Vector3::y(), Vector3::z(), -Vector3::x(), -Vector3::y(), -Vector3::z()];
    let way = |key: &str, otherwise: usize| {
        let Some(value) = table.get(key) else { return Ok(ways[otherwise]) };
        let found = value.as_str().and_then(|word| NAMES.iter().position(|name| *name == word));
        found.map(|at| ways[at]).ok_or_else(|| {
            let what = format!("found {value}, expected one of \"{}\"", NAMES.join("\", \""));
            RobotError::new(key, what, "correct it, or leave it out")
        })
    };
    let (forward, up) = (way("forward", 0)?, way("up", 2)?);
    if forward.dot(&up) != 0.0 {
        return Err(RobotError::new("forward", "found the direction of up", "expected one square to it"));
    }
    Ok([forward, up])
}
