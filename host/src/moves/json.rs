//! JSON by joint name: columns, rows, records, one record per line; LeRobot's records with lists.

use std::path::Path;

use serde_json::{Map, Value};

use super::build::{Draft, is_index, time_unit};
use super::error::shown;
use super::{Channel, Extra, Format, Moves, MovesError, Options, Unit, reachy, unit_of};
use crate::files;

/// Names of lists in LeRobot's tables: what was told, then what was measured.
const LISTS: [&str; 2] = ["action", "observation.state"];

/// Whether a name is one of a list in LeRobot's tables.
pub(super) fn is_list_name(name: &str) -> bool {
    LISTS.contains(&name.trim())
}

/// Reads any of them.
pub(super) fn parse(text: &str, path: &Path, options: &Options) -> Result<Moves, MovesError> {
    let refuse = |error: serde_json::Error| {
        let help = "`python -m json.tool FILE` finds the same error; is the file whole?";
        MovesError::new(format!("line {}", error.line()), format!("not JSON: {error}"), help)
    };
    let values: Vec<Value> =
        serde_json::Deserializer::from_str(text).into_iter().collect::<Result<_, _>>().map_err(refuse)?;
    match values.as_slice() {
        [Value::Object(whole)] if whole.contains_key("set_target_data") => reachy::parse(whole, options),
        [Value::Object(whole)] if whole.contains_key("joints") => columns(whole, options),
        [Value::Object(whole)] if whole.contains_key("joint_names") => rows(whole, options),
        [Value::Array(all)] => records(all, Format::Records, path, options),
        [Value::Object(whole)] => {
            let keys: Vec<&str> = whole.keys().take(8).map(String::as_str).collect();
            let what = format!("found the keys {}, expected joints, joint_names or set_target_data", keys.join(", "));
            Err(MovesError::new("", what, "as in {\"fps\": 50, \"joints\": {\"pan\": [0.1, 0.2]}}"))
        }
        all if !all.is_empty() => records(all, Format::JsonLines, path, options),
        _ => Err(MovesError::new("", "found no value, expected a motion", "is the file whole?")),
    }
}

/// The unit of all channels, if the file says one.
fn unit(whole: &Map<String, Value>) -> Result<Option<Unit>, MovesError> {
    let Some(value) = whole.get("unit").or_else(|| whole.get("units")) else { return Ok(None) };
    match value.as_str().and_then(unit_of) {
        Some(unit) => Ok(Some(unit)),
        None => {
            Err(MovesError::new("unit", format!("found {value}, expected deg, rad, m, mm, ticks or us"), "correct it"))
        }
    }
}

/// A finite number.
pub(super) fn finite(value: &Value, place: impl Fn() -> String) -> Result<f64, MovesError> {
    value.as_f64().filter(|x| x.is_finite()).ok_or_else(|| {
        let what = format!("found {}, expected a finite number", shown(&value.to_string()));
        MovesError::new(place(), what, "correct the value, or cut the frame out")
    })
}

fn numbers(value: &Value, name: &str) -> Result<Vec<f64>, MovesError> {
    let Some(list) = value.as_array() else {
        let what = format!("found {}, expected a list of numbers", shown(&value.to_string()));
        return Err(MovesError::new(name, what, "one number per frame, in brackets"));
    };
    list.iter().enumerate().map(|(frame, x)| finite(x, || format!("{name}, frame {frame}"))).collect()
}

/// Times and rate of a file, and the unit of its joints.
struct Head {
    times: Option<Vec<f64>>,
    fps: Option<f64>,
    unit: Option<Unit>,
    extra: Extra,
}

fn head(whole: &Map<String, Value>, own: &[&str]) -> Result<Head, MovesError> {
    let times = whole.get("times").or_else(|| whole.get("time"));
    let rate = ["fps", "rate", "frame_rate"].into_iter().find_map(|key| Some((key, whole.get(key)?)));
    let known = ["times", "time", "fps", "rate", "frame_rate", "unit", "units"];
    let other = whole.iter().filter(|(key, _)| !known.contains(&key.as_str()) && !own.contains(&key.as_str()));
    let fields = other.map(|(key, value)| (key.clone(), value.clone())).collect();
    Ok(Head {
        times: times.map(|times| numbers(times, "times")).transpose()?,
        fps: rate.map(|(key, rate)| finite(rate, || key.to_owned())).transpose()?,
        unit: unit(whole)?,
        extra: Extra { fields, ..Extra::default() },
    })
}

fn channel(header: &str, unit: Option<Unit>) -> Channel {
    let found = Channel::from_header(header);
    Channel { unit: found.unit.or(unit), ..found }
}

