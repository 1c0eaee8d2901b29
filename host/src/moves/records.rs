//! JSON with one object per frame: `[{"time": 0, "pan": 0.1}, ...]`, JSON lines, LeRobot's records with lists.

use std::collections::HashMap;
use std::path::Path;

use serde_json::{Map, Value};

use super::build::{Draft, is_index, time_unit};
use super::error::shown;
use super::lerobot::{self, Episode};
use super::spelling::{Slot, Spelling};
use super::tape::Node;
use super::{Channel, Extra, Format, Moves, MovesError, Options};

/// Members that are no joints, frame by frame.
pub(super) struct Others {
    columns: HashMap<String, usize>,
    rows: Vec<Vec<Value>>,
    left: usize,
    /// Members of all frames, and of the first.
    said: [usize; 2],
}

impl Others {
    /// None yet; `size` is that of the file, bytes.
    pub fn new(size: usize) -> Self {
        Self { columns: HashMap::new(), rows: Vec::new(), left: size.max(100_000), said: [0; 2] }
    }

    /// Begins a frame.
    pub fn frame(&mut self, frame: Node<'_>) {
        let members = frame.members().count();
        let [all, first] = self.said;
        self.said = [all + members, if self.rows.is_empty() { members } else { first }];
        self.rows.push(Vec::new());
    }

    /// Adds a member of this frame.
    pub fn add(&mut self, key: &str, value: Node<'_>) -> Result<(), MovesError> {
        let at = match self.columns.get(key) {
            Some(at) => *at,
            None => {
                self.columns.insert(key.to_owned(), self.columns.len());
                self.columns.len() - 1
            }
        };
        let Some(row) = self.rows.last() else { return Ok(()) };
        // An object takes as much memory as some twenty numbers.
        let cost = (at + 1).saturating_sub(row.len()) + 24 * value.maps();
        self.pay(key, value, cost)?;
        let Some(row) = self.rows.last_mut() else { return Ok(()) };
        if row.len() <= at {
            row.resize(at + 1, Value::Null);
        }
        if let Some(cell) = row.get_mut(at) {
            *cell = value.value();
        }
        Ok(())
    }

    /// Bounds memory: a small file can stand for much.
    fn pay(&mut self, key: &str, value: Node<'_>, cost: usize) -> Result<(), MovesError> {
        self.left = self.left.checked_sub(cost).ok_or_else(|| {
            let what =
                "found keys that differ from frame to frame, or many objects that are no joints, expected a motion";
            MovesError::new(value.place(key), what, "remove what is no motion")
        })?;
        Ok(())
    }

    /// Names of the columns, and one value per frame and column. A table of them must not be many times what the frames say.
    pub fn finish(self) -> Result<(Vec<String>, Vec<Vec<Value>>), MovesError> {
        let (width, frames, [all, first]) = (self.columns.len(), self.rows.len(), self.said);
        if width * frames > 8 * all + 1000 {
            let what = format!(
                "found {width} names beside the joints in {frames} frames, of which most say little; the first has {first} members"
            );
            return Err(MovesError::new("frame 0", what, "take what does not belong to every frame out of it"));
        }
        let mut columns = vec![String::new(); width];
        for (key, at) in self.columns {
            if let Some(column) = columns.get_mut(at) {
                *column = key;
            }
        }
        let rows = if columns.is_empty() { Vec::new() } else { self.rows };
        Ok((columns, rows))
    }
}

/// Members of the whole file that are no joints; `size` is that of the file, bytes.
pub(super) fn fields<'a>(
    members: impl Iterator<Item = (&'a str, Node<'a>)>,
    size: usize,
) -> Result<Map<String, Value>, MovesError> {
    let mut others = Others::new(size);
    members
        .map(|(key, value)| {
            others.pay(key, value, 24 * value.maps())?;
            Ok((key.to_owned(), value.value()))
        })
        .collect()
}

/// What the members of the first record are.
struct Head<'a> {
    slots: HashMap<&'a str, Slot>,
    labels: Vec<String>,
    spelling: Spelling,
    list: Option<&'static str>,
}

