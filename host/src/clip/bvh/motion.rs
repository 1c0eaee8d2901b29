//! The MOTION section: one line of numbers per frame.

use super::cursor::Cursor;
use super::fault::BvhFault;
use super::hierarchy::RawJoint;

/// Seconds between frames that are taken for a recording: what lies outside is a mistake, and would make clips of years.
const SHORTEST: f64 = 1e-5;
const LONGEST: f64 = 10.0;

/// The motion as the file has it: `values` is row-major `[frames x channels]`, file units and degrees.
pub(super) struct Motion {
    pub frame_time: f64,
    pub frames: usize,
    pub values: Vec<f64>,
}

/// Reads from after the keyword MOTION to the end.
pub(super) fn parse(mut cursor: Cursor<'_>, joints: &[RawJoint]) -> Result<Motion, BvhFault> {
    let channels: usize = joints.iter().map(|j| j.channels.len()).sum();
    if channels == 0 {
        return Err(BvhFault::NoChannels);
    }
    let (declared_line, declared) = frame_count(&mut cursor)?;
    let frame_time = frame_time(&mut cursor)?;

    // A value takes two bytes at least: the file's size, not its claim, bounds what is reserved.
    let mut values = Vec::with_capacity(declared.saturating_mul(channels).min(cursor.left() / 2 + 1));
    let mut frames = 0;
    while let Some((line, text)) = cursor.full_line() {
        if frames == declared {
            return Err(BvhFault::MoreFrames { line, declared, declared_line });
        }
        frames += 1;
        let start = values.len();
        for word in text.split_ascii_whitespace() {
            let value = values.len() - start;
            match word.parse::<f64>() {
                Ok(number) if number.is_finite() => values.push(number),
                parsed if value < channels => {
                    return Err(bad_value(joints, line, frames, value, word, parsed.is_ok()));
                }
                _ => values.push(0.0), // Beyond the last channel: the count is the fault to report.
            }
        }
        let found = values.len() - start;
        if found != channels {
            let last = cursor.at_end();
            return Err(BvhFault::ValueCount { line, frame: frames, found, expected: channels, last });
        }
    }
    if frames < declared {
        return Err(BvhFault::FewerFrames { line: cursor.line(), declared, declared_line, found: frames });
    }
    Ok(Motion { frame_time, frames, values })
}

fn bad_value(joints: &[RawJoint], line: usize, frame: usize, index: usize, word: &str, number: bool) -> BvhFault {
    let mut all = joints.iter().flat_map(|j| j.channels.iter().map(move |c| (j.name.clone(), c.name())));
    let (joint, channel) = all.nth(index).unwrap_or_default();
    let (value, found) = (index + 1, word.chars().take(40).collect());
    match number {
        true => BvhFault::NotFinite { line, frame, value, joint, channel, found },
        false => BvhFault::Value { line, frame, value, joint, channel, found },
    }
}

/// `Frames: N`, with or without blanks around the colon.
fn frame_count(cursor: &mut Cursor<'_>) -> Result<(usize, usize), BvhFault> {
    let (line, text) = cursor.full_line().unwrap_or((cursor.line(), "the end of the file"));
    let Some(value) = after_keys(text, &["frames"]) else {
        return Err(BvhFault::MissingFrames { line, found: short(text) });
    };
    match value.parse::<usize>() {
        Ok(n) if n > 0 => Ok((line, n)),
        _ => Err(BvhFault::FrameCount { line, found: short(value) }),
    }
}

fn frame_time(cursor: &mut Cursor<'_>) -> Result<f64, BvhFault> {
    let (line, text) = cursor.full_line().unwrap_or((cursor.line(), "the end of the file"));
    let Some(value) = after_keys(text, &["frame", "time"]) else {
        return Err(BvhFault::MissingFrameTime { line, found: short(text) });
    };
    match value.parse::<f64>() {
        Ok(t) if (SHORTEST..=LONGEST).contains(&t) => Ok(t),
        _ => Err(BvhFault::FrameTime { line, found: short(value) }),
    }
}

/// What follows the key words and a colon, in any case and spacing.
fn after_keys<'a>(text: &'a str, keys: &[&str]) -> Option<&'a str> {
    let mut rest = text;
    for key in keys {
        rest = rest.trim_start();
        let head = rest.get(..key.len())?;
        if !head.eq_ignore_ascii_case(key) {
            return None;
        }
        rest = &rest[key.len()..];
    }
    Some(rest.trim_start().strip_prefix(':')?.trim())
}

fn short(text: &str) -> String {
    text.chars().take(40).collect()
}
