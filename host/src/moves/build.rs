//! What every format is checked for, once it is columns of numbers.

use std::collections::{HashMap, HashSet};

use super::{Channel, Extra, Format, Moves, MovesError, Options, Unit, rate, unit_name};

/// Angles beyond this are no radians: two turns.
const TURNS: f64 = 4.0 * std::f64::consts::PI;

/// A motion on its way.
pub(super) struct Draft {
    pub format: Format,
    pub channels: Vec<Channel>,
    /// s; `None` for a file that says no times.
    pub times: Option<Vec<f64>>,
    /// Frames per second that the file says.
    pub fps: Option<f64>,
    pub values: Vec<f64>,
    pub extra: Extra,
    pub notes: Vec<String>,
    /// How a frame is named in messages: `line 3`, `frame 2`.
    pub place: Box<dyn Fn(usize) -> String>,
}

/// Frames nearer to each other, s, are no motion, and would be at one time where they are written.
const SHORTEST: f64 = 1e-6;

impl Draft {
    /// The motion, or what is wrong with it.
    pub fn finish(mut self, options: &Options) -> Result<Moves, MovesError> {
        self.tell_apart();
        if self.channels.is_empty() {
            return Err(MovesError::new(
                "",
                "found no column of numbers, expected one per joint",
                "name joints in the header",
            ));
        }
        let mut known = HashSet::new();
        if let Some(channel) = self.channels.iter().find(|channel| !known.insert(channel.name.as_str())) {
            let what = format!("found the joint {} twice", super::error::shown(&channel.name));
            return Err(MovesError::new("", what, "name every joint once"));
        }
        let frames = self.values.len() / self.channels.len();
        if frames < 2 {
            return Err(MovesError::new(
                "",
                format!("found {frames} frames, expected at least 2"),
                "is the file whole?",
            ));
        }
        let times = self.clock(frames, options)?;
        if self.times.is_some() {
            self.notes.extend(odd_clock(&times, self.format));
        }
        for (index, channel) in self.channels.iter().enumerate().filter(|(_, c)| c.unit == Some(Unit::Radians)) {
            let values = self.values.iter().skip(index).step_by(self.channels.len());
            if let Some((frame, value)) = values.enumerate().find(|(_, value)| value.abs() > TURNS) {
                let what = format!("joint '{}': found {value} rad, expected at most two turns, 12.57", channel.name);
                let help =
                    format!("these look like degrees: name the column {}_deg, or say the unit as deg", channel.name);
                return Err(MovesError::new((self.place)(frame), what, help));
            }
        }
        let Self { format, channels, values, extra, notes, .. } = self;
        Ok(Moves { format, channels, times, values, extra, notes })
    }

    /// A place and an angle of one name keep their units in it: `Hips_z_m`, `Hips_z_deg`.
    fn tell_apart(&mut self) {
        let mut units: HashMap<String, HashSet<Option<&str>>> = HashMap::new();
        for channel in &self.channels {
            units.entry(channel.name.clone()).or_default().insert(channel.unit.map(unit_name));
        }
        for channel in self.channels.iter_mut().filter(|channel| units[&channel.name].len() > 1) {
            channel.name = channel.header();
        }
    }

    /// When every frame is due, from 0 on.
    fn clock(&self, frames: usize, options: &Options) -> Result<Vec<f64>, MovesError> {
        let Some(times) = &self.times else {
            let Some(fps) = self.fps.or(options.rate) else {
                let help = "say how many frames there are in a second: --rate 50";
                return Err(MovesError::new("", "found neither times nor a frame rate, expected one of them", help));
            };
            if !(1e-3..=1e5).contains(&fps) {
                let what = format!("found the frame rate {fps}, expected a number above 0, at most 100000");
                return Err(MovesError::new("", what, "as in 50"));
            }
            return Ok((0..frames).map(|frame| frame as f64 / fps).collect());
        };
        if times.len() != frames {
            let what = format!("found {} times and {frames} frames, expected as many", times.len());
            return Err(MovesError::new("", what, "is the file whole?"));
        }
        let first = times.first().copied().unwrap_or_default();
        for (frame, pair) in times.windows(2).enumerate() {
            if !(pair[0] < pair[1] && pair[1].is_finite() && pair[0].is_finite()) {
                let what = format!("found the time {} after {}, expected times that rise", pair[1], pair[0]);
                return Err(MovesError::new(
                    (self.place)(frame + 1),
                    what,
                    "sort the frames, or cut the repeated ones out",
                ));
            }
            if pair[1] - pair[0] < SHORTEST {
                let what = format!("found frames {:e} s apart, expected at least {SHORTEST:e}", pair[1] - pair[0]);
                return Err(MovesError::new(
                    (self.place)(frame + 1),
                    what,
                    "say what the times count: time_s, time_ms, time_us",
                ));
            }
        }
        Ok(times.iter().map(|time| time - first).collect())
    }
}

/// Frames a second that are hardly meant: what the times may count instead.
fn odd_clock(times: &[f64], format: Format) -> Option<String> {
    let fps = rate(times);
    let (word, column) = match 1.0 / fps {
        _ if fps > 2000.0 => ("seconds", "time_s"),
        step if step > 1e6 => ("nanoseconds", "time_ns"),
        step if step > 1e3 => ("microseconds", "time_us"),
        _ if fps < 2.0 => ("milliseconds", "time_ms"),
        _ => return None,
    };
    let say = match format {
        Format::Csv | Format::Records | Format::JsonLines => format!("Name the column {column}"),
        _ => "Give them in seconds".to_owned(),
    };
    Some(format!(
        "{} frames a second: are its times {word}? {say}.",
        if fps < 2.0 { short(fps) } else { format!("{fps:.0}") }
    ))
}

/// Two digits that count.
fn short(x: f64) -> String {
    let places = (1.0 - x.log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{x:.places$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Seconds in one of what a name of times counts; `None` for a name of no time.
pub(super) fn time_unit(name: &str) -> Option<f64> {
    let plain: String = name.trim().to_lowercase().chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
    match plain.trim_matches('_') {
        "time" | "t" | "time_s" | "time_sec" | "timestamp" | "timestamp_s" | "seconds" | "sec" | "secs" | "stamp"
        | "time_from_start" | "time_stamp" => Some(1.0),
        "time_ms" | "timestamp_ms" | "ms" | "milliseconds" | "millis" | "t_ms" | "stamp_ms" => Some(1e-3),
        "time_us" | "timestamp_us" | "microseconds" | "micros" => Some(1e-6),
        "time_ns" | "timestamp_ns" | "stamp_ns" | "ns" | "nanoseconds" => Some(1e-9),
        _ => None,
    }
}

/// A name that counts frames and is no joint.
pub(super) fn is_index(name: &str) -> bool {
    matches!(name.trim().to_lowercase().as_str(), "frame" | "frame_index" | "index" | "" | "unnamed: 0")
}
