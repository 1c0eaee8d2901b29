//! Every format written back: the one that the file's name says, in the flavour that the motion came in.

use std::fmt::Write;
use std::path::Path;

use serde_json::{Map, Value, json};

use super::{Format, Moves, MovesError, reachy, trajectory};
use crate::files::write_whole;
use crate::plain::quoted;

impl Moves {
    /// Writes the motion, whole or not at all, in the format that the name of the file says: `.csv`, `.json`, `.jsonl`, `.yaml`. A motion
    /// that was read from JSON keeps its flavour, moves of Reachy Mini among them.
    pub fn write(&self, path: &Path) -> Result<(), MovesError> {
        let extension = path.extension().and_then(|found| found.to_str()).unwrap_or("").to_lowercase();
        let in_file = |error: MovesError| error.in_file(path);
        let text = match extension.as_str() {
            "csv" => self.to_csv(),
            "json" => self.to_json().map_err(in_file)?,
            "jsonl" | "ndjson" => self.to_lines(),
            "yaml" | "yml" => {
                let whole = trajectory::write(self).map_err(in_file)?;
                serde_norway::to_string(&whole)
                    .map_err(|error| in_file(MovesError::new("", error.to_string(), "write .csv")))?
            }
            _ => {
                let help = format!("name it {}", path.with_extension("csv").display());
                return Err(MovesError::new(
                    path.display().to_string(),
                    "found another extension, expected .csv, .json, .jsonl or .yaml",
                    help,
                ));
            }
        };
        write_whole(path, text.as_bytes()).map_err(|error| {
            let help = "check that the folder exists and may be written to";
            MovesError::new(path.display().to_string(), format!("cannot be written: {error}"), help)
        })
    }

    /// A table: times, joints with their units, and what is no joint.
    pub fn to_csv(&self) -> String {
        let mut text = "time_s".to_owned();
        let headers = self.channels.iter().map(super::Channel::header).chain(self.extra.columns.iter().cloned());
        headers.for_each(|header| text.push_str(&format!(",{}", quoted(&header))));
        text.push('\n');
        for frame in 0..self.frames() {
            // Writing to a String cannot fail.
            let _ = write!(text, "{}", seconds(self.times[frame]));
            self.frame(frame).iter().for_each(|x| text.push_str(&format!(",{}", plain(*x))));
            for cell in self.extra.rows.get(frame).into_iter().flatten() {
                let cell = cell.as_str().map_or_else(|| cell.to_string(), str::to_owned);
                text.push_str(&format!(",{}", quoted(&cell)));
            }
            text.push('\n');
        }
        text
    }

    /// JSON in the flavour that the motion came in, else by joint name.
    fn to_json(&self) -> Result<String, MovesError> {
        let whole = match self.format {
            Format::Reachy => reachy::write(self)?,
            Format::Records => (0..self.frames()).map(|frame| self.record(frame)).collect(),
            _ => self.columns(),
        };
        Ok(format!("{whole}\n"))
    }

    /// One object per line.
    fn to_lines(&self) -> String {
        (0..self.frames()).map(|frame| format!("{}\n", self.record(frame))).collect()
    }

    fn record(&self, frame: usize) -> Value {
        let mut record = Map::new();
        record.insert("time".into(), json!(seconds(self.times[frame])));
        for (channel, x) in self.channels.iter().zip(self.frame(frame)) {
            record.insert(channel.header(), json!(x));
        }
        for (key, value) in self.extra.columns.iter().zip(self.extra.rows.get(frame).into_iter().flatten()) {
            record.insert(key.clone(), value.clone());
        }
        Value::Object(record)
    }

    fn columns(&self) -> Value {
        let width = self.channels.len();
        let list = |at: usize| self.values.iter().skip(at).step_by(width).copied().collect::<Vec<f64>>();
        let joints: Map<String, Value> =
            self.channels.iter().enumerate().map(|(at, channel)| (channel.header(), json!(list(at)))).collect();
        let mut whole = self.extra.fields.clone();
        whole.insert("times".into(), json!(self.times.iter().map(|time| seconds(*time)).collect::<Vec<f64>>()));
        whole.insert("joints".into(), Value::Object(joints));
        Value::Object(whole)
    }
}

/// A time to the tenth of a microsecond: sums of frames have more digits than clocks.
fn seconds(time: f64) -> f64 {
    (time * 1e7).round() / 1e7
}

/// As few digits as give the number back; no negative zero.
fn plain(x: f64) -> f64 {
    x + 0.0
}
