//! From a path to a clip: the bytes, the reader, the notes.

use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use super::error::ReadError;
use super::formats::{is_bvh, reader_of, sniffed};
use super::map::SkeletonMap;
use super::notes::{NoteLog, is_assumption};
use super::units::{Unit, UpAxis};
use super::{Clip, bvh, kinect};
use crate::files;
use crate::moves;
use crate::robot::Machine;

/// What the caller knows better than the file. The default lets the reader find out, and say so in the notes.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Unit of length of the file. `None`: the map file's, else detected from the
    /// size of the skeleton, see [`Unit::detect`].
    pub units: Option<Unit>,
    /// Up axis of the file. `None`: the map file's, else found from rest pose, motion and floor, else Y.
    pub up: Option<UpAxis>,
    /// The file's axes are left-handed: its Z is turned round.
    pub left_handed: bool,
    /// Which figure of a file with several, by the name of its root; the first unless given.
    pub root: Option<String>,
    /// Bridge frames that were lost or leap.
    pub repair: bool,
    /// Refuse what would be assumed.
    pub strict: bool,
    /// Where notes are gathered, see [`NoteLog`].
    pub log: Option<&'static NoteLog>,
    /// The machine whose motions the files hold, instead of a body's.
    pub machine: Option<Arc<Machine>>,
    /// What angles of a machine's motions are counted in, where the file does not say it.
    pub angles: Option<moves::Unit>,
    /// Frames per second of a machine's motions without times; an episode of a table with several.
    pub moves: moves::Options,
    /// Joint names of a skeleton that is not among the known layouts.
    pub map: Option<SkeletonMap>,
    /// Options for recordings without a steady clock.
    pub kinect: kinect::KinectOptions,
}

/// Reads a clip with default options. See [`read_with`].
///
/// ```no_run
/// let clip = kinesic_host::clip::read("walk.bvh")?;
/// println!("{} frames at {:.0} fps", clip.frames(), clip.fps());
/// # Ok::<(), kinesic_host::clip::ReadError>(())
/// ```
pub fn read(path: impl AsRef<Path>) -> Result<Clip, ReadError> {
    read_with(path, &ReadOptions::default())
}

/// Reads a clip of any kind in [`READERS`](super::formats::READERS), also compressed with gzip.
///
/// What was assumed or changed on the way in is in [`Clip::notes`].
pub fn read_with(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Clip, ReadError> {
    let path = path.as_ref();
    if let Some(clip) = plain(path, options)? {
        gathered(path, &clip.notes, options)?;
        return Ok(clip);
    }
    let (bytes, packed) = unpacked(slurp(path)?, path)?;
    let head = &bytes[..bytes.len().min(HEAD)];
    if sniffed(head).is_none() && moves::is_moves(path, head) {
        return Err(ReadError::Machine { path: path.into() });
    }
    let Some(reader) = reader_of(path, head) else {
        return Err(ReadError::UnknownFormat { path: path.into(), found: describe(&bytes) });
    };
    let mut clip = (reader.parse)(&bytes, path, options)?;
    if packed {
        clip.notes.push("The file was compressed with gzip.".into());
    }
    gathered(path, &clip.notes, options)?;
    Ok(clip)
}

/// A plain BVH file, without ever holding its text. Whatever else there is at the path is left to what reads it whole.
fn plain(path: &Path, options: &ReadOptions) -> Result<Option<Clip>, ReadError> {
    if path == Path::new("-") || files::check_regular(path).is_err() {
        return Ok(None);
    }
    let Ok(mut file) = std::fs::File::open(path) else { return Ok(None) };
    let (mut head, length) = (Vec::new(), file.metadata().map_or(0, |m| m.len() as usize));
    let read = file.by_ref().take(HEAD as u64).read_to_end(&mut head);
    if read.is_err() || !is_bvh(&head) {
        return Ok(None);
    }
    let mut source = head.as_slice().chain(file);
    bvh::read(&mut source, length, options).transpose().map_err(|error| error.at(path))
}

/// The content of a file, unpacked.
pub fn contents(path: &Path) -> Result<Vec<u8>, ReadError> {
    Ok(unpacked(slurp(path)?, path)?.0)
}

/// Gathers the notes of a file, or refuses what was assumed where that is asked for.
pub fn gathered(path: &Path, notes: &[String], options: &ReadOptions) -> Result<(), ReadError> {
    if options.strict
        && let Some(note) = notes.iter().find(|note| is_assumption(note))
    {
        return Err(ReadError::Assumed { path: path.into(), note: note.clone() });
    }
    if let Some(log) = options.log {
        log.add(path, notes);
    }
    Ok(())
}

/// Bytes by which a kind of file is told.
const HEAD: usize = 4096;

/// Most bytes that a compressed file may hold: a small one can claim a lot.
const MOST: u64 = 1 << 31;

/// The content of a gzip file, or the bytes as they are.
fn unpacked(bytes: Vec<u8>, path: &Path) -> Result<(Vec<u8>, bool), ReadError> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok((bytes, false));
    }
    let mut out = Vec::new();
    let mut reader = flate2::read::MultiGzDecoder::new(bytes.as_slice()).take(MOST + 1);
    let refuse = |error: String| ReadError::Compressed { path: path.into(), error };
    reader.read_to_end(&mut out).map_err(|error| refuse(error.to_string()))?;
    if out.len() as u64 > MOST {
        return Err(refuse(format!("it holds more than {MOST} bytes")));
    }
    Ok((out, true))
}

/// The whole file, with errors that tell a missing file from a folder.
pub(super) fn slurp(path: &Path) -> Result<Vec<u8>, ReadError> {
    if path.is_dir() {
        return Err(ReadError::Directory { path: path.into() });
    }
    files::read(path).map_err(|source| match source.kind() {
        std::io::ErrorKind::NotFound => ReadError::NotFound { path: path.into() },
        _ => ReadError::Io { path: path.into(), error: source.to_string() },
    })
}

fn describe(bytes: &[u8]) -> String {
    if bytes.is_empty() {
        return "an empty file".into();
    }
    let line = bytes.split(|&b| b == b'\n').next().unwrap_or(&[]);
    match std::str::from_utf8(line) {
        Ok(text) if !text.contains('\0') => {
            format!("text that starts with '{}'", text.trim().chars().take(40).collect::<String>())
        }
        _ => "binary data".into(),
    }
}
