//! Tables: CSV by joint name, LeRobot's tables with lists in cells, ROS trajectories as CSV, kinesic's own joint angles.

use std::path::Path;

use serde_json::Value;

use super::build::{Draft, at_lines, time_unit};
use super::columns::{self, Columns};
use super::error::shown;
use super::lerobot::{self, Episode};
use super::spelling::Slot;
use super::{Channel, Extra, Format, Moves, MovesError, Options, trajectory};

/// The separator of the most cells.
pub(super) fn separator(header: &str) -> char {
    let count = |separator: char| header.matches(separator).count();
    [',', ';', '\t'].into_iter().max_by_key(|separator| (count(*separator), *separator == ',')).unwrap_or(',')
}

/// A number, and whether a comma stands for its point: only where other signs are between cells.
pub(super) fn number(cell: &str, separator: char) -> Option<(f64, bool)> {
    let cell = cell.trim();
    match cell.parse() {
        Ok(value) => Some((value, false)),
        Err(_) if separator != ',' && cell.contains(',') => Some((cell.replacen(',', ".", 1).parse().ok()?, true)),
        Err(_) => None,
    }
}

/// Rows of cells under their headers, each with its line.
pub(super) struct Rows<'a> {
    reader: csv::Reader<&'a [u8]>,
    text: &'a str,
    /// Bytes that are read, and the lines that end in them.
    read: (usize, u32),
    names: usize,
}

impl<'a> Rows<'a> {
    /// The headers, and the rows below them.
    pub fn new(text: &'a str, separator: char) -> Result<(Vec<String>, Self), MovesError> {
        let mut builder = csv::ReaderBuilder::new();
        builder.delimiter(separator as u8).comment(Some(b'#')).flexible(true).trim(csv::Trim::All);
        let mut reader = builder.from_reader(text.as_bytes());
        let names: Vec<String> = reader.headers().map_err(refuse)?.iter().map(str::to_owned).collect();
        let rows = Self { reader, text, read: (0, 0), names: names.len() };
        Ok((names, rows))
    }

    /// The next row that is not blank, and its line.
    pub fn next(&mut self, row: &mut csv::StringRecord) -> Result<Option<u32>, MovesError> {
        while self.reader.read_record(row).map_err(refuse)? {
            let line = self.line();
            if self.names > 1 && row.len() == 1 && row.get(0) == Some("") {
                continue;
            }
            if row.len() != self.names {
                let what = format!("found {} cells, expected {}, as in the header", row.len(), self.names);
                return Err(MovesError::new(format!("line {line}"), what, "is the line whole?"));
            }
            return Ok(Some(line));
        }
        Ok(None)
    }

    /// The line of the row that was read: its own position is that before the comments above it.
    fn line(&mut self) -> u32 {
        let end = self.reader.position().byte() as usize;
        let new = self.text.as_bytes().get(self.read.0..end).unwrap_or(&[]);
        let before = self.read.1 + new.iter().filter(|byte| **byte == b'\n').count() as u32;
        self.read = (end, before);
        before + u32::from(new.last() != Some(&b'\n'))
    }
}

fn refuse(error: csv::Error) -> MovesError {
    let line = error.position().map_or(1, csv::Position::line);
    MovesError::new(format!("line {line}"), format!("not a table: {error}"), "is the file whole?")
}

/// Numbers of a list: `[0.1, 0.2]`, or `[0.1 0.2]` as numpy prints them.
fn list<'a>(cell: &'a str, place: &dyn Fn(&str) -> MovesError) -> Result<impl Iterator<Item = &'a str>, MovesError> {
    let inner = cell.strip_prefix('[').and_then(|inner| inner.strip_suffix(']')).ok_or_else(|| place(cell))?;
    Ok(inner.split([',', ' ', '\n', '\r', '\t']).filter(|part| !part.is_empty()))
}

