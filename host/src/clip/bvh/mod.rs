//! BVH (Biovision hierarchy), read and written.
//!
//! What the format leaves open, and what is done here:
//! - **Position channels replace the joint's OFFSET**, they are not added to it (Blender and the Bandai-Namco clips agree).
//!   On a joint below the root, positions that stay put are the bone; positions that vary give their mean, with a note.
//! - **Rotation channels multiply in the order in which they are listed**: `Zrotation Xrotation Yrotation` is `Rz Rx Ry`,
//!   degrees, acting on column vectors. Any order, any subset of the six channels, on any joint.
//! - **Static scene roots are folded**: where the root has one child and that child carries the motion (or is the pelvis by
//!   the joint map), the child becomes the clip's root; both transforms are composed, so nothing moves in the world.
//! - **Units and up axis** are not in the file, see [`units`](super::units).
//!
//! Keywords may be in any case, spacing is free, lines may end in CRLF, a byte-order mark is skipped, joint names may hold
//! blanks and colons. Dialects whose meaning is certain are read with a note (`text`, `hierarchy`, `motion`, `select`); everything
//! else is refused by line number, see [`BvhFault`].

mod assemble;
mod cursor;
pub mod euler;
mod fault;
mod fields;
mod fold;
mod hierarchy;
mod motion;
mod number;
pub(super) mod orient;
mod plain;
mod rows;
mod select;
pub(super) mod spikes;
#[cfg(test)]
mod tests;
pub(super) mod text;
pub mod write;

use std::io::Read;
use std::path::Path;

pub use fault::BvhFault;

use super::map::MapError;
use super::{Clip, ReadError, ReadOptions};

/// Most joints a file may have.
pub const MAX_JOINTS: usize = 1024;
/// Deepest nesting a file may have.
pub const MAX_DEPTH: usize = 256;

/// Why BVH text is refused; [`ReadError`] without the file's name.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParseError {
    /// The text is broken.
    #[error("{0}")]
    Fault(#[from] BvhFault),
    /// The map in the options does not fit.
    #[error("the skeleton map does not fit: {0}")]
    Map(#[from] MapError),
    /// The size fits no unit.
    #[error("the unit of length cannot be told from {0}")]
    UnknownUnits(String),
}

impl ParseError {
    /// The same error, with the file's name.
    pub fn at(self, path: &Path) -> ReadError {
        let path = path.into();
        match self {
            ParseError::Fault(fault) => ReadError::Bvh { path, fault },
            ParseError::Map(error) => ReadError::Map { path, error },
            ParseError::UnknownUnits(measured) => ReadError::UnknownUnits { path, measured },
        }
    }
}

/// Parses the bytes of a BVH file. Cost: one float parsed per value and one sine and cosine per rotation channel.
pub fn parse(bytes: &[u8], options: &ReadOptions) -> Result<Clip, ParseError> {
    read(&mut &*bytes, bytes.len(), options).unwrap_or_else(|| parse_any(bytes, options))
}

/// Reads a plain file of about `length` bytes without ever holding its text; nothing where the text is of a dialect, or broken, and
/// [`parse`] has to look at it.
pub(super) fn read(
    source: &mut (impl Read + Send),
    length: usize,
    options: &ReadOptions,
) -> Option<Result<Clip, ParseError>> {
    let plain = plain::read(source, length, options.root.as_deref())?;
    Some(assemble::clip(plain.joints, plain.rows, plain.frame_time, options, plain.notes))
}

/// Parses text of any dialect, and says what is wrong with it.
fn parse_any(bytes: &[u8], options: &ReadOptions) -> Result<Clip, ParseError> {
    let mut notes = Vec::new();
    let text = text::decode(bytes, &mut notes)?;
    let mut cursor = cursor::Cursor::new(&text);
    let mut hierarchy = hierarchy::parse(&mut cursor)?;
    notes.append(&mut hierarchy.notes);
    let motion = motion::parse(cursor, &hierarchy.joints, &mut notes)?;
    let (joints, keep) = select::used(hierarchy.joints, options.root.as_deref(), &mut notes)?;
    let mut rows = rows::Rows::new(&joints, motion.values.len() / keep.len());
    for frame in motion.values.chunks_exact(keep.len()) {
        rows.push(&joints, frame.iter().zip(&keep).filter(|(_, keep)| **keep).map(|(value, _)| *value));
    }
    drop(motion.values);
    assemble::clip(joints, rows, motion.frame_time, options, notes)
}
