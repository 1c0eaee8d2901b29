//! Choosing the reader: by content first, because a wrong extension is common, then by extension.

use std::path::Path;

use super::error::ReadError;
use super::map::SkeletonMap;
use super::units::{Unit, UpAxis};
use super::{Clip, bvh, kinect};
use crate::files;

/// What the caller knows better than the file. The default lets the reader find out, and say so in the notes.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Unit of length of the file (BVH only; the Kinect CSV is in metres). `None`: the map file's, else detected from the
    /// size of the skeleton, see [`Unit::detect`].
    pub units: Option<Unit>,
    /// Up axis of the file (BVH only). `None`: the map file's, else Y unless rest pose and motion both say Z.
    pub up: Option<UpAxis>,
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

/// Reads a clip: BVH, or the CSV of a Kinect recording.
///
/// What was assumed or changed on the way in is in [`Clip::notes`].
pub fn read_with(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Clip, ReadError> {
    let path = path.as_ref();
    let bytes = slurp(path)?;
    match format_of(path, &bytes) {
        Some(Format::Bvh) => bvh::parse(&bytes, options).map_err(|error| error.at(path)),
        Some(Format::Kinect) => match kinect::parse(&bytes, &options.kinect) {
            Ok(recording) => Ok(recording.clip),
            Err(fault) => Err(ReadError::Kinect { path: path.into(), fault }),
        },
        None => Err(ReadError::UnknownFormat { path: path.into(), found: describe(&bytes) }),
    }
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

enum Format {
    Bvh,
    Kinect,
}

fn format_of(path: &Path, bytes: &[u8]) -> Option<Format> {
    let head = &bytes[..bytes.len().min(4096)];
    let head = String::from_utf8_lossy(head).to_ascii_lowercase();
    let head = head.trim_start_matches('\u{feff}').trim_start();
    if head.starts_with("hierarchy") {
        return Some(Format::Bvh);
    }
    if head.starts_with("timestamp") && head.contains("hipcenterx") {
        return Some(Format::Kinect);
    }
    match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "bvh" => Some(Format::Bvh),
        "csv" => Some(Format::Kinect),
        _ => None,
    }
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
