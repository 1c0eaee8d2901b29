//! Every format written back: the one that the file's name says, in the flavour that the motion came in.

use std::fmt::Write;
use std::path::Path;

use serde_json::Value;

use super::spelling::{Slot, clock, slots};
use super::tape::quote;
use super::{Channel, Format, Moves, MovesError, reachy, trajectory};
use crate::files::write_whole;

impl Moves {
    /// Writes the motion, whole or not at all, in the format that the name of the file says: `.csv`, `.json`, `.jsonl`, `.yaml`. Where that
    /// is the format that the motion came in, its headers, separators and layout are kept.
    ///
    /// A table and JSON lines have no room for members of the whole file ([`Extra::fields`](super::Extra::fields)); a trajectory has none for
    /// what every frame has beside joints.
    pub fn write(&self, path: &Path) -> Result<(), MovesError> {
        let extension = path.extension().and_then(|found| found.to_str()).unwrap_or("").to_lowercase();
        let text = match extension.as_str() {
            "csv" | "tsv" => self.to_csv(),
            "json" => self.to_json().map_err(|error| error.in_file(path))?,
            "jsonl" | "ndjson" => self.records(["", "\n", "\n"]),
            "yaml" | "yml" => trajectory::write(self),
            _ => {
                let what = "found another extension, expected .csv, .json, .jsonl or .yaml";
                let help = format!("name it {}", path.with_extension("csv").display());
                return Err(MovesError::new(path.display().to_string(), what, help));
            }
        };
        write_whole(path, text.as_bytes()).map_err(|error| {
            let help = "check that the folder exists and may be written to";
            MovesError::new(path.display().to_string(), format!("cannot be written: {error}"), help)
        })
    }

    /// A table: times, joints with their units, and what is no joint. Columns stand as in the table that the motion was read from.
    pub fn to_csv(&self) -> String {
        let spelling = &self.extra.spelling;
        let separator = spelling.separator.unwrap_or(',');
        let comma = spelling.comma && separator != ',';
        let slots = slots(&self.channels, &self.extra, "time_s");
        let mut text: String = spelling.comments.iter().map(|line| format!("{line}\n")).collect();
        let mut cells: Vec<String> = slots.iter().map(|(label, _)| label.clone()).collect();
        line(&mut text, &cells, separator);
        for (frame, time) in self.times.iter().enumerate() {
            cells.clear();
            let point = |x: String| if comma { x.replace('.', ",") } else { x };
            cells.extend(slots.iter().map(|(_, slot)| match slot {
                Slot::Time(seconds) => point(plain(clock(*time, *seconds))),
                Slot::Joint(at) => point(plain(self.frame(frame).get(*at).copied().unwrap_or_default())),
                Slot::List => {
                    format!("[{}]", self.frame(frame).iter().map(|x| plain(*x)).collect::<Vec<_>>().join(", "))
                }
                Slot::Index | Slot::Episode => frame.to_string(),
                Slot::Extra(at) => match self.extra.rows.get(frame).and_then(|row| row.get(*at)) {
                    Some(Value::String(cell)) => cell.clone(),
                    None | Some(Value::Null) => String::new(),
                    Some(other) => other.to_string(),
                },
            }));
            line(&mut text, &cells, separator);
        }
        text
    }

    /// JSON in the flavour that the motion came in, else by joint name.
    fn to_json(&self) -> Result<String, MovesError> {
        match self.format {
            Format::Reachy => reachy::write(self).ok_or_else(|| {
                let what = "found other joints or units than a move of Reachy Mini has";
                let help = "write .csv, or a robot with head_x ... head_yaw, right_antenna, left_antenna, body_yaw in m and rad";
                MovesError::new("", what, help)
            }),
            Format::Records | Format::JsonLines | Format::LeRobot => Ok(self.records(["[\n", ",\n", "\n]\n"])),
            _ => Ok(self.whole()),
        }
    }

