//! What the plugin counted: instructions of every frame, and of every address.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Counts of one instruction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Instruction {
    /// Its bytes in memory order.
    pub bytes: Vec<u8>,
    /// Executions and taken branches in all frames.
    pub all: (u64, u64),
    /// Executions and taken branches in the longest frame.
    pub longest: (u64, u64),
}

/// The counts of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Profile {
    /// Instructions of each frame in order.
    pub frames: Vec<u64>,
    /// Every instruction that a frame executed, by address.
    pub instructions: BTreeMap<u64, Instruction>,
}

/// The plugin's file cannot be used.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ProfileError {
    /// It is not there.
    #[error("cannot read the plugin's counts {}: {source}", path.display())]
    #[diagnostic(help("the emulator may have refused the plugin: it speaks plugin API 1, of QEMU 6.0 to 8.2"))]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A line is not what the plugin writes.
    #[error("the plugin's counts {} are damaged at line {line}", path.display())]
    #[diagnostic(help("delete the folder `firmware` in cargo's target folder and run again"))]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Line number from 1.
        line: usize,
    },
    /// No frame was seen.
    #[error("the plugin saw no whole frame ({})", path.display())]
    #[diagnostic(help("the image must call kinesic_frame_begin and kinesic_frame_end around every step"))]
    NoFrame {
        /// The file.
        path: PathBuf,
    },
}

impl Profile {
    /// Reads the file whose format `firmware-sim/plugin` documents.
    pub fn read(path: &Path) -> Result<Self, ProfileError> {
        let text =
            std::fs::read_to_string(path).map_err(|source| ProfileError::Read { path: path.to_owned(), source })?;
        let damaged = |line: usize| ProfileError::Damaged { path: path.to_owned(), line };
        let mut lines = text.lines();
        let (Some(_), Some(lengths)) = (lines.next(), lines.next()) else { return Err(damaged(1)) };
        let frames: Option<Vec<u64>> = lengths.split_whitespace().map(|number| number.parse().ok()).collect();
        let frames = frames.ok_or_else(|| damaged(2))?;
        if frames.is_empty() {
            return Err(ProfileError::NoFrame { path: path.to_owned() });
        }
        let mut instructions = BTreeMap::new();
        for (number, line) in lines.enumerate().skip(1) {
            let (address, instruction) = instruction(line).ok_or_else(|| damaged(number + 3))?;
            instructions.insert(address, instruction);
        }
        let profile = Self { frames, instructions };
        // The per-frame sums and the per-address counts are kept by different counters: they must agree.
        let by_address: u64 = profile.instructions.values().map(|instruction| instruction.all.0).sum();
        if by_address != profile.frames.iter().sum::<u64>() { Err(damaged(2)) } else { Ok(profile) }
    }

    /// Fewest, median and most instructions of a frame.
    pub fn spread(&self) -> [u64; 3] {
        let mut sorted = self.frames.clone();
        sorted.sort_unstable();
        let at = |index: usize| sorted.get(index).copied().unwrap_or(0);
        [at(0), at(sorted.len() / 2), at(sorted.len().saturating_sub(1))]
    }
}

fn instruction(line: &str) -> Option<(u64, Instruction)> {
    let mut fields = line.split(' ');
    let address = u64::from_str_radix(fields.next()?, 16).ok()?;
    let digits = fields.next()?;
    let bytes = (0..digits.len()).step_by(2).map(|at| u8::from_str_radix(digits.get(at..at + 2)?, 16).ok());
    let bytes = bytes.collect::<Option<Vec<u8>>>()?;
    let mut number = || fields.next()?.parse().ok();
    let (all, longest) = ((number()?, number()?), (number()?, number()?));
    Some((address, Instruction { bytes, all, longest }))
}
