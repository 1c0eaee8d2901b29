//! Motions of machines in their own joints: one number per channel and frame, in the units of the file.
//!
//! | file | holds |
//! |---|---|
//! | `unit` | [`Unit`], [`Channel`]: units, and how headers carry them |
//! | `read` | [`read`], [`parse`], [`is_moves`]: which format a file has |
//! | `table` | CSV by joint name, LeRobot's tables, ROS trajectories as CSV |
//! | `json` | JSON by joint name, JSON lines |
//! | `reachy` | moves of Reachy Mini |
//! | `trajectory` | `trajectory_msgs/JointTrajectory` as YAML |
//! | `build` | checks that all formats share: times, names, counts |
//! | `resample` | other frame rates |
//! | `write` | every format written back |

mod build;
mod error;
mod json;
mod reachy;
mod read;
mod resample;
mod table;
mod trajectory;
mod unit;
mod write;

use serde::Serialize;
use serde_json::{Map, Value};

pub use error::MovesError;
pub use read::{is_moves, parse, read};
pub use unit::{Channel, UNITS, Unit, unit_name, unit_of};

/// Which format a file had, so that it can be written back in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// A table with a header of joint names.
    Csv,
    /// `{"fps": 50, "joints": {"pan": [...]}}`.
    Json,
    /// `[{"time": 0, "pan": 0.1}, ...]`.
    Records,
    /// One JSON object per line.
    JsonLines,
    /// A move of Reachy Mini.
    Reachy,
    /// `trajectory_msgs/JointTrajectory` as YAML.
    Trajectory,
}

/// What the caller knows better than the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Frames per second of a file without times.
    pub rate: Option<f64>,
    /// Which episode of a table with several; the first unless given.
    pub episode: Option<u64>,
}

/// What a file holds beside joints: sound, lights, eyes, a description. Written back as it was.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Extra {
    /// Of the whole file.
    pub fields: Map<String, Value>,
    /// Names of what every frame has.
    pub columns: Vec<String>,
    /// One value per frame and column; a cell of a table is a text.
    pub rows: Vec<Vec<Value>>,
}

/// A motion of a machine in its own joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Moves {
    /// Which format the file had.
    pub format: Format,
    /// The columns of numbers.
    pub channels: Vec<Channel>,
    /// When every frame is due, s, rising, from 0 on.
    pub times: Vec<f64>,
    /// `[frames x channels]`, in the units of the file.
    pub values: Vec<f64>,
    /// What is no joint.
    pub extra: Extra,
    /// What was assumed or left out, one sentence each.
    pub notes: Vec<String>,
}

/// A motion in figures.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Which format the file had.
    pub format: Format,
    /// Number of frames.
    pub frames: usize,
    /// Length, s.
    pub duration_s: f64,
    /// Frames per second, the median.
    pub fps: f64,
    /// Whether all frames are equally far apart.
    pub even: bool,
    /// The channels.
    pub channels: Vec<ChannelSummary>,
    /// Names of what is no joint.
    pub extra: Vec<String>,
    /// What was assumed or left out.
    pub notes: Vec<String>,
}

/// A channel in figures, in its own unit.
#[derive(Clone, Debug, Serialize)]
pub struct ChannelSummary {
    /// Its name.
    pub name: String,
    /// Its unit, where the file says it, or what a robot takes it for.
    pub unit: Option<&'static str>,
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// Largest speed from frame to frame, per second.
    pub speed: f64,
}

/// Frames may be so far from equally spaced, as a share of their distance.
const EVEN: f64 = 0.02;

impl Moves {
    /// A motion that comes from no file, evenly or unevenly in time.
    pub fn new(channels: Vec<Channel>, times: Vec<f64>, values: Vec<f64>) -> Self {
        Self { format: Format::Csv, channels, times, values, extra: Extra::default(), notes: Vec::new() }
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.times.len()
    }

    /// The numbers of a frame.
    pub fn frame(&self, frame: usize) -> &[f64] {
        let width = self.channels.len();
        self.values.get(frame * width..(frame + 1) * width).unwrap_or(&[])
    }

    /// Index of a channel.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.channels.iter().position(|channel| channel.name == name)
    }

    /// Frames per second: of the median distance between frames.
    pub fn fps(&self) -> f64 {
        rate(&self.times)
    }

    /// Whether every frame is where an even clock would have it, within a fiftieth of a frame for each second.
    pub fn is_even(&self) -> bool {
        let fps = self.fps();
        self.times.iter().zip(0..).all(|(time, frame)| {
            let due = f64::from(frame) / fps;
            (time - due).abs() * fps < EVEN * (1.0 + time)
        })
    }

    /// The frames of a range; what the range has beyond the motion is left out.
    pub fn slice(&self, frames: std::ops::Range<usize>) -> Self {
        let end = frames.end.min(self.frames());
        let start = frames.start.min(end);
        let width = self.channels.len();
        let first = self.times.get(start).copied().unwrap_or_default();
        Self {
            times: self.times[start..end].iter().map(|time| time - first).collect(),
            values: self.values.get(start * width..end * width).unwrap_or(&[]).to_vec(),
            extra: Extra { rows: self.extra.rows.get(start..end).unwrap_or(&[]).to_vec(), ..self.extra.clone() },
            ..self.clone()
        }
    }

    /// Another motion in the same format, with what is no joint at its times.
    pub fn with(&self, channels: Vec<Channel>, times: Vec<f64>, values: Vec<f64>) -> Self {
        let rows = if self.extra.columns.is_empty() {
            Vec::new()
        } else {
            times.iter().filter_map(|time| self.extra.rows.get(self.latest(*time)).cloned()).collect()
        };
        let extra = Extra { rows, ..self.extra.clone() };
        Self { format: self.format, channels, times, values, extra, notes: self.notes.clone() }
    }

    /// The last frame that is due at a time.
    fn latest(&self, time: f64) -> usize {
        self.times.partition_point(|due| *due <= time + 1e-9).saturating_sub(1)
    }

    /// The motion in figures.
    pub fn summary(&self) -> Summary {
        let width = self.channels.len().max(1);
        let channel = |(index, channel): (usize, &Channel)| {
            let values: Vec<f64> = self.values.iter().skip(index).step_by(width).copied().collect();
            let steps = values.windows(2).zip(self.times.windows(2));
            ChannelSummary {
                name: channel.name.clone(),
                unit: channel.unit.map(unit_name),
                min: values.iter().copied().fold(f64::INFINITY, f64::min),
                max: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
                speed: steps.map(|(x, t)| (x[1] - x[0]).abs() / (t[1] - t[0])).fold(0.0, f64::max),
            }
        };
        Summary {
            format: self.format,
            frames: self.frames(),
            duration_s: self.times.last().copied().unwrap_or_default(),
            fps: self.fps(),
            even: self.is_even(),
            channels: self.channels.iter().enumerate().map(channel).collect(),
            extra: self.extra.fields.keys().chain(&self.extra.columns).cloned().collect(),
            notes: self.notes.clone(),
        }
    }
}

/// Frames per second of times: of the median distance between them.
fn rate(times: &[f64]) -> f64 {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    let step = steps.get(steps.len() / 2).copied().unwrap_or(1.0);
    let fps = 1.0 / step;
    // Times are written with few digits: 49.9998 is meant to be 50.
    if (fps - fps.round()).abs() < 2e-3 * fps && fps >= 1.0 { fps.round() } else { fps }
}
