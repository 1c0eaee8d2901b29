//! JSON by joint name: a list per joint, or a list per frame.

use std::path::Path;

use super::build::Draft;
use super::error::shown;
use super::spelling::Spelling;
use super::tape::Node;
use super::{Channel, Extra, Format, Moves, MovesError, Options, Unit, lex, reachy, records};

/// Keys of times, of rates and of units.
const TIMES: [&str; 4] = ["times", "time", "timestamps", "t"];
const RATES: [&str; 3] = ["fps", "rate", "frame_rate"];
const UNITS: [&str; 2] = ["unit", "units"];

const EXAMPLE: &str = "as in {\"fps\": 50, \"joints\": {\"pan\": [0.1, 0.2]}}";

/// Reads any of them, and moves of Reachy Mini and records.
pub(super) fn parse(text: &str, path: &Path, options: &Options) -> Result<Moves, MovesError> {
    let tape = lex::parse(text)?;
    let mut values = tape.root().items();
    let (Some(whole), second) = (values.next(), values.next()) else {
        return Err(MovesError::new("", "found no value, expected a motion", EXAMPLE));
    };
    let size = text.len();
    if second.is_some() {
        return records::parse(tape.root().items(), (Format::JsonLines, path, size), options);
    }
    if whole.is_list() {
        return records::parse(whole.items(), (Format::Records, path, size), options);
    }
    let has = |key: &str| whole.get(key).is_some();
    match () {
        () if has("set_target_data") => reachy::parse(whole, size, options),
        () if has("joints") => columns(whole, size, options),
        () if has("joint_names") => rows(whole, size, options),
        () => {
            let keys: Vec<&str> = whole.members().take(8).map(|(key, _)| key).collect();
            let what = format!("found {}, expected joints, joint_names or set_target_data", shown(&keys.join(", ")));
            Err(MovesError::new(whole.place(""), what, EXAMPLE))
        }
    }
}

/// The finite numbers of a list.
fn numbers(list: Node<'_>, name: &str) -> Result<Vec<f64>, MovesError> {
    let items = list.list(|| name.to_owned())?;
    items.enumerate().map(|(frame, x)| x.finite(|| format!("{name}, frame {frame}"))).collect()
}

/// Times, rate, unit and what is no joint.
struct Head {
    times: Option<Vec<f64>>,
    fps: Option<f64>,
    unit: Option<Unit>,
    extra: Extra,
}

fn head(whole: Node<'_>, own: &[&str], size: usize) -> Result<Head, MovesError> {
    let (mut spelling, mut others) = (Spelling::default(), Vec::new());
    let (mut times, mut fps, mut unit) = (None, None, None);
    for (key, value) in whole.members() {
        if own.contains(&key) {
            continue;
        }
        if TIMES.contains(&key) && value.is_list() && times.is_none() {
            times = Some(numbers(value, key)?);
            spelling.time = Some((key.to_owned(), 1.0));
        } else if RATES.contains(&key) && fps.is_none() {
            let rate = value.finite(|| key.to_owned())?;
            (fps, spelling.rate) = (Some(rate), Some((key.to_owned(), rate)));
        } else if UNITS.contains(&key) && !value.is_map() && unit.is_none() {
            unit = Unit::parse(value.text());
            if unit.is_none() {
                let what = format!("found {}, expected deg, rad, m, mm, ticks, us or percent", value.shown());
                return Err(MovesError::new(value.place(key), what, "correct it"));
            }
            spelling.unit = Some((key.to_owned(), value.text().to_owned()));
        } else {
            others.push((key, value));
        }
    }
    let fields = records::fields(others.into_iter(), size)?;
    Ok(Head { times, fps, unit, extra: Extra { fields, spelling, ..Extra::default() } })
}

fn channel(header: &str, unit: Option<Unit>) -> Channel {
    let found = Channel::from_header(header);
    Channel { unit: found.unit.or(unit), ..found }
}

