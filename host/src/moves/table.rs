//! Tables: CSV by joint name, LeRobot's tables with lists in cells, ROS trajectories as CSV.

use std::borrow::Cow;
use std::path::Path;

use serde_json::Value;

use super::build::{Draft, is_index, time_unit};
use super::error::shown;
use super::{Channel, Extra, Format, Moves, MovesError, Options, json};

/// Whether the beginning of a table is a motion: a header with a column of times or of frames, or with columns of joints, above numbers.
pub(super) fn is_motion(head: &str) -> bool {
    let lower = head.to_lowercase();
    // Positions of joints, and of landmarks.
    if lower.contains("hipcenterx") || lower.contains("landmark") {
        return false;
    }
    let mut lines = head.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    let (Some(header), Some(first)) = (lines.next(), lines.next()) else { return false };
    let separator = separator(header);
    let names: Vec<&str> = header.split(separator).map(|name| name.trim().trim_matches('"')).collect();
    let numbers = first.split(separator).filter(|cell| number(cell, separator).is_some()).count();
    let clock = names.iter().any(|name| time_unit(name).is_some() || name.eq_ignore_ascii_case("frame_index"));
    let units = names.iter().any(|name| Channel::from_header(name).unit.is_some());
    let lists = names.iter().any(|name| json::is_list_name(name));
    names.iter().any(|name| number(name, separator).is_none()) && numbers > 0 && (clock || units || lists)
}

/// What most cells are parted by; what stands in quotes is part of a name.
fn separator(header: &str) -> char {
    let count =
        |separator: char| header.split('"').step_by(2).map(|text| text.matches(separator).count()).sum::<usize>();
    [',', ';', '\t'].into_iter().max_by_key(|separator| (count(*separator), *separator == ',')).unwrap_or(',')
}

/// A number; with semicolons between cells a comma may stand for the point.
fn number(cell: &str, separator: char) -> Option<f64> {
    let cell = cell.trim().trim_matches('"');
    match cell.parse::<f64>() {
        Ok(value) => Some(value),
        Err(_) if separator != ',' && cell.contains(',') => cell.replace(',', ".").parse().ok(),
        Err(_) => None,
    }
}

/// Reads a table.
pub(super) fn parse(text: &str, path: &Path, options: &Options) -> Result<Moves, MovesError> {
    // A last line without its end would be counted as the line before.
    let text = &if text.ends_with('\n') { Cow::Borrowed(text) } else { Cow::Owned(format!("{text}\n")) };
    let header = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or("");
    let separator = separator(header);
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator as u8)
        .comment(Some(b'#'))
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let refuse = |error: csv::Error| {
        let line = error.position().map_or(1, csv::Position::line);
        MovesError::new(format!("line {line}"), format!("not a table: {error}"), "is the file whole?")
    };
    let names: Vec<String> = reader.headers().map_err(refuse)?.iter().map(str::to_owned).collect();
    if names.iter().all(|name| number(name, separator).is_some()) {
        let what = "found numbers in the first line, expected the names of the joints";
        return Err(MovesError::new("line 1", what, "put a header above them, as in time_s,pan_deg,tilt_deg"));
    }
    let mut rows: Vec<(u64, csv::StringRecord)> = Vec::new();
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record).map_err(refuse)? {
        // Where the reader is now: a record's own position is that before the comments above it.
        let line = reader.position().line() - 1;
        if record.len() != names.len() {
            let what = format!("found {} cells, expected {}, as in the header", record.len(), names.len());
            return Err(MovesError::new(format!("line {line}"), what, "is the line whole?"));
        }
        rows.push((line, record.clone()));
    }
    if rows.is_empty() {
        return Err(MovesError::new("", "found a header without rows, expected frames below it", "is the file whole?"));
    }
    if names.iter().any(|name| json::is_list_name(name)) {
        return lists(&names, &rows, separator, path, options);
    }
    columns(&names, &rows, separator, options)
}

/// What a column is.
enum Column {
    /// Seconds in one of its units.
    Time(f64),
    Index,
    Joint(Channel),
    Extra,
}

