//! The HIERARCHY section: joints, offsets, channels.

use std::collections::HashMap;

use nalgebra::Vector3;

use super::cursor::Cursor;
use super::fault::BvhFault;
use super::fields::{self, Channel};
use super::{MAX_DEPTH, MAX_JOINTS};

/// A joint as the file has it, in file units.
#[derive(Debug)]
pub(super) struct RawJoint {
    pub name: String,
    pub parent: Option<usize>,
    pub offset: Vector3<f64>,
    pub end: Option<Vector3<f64>>,
    pub channels: Vec<Channel>,
}

/// The joints of a file, and what was made of its oddities.
pub(super) struct Hierarchy {
    pub joints: Vec<RawJoint>,
    pub notes: Vec<String>,
}

/// A joint whose closing brace has not come yet.
struct Open {
    joint: usize,
    line: usize,
    offset: bool,
    channels: bool,
}

/// Reads up to and including the keyword MOTION.
pub(super) fn parse(cursor: &mut Cursor<'_>) -> Result<Hierarchy, BvhFault> {
    start(cursor)?;
    let mut joints: Vec<RawJoint> = Vec::new();
    let mut names: HashMap<String, usize> = HashMap::new();
    let mut notes = Vec::new();
    loop {
        figure(cursor, &mut joints, &mut names, &mut notes)?;
        // Figures of one kind have joints of the same names; their roots are told apart, since one is chosen by name.
        names.retain(|name, _| joints.iter().any(|j| j.parent.is_none() && j.name == *name));
        match cursor.word() {
            Some(word) if word.eq_ignore_ascii_case("MOTION") => return Ok(Hierarchy { joints, notes }),
            Some(word) if word.eq_ignore_ascii_case("ROOT") => {}
            Some("}") => return Err(BvhFault::ExtraBrace { line: cursor.line() }),
            Some(word) => {
                return Err(BvhFault::MissingMotion { line: cursor.line(), found: format!("'{word}'") });
            }
            None => {
                return Err(BvhFault::MissingMotion { line: cursor.line(), found: "the end of the file".into() });
            }
        }
    }
}

/// One ROOT with everything below it; the keyword was taken.
fn figure(
    cursor: &mut Cursor<'_>,
    joints: &mut Vec<RawJoint>,
    names: &mut HashMap<String, usize>,
    notes: &mut Vec<String>,
) -> Result<(), BvhFault> {
    let mut open: Vec<Open> = Vec::new();
    open_joint(cursor, "ROOT", joints, names, &mut open, notes)?;
    // An explicit stack: nesting depth is the file's choice and must not be ours.
    while let Some(top) = open.last_mut() {
        let joint = top.joint;
        let name = || joints[joint].name.clone();
        let Some(word) = cursor.word() else {
            return Err(BvhFault::TruncatedHierarchy { line: cursor.line(), joint: name(), opened: top.line });
        };
        let line = cursor.line();
        match word.to_ascii_uppercase().as_str() {
            "OFFSET" if top.offset => {
                return Err(BvhFault::SecondOffset { line, joint: name() });
            }
            "OFFSET" => {
                top.offset = true;
                joints[joint].offset = fields::offset(cursor, line, &joints[joint].name, notes)?;
            }
            "CHANNELS" if top.channels => {
                return Err(BvhFault::SecondChannels { line, joint: name() });
            }
            "CHANNELS" => {
                top.channels = true;
                joints[joint].channels = fields::channels(cursor, line, &joints[joint].name)?;
            }
            "JOINT" => open_joint(cursor, "JOINT", joints, names, &mut open, notes)?,
            "END" | "ENDSITE" => {
                let (tip, unused) = fields::end_site(cursor, &joints[joint].name, notes)?;
                if unused > 0 {
                    notes.push(format!("The End Site of '{}' has channels, which are left out.", joints[joint].name));
                }
                // Its numbers stand behind those of the joints before it.
                let last = joints.len() - 1;
                joints[last].channels.extend(std::iter::repeat_n(Channel::Unused(3), unused));
                // Only the first tip is kept: one is all that a pose needs.
                joints[joint].end.get_or_insert(tip);
            }
            "}" => {
                if !top.offset {
                    return Err(BvhFault::MissingOffset { line: top.line, joint: name() });
                }
                if !top.channels {
                    notes.push(format!("Joint '{}' has no CHANNELS: taken as rigid.", name()));
                }
                open.pop();
            }
            "MOTION" | "ROOT" => {
                let (joint, opened) = (name(), top.line);
                return Err(BvhFault::UnclosedJoint { line, joint, opened, found: word.into() });
            }
            _ => {
                return Err(BvhFault::Unexpected { line, joint: name(), found: word.into() });
            }
        }
    }
    Ok(())
}

/// The keywords HIERARCHY and ROOT.
fn start(cursor: &mut Cursor<'_>) -> Result<(), BvhFault> {
    let Some(word) = cursor.word() else {
        return Err(BvhFault::Empty);
    };
    let (line, found) = (cursor.line(), word.chars().take(40).collect::<String>());
    if !word.eq_ignore_ascii_case("HIERARCHY") {
        let known = ["ROOT", "JOINT", "MOTION", "OFFSET"].iter().any(|k| word.eq_ignore_ascii_case(k));
        return Err(match known {
            true => BvhFault::MissingHierarchy { line, found },
            false => BvhFault::NotBvh { line, found },
        });
    }
    match cursor.word() {
        Some(word) if word.eq_ignore_ascii_case("ROOT") => Ok(()),
        other => {
            Err(BvhFault::MissingRoot { line: cursor.line(), found: other.unwrap_or("the end of the file").into() })
        }
    }
}

fn open_joint(
    cursor: &mut Cursor<'_>,
    keyword: &'static str,
    joints: &mut Vec<RawJoint>,
    names: &mut HashMap<String, usize>,
    open: &mut Vec<Open>,
    notes: &mut Vec<String>,
) -> Result<(), BvhFault> {
    let line = cursor.line();
    let mut name = cursor.name().to_owned();
    if name.is_empty() {
        return Err(BvhFault::NoName { line, keyword });
    }
    if let Some(&first) = names.get(&name) {
        let free = (2..).map(|n| format!("{name}_{n}")).find(|other| !names.contains_key(other));
        let other = free.unwrap_or_default();
        notes.push(format!("Line {line}: the joint name '{name}' was used on line {first} already: '{other}' here."));
        name = other;
    }
    if joints.len() >= MAX_JOINTS {
        return Err(BvhFault::TooManyJoints { line, joint: name, limit: MAX_JOINTS });
    }
    if open.len() >= MAX_DEPTH {
        return Err(BvhFault::TooDeep { line, joint: name, limit: MAX_DEPTH });
    }
    match cursor.word() {
        Some("{") => {}
        Some(word) => {
            return Err(BvhFault::MissingBrace { line: cursor.line(), joint: name, found: word.into() });
        }
        None => {
            return Err(BvhFault::TruncatedHierarchy { line: cursor.line(), joint: name, opened: line });
        }
    }
    names.insert(name.clone(), line);
    let parent = open.last().map(|o| o.joint);
    open.push(Open { joint: joints.len(), line, offset: false, channels: false });
    joints.push(RawJoint { name, parent, offset: Vector3::zeros(), end: None, channels: Vec::new() });
    Ok(())
}
