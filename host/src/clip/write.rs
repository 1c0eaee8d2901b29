//! Writing a clip in the format that the file's name says.

use std::path::Path;

use super::Clip;
use super::bvh::write::{WriteError, WriteOptions};
use crate::files::write_whole;

/// A format that motions are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// BVH in centimetres, see [`super::bvh::write`].
    Bvh,
    /// glTF 2.0 in one binary file, see [`super::gltf`].
    Glb,
    /// glTF 2.0 as JSON, with the numbers in it as base64.
    Gltf,
    /// Table of joint angles, see [`super::angles`].
    Csv,
}

impl Format {
    /// All of them, with the extension of each.
    pub const ALL: [(&'static str, Self); 4] =
        [("bvh", Self::Bvh), ("glb", Self::Glb), ("gltf", Self::Gltf), ("csv", Self::Csv)];

    /// The format that a file's name says.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?;
        Self::ALL.into_iter().find(|(name, _)| extension.eq_ignore_ascii_case(name)).map(|(_, format)| format)
    }
}

impl Clip {
    /// Writes the clip in the format that the name of the file says: whole or not at all.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        let path = path.as_ref();
        let format = Format::of(path).ok_or_else(|| WriteError::Format { path: path.into() })?;
        let bytes = match format {
            Format::Bvh => self.to_bvh(&WriteOptions::default())?.into_bytes(),
            Format::Glb => self.to_glb()?,
            Format::Gltf => self.to_gltf()?.into_bytes(),
            Format::Csv => self.to_angles()?.into_bytes(),
        };
        write_whole(path, &bytes).map_err(|e| WriteError::Io { path: path.into(), error: e.to_string() })
    }
}