fn frame_place() -> Box<dyn Fn(usize) -> String> {
    Box::new(|frame| format!("frame {frame}"))
}

/// `{"fps": 50, "joints": {"pan": [...]}}`.
fn columns(whole: &Map<String, Value>, options: &Options) -> Result<Moves, MovesError> {
    let Head { times, fps, unit, extra } = head(whole, &["joints"])?;
    let Some(joints) = whole.get("joints").and_then(Value::as_object) else {
        return Err(MovesError::new(
            "joints",
            "found no object, expected a list of numbers per joint",
            "as in {\"pan\": [0.1, 0.2]}",
        ));
    };
    let lists: Vec<(Channel, Vec<f64>)> = joints
        .iter()
        .map(|(name, list)| Ok((channel(name, unit), numbers(list, name)?)))
        .collect::<Result<_, MovesError>>()?;
    let frames = lists.first().map_or(0, |(_, list)| list.len());
    if let Some((odd, list)) = lists.iter().find(|(_, list)| list.len() != frames) {
        let what = format!("found {} numbers, expected {frames}, as for {}", list.len(), lists[0].0.name);
        return Err(MovesError::new(&odd.name, what, "is the file whole?"));
    }
    let values = (0..frames).flat_map(|frame| lists.iter().map(move |(_, list)| list[frame])).collect();
    let channels = lists.iter().map(|(channel, _)| channel.clone()).collect();
    Draft { format: Format::Json, channels, times, fps, values, extra, notes: Vec::new(), place: frame_place() }
        .finish(options)
}

/// `{"joint_names": [...], "frames": [[...]]}`.
fn rows(whole: &Map<String, Value>, options: &Options) -> Result<Moves, MovesError> {
    let Head { times, fps, unit, extra } = head(whole, &["joint_names", "frames"])?;
    let names = whole.get("joint_names").and_then(Value::as_array).map(Vec::as_slice).unwrap_or_default();
    let names: Option<Vec<Channel>> = names.iter().map(|name| Some(channel(name.as_str()?, unit))).collect();
    let (Some(channels), Some(frames)) = (names, whole.get("frames").and_then(Value::as_array)) else {
        let what = "found no list of names and of frames, expected both";
        return Err(MovesError::new(
            "joint_names",
            what,
            "as in {\"joint_names\": [\"pan\"], \"fps\": 50, \"frames\": [[0.1], [0.2]]}",
        ));
    };
    let mut values = Vec::with_capacity(frames.len() * channels.len());
    for (at, frame) in frames.iter().enumerate() {
        let row = numbers(frame, &format!("frame {at}"))?;
        if row.len() != channels.len() {
            let what = format!("found {} numbers, expected {}, as many as joint_names", row.len(), channels.len());
            return Err(MovesError::new(format!("frame {at}"), what, "is the file whole?"));
        }
        values.extend(row);
    }
    Draft { format: Format::Json, channels, times, fps, values, extra, notes: Vec::new(), place: frame_place() }
        .finish(options)
}

/// `[{"time": 0, "pan": 0.1}, ...]`, or one object per line.
fn records(all: &[Value], format: Format, path: &Path, options: &Options) -> Result<Moves, MovesError> {
    let place = move |frame: usize| match format {
        Format::JsonLines => format!("line {}", frame + 1),
        _ => format!("frame {frame}"),
    };
    let Some(first) = all.first().and_then(Value::as_object) else {
        let what = "found a list of other things, expected one object per frame";
        return Err(MovesError::new("", what, "as in [{\"time\": 0.0, \"pan\": 0.1}]"));
    };
    if first.keys().any(|key| is_list_name(key)) {
        return lerobot(all, path, options, Box::new(place));
    }
    let clock = first.keys().find_map(|key| Some((key.clone(), time_unit(key)?)));
    let is_clock = |key: &str| clock.as_ref().is_some_and(|(name, _)| name == key);
    let joints: Vec<&String> = first
        .iter()
        .filter(|(key, value)| value.is_number() && !is_clock(key) && !is_index(key))
        .map(|(key, _)| key)
        .collect();
    let others = first.iter().filter(|(key, value)| !value.is_number() && !is_clock(key));
    let mut extra = Extra { columns: others.map(|(key, _)| key.clone()).collect(), ..Extra::default() };
    bounded(&extra.columns, first, all)?;
    let (mut times, mut values) = (Vec::new(), Vec::new());
    for (at, record) in all.iter().enumerate() {
        let member = |key: &str| {
            record.get(key).ok_or_else(|| {
                MovesError::new(
                    place(at),
                    format!("found no {key}, expected it as in the first frame"),
                    "is the file whole?",
                )
            })
        };
        let number = |key: &str| finite(member(key)?, || format!("{}, {key}", place(at)));
        if let Some((key, seconds)) = &clock {
            times.push(number(key)? * seconds);
        }
        for key in &joints {
            values.push(number(key)?);
        }
        if !extra.columns.is_empty() {
            extra.rows.push(extra.columns.iter().map(|key| record.get(key).cloned().unwrap_or(Value::Null)).collect());
        }
    }
    let channels = joints.iter().map(|name| Channel::from_header(name)).collect();
    let times = clock.is_some().then_some(times);
    Draft { format, channels, times, fps: None, values, extra, notes: Vec::new(), place: Box::new(place) }
        .finish(options)
}

