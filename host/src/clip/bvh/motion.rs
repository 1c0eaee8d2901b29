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
    pub values: Vec<f64>,
}

/// What stands between the keyword MOTION and the first frame.
pub(super) struct Header {
    /// Where the number of frames is, or should be.
    line: usize,
    /// How many frames are announced, if it is said.
    pub frames: Option<usize>,
    pub frame_time: f64,
}

/// Reads from after the keyword MOTION to the first frame.
pub(super) fn header(cursor: &mut Cursor<'_>) -> Result<Header, BvhFault> {
    let (mut line, mut frames) = frame_count(cursor)?;
    let frame_time = frame_time(cursor)?;
    let before = *cursor;
    // The two lines may stand the other way round.
    match cursor.full_line().and_then(|(at, text)| Some((at, after_keys(text, &["frames"])?))) {
        Some((at, value)) if frames.is_none() => (line, frames) = counted(at, value)?,
        _ => *cursor = before,
    }
    Ok(Header { line, frames, frame_time })
}

impl Header {
    /// Compares what was announced with what there is at the end, on line `line`.
    pub(super) fn check(&self, frames: usize, line: usize, notes: &mut Vec<String>) -> Result<(), BvhFault> {
        let declared_line = self.line;
        match self.frames {
            Some(declared) if frames + 1 < declared || frames == 0 => {
                return Err(BvhFault::FewerFrames { line, declared, declared_line, found: frames });
            }
            None if frames == 0 => {
                return Err(BvhFault::FewerFrames { line, declared: 1, declared_line, found: 0 });
            }
            Some(declared) if declared != frames => notes.push(format!(
                "Line {declared_line} declares {declared} frames, the file has {frames} whole ones: all of them are read."
            )),
            Some(_) => {}
            None => notes.push(format!("The number of frames is not given: {frames} are read.")),
        }
        Ok(())
    }
}

/// Reads from after the keyword MOTION to the end.
pub(super) fn parse(mut cursor: Cursor<'_>, joints: &[RawJoint], notes: &mut Vec<String>) -> Result<Motion, BvhFault> {
    let channels: usize = joints.iter().map(|j| j.channels.len()).sum();
    if channels == 0 {
        return Err(BvhFault::NoChannels);
    }
    let header = header(&mut cursor)?;
    let Header { frames: declared, frame_time, .. } = header;
    let start = cursor;

    // A value takes two bytes at least: the file's size, not its claim, bounds what is reserved.
    let room = declared.unwrap_or(usize::MAX).saturating_mul(channels).min(cursor.left() / 2 + 1);
    let mut values = Vec::with_capacity(room);
    let (mut frames, mut glued) = (0, 0);
    while let Some((line, text)) = cursor.full_line() {
        frames += 1;
        let start_of_line = values.len();
        for word in text.split_ascii_whitespace() {
            let value = values.len() - start_of_line;
            match push(word, &mut values) {
                Some(more) => glued += more,
                None if value < channels => return Err(bad_value(joints, line, frames, value, word)),
                None => values.push(0.0), // Beyond the last channel: the count is the fault to report.
            }
        }
        let found = values.len() - start_of_line;
        if found != channels {
            let last = cursor.at_end();
            let fault = BvhFault::ValueCount { line, frame: frames, found, expected: channels, last };
            (values, glued) = wrapped(start, channels, declared).ok_or(fault)?;
            notes.push("Frames are broken over several lines: cut by the number of channels.".into());
            frames = values.len() / channels;
            break;
        }
    }
    header.check(frames, cursor.line(), notes)?;
    if glued > 0 {
        notes.push(format!("{glued} words are several numbers without a blank between them (1.5-2.5): taken apart."));
    }
    Ok(Motion { frame_time, values })
}

/// All numbers of the motion in one row, and how many words were taken apart: where they make whole frames, as many as were declared.
/// Where the count is off by one, or missing, every frame must begin a line too: else numbers may be missing here and there.
fn wrapped(mut cursor: Cursor<'_>, channels: usize, declared: Option<usize>) -> Option<(Vec<f64>, usize)> {
    let (mut values, mut glued, mut by_lines) = (Vec::new(), 0, true);
    while let Some((_, text)) = cursor.full_line() {
        let before = values.len();
        for word in text.split_ascii_whitespace() {
            glued += push(word, &mut values)?;
        }
        by_lines &= (values.len() - 1) / channels == before / channels;
    }
    let frames = values.len() / channels;
    let counted = declared == Some(frames) || by_lines && declared.is_none_or(|n| n.abs_diff(frames) == 1);
    (values.len().is_multiple_of(channels) && counted).then_some((values, glued))
}

/// Adds the number of a word, or its numbers, and says whether it had to be taken apart; none where it is no finite number.
fn push(word: &str, values: &mut Vec<f64>) -> Option<usize> {
    if let Some(number) = word.parse::<f64>().ok().filter(|x| x.is_finite()) {
        values.push(number);
        return Some(0);
    }
    values.extend(unglued(word)?);
    Some(1)
}

/// The numbers of a word like `1.5-2.5`: fixed columns leave no blank before a minus sign.
pub(super) fn unglued(word: &str) -> Option<Vec<f64>> {
    let mut numbers = Vec::new();
    let (mut start, mut before) = (0, b'-');
    for (at, byte) in word.bytes().enumerate() {
        if byte == b'-' && (before.is_ascii_digit() || before == b'.') {
            numbers.push(word.get(start..at)?.parse().ok()?);
            start = at;
        }
        before = byte;
    }
    numbers.push(word.get(start..)?.parse().ok()?);
    (numbers.len() > 1 && numbers.iter().all(|x: &f64| x.is_finite())).then_some(numbers)
}

fn bad_value(joints: &[RawJoint], line: usize, frame: usize, index: usize, word: &str) -> BvhFault {
    let mut all = joints.iter().flat_map(|j| j.channels.iter().map(move |c| (j.name.clone(), c.name())));
    let (joint, channel) = all.nth(index).unwrap_or_default();
    let (value, found) = (index + 1, word.chars().take(40).collect());
    match word.parse::<f64>().is_ok() {
        true => BvhFault::NotFinite { line, frame, value, joint, channel, found },
        false => BvhFault::Value { line, frame, value, joint, channel, found },
    }
}

/// `Frames: N`, with or without blanks and colon; none where the line is missing or says 0, as live recorders write.
fn frame_count(cursor: &mut Cursor<'_>) -> Result<(usize, Option<usize>), BvhFault> {
    let before = *cursor;
    let (line, text) = cursor.full_line().unwrap_or((cursor.line(), "the end of the file"));
    if after_keys(text, &["frame", "time"]).is_some() {
        *cursor = before;
        return Ok((line, None));
    }
    let Some(value) = after_keys(text, &["frames"]) else {
        return Err(BvhFault::MissingFrames { line, found: short(text) });
    };
    counted(line, value)
}

/// The number of frames on a line; none where nothing stands there, or 0.
fn counted(line: usize, value: &str) -> Result<(usize, Option<usize>), BvhFault> {
    match value.parse::<usize>() {
        Ok(n) => Ok((line, Some(n).filter(|n| *n > 0))),
        _ if value.is_empty() => Ok((line, None)),
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

/// What follows the key words and a colon or blank, in any case and spacing.
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
    let value = rest.trim_start();
    match value.strip_prefix(':') {
        Some(value) => Some(value.trim()),
        None => rest.starts_with(char::is_whitespace).then_some(value.trim()),
    }
}

fn short(text: &str) -> String {
    text.chars().take(40).collect()
}