/// `{"fps": 50, "joints": {"pan": [...]}}`.
fn columns(whole: Node<'_>, size: usize, options: &Options) -> Result<Moves, MovesError> {
    let Head { times, fps, unit, extra } = head(whole, &["joints"], size)?;
    let joints = whole.get("joints").unwrap_or(whole);
    if !joints.is_map() {
        let what = format!("found {}, expected an object with a list of numbers per joint", joints.shown());
        return Err(MovesError::new(joints.place("joints"), what, EXAMPLE));
    }
    let width = joints.members().count();
    let (mut labels, mut values, mut frames) = (Vec::with_capacity(width), Vec::new(), 0);
    for (at, (name, list)) in joints.members().enumerate() {
        let count = list.list(|| name.to_owned())?.count();
        if at == 0 {
            frames = count;
            values.resize(frames * width, 0.0);
        }
        if count != frames {
            let first = labels.first().map_or("", String::as_str);
            let what = format!("found {count} numbers, expected {frames}, as for {}", shown(first));
            return Err(MovesError::new(list.place(name), what, "is the file whole?"));
        }
        let numbers = list.items().enumerate();
        for (to, (frame, x)) in values.iter_mut().skip(at).step_by(width).zip(numbers) {
            *to = x.finite(|| format!("{name}, frame {frame}"))?;
        }
        labels.push(name.to_owned());
    }
    draft(labels, unit, [times, Some(values)], fps, extra, options)
}

/// `{"joint_names": [...], "frames": [[...]]}`.
fn rows(whole: Node<'_>, size: usize, options: &Options) -> Result<Moves, MovesError> {
    let Head { times, fps, unit, mut extra } = head(whole, &["joint_names", "frames"], size)?;
    extra.spelling.frames = true;
    let Some(frames) = whole.get("frames") else {
        let help = "as in {\"joint_names\": [\"pan\"], \"fps\": 50, \"frames\": [[0.1], [0.2]]}";
        return Err(MovesError::new(whole.place(""), "found joint_names and no 'frames', expected both", help));
    };
    let names = whole.get("joint_names").unwrap_or(whole);
    let labels: Vec<String> = names.list(|| "joint_names".into())?.map(|name| name.text().to_owned()).collect();
    let mut values = Vec::new();
    for (frame, row) in frames.list(|| "frames".into())?.enumerate() {
        let start = values.len();
        for (at, x) in row.list(|| format!("frame {frame}"))?.enumerate() {
            let name = || labels.get(at).map_or("", String::as_str);
            values.push(x.finite(|| format!("frame {frame}, {}", name()))?);
        }
        let (found, expected) = (values.len() - start, labels.len());
        if found != expected {
            let what = format!("found {found} numbers, expected {expected}, as many as joint_names");
            return Err(MovesError::new(row.place(&format!("frame {frame}")), what, "is the file whole?"));
        }
    }
    draft(labels, unit, [times, Some(values)], fps, extra, options)
}

fn draft(
    labels: Vec<String>,
    unit: Option<Unit>,
    [times, values]: [Option<Vec<f64>>; 2],
    fps: Option<f64>,
    extra: Extra,
    options: &Options,
) -> Result<Moves, MovesError> {
    let channels = labels.iter().map(|label| channel(label, unit)).collect();
    let (values, place) = (values.unwrap_or_default(), Box::new(|frame| format!("frame {frame}")));
    let mut notes = Vec::new();
    if let (Some(times), Some(fps)) = (&times, fps) {
        let steps = times.len().saturating_sub(1) as f64;
        let length = times.last().copied().unwrap_or_default() - times.first().copied().unwrap_or_default();
        if (steps / fps - length).abs() > 0.01 * length {
            notes.push(format!("The times are taken; the rate of {fps} frames per second does not fit them."));
        }
    }
    Draft { format: Format::Json, channels, labels, times, fps, values, extra, notes, place }.finish(options)
}