    /// One object per frame; what is before, between and behind them.
    fn records(&self, [before, between, behind]: [&str; 3]) -> String {
        let slots = slots(&self.channels, &self.extra, "time");
        let mut out = before.to_owned();
        for (frame, time) in self.times.iter().enumerate() {
            out.push_str(if frame == 0 { "{" } else { between });
            if frame > 0 {
                out.push('{');
            }
            let mut first = true;
            for (label, slot) in &slots {
                let text = match slot {
                    Slot::Time(seconds) => number(clock(*time, *seconds)),
                    Slot::Joint(at) => number(self.frame(frame).get(*at).copied().unwrap_or_default()),
                    Slot::List => numbers(self.frame(frame).iter().copied()),
                    Slot::Index | Slot::Episode => frame.to_string(),
                    Slot::Extra(at) => match self.extra.rows.get(frame).and_then(|row| row.get(*at)) {
                        None | Some(Value::Null) => continue,
                        Some(value) => value.to_string(),
                    },
                };
                out.push_str(if first { "" } else { ", " });
                first = false;
                quote(label, &mut out);
                out.push_str(": ");
                out.push_str(&text);
            }
            out.push('}');
        }
        out.push_str(behind);
        out
    }

    /// One object: a list per joint, or per frame.
    fn whole(&self) -> String {
        let spelling = &self.extra.spelling;
        let mut out = String::from("{");
        let mut member = |key: &str, value: &str| {
            out.push_str(if out.len() > 1 { ",\n" } else { "" });
            quote(key, &mut out);
            out.push_str(": ");
            out.push_str(value);
        };
        self.extra.fields.iter().for_each(|(key, value)| member(key, &value.to_string()));
        // A unit of the whole file would be that of channels that have none, too.
        let unit = spelling.unit.as_ref().filter(|_| self.channels.iter().all(|own| own.unit.is_some()));
        if let Some((key, word)) = unit {
            member(key, &Value::String(word.clone()).to_string());
        }
        let due = |rate: f64| self.times.iter().zip(0..).all(|(time, at)| (time - f64::from(at) / rate).abs() < 1e-9);
        match &spelling.rate {
            Some((key, rate)) if spelling.time.is_none() && due(*rate) => member(key, &number(*rate)),
            _ => {
                let key = spelling.time.as_ref().map_or("times", |(key, _)| key);
                member(key, &numbers(self.times.iter().map(|time| clock(*time, 1.0))));
            }
        }
        let plain = spelling.unit.is_some() && unit.is_none();
        let label = |(at, own): (usize, &Channel)| if plain { own.header() } else { spelling.label(at, own) };
        let labels: Vec<String> = self.channels.iter().enumerate().map(label).collect();
        if spelling.frames {
            member("joint_names", &Value::from(labels).to_string());
            let rows: Vec<String> =
                (0..self.frames()).map(|frame| numbers(self.frame(frame).iter().copied())).collect();
            member("frames", &format!("[{}]", rows.join(",\n")));
        } else {
            let mut joints = String::from("{");
            for (at, label) in labels.iter().enumerate() {
                joints.push_str(if at == 0 { "" } else { ",\n" });
                quote(label, &mut joints);
                let own = self.values.iter().skip(at).step_by(labels.len()).copied();
                let _ = write!(joints, ": {}", numbers(own));
            }
            joints.push('}');
            member("joints", &joints);
        }
        out.push_str("}\n");
        out
    }
}

fn line(text: &mut String, cells: &[String], separator: char) {
    for (at, cell) in cells.iter().enumerate() {
        if at > 0 {
            text.push(separator);
        }
        quoted(cell, separator, text);
    }
    text.push('\n');
}

/// A cell as CSV wants it (RFC 4180).
fn quoted(cell: &str, separator: char, out: &mut String) {
    if cell.contains([separator, '"', '\n', '\r']) || cell.starts_with('#') {
        out.push('"');
        out.push_str(&cell.replace('"', "\"\""));
        out.push('"');
    } else {
        out.push_str(cell);
    }
}

/// Numbers as a list of JSON.
pub(super) fn numbers(values: impl Iterator<Item = f64>) -> String {
    let mut out = String::from("[");
    for (at, x) in values.enumerate() {
        out.push_str(if at == 0 { "" } else { ", " });
        out.push_str(&number(x));
    }
    out.push(']');
    out
}

/// A number as JSON: as few digits as give it back, no negative zero.
pub(super) fn number(x: f64) -> String {
    match x.is_finite() {
        true => format!("{:?}", x + 0.0),
        false => "null".into(),
    }
}

/// A number as a cell.
fn plain(x: f64) -> String {
    match x.abs() {
        size if size == 0.0 || (1e-5..1e15).contains(&size) => format!("{}", x + 0.0),
        _ => format!("{x:?}"),
    }
}