/// Refuses records of which the first has many more members than the others: every frame would hold what only the first says.
pub(super) fn bounded(columns: &[String], first: &Map<String, Value>, all: &[Value]) -> Result<(), MovesError> {
    let said: usize = all.iter().filter_map(Value::as_object).map(Map::len).sum();
    if columns.len() * all.len() > 8 * said + 1000 {
        let what =
            format!("found {} members in the first of {} frames, of which the others have few", first.len(), all.len());
        return Err(MovesError::new("frame 0", what, "take what does not belong to every frame out of it"));
    }
    Ok(())
}

/// LeRobot's records: `timestamp`, `episode_index`, `action` or `observation.state` as lists.
pub(super) fn lerobot(
    all: &[Value],
    path: &Path,
    options: &Options,
    place: Box<dyn Fn(usize) -> String>,
) -> Result<Moves, MovesError> {
    let mut notes = Vec::new();
    let episode = |record: &Value| record.get("episode_index").and_then(Value::as_f64).map_or(0, |x| x as u64);
    let first = all.first().map_or(0, episode);
    let wanted = options.episode.unwrap_or(first);
    let chosen: Vec<(usize, &Value)> = all.iter().enumerate().filter(|(_, record)| episode(record) == wanted).collect();
    let Some((_, head)) = chosen.first() else {
        let what = format!("found no episode {wanted}; the first one is {first}");
        return Err(MovesError::new("episode_index", what, "choose another with --episode"));
    };
    if options.episode.is_none() && chosen.len() < all.len() {
        notes.push(format!("The table has several episodes: {wanted} is taken (--episode)."));
    }
    let list = LISTS.into_iter().find(|key| head.get(*key).is_some_and(Value::is_array)).unwrap_or(LISTS[0]);
    let width = head.get(list).and_then(Value::as_array).map_or(0, Vec::len);
    let names = names_of(path, list).filter(|names| names.len() == width);
    if names.is_none() {
        notes.push(format!("No meta/info.json names the joints of '{list}': they are called {list}_0, {list}_1, ..."));
    }
    let names = names.unwrap_or_else(|| (0..width).map(|at| format!("{list}_{at}")).collect());
    notes.push(format!("'{list}' of a LeRobot table names no unit: degrees, or -100 to 100 of a joint's range, as the robot was set up."));
    let (mut times, mut values) = (Vec::new(), Vec::new());
    let lines: Vec<usize> = chosen.iter().map(|(at, _)| *at).collect();
    for (at, record) in &chosen {
        let row = numbers(record.get(list).unwrap_or(&Value::Null), &format!("{}, {list}", place(*at)))?;
        if row.len() != width {
            let what = format!("{list}: found {} numbers, expected {width}, as in the first frame", row.len());
            return Err(MovesError::new(place(*at), what, "is the file whole?"));
        }
        values.extend(row);
        times.extend(
            record.get("timestamp").map(|time| finite(time, || format!("{}, timestamp", place(*at)))).transpose()?,
        );
    }
    let times = (!times.is_empty()).then_some(times);
    let channels = names.iter().map(|name| Channel::from_header(name)).collect();
    let place = Box::new(move |frame: usize| place(lines.get(frame).copied().unwrap_or_default()));
    Draft { format: Format::JsonLines, channels, times, fps: None, values, extra: Extra::default(), notes, place }
        .finish(options)
}

/// The names in a data set's `meta/info.json`, beside the file or above it.
fn names_of(path: &Path, list: &str) -> Option<Vec<String>> {
    let info =
        path.ancestors().skip(1).take(4).map(|folder| folder.join("meta/info.json")).find(|info| info.is_file())?;
    let info: Value = serde_json::from_str(&files::read_text(&info).ok()?).ok()?;
    let names = info.get("features")?.get(list)?.get("names")?;
    // Older data sets have them under the name of a group.
    let names = names.as_array().or_else(|| names.as_object()?.values().next()?.as_array())?;
    names.iter().map(|name| Some(name.as_str()?.to_owned())).collect()
}