fn head<'a>(first: Node<'a>) -> Result<Head<'a>, MovesError> {
    if !first.is_map() {
        let what = format!("found {}, expected one object per frame", first.shown());
        return Err(MovesError::new(first.place(""), what, "as in [{\"time\": 0.0, \"pan\": 0.1}]"));
    }
    let list = lerobot::chosen(first.members().filter(|(_, value)| value.is_list()).map(|(key, _)| key));
    let (mut slots, mut labels, mut spelling) = (HashMap::new(), Vec::new(), Spelling::default());
    spelling.list = list.map(str::to_owned);
    for (key, value) in first.members() {
        spelling.order.push(key.to_owned());
        let numeric = value.number().is_some();
        let slot = match time_unit(key) {
            Some(seconds) if numeric && spelling.time.is_none() => {
                spelling.time = Some((key.to_owned(), seconds));
                Slot::Time(seconds)
            }
            // A second clock is no joint.
            Some(_) => continue,
            None if is_index(key) && numeric && spelling.index.is_none() => {
                spelling.index = Some(key.to_owned());
                Slot::Index
            }
            None if list == Some(key) => Slot::List,
            None if list.is_some() && key == "episode_index" => Slot::Episode,
            None if list.is_none() && numeric && !is_index(key) => {
                labels.push(key.to_owned());
                Slot::Joint(labels.len() - 1)
            }
            None => continue,
        };
        if slots.insert(key, slot).is_some() {
            let what = format!("found {} twice", shown(key));
            return Err(MovesError::new(value.place(key), what, "name every joint once"));
        }
    }
    Ok(Head { slots, labels, spelling, list })
}

/// Reads them. `size` is that of the file, bytes.
pub(super) fn parse<'a>(
    records: impl Iterator<Item = Node<'a>>,
    (format, path, size): (Format, &Path, usize),
    options: &Options,
) -> Result<Moves, MovesError> {
    let mut records = records.enumerate().peekable();
    let Some((_, first)) = records.peek().copied() else {
        return Err(MovesError::new("", "found no frame, expected at least 2", "is the file whole?"));
    };
    let Head { slots, labels, spelling, list } = head(first)?;
    let (mut times, mut values, mut lines, mut notes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut others, mut episode) = (Others::new(size), Episode::new(options.episode));
    let mut width = labels.len();
    for (frame, record) in records {
        let place = |key: &str| match format {
            Format::JsonLines => key.to_owned(),
            _ => format!("frame {frame}{}{key}", if key.is_empty() { "" } else { ", " }),
        };
        if list.is_some() {
            let number = record.get("episode_index").map(|x| x.finite(|| place("episode_index"))).transpose()?;
            if !episode.takes(number) {
                continue;
            }
        }
        if let (Some(list), true) = (list, lines.is_empty()) {
            width = record.get(list).map_or(0, |list| list.items().count());
        }
        let start = values.len();
        values.resize(start + width, f64::NAN);
        let (mut timed, mut found) = (false, 0);
        others.frame(record);
        for (key, value) in record.members() {
            match slots.get(key) {
                Some(Slot::Time(seconds)) => {
                    times.push(value.finite(|| place(key))? * seconds);
                    timed = true;
                }
                Some(Slot::Joint(at)) => {
                    if let Some(to) = values.get_mut(start + at) {
                        found += usize::from(to.is_nan());
                        *to = value.finite(|| place(key))?;
                    }
                }
                Some(Slot::List) => {
                    for item in value.list(|| place(key))? {
                        if let Some(to) = values.get_mut(start + found) {
                            *to = item.finite(|| place(key))?;
                        }
                        found += 1;
                    }
                }
                Some(Slot::Index) => {}
                Some(_) | None => others.add(key, value)?,
            }
        }
        if found != width {
            return Err(count(record, &labels, list, [found, width], &place));
        }
        if spelling.time.is_some() && times.len() != lines.len() + 1 || timed != spelling.time.is_some() {
            let time = spelling.time.map_or_else(String::new, |(label, _)| label);
            let what = format!("found no {time} or several, expected one, as in the first frame");
            return Err(MovesError::new(record.place(&place("")), what, "is the file whole?"));
        }
        lines.push(record.line());
    }
    let labels = match list {
        Some(list) => lerobot::names(path, list, width, &mut notes),
        None => labels,
    };
    episode.finish(lines.len(), &mut notes)?;
    let (columns, rows) = others.finish()?;
    let times = spelling.time.is_some().then_some(times);
    let extra = Extra { columns, rows, spelling, ..Extra::default() };
    let channels = labels.iter().map(|name| Channel::from_header(name)).collect();
    let (format, place) = (if list.is_some() { Format::LeRobot } else { format }, super::build::at_lines(lines));
    Draft { format, channels, labels, times, fps: None, values, extra, notes, place }.finish(options)
}

/// A frame with another number of joints than the first.
fn count(
    record: Node<'_>,
    labels: &[String],
    list: Option<&str>,
    [found, width]: [usize; 2],
    place: &dyn Fn(&str) -> String,
) -> MovesError {
    if let Some(list) = list {
        let what = format!("found {found} numbers, expected {width}, as in the first frame");
        return MovesError::new(record.place(&place(list)), what, "is the file whole?");
    }
    let missing = labels.iter().find(|label| record.get(label).is_none()).map_or("", String::as_str);
    let what = format!("found no {}, expected it as in the first frame", shown(missing));
    MovesError::new(record.place(&place("")), what, "is the file whole?")
}
