//! `trajectory_msgs/JointTrajectory` as YAML: what `ros2 topic echo` and bag dumps print, and configuration files hold.

use std::fmt::Write;

use super::build::Draft;
use super::tape::{Node, quote};
use super::write::number;
use super::{Channel, Extra, Format, Moves, MovesError, Options, Unit, records, yaml};

const HELP: &str = "as in  joint_names: [pan]  points: [{positions: [0.1], time_from_start: {sec: 0, nanosec: 0}}]";

/// What a JointTrajectory is in, as far as it says so.
pub(super) const UNITS: &str = "A JointTrajectory is in rad and m: it names no unit of a joint.";

/// Reads the first document that holds a trajectory.
pub(super) fn parse(text: &str, options: &Options) -> Result<Moves, MovesError> {
    let tape = yaml::parse(text)?;
    let mut found = tape.root().items().filter_map(|document| trajectory(document, 0));
    let Some((whole, depth)) = found.next() else {
        return Err(MovesError::new("", "found no joint_names and points, expected a JointTrajectory", HELP));
    };
    let mut notes = vec![UNITS.to_owned()];
    match found.count() {
        0 => {}
        more => notes.push(format!("The file holds {more} further trajectories: the first is taken.")),
    }
    if depth > 0 {
        notes.push("What is around the trajectory is left out.".into());
    }
    let (names, points) = (whole.get("joint_names").unwrap_or(whole), whole.get("points").unwrap_or(whole));
    let labels: Vec<String> = names.list(|| "joint_names".into())?.map(|name| name.text().to_owned()).collect();
    let (mut times, mut values) = (Vec::new(), Vec::new());
    let mut dropped: Vec<&str> = Vec::new();
    for (frame, point) in points.list(|| "points".into())?.enumerate() {
        let place = |key: &str| format!("point {frame}, {key}");
        let start = values.len();
        let positions = point.get("positions").unwrap_or(point);
        if positions.is_list() {
            for (at, position) in positions.items().enumerate() {
                let name = || labels.get(at).map_or("positions", String::as_str);
                values.push(position.finite(|| place(name()))?);
            }
        }
        let (found, expected) = (values.len() - start, labels.len());
        if found != expected {
            let what = format!("found {found} positions, expected {expected}, as many as joint_names");
            return Err(MovesError::new(positions.place(&place("positions")), what, HELP));
        }
        times.push(seconds(point.get("time_from_start"), point, || place("time_from_start"))?);
        for (key, value) in point.members() {
            let own = ["positions", "time_from_start"].contains(&key);
            let filled = !value.is_list() || value.items().next().is_some();
            if !own && filled && !dropped.contains(&key) && dropped.len() < 8 {
                dropped.push(key);
            }
        }
    }
    if !dropped.is_empty() {
        notes.push(format!("The points' {} are left out: positions and times are read.", dropped.join(", ")));
    }
    let channels = labels.iter().map(|name| Channel { name: name.clone(), unit: None }).collect();
    let fields = whole.members().filter(|(key, _)| !["joint_names", "points"].contains(key));
    let fields = records::fields(fields, text.len())?;
    let extra = Extra { fields, ..Extra::default() };
    let place = Box::new(|frame| format!("point {frame}"));
    Draft { format: Format::Trajectory, channels, labels, times: Some(times), fps: None, values, extra, notes, place }
        .finish(options)
}

/// The map with joint names and points, also one inside others, and how deep: goals of actions, launch files.
fn trajectory(value: Node<'_>, depth: usize) -> Option<(Node<'_>, usize)> {
    if value.get("joint_names").is_some() && value.get("points").is_some() {
        return Some((value, depth));
    }
    let inside = (depth < 8).then(|| value.members().find_map(|(_, inner)| trajectory(inner, depth + 1)));
    inside.flatten()
}

/// A duration: `{sec, nanosec}`, `{secs, nsecs}`, or a number of seconds.
fn seconds(value: Option<Node<'_>>, point: Node<'_>, place: impl Fn() -> String) -> Result<f64, MovesError> {
    let Some(value) = value else {
        return Err(MovesError::new(point.place(&place()), "found none, expected sec and nanosec", HELP));
    };
    if !value.is_map() {
        return value.finite(place);
    }
    let part = |keys: [&str; 2]| keys.into_iter().find_map(|key| value.get(key));
    let (Some(whole), Some(rest)) = (part(["sec", "secs"]), part(["nanosec", "nsecs"])) else {
        return Err(MovesError::new(value.place(&place()), "found no sec and nanosec, expected both", HELP));
    };
    Ok(whole.finite(&place)? + 1e-9 * rest.finite(&place)?)
}

/// Writes a trajectory: positions in rad and m.
pub(super) fn write(moves: &Moves) -> String {
    let si = |channel: &Channel| match channel.unit {
        Some(Unit::Degrees) => 1f64.to_radians(),
        Some(Unit::Millimetres) => 1e-3,
        _ => 1.0,
    };
    let mut out = String::new();
    for (key, value) in &moves.extra.fields {
        quote(key, &mut out);
        // JSON is YAML. Writing to a String cannot fail.
        let _ = writeln!(out, ": {value}");
    }
    out.push_str("joint_names:\n");
    for channel in &moves.channels {
        out.push_str("- ");
        quote(&channel.name, &mut out);
        out.push('\n');
    }
    out.push_str("points:\n");
    for (frame, time) in moves.times.iter().enumerate() {
        let positions = moves.frame(frame).iter().zip(&moves.channels).map(|(x, own)| yaml_number(x * si(own)));
        let positions = positions.collect::<Vec<_>>().join(", ");
        let nanoseconds = (time * 1e9).round() as u64;
        let (sec, nanosec) = (nanoseconds / 1_000_000_000, nanoseconds % 1_000_000_000);
        let _ = writeln!(out, "- positions: [{positions}]\n  time_from_start: {{sec: {sec}, nanosec: {nanosec}}}");
    }
    out
}

/// A number that readers of YAML 1.1 take for one: with a point, and a sign in the exponent.
fn yaml_number(x: f64) -> String {
    let text = number(x);
    match text.split_once('e') {
        Some((digits, power)) => {
            let point = if digits.contains('.') { "" } else { ".0" };
            let sign = if power.starts_with('-') { "" } else { "+" };
            format!("{digits}{point}e{sign}{power}")
        }
        None => text,
    }
}
