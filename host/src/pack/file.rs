//! Packs on disk.

use std::path::{Path, PathBuf};

use kinesic::{LoadError, Pack};

use super::Provenance;

/// A pack file in memory, aligned as the device would have it in flash.
#[derive(Clone, Debug)]
pub struct PackFile {
    /// 16-byte words, so that the bytes are aligned without unsafe code.
    words: Vec<u128>,
    len: usize,
}

/// Why a pack file could not be used.
#[derive(Debug, thiserror::Error)]
pub enum ReadPackError {
    /// The file cannot be read.
    #[error("cannot read the pack {}: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The cause.
        error: std::io::Error,
    },
    /// The file is not a usable pack.
    #[error("cannot use the pack {}: {error}", path.display())]
    Load {
        /// The file.
        path: PathBuf,
        /// The cause.
        error: LoadError,
    },
}

impl PackFile {
    /// Reads and checks a pack.
    pub fn read(path: &Path) -> Result<Self, ReadPackError> {
        let bytes = crate::files::read(path).map_err(|error| ReadPackError::Io { path: path.to_owned(), error })?;
        let file = Self::from_bytes(&bytes);
        file.pack().map_err(|error| ReadPackError::Load { path: path.to_owned(), error })?;
        Ok(file)
    }

    /// An aligned copy of `bytes`, unchecked.
    pub fn from_bytes(bytes: &[u8]) -> Self {
        let mut words = vec![0u128; bytes.len().div_ceil(size_of::<u128>())];
        bytemuck::cast_slice_mut(&mut words)[..bytes.len()].copy_from_slice(bytes);
        Self { words, len: bytes.len() }
    }

    /// The file's bytes, aligned to 16.
    pub fn bytes(&self) -> &[u8] {
        &bytemuck::cast_slice(&self.words)[..self.len]
    }

    /// The same, to be changed: how tests damage a pack.
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        &mut bytemuck::cast_slice_mut(&mut self.words)[..self.len]
    }

    /// The checked view that the device would load.
    pub fn pack(&self) -> Result<Pack<'_>, LoadError> {
        Pack::load(self.bytes())
    }

    /// Where the pack comes from; `None` if this release cannot read that part.
    pub fn provenance(&self) -> Option<Provenance> {
        Provenance::decode(self.pack().ok()?.metadata().provenance)
    }
}
