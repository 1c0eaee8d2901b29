//! `trajectory_msgs/JointTrajectory` as YAML: what `ros2 topic echo` and bag dumps print, and configuration files hold.

use serde_json::{Value, json};

use super::build::Draft;
use super::error::shown;
use super::json::finite;
use super::{Channel, Extra, Format, Moves, MovesError, Options, Unit, unit_name};

const HELP: &str = "as in  joint_names: [pan]  points: [{positions: [0.1], time_from_start: {sec: 0, nanosec: 0}}]";

/// Reads the first document that holds a trajectory.
pub(super) fn parse(text: &str, options: &Options) -> Result<Moves, MovesError> {
    let mut found = None;
    for document in serde_norway::Deserializer::from_str(text) {
        let value: Value = serde::Deserialize::deserialize(document).map_err(|error: serde_norway::Error| {
            let line = error.location().map_or(1, |location| location.line());
            let help = "is the file whole, and indented by spaces? `yamllint FILE` finds the same error";
            MovesError::new(format!("line {line}"), format!("not YAML: {}", shown(&error.to_string())), help)
        })?;
        found = found.or_else(|| trajectory(&value, 0).cloned());
    }
    let Some(found) = found else {
        return Err(MovesError::new("", "found no joint_names and points, expected a JointTrajectory", HELP));
    };
    let names = found.get("joint_names").and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default();
    let names: Option<Vec<&str>> = names.iter().map(Value::as_str).collect();
    let names =
        names.ok_or_else(|| MovesError::new("joint_names", "found another thing, expected a list of names", HELP))?;
    let points = found.get("points").and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default();
    let (mut times, mut values, mut dropped) = (Vec::new(), Vec::new(), Vec::new());
    for (frame, point) in points.iter().enumerate() {
        let place = |key: &str| format!("point {frame}, {key}");
        let positions = point.get("positions").and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default();
        if positions.len() != names.len() {
            let what = format!("found {} numbers, expected {}, as many as joint_names", positions.len(), names.len());
            return Err(MovesError::new(place("positions"), what, HELP));
        }
        for position in positions {
            if position.as_str() == Some("...") {
                let what = "found '...', expected a number";
                return Err(MovesError::new(
                    place("positions"),
                    what,
                    "record it again with ros2 topic echo --full-length",
                ));
            }
            values.push(finite(position, || place("positions"))?);
        }
        times.push(seconds(point.get("time_from_start").unwrap_or(&Value::Null), || place("time_from_start"))?);
        for key in ["velocities", "accelerations", "effort"] {
            let filled = point.get(key).and_then(Value::as_array).is_some_and(|list| !list.is_empty());
            if filled && !dropped.contains(&key) {
                dropped.push(key);
            }
        }
    }
    let mut notes = vec!["Positions are taken as rad, and of sliders as m, as ROS has them.".to_owned()];
    if !dropped.is_empty() {
        notes.push(format!("The points' {} are left out: they follow from the positions.", dropped.join(", ")));
    }
    let channels = names.iter().map(|name| Channel { name: (*name).to_owned(), unit: None }).collect();
    let fields = found.as_object().into_iter().flatten().filter(|(key, _)| *key != "joint_names" && *key != "points");
    let extra = Extra { fields: fields.map(|(key, value)| (key.clone(), value.clone())).collect(), ..Extra::default() };
    let place = Box::new(|frame| format!("point {frame}"));
    Draft { format: Format::Trajectory, channels, times: Some(times), fps: None, values, extra, notes, place }
        .finish(options)
}

/// The map with joint names and points, also one inside others: goals of actions, launch files.
fn trajectory(value: &Value, depth: usize) -> Option<&Value> {
    let map = value.as_object()?;
    if map.contains_key("joint_names") && map.contains_key("points") {
        return Some(value);
    }
    (depth < 8).then(|| map.values().find_map(|inner| trajectory(inner, depth + 1)))?
}

/// A duration: `{sec, nanosec}`, `{secs, nsecs}`, or a number of seconds.
fn seconds(value: &Value, place: impl Fn() -> String) -> Result<f64, MovesError> {
    if value.is_number() {
        return finite(value, place);
    }
    let part = |keys: [&str; 2]| keys.into_iter().find_map(|key| value.get(key));
    let (Some(whole), Some(rest)) = (part(["sec", "secs"]), part(["nanosec", "nsecs"])) else {
        return Err(MovesError::new(place(), "found no sec and nanosec, expected both", HELP));
    };
    Ok(finite(whole, &place)? + 1e-9 * finite(rest, &place)?)
}

/// Writes a trajectory: positions in rad and m. Numbers that only a servo knows are refused.
pub(super) fn write(moves: &Moves) -> Result<Value, MovesError> {
    if let Some(channel) = moves.channels.iter().find(|channel| channel.unit.is_some_and(Unit::is_whole)) {
        let found = channel.unit.map_or("", unit_name);
        let what = format!("joint '{}' is in {found}, a JointTrajectory in rad and m", channel.name);
        return Err(MovesError::new("", what, "write .csv or .json"));
    }
    let si: Vec<f64> = moves
        .channels
        .iter()
        .map(|channel| match channel.unit {
            Some(Unit::Degrees) => 1f64.to_radians(),
            Some(Unit::Millimetres) => 1e-3,
            _ => 1.0,
        })
        .collect();
    let point = |frame: usize| {
        let positions: Vec<f64> = moves.frame(frame).iter().zip(&si).map(|(x, unit)| x * unit).collect();
        let nanoseconds = (moves.times[frame] * 1e9).round() as u64;
        json!({
            "positions": positions,
            "time_from_start": {"sec": nanoseconds / 1_000_000_000, "nanosec": nanoseconds % 1_000_000_000},
        })
    };
    let names: Vec<&str> = moves.channels.iter().map(|channel| channel.name.as_str()).collect();
    let mut whole = moves.extra.fields.clone();
    whole.insert("joint_names".into(), json!(names));
    whole.insert("points".into(), (0..moves.frames()).map(point).collect());
    Ok(Value::Object(whole))
}
