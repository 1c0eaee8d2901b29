//! Other frame rates.

use super::{Extra, Moves, MovesError};
use crate::clip::Memory;

impl Moves {
    /// The motion at `fps` frames per second, evenly from its first frame to its last: straight lines between frames, the latest value of
    /// what is no joint.
    pub fn resample(&self, fps: f64) -> Result<Self, MovesError> {
        if !(1e-3..=1e5).contains(&fps) {
            let what = format!("found the frame rate {fps}, expected a number above 0, at most 100000");
            return Err(MovesError::new("", what, "as in 50"));
        }
        if self.frames() == 0 {
            return Ok(self.clone());
        }
        let end = self.times.last().copied().unwrap_or_default();
        let count = (end * fps + 1e-6).floor() + 1.0;
        Memory::check(self.frames(), count, self.channels.len()).map_err(|memory| {
            let what = format!("the {count:.0} frames that {end:.0} s take at {fps} frames per second {memory}");
            MovesError::new("", what, "cut the pauses out, or ask for fewer frames per second")
        })?;
        let times: Vec<f64> = (0..count as usize).map(|frame| frame as f64 / fps).collect();
        let mut values = Vec::with_capacity(times.len() * self.channels.len());
        let mut rows = Vec::new();
        for time in &times {
            let before = self.latest(*time);
            let after = (before + 1).min(self.frames() - 1);
            let (from, to) = (self.times[before], self.times[after]);
            let part = if to > from { ((time - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
            values.extend(self.frame(before).iter().zip(self.frame(after)).map(|(a, b)| a + part * (b - a)));
            if !self.extra.columns.is_empty() {
                rows.extend(self.extra.rows.get(before).cloned());
            }
        }
        let extra = Extra { rows, ..self.extra.clone() };
        Ok(Self { times, values, extra, ..self.clone() })
    }
}
