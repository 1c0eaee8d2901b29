//! Strength that changes while a clip plays: keys with straight lines between them.
//!
//! `0.8` is one strength throughout, `0@0s,1@2s` rises for two seconds, `@curve.csv` reads the keys from a table of times and strengths. Before the
//! first key and after the last one the strength is theirs.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use kinesic::engine::Controls;

use crate::files;
use crate::rig::MAX_ROWS;

/// Keys at most.
const MOST_KEYS: usize = 1_000_000;

/// A strength for every time. There is at least one key, and times rise.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Seconds of the clip, strength.
    keys: Vec<(f64, f32)>,
}

/// What is turned while a clip plays.
#[derive(Clone, Debug, Default)]
pub struct Knobs {
    /// Strength and mask.
    pub controls: Controls<MAX_ROWS>,
    /// Where it is given, the strength instead.
    pub curve: Option<Curve>,
}

impl Knobs {
    /// The strength of a frame.
    pub fn strength(&self, frame: usize, frame_time: f64) -> f32 {
        self.curve.as_ref().map_or(self.controls.strength, |curve| curve.at(frame as f64 * frame_time))
    }
}

impl From<Controls<MAX_ROWS>> for Knobs {
    fn from(controls: Controls<MAX_ROWS>) -> Self {
        Self { controls, curve: None }
    }
}

impl Curve {
    /// One strength throughout.
    pub fn still(strength: f32) -> Self {
        Self { keys: vec![(0.0, strength)] }
    }

    /// The strength at a time of the clip, s.
    pub fn at(&self, seconds: f64) -> f32 {
        let next = self.keys.partition_point(|(time, _)| *time <= seconds);
        let before = next.checked_sub(1).and_then(|at| self.keys.get(at));
        match (before, self.keys.get(next)) {
            (Some((start, from)), Some((end, to))) => {
                let part = (seconds - start) / (end - start);
                (f64::from(*from) + part * (f64::from(*to) - f64::from(*from))) as f32
            }
            (Some((_, strength)), None) | (None, Some((_, strength))) => *strength,
            (None, None) => 1.0,
        }
    }

    /// The strength, where it is one throughout.
    pub fn constant(&self) -> Option<f32> {
        let [low, high] = self.range();
        (low == high).then_some(low)
    }

    /// Least and greatest strength.
    pub fn range(&self) -> [f32; 2] {
        let strengths = || self.keys.iter().map(|(_, strength)| *strength);
        [strengths().fold(f32::INFINITY, f32::min), strengths().fold(f32::NEG_INFINITY, f32::max)]
    }

    /// Number of keys.
    pub fn count(&self) -> usize {
        self.keys.len()
    }

    /// The key whose time is the last, s.
    pub fn end(&self) -> f64 {
        self.keys.last().map_or(0.0, |(time, _)| *time)
    }

    /// From keys in order; `name` says which is wrong.
    fn new(keys: Vec<(f64, f32)>, name: impl Fn(usize) -> String) -> Result<Self, String> {
        if let Some(at) = (1..keys.len()).find(|at| keys[*at].0 <= keys[at - 1].0) {
            return Err(format!(
                "{}: found a time of {} s after one of {} s, expected times that rise",
                name(at),
                keys[at].0,
                keys[at - 1].0
            ));
        }
        Ok(Self { keys })
    }

    /// A table: time in seconds and strength, parted by commas, semicolons, tabs or blanks, with or without a header.
    fn read(path: &Path) -> Result<Self, String> {
        let refuse = |cause: String| format!("{}: {cause}", path.display());
        let text = files::read_text(path).map_err(|error| refuse(format!("cannot be read: {error}")))?;
        let (mut keys, mut lines) = (Vec::new(), Vec::new());
        for (index, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
            let cells: Vec<&str> =
                line.split([',', ';', '\t', ' ']).map(str::trim).filter(|cell| !cell.is_empty()).collect();
            let key = match cells[..] {
                [time, strength] => time.parse().ok().and_then(|time| key(time, strength)),
                _ => None,
            };
            match key {
                Some(key) => {
                    keys.push(key);
                    lines.push(index + 1);
                }
                // The header.
                None if keys.is_empty() && index == 0 && cells.iter().all(|cell| cell.parse::<f64>().is_err()) => {}
                None => {
                    let shown: String = line.chars().take(60).collect();
                    return Err(refuse(format!(
                        "line {}: found '{shown}', expected a time in seconds from 0 up and a strength, for example 1.5,0.8",
                        index + 1
                    )));
                }
            }
            if keys.len() > MOST_KEYS {
                return Err(refuse(format!("found more than {MOST_KEYS} keys, expected at most that")));
            }
        }
        if keys.is_empty() {
            return Err(refuse("found no key, expected lines of a time in seconds and a strength".to_owned()));
        }
        Self::new(keys, |at| format!("{}: line {}", path.display(), lines[at]))
    }
}

