//! Plain files, block by block: the text is never held whole, and the blocks are read on all cores.
//!
//! A file is plain if it is UTF-8 and every frame is one line of as many numbers as there are channels. Whatever is not plain, or is
//! wrong, is left to the reader that holds the text and knows dialects and faults: here it gives nothing. Both give the same bits.

use std::borrow::Cow;
use std::io::{Error, ErrorKind, Read, Result};

use rayon::prelude::*;

use super::hierarchy::RawJoint;
use super::number::{is_space, number};
use super::rows::Rows;
use super::{cursor, hierarchy, motion, select, text};

/// Bytes of a block: it holds the hierarchy of every file but absurd ones, and some hundred frames.
const BLOCK: usize = 1 << 19;
/// Blocks that are read at once, per thread.
const DEPTH: usize = 4;

/// What a plain file holds.
pub(super) struct Plain {
    pub joints: Vec<RawJoint>,
    pub rows: Rows,
    pub frame_time: f64,
    pub notes: Vec<String>,
}

/// Reads a plain file of about `length` bytes; nothing where it is not plain.
pub(super) fn read(source: &mut (impl Read + Send), length: usize, root: Option<&str>) -> Option<Plain> {
    let mut blocks = Blocks { source, rest: Vec::new() };
    let first = blocks.next().ok()?;
    let mut notes = Vec::new();
    let Cow::Borrowed(head) = text::decode(&first, &mut notes).ok()? else { return None };
    let mut cursor = cursor::Cursor::new(head);
    let mut hierarchy = hierarchy::parse(&mut cursor).ok()?;
    notes.append(&mut hierarchy.notes);
    let all: usize = hierarchy.joints.iter().map(|j| j.channels.len()).sum();
    let header = motion::header(&mut cursor).ok().filter(|_| all > 0)?;
    let mut chosen = Vec::new();
    let (joints, keep) = select::used(hierarchy.joints, root, &mut chosen).ok()?;

    // A number takes two bytes at least: the file's size, not its claim, bounds what is reserved.
    let room = header.frames.unwrap_or(0).min(length / (2 * all) + 1);
    let mut rows = Rows::new(&joints, room);
    let layout = Layout { joints: &joints, keep: &keep };
    rows.extend(&layout.frames(cursor.rest().as_bytes())?);
    drop(first);
    // While some blocks are parsed, those before them are put in their place and those after them are read.
    let (mut parsed, mut next) = (Vec::new(), blocks.some().ok()?);
    while !(next.is_empty() && parsed.is_empty()) {
        let (new, coming) = rayon::join(
            || next.par_iter().map(|block| layout.frames(block)).collect::<Option<Vec<Rows>>>(),
            || {
                parsed.iter().for_each(|part| rows.extend(part));
                blocks.some()
            },
        );
        (parsed, next) = (new?, coming.ok()?);
    }
    header.check(rows.frames, 0, &mut notes).ok()?;
    notes.append(&mut chosen);
    Some(Plain { joints, rows, frame_time: header.frame_time, notes })
}

/// What a line holds.
#[derive(Clone, Copy)]
struct Layout<'a> {
    joints: &'a [RawJoint],
    /// Which of the numbers are of these joints.
    keep: &'a [bool],
}

impl Layout<'_> {
    /// The frames of whole lines.
    fn frames(&self, text: &[u8]) -> Option<Rows> {
        // All lines are about as long as the first.
        let first = text.iter().position(|b| *b == b'\n').unwrap_or(text.len());
        let mut rows = Rows::new(self.joints, text.len() * 9 / (8 * (first + 1)) + 2);
        let mut values = Vec::with_capacity(self.keep.len());
        let mut at = 0;
        loop {
            match text.get(at) {
                Some(b' ') => at += 1,
                None | Some(b'\n') => {
                    if values.len() == self.keep.len() {
                        let kept = values.iter().zip(self.keep).filter(|(_, keep)| **keep);
                        rows.push(self.joints, kept.map(|(value, _)| *value));
                    } else if !values.is_empty() {
                        return None;
                    }
                    values.clear();
                    if at >= text.len() {
                        return Some(rows);
                    }
                    at += 1;
                }
                Some(byte) if is_space(*byte) => at += 1,
                Some(_) => {
                    let (value, end) = number(text, at)?;
                    values.push(value);
                    at = end;
                }
            }
        }
    }
}

/// A source in blocks that end with a line.
struct Blocks<'a, R> {
    source: &'a mut R,
    /// What was read of the next line.
    rest: Vec<u8>,
}

impl<R: Read> Blocks<'_, R> {
    /// The next block, empty at the end; refused where a line is longer than a block.
    fn next(&mut self) -> Result<Vec<u8>> {
        let mut block = Vec::with_capacity(BLOCK);
        block.append(&mut self.rest);
        let wanted = (BLOCK - block.len()) as u64;
        if (self.source.by_ref().take(wanted).read_to_end(&mut block)? as u64) < wanted {
            return Ok(block);
        }
        let end = block.iter().rposition(|b| *b == b'\n').ok_or(Error::from(ErrorKind::FileTooLarge))?;
        self.rest = block.split_off(end + 1);
        Ok(block)
    }

    /// The next blocks, as many as there are threads to read them; none at the end.
    fn some(&mut self) -> Result<Vec<Vec<u8>>> {
        let mut blocks = Vec::new();
        while blocks.len() < DEPTH * rayon::current_num_threads() {
            let block = self.next()?;
            if block.is_empty() {
                break;
            }
            blocks.push(block);
        }
        Ok(blocks)
    }
}
