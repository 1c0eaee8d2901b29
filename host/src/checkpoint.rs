//! Checkpoints: what a long training has reached, beside its pack, so that a kill costs seconds and not hours.
//!
//! A file `NAME.checkpoint` is written whole or not at all, and removed when the pack is there. It carries a key over
//! everything that decides the outcome (version, options, clips); a checkpoint of another training is refused, not used.
//! A training that goes on from one ends with the same pack, byte for byte, as one that was never stopped.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use sha2::{Digest, Sha256};

use crate::files::{self, write_whole};

/// First bytes of a checkpoint: name and version of its format.
const MAGIC: [u8; 8] = *b"KNSCKP01";

/// Why a checkpoint cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The system refused.
    #[error("{}: the checkpoint cannot be read: {error}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The cause.
        error: std::io::Error,
    },
    /// Cut off or changed.
    #[error(
        "{}: found {found} bytes that are no whole checkpoint, expected one of this release: remove it to train from the \
         beginning",
        path.display()
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Its length.
        found: usize,
    },
    /// Of another training.
    #[error(
        "{}: found the checkpoint of a training with other clips, other options or another release. Repeat the command that it \
         was made with, or leave out --resume to train from the beginning",
        path.display()
    )]
    Another {
        /// The file.
        path: PathBuf,
    },
}

/// Where a training keeps what it has reached. `()` keeps nothing.
pub trait Keep {
    /// What an earlier run has kept.
    fn earlier(&mut self) -> Option<Vec<u8>> {
        None
    }

    /// Offers the present state; `state` is called where it is time to keep it.
    fn offer(&mut self, state: &dyn Fn() -> Vec<u8>) {
        let _ = state;
    }
}

impl Keep for () {}

/// A checkpoint on disk.
#[derive(Debug)]
pub struct Checkpoint {
    path: PathBuf,
    key: [u8; 32],
    every: Duration,
    written: Instant,
    earlier: Option<Vec<u8>>,
    failed: Option<std::io::Error>,
}

impl Checkpoint {
    /// The checkpoint of the pack `out`, written at most once in `every`. `deciding` is everything that decides the outcome of
    /// the training: two trainings with the same parts must be the same training.
    pub fn new(out: &Path, deciding: &[String], every: Duration) -> Self {
        let mut hash = Sha256::new();
        for part in [env!("CARGO_PKG_VERSION")].into_iter().chain(deciding.iter().map(String::as_str)) {
            // The length first, so that no two lists of parts run together into the same bytes.
            hash.update((part.len() as u64).to_le_bytes());
            hash.update(part);
        }
        let path = out.with_extension("checkpoint");
        Self { path, key: hash.finalize().into(), every, written: Instant::now(), earlier: None, failed: None }
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads what an earlier run has left; false if there is nothing.
    pub fn resume(&mut self) -> Result<bool, CheckpointError> {
        let path = || self.path.clone();
        let bytes = match files::read(&self.path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(false),
            Err(error) => return Err(CheckpointError::Io { path: path(), error }),
        };
        let damaged = || CheckpointError::Damaged { path: path(), found: bytes.len() };
        let rest = bytes.strip_prefix(&MAGIC).ok_or_else(damaged)?;
        let (key, rest) = rest.split_first_chunk::<32>().ok_or_else(damaged)?;
        let (sum, state) = rest.split_first_chunk::<32>().ok_or_else(damaged)?;
        if *sum != <[u8; 32]>::from(Sha256::digest(state)) {
            return Err(damaged());
        }
        if *key != self.key {
            return Err(CheckpointError::Another { path: path() });
        }
        self.earlier = Some(state.to_vec());
        Ok(true)
    }

    /// The error of the last write, if it failed: training goes on without.
    pub fn take_failure(&mut self) -> Option<std::io::Error> {
        self.failed.take()
    }

    /// Removes the file: the pack is there.
    pub fn finish(self) {
        // One that cannot be removed does no harm: its key still says what it is.
        let _ = std::fs::remove_file(&self.path);
    }

    fn write(&self, state: &[u8]) -> std::io::Result<()> {
        let sum: [u8; 32] = Sha256::digest(state).into();
        write_whole(&self.path, &[&MAGIC, &self.key[..], &sum, state].concat())
    }
}

impl Keep for Checkpoint {
    fn earlier(&mut self) -> Option<Vec<u8>> {
        self.earlier.take()
    }

    fn offer(&mut self, state: &dyn Fn() -> Vec<u8>) {
        if self.written.elapsed() >= self.every {
            self.failed = self.write(&state()).err();
            self.written = Instant::now();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_kept_comes_back_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("my.kin");
        let new = |part: &str| Checkpoint::new(&out, &[part.to_owned()], Duration::ZERO);
        assert!(!new("a").resume().unwrap());
        new("a").offer(&|| vec![1, 2, 3]);
        let mut again = new("a");
        assert!(again.resume().unwrap());
        assert_eq!(again.earlier(), Some(vec![1, 2, 3]));
        assert!(matches!(new("b").resume(), Err(CheckpointError::Another { .. })));

        let path = again.path().to_owned();
        let bytes = std::fs::read(&path).unwrap();
        for len in 0..bytes.len() {
            std::fs::write(&path, &bytes[..len]).unwrap();
            assert!(matches!(new("a").resume(), Err(CheckpointError::Damaged { .. })), "cut to {len} bytes");
        }
        for bit in 0..8 * bytes.len() {
            let mut flipped = bytes.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            std::fs::write(&path, &flipped).unwrap();
            assert!(new("a").resume().is_err(), "bit {bit} flipped");
        }
        again.finish();
        assert!(!path.exists());
    }

    #[test]
    fn a_checkpoint_is_written_when_it_is_due_and_a_failure_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let mut seldom = Checkpoint::new(&folder.path().join("my.kin"), &[], Duration::from_secs(3600));
        seldom.offer(&|| unreachable!("not yet due"));
        assert!(!seldom.path().exists());
        let mut nowhere = Checkpoint::new(&folder.path().join("gone/my.kin"), &[], Duration::ZERO);
        nowhere.offer(&|| vec![1]);
        assert!(nowhere.take_failure().is_some());
    }
}