/// Reads a table.
pub(super) fn parse(text: &str, path: &Path, options: &Options) -> Result<Moves, MovesError> {
    let Columns { separator, names, slots, mut labels, columns, mut spelling, mut notes, list: lists } =
        columns::of(text)?;
    let (mut times, mut values, mut lines, mut indices) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut extra = Extra { columns, ..Extra::default() };
    let (mut episode, mut width) = (Episode::new(options.episode), labels.len());
    let (_, mut reader) = Rows::new(text, separator)?;
    let mut row = csv::StringRecord::new();
    while let Some(line) = reader.next(&mut row)? {
        let odd = |at: usize, found: &str, expected: &str| {
            let name = names.get(at).map_or("", String::as_str);
            let what = format!("found {}, expected {expected}", shown(found));
            MovesError::new(format!("line {line}, column {name}"), what, "correct the cell, or cut the line out")
        };
        let finite = |at: usize, cell: &str, comma: &mut bool| match number(cell, separator) {
            Some((value, own)) if value.is_finite() => {
                *comma |= own;
                Ok(value)
            }
            _ => Err(odd(at, cell, "a finite number")),
        };
        let place = slots.iter().position(|slot| *slot == Slot::Episode);
        if let Some(at) = place
            && !episode.takes(Some(finite(at, row.get(at).unwrap_or(""), &mut false)?))
        {
            continue;
        }
        let mut texts = Vec::with_capacity(extra.columns.len());
        for (at, (slot, cell)) in slots.iter().zip(&row).enumerate() {
            match slot {
                Slot::Time(seconds) => times.push(finite(at, cell, &mut spelling.comma)? * seconds),
                Slot::Joint(_) => values.push(finite(at, cell, &mut spelling.comma)?),
                Slot::Index => indices.extend(number(cell, separator).map(|(value, _)| value)),
                Slot::List => {
                    let before = values.len();
                    for part in list(cell, &|cell| odd(at, cell, "a list of numbers, as in [0.1, 0.2]"))? {
                        values.push(finite(at, part, &mut false)?);
                    }
                    let found = values.len() - before;
                    width = if lines.is_empty() { found } else { width };
                    if found != width {
                        return Err(odd(at, cell, &format!("{width} numbers, as in the first frame")));
                    }
                }
                Slot::Episode | Slot::Extra(_) => texts.push(Value::String(cell.to_owned())),
            }
        }
        if !extra.columns.is_empty() {
            extra.rows.push(texts);
        }
        lines.push(line);
    }
    if lists.is_some() || slots.contains(&Slot::Episode) {
        episode.finish(lines.len(), &mut notes)?;
    }
    if let Some(lists) = lists {
        labels = lerobot::names(path, lists, width, &mut notes);
    }
    let timed = spelling.time.clone();
    let times = match &timed {
        Some(_) => Some(times),
        None => columns::gaps(&indices, lines.len(), options, &mut notes),
    };
    let ros = timed.is_some_and(|(label, _)| label.trim().eq_ignore_ascii_case("time_from_start"));
    if ros {
        notes.push(trajectory::UNITS.to_owned());
    }
    let format = match () {
        () if lists.is_some() => Format::LeRobot,
        () if ros => Format::TrajectoryCsv,
        () if columns::is_angles(&names) => Format::Angles,
        () => Format::Csv,
    };
    extra.spelling = spelling;
    let channels = labels.iter().map(|label| Channel::from_header(label)).collect();
    Draft { format, channels, labels, times, fps: None, values, extra, notes, place: at_lines(lines) }.finish(options)
}

/// Whether the beginning of a table is a motion: a header with a column of times or of frames, or with columns of joints, above numbers.
pub(super) fn is_motion(head: &str) -> bool {
    let lower = head.to_lowercase();
    let mut lines = head.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    let Some(header) = lines.next() else { return false };
    let separator = separator(header);
    let names: Vec<&str> = header.split(separator).map(|name| name.trim().trim_matches('"')).collect();
    let is = |name: &str| names.iter().any(|own| own.eq_ignore_ascii_case(name));
    // Positions of joints, and of landmarks.
    if lower.contains("hipcenterx")
        || lower.contains("landmark")
        || (is("x0") || is("x_0")) && (is("y67") || is("y_67"))
    {
        return false;
    }
    let cells = |line: &str| {
        line.split(separator).filter(|cell| number(cell.trim_matches('"'), separator).is_some()).count() > 0
    };
    let clock = names.iter().any(|name| time_unit(name).is_some() || name.eq_ignore_ascii_case("frame_index"));
    let units = names.iter().any(|name| Channel::from_header(name).unit.is_some());
    let lists = names.iter().any(|name| lerobot::is_list_name(name));
    let worded = names.iter().any(|name| number(name, separator).is_none());
    // A wide header fills the beginning of a file alone.
    worded && lines.next().is_none_or(cells) && (clock || units || lists)
}