fn columns(
    names: &[String],
    rows: &[(u64, csv::StringRecord)],
    separator: char,
    options: &Options,
) -> Result<Moves, MovesError> {
    let cell = |row: &csv::StringRecord, at: usize| number(row.get(at).unwrap_or(""), separator);
    let mut found: Vec<Column> = Vec::new();
    let mut timed = false;
    for (at, name) in names.iter().enumerate() {
        let numbers = rows.iter().filter(|(_, row)| cell(row, at).is_some()).count();
        found.push(match time_unit(name) {
            Some(seconds) if !timed => {
                timed = true;
                Column::Time(seconds)
            }
            _ if is_index(name) && counts(rows.iter().map(|(_, row)| cell(row, at))) => Column::Index,
            // Hardly a number in it: text.
            _ if numbers == 0 || 10 * numbers < rows.len() => Column::Extra,
            _ => Column::Joint(Channel::from_header(name)),
        });
    }
    let (mut times, mut values, mut extra) = (Vec::new(), Vec::new(), Extra::default());
    extra.columns =
        names.iter().zip(&found).filter(|(_, c)| matches!(c, Column::Extra)).map(|(n, _)| n.clone()).collect();
    for (line, row) in rows {
        let mut texts = Vec::new();
        for (at, column) in found.iter().enumerate() {
            let told = || {
                let what =
                    format!("{}: found {}, expected a finite number", names[at], shown(row.get(at).unwrap_or("")));
                MovesError::new(format!("line {line}"), what, "correct the cell, or cut the line out")
            };
            match column {
                Column::Time(seconds) => {
                    times.push(cell(row, at).filter(|x| x.is_finite()).ok_or_else(told)? * seconds)
                }
                Column::Joint(_) => values.push(cell(row, at).filter(|x| x.is_finite()).ok_or_else(told)?),
                Column::Extra => texts.push(Value::String(row.get(at).unwrap_or("").to_owned())),
                Column::Index => {}
            }
        }
        if !extra.columns.is_empty() {
            extra.rows.push(texts);
        }
    }
    let lines: Vec<u64> = rows.iter().map(|(line, _)| *line).collect();
    let draft = Draft {
        format: Format::Csv,
        channels: found
            .into_iter()
            .filter_map(|c| if let Column::Joint(channel) = c { Some(channel) } else { None })
            .collect(),
        times: timed.then_some(times),
        fps: None,
        values,
        extra,
        notes: Vec::new(),
        place: Box::new(move |frame| format!("line {}", lines.get(frame).copied().unwrap_or_default())),
    };
    draft.finish(options)
}

/// Whether numbers are those of frames: whole, and never falling. A finger may be called index.
fn counts(numbers: impl Iterator<Item = Option<f64>>) -> bool {
    let mut last = f64::NEG_INFINITY;
    numbers.into_iter().all(|number| {
        let known = number.is_some_and(|x| x.fract() == 0.0 && x >= last);
        last = number.unwrap_or(last);
        known
    })
}

/// LeRobot's rows as JSON records: the cells of lists are `[0.1, 0.2]`, or `[0.1 0.2]` as numpy prints them.
fn lists(
    names: &[String],
    rows: &[(u64, csv::StringRecord)],
    separator: char,
    path: &Path,
    options: &Options,
) -> Result<Moves, MovesError> {
    let mut records = Vec::new();
    for (line, row) in rows {
        let mut record = serde_json::Map::new();
        for (name, cell) in names.iter().zip(row) {
            let value = match cell.strip_prefix('[').and_then(|inner| inner.strip_suffix(']')) {
                Some(inner) => {
                    let parts = inner.split([',', ' ', '\n']).filter(|part| !part.is_empty());
                    let numbers: Option<Vec<Value>> = parts
                        .map(|part| part.parse::<f64>().ok().and_then(serde_json::Number::from_f64).map(Value::Number))
                        .collect();
                    let Some(numbers) = numbers else {
                        let what = format!("{name}: found {}, expected a list of finite numbers", shown(cell));
                        return Err(MovesError::new(format!("line {line}"), what, "as in [0.1, 0.2]"));
                    };
                    Value::Array(numbers)
                }
                None => number(cell, separator)
                    .and_then(serde_json::Number::from_f64)
                    .map_or_else(|| Value::String(cell.to_owned()), Value::Number),
            };
            record.insert(name.clone(), value);
        }
        records.push(Value::Object(record));
    }
    let lines: Vec<u64> = rows.iter().map(|(line, _)| *line).collect();
    let place = move |frame: usize| format!("line {}", lines.get(frame).copied().unwrap_or_default());
    json::lerobot(&records, path, options, Box::new(place))
}