fn key(time: f64, strength: &str) -> Option<(f64, f32)> {
    let strength: f32 = strength.trim().parse().ok()?;
    (time.is_finite() && time >= 0.0 && strength.is_finite()).then_some((time, strength))
}

impl FromStr for Curve {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(path) = text.strip_prefix('@') {
            return Self::read(Path::new(path));
        }
        if !text.contains('@') {
            let wrong = || {
                "expected a number, usually from 0 to 1; or keys STRENGTH@SECONDS,... as 0@0s,1@2s; or @FILE with a time and a strength a line"
                    .to_owned()
            };
            return Ok(Self { keys: vec![key(0.0, text).ok_or_else(wrong)?] });
        }
        let texts: Vec<&str> = text.split(',').map(str::trim).collect();
        let name = |at: usize| format!("key {}, '{}'", at + 1, texts[at]);
        let read = |(at, text): (usize, &&str)| {
            let parts = text.split_once('@').and_then(|(strength, time)| {
                let time = time.trim();
                key(time.strip_suffix('s').unwrap_or(time).trim().parse().ok()?, strength)
            });
            parts.ok_or_else(|| {
                format!("{}: expected STRENGTH@SECONDS with a time from 0 up, for example 0.5@1.2s", name(at))
            })
        };
        let keys = texts.iter().enumerate().map(read).collect::<Result<Vec<_>, _>>()?;
        Self::new(keys, name)
    }
}

impl fmt::Display for Curve {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.constant() {
            Some(strength) => write!(f, "{strength}"),
            None => {
                let [low, high] = self.range();
                write!(f, "{low} to {high} with {} keys", self.keys.len())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(text: &str) -> Curve {
        text.parse().unwrap()
    }

    #[test]
    fn lines_between_keys_and_the_ends_held() {
        let keyed = curve("0@1s, 1@2,-0.5@4s");
        let found = [0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 99.0].map(|time| keyed.at(time));
        assert_eq!(found, [0.0, 0.0, 0.5, 1.0, 0.25, -0.5, -0.5]);
        assert_eq!((keyed.range(), keyed.constant(), keyed.end()), ([-0.5, 1.0], None, 4.0));
        assert_eq!((curve("-0.4").constant(), curve("0.4@3s").at(0.0)), (Some(-0.4), 0.4));
    }

    #[test]
    fn the_key_that_is_wrong_is_named() {
        let error = |text: &str| text.parse::<Curve>().unwrap_err();
        for bad in ["much", "nan", "inf", ""] {
            assert!(error(bad).contains("number"), "{bad}");
        }
        assert!(error("0@0s,1@x").contains("key 2, '1@x'"));
        assert!(error("0@0s,1").contains("key 2, '1': expected STRENGTH@SECONDS"));
        assert!(error("0@0s,1@-1s").contains("key 2"));
        assert!(error("nan@0s").contains("key 1"));
        assert!(error("0@0s,1@2s,0@2s").contains("key 3, '0@2s': found a time of 2 s after one of 2 s"));
        assert!(error("0@0s,").contains("key 2, ''"));
    }

    #[test]
    fn a_table_may_have_a_header_and_its_lines_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("curve.csv");
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            format!("@{}", path.display()).parse::<Curve>()
        };
        assert_eq!(read("time,strength\n0,0\n\n2,1\n").unwrap(), curve("0@0s,1@2s"));
        assert_eq!(read("0\t0.5\n1.5 1").unwrap(), curve("0.5@0s,1@1.5s"));
        for (text, cause) in [
            ("time,strength\n0,x\n", "line 2"),
            ("0,0\n1\n", "line 2"),
            ("0,0\n2,1\n\n1,1\n", "line 4: found a time of 1 s after one of 2 s"),
            ("time,strength\n", "found no key"),
            ("1,x\n", "line 1"),
        ] {
            let error = read(text).unwrap_err();
            assert!(error.contains(cause) && error.contains("curve.csv"), "{text:?}: {error}");
        }
        assert!("@gone.csv".parse::<Curve>().unwrap_err().contains("gone.csv: cannot be read"));
    }
}
