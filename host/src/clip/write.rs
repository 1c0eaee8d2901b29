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
    /// Table of joint positions, see [`Clip::to_positions`].
    Positions,
}

/// How the name of a table of positions ends, beside `.csv` for angles.
const POSITIONS: &str = ".positions.csv";

impl Format {
    /// Those that an extension alone says, with it.
    pub const ALL: [(&'static str, Self); 4] =
        [("bvh", Self::Bvh), ("glb", Self::Glb), ("gltf", Self::Gltf), ("csv", Self::Csv)];

    /// The format that a file's name says: `x.csv` holds angles, `x.positions.csv` positions.
    pub fn of(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
        if name.ends_with(POSITIONS) || name == POSITIONS[1..] {
            return Some(Self::Positions);
        }
        let extension = path.extension()?;
        Self::ALL.into_iter().find(|(name, _)| extension.eq_ignore_ascii_case(name)).map(|(_, format)| format)
    }
}

impl Clip {
    /// Writes the clip in the format that the name of the file says: whole or not at all. In glTF scene and animation have the file's name;
    /// BVH has no place for one.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        let path = path.as_ref();
        let format = Format::of(path).ok_or_else(|| WriteError::Format { path: path.into() })?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let bytes = match format {
            Format::Bvh => self.to_bvh(&WriteOptions::default())?.into_bytes(),
            Format::Glb => self.to_glb_named(&name)?,
            Format::Gltf => self.to_gltf_named(&name)?.into_bytes(),
            Format::Csv => self.to_angles()?.into_bytes(),
            Format::Positions => self.to_positions()?.into_bytes(),
        };
        write_whole(path, &bytes).map_err(|e| WriteError::Io { path: path.into(), error: e.to_string() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_says_angles_or_positions() {
        let of = |name: &str| Format::of(Path::new(name));
        assert_eq!(of("walk.csv"), Some(Format::Csv));
        assert_eq!(of("a/walk.Positions.CSV"), Some(Format::Positions));
        assert_eq!(of("a/positions.csv"), Some(Format::Positions));
        assert_eq!(of("walkpositions.csv"), Some(Format::Csv));
        assert_eq!([of("walk"), of("walk.txt"), of("..")], [None; 3]);
    }
}
