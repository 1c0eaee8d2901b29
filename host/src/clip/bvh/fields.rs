//! What stands inside a joint: OFFSET, CHANNELS, End Site.

use nalgebra::Vector3;

use super::cursor::Cursor;
use super::fault::BvhFault;
use super::motion::unglued;

/// One motion channel of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channel {
    /// Position along axis 0, 1 or 2, in file units.
    Position(usize),
    /// Rotation about axis 0, 1 or 2, in degrees.
    Rotation(usize),
    /// A number that no pose needs: the scale along axis 0, 1 or 2, or (3) whatever an End Site has.
    Unused(usize),
}

const CHANNELS: [(&str, Channel); 9] = [
    ("Xposition", Channel::Position(0)),
    ("Yposition", Channel::Position(1)),
    ("Zposition", Channel::Position(2)),
    ("Xrotation", Channel::Rotation(0)),
    ("Yrotation", Channel::Rotation(1)),
    ("Zrotation", Channel::Rotation(2)),
    ("Xscale", Channel::Unused(0)),
    ("Yscale", Channel::Unused(1)),
    ("Zscale", Channel::Unused(2)),
];

impl Channel {
    fn from_name(name: &str) -> Option<Channel> {
        CHANNELS.iter().find(|(n, _)| n.eq_ignore_ascii_case(name)).map(|&(_, c)| c)
    }

    pub(super) fn name(self) -> &'static str {
        CHANNELS.iter().find(|(_, c)| *c == self).map_or("channel", |&(n, _)| n)
    }
}

/// Whether a word ends a list of numbers or channels.
fn is_keyword(word: &str) -> bool {
    const KEYWORDS: [&str; 9] = ["{", "}", "OFFSET", "CHANNELS", "JOINT", "END", "ENDSITE", "MOTION", "ROOT"];
    KEYWORDS.iter().any(|k| word.eq_ignore_ascii_case(k))
}

/// Three numbers, no more and no fewer.
pub(super) fn offset(
    cursor: &mut Cursor<'_>,
    line: usize,
    joint: &str,
    notes: &mut Vec<String>,
) -> Result<Vector3<f64>, BvhFault> {
    let mut values = Vec::new();
    while let Some(word) = cursor.peek().filter(|w| !is_keyword(w)) {
        match (word.parse::<f64>(), unglued(word)) {
            (Ok(value), _) if value.is_finite() => values.push(value),
            _ if values.len() >= 3 => break, // Not ours: the joint's next line.
            (_, Some(numbers)) => {
                values.extend(numbers);
                notes.push(format!("Line {line}: OFFSET of '{joint}': '{word}' was taken apart."));
            }
            _ => {
                return Err(BvhFault::OffsetNumber { line, joint: joint.into(), found: word.into() });
            }
        }
        cursor.word();
    }
    match values[..] {
        [x, y, z] => Ok(Vector3::new(x, y, z)),
        _ => Err(BvhFault::OffsetCount { line, joint: joint.into(), found: values.len() }),
    }
}

/// The announced number of known channels, each once.
pub(super) fn channels(cursor: &mut Cursor<'_>, line: usize, joint: &str) -> Result<Vec<Channel>, BvhFault> {
    let count = cursor.peek().filter(|w| !is_keyword(w)).unwrap_or("");
    let Some(announced) = count.parse::<usize>().ok().filter(|&n| n <= 9) else {
        return Err(BvhFault::ChannelCount { line, joint: joint.into(), found: count.into() });
    };
    cursor.word();
    let mut list = Vec::with_capacity(announced);
    while let Some(word) = cursor.peek().filter(|w| !is_keyword(w)) {
        let Some(channel) = Channel::from_name(word) else {
            if list.len() == announced {
                break; // Not ours: the joint's next line.
            }
            return Err(BvhFault::UnknownChannel { line, joint: joint.into(), found: word.into() });
        };
        if list.contains(&channel) {
            return Err(BvhFault::DuplicateChannel { line, joint: joint.into(), found: word.into() });
        }
        list.push(channel);
        cursor.word();
    }
    if list.len() != announced {
        return Err(BvhFault::ChannelMismatch { line, joint: joint.into(), announced, found: list.len() });
    }
    Ok(list)
}

/// `Site { OFFSET x y z }`, and how many channels it announces; the word after End is not looked at, some files give the tip a
/// name.
pub(super) fn end_site(
    cursor: &mut Cursor<'_>,
    joint: &str,
    notes: &mut Vec<String>,
) -> Result<(Vector3<f64>, usize), BvhFault> {
    let broken = |cursor: &Cursor<'_>, found: Option<&str>| BvhFault::BrokenEndSite {
        line: cursor.line(),
        joint: joint.into(),
        found: found.unwrap_or("the end of the file").into(),
    };
    cursor.name();
    for expected in ["{", "OFFSET"] {
        let word = cursor.word();
        if !word.is_some_and(|w| w.eq_ignore_ascii_case(expected)) {
            return Err(broken(cursor, word));
        }
    }
    let name = format!("{joint} (End Site)");
    let tip = offset(cursor, cursor.line(), &name, notes)?;
    let mut unused = 0;
    if cursor.peek().is_some_and(|w| w.eq_ignore_ascii_case("CHANNELS")) {
        cursor.word();
        unused = channels(cursor, cursor.line(), &name)?.len();
    }
    match cursor.word() {
        Some("}") => Ok((tip, unused)),
        word => Err(broken(cursor, word)),
    }
}
