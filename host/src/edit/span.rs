//! Times of a clip, and the part between two of them.

use std::fmt;
use std::str::FromStr;

use super::EditError;
use crate::clip::Clip;

/// A time of a clip as the command line gives it: `1.2s`, `1.2` (seconds) or `36f` (a frame, counted from 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Time {
    /// Seconds from the first frame.
    Seconds(f64),
    /// A frame, counted from 0.
    Frame(usize),
}

impl FromStr for Time {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        let frame = text.strip_suffix('f').map(|frame| frame.trim().parse().ok().map(Self::Frame));
        let seconds = || {
            let number: f64 = text.strip_suffix('s').unwrap_or(text).trim().parse().ok()?;
            (number.is_finite() && number >= 0.0).then_some(Self::Seconds(number))
        };
        let time = frame.unwrap_or_else(seconds);
        time.ok_or_else(|| "expected seconds from 0 up, as 1.2s, or a frame, as 36f".to_owned())
    }
}

impl fmt::Display for Time {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Seconds(seconds) => write!(f, "{seconds}s"),
            Self::Frame(frame) => write!(f, "{frame}f"),
        }
    }
}

impl Time {
    /// The frame of a clip that is nearest, if there is one.
    fn frame(self, clip: &Clip) -> Option<usize> {
        let frame = match self {
            Self::Frame(frame) => frame,
            // A float beyond all integers becomes the greatest one.
            Self::Seconds(seconds) => (seconds / clip.frame_time).round() as usize,
        };
        (frame < clip.frames()).then_some(frame)
    }
}

/// The frames from one time to another, both among them; without one, from the start or to the end. Costs a copy.
pub fn trim(clip: &Clip, from: Option<Time>, to: Option<Time>) -> Result<Clip, EditError> {
    let last = clip.frames().saturating_sub(1);
    let find = |option, time: Option<Time>, without| match time {
        None => Ok(without),
        Some(time) => {
            let past = || EditError::Past { option, asked: time.to_string(), end: clip.duration(), last };
            time.frame(clip).ok_or_else(past)
        }
    };
    let (from, to) = (find("--from", from, 0)?, find("--to", to, last)?);
    if to <= from {
        return Err(EditError::Nothing { from, to, frames: (to + 1).saturating_sub(from) });
    }
    Ok(clip.slice(from..to + 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::{Manner, walk};

    #[test]
    fn times_are_seconds_or_frames() {
        let read = |text: &str| text.parse::<Time>().unwrap();
        assert_eq!([read("1.2s"), read("1.2"), read(" 0 s")].map(|t| t.to_string()), ["1.2s", "1.2s", "0s"]);
        assert_eq!(read("36f"), Time::Frame(36));
        for bad in ["", "s", "f", "-1", "nan", "inf", "1.5f", "-3f", "1m", "1.2 s s"] {
            assert!(bad.parse::<Time>().unwrap_err().contains("36f"), "{bad}");
        }
    }

    #[test]
    fn a_part_begins_and_ends_where_it_is_told() {
        let clip = walk(&Manner::NEUTRAL, 2.0, 60.0, 0.0, 1);
        let part = trim(&clip, Some(Time::Seconds(0.5)), Some(Time::Frame(90))).unwrap();
        assert_eq!((part.frames(), part.root[0], part.root[60]), (61, clip.root[30], clip.root[90]));
        assert_eq!(part.pose(60), clip.pose(90));
        assert_eq!(trim(&clip, None, None).unwrap().frames(), 120);
        let error = trim(&clip, None, Some(Time::Seconds(2.0))).unwrap_err().to_string();
        assert!(error.contains("--to 2s") && error.contains("1.983 s (frame 119)"), "{error}");
        let error = trim(&clip, Some(Time::Frame(5)), Some(Time::Frame(5))).unwrap_err().to_string();
        assert!(error.contains("1 frames") && error.contains("later --to"), "{error}");
        assert!(trim(&clip, Some(Time::Seconds(1e300)), None).is_err());
    }
}
