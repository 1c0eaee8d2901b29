//! Changes to a clip that keep its skeleton, its rate and its names: cut, smooth, close to a cycle, stay in place.
//!
//! | file | holds |
//! |---|---|
//! | `span` | [`Time`]: seconds or a frame; [`trim`] |
//! | `smooth` | [`smooth()`]: a low-pass without delay, rotations on the sphere |
//! | `seam` | where a clip comes back to what it did before |
//! | `cycle` | [`close`]: a clip that can be played over and over |
//! | `in_place` | [`stay`]: the way along the ground taken out |
//!
//! Of a machine's motion the coordinates are changed; [`show`] makes the rotations that show them.

mod cycle;
mod in_place;
mod seam;
mod smooth;
mod span;

pub use cycle::{Cycle, Seam, close};
pub use in_place::{Sway, stay};
pub use smooth::smooth;
pub use span::{Time, trim};

use crate::clip::Clip;
use crate::rig::Rig;

/// Why a clip cannot be changed so. The option is named as the command has it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// Beyond the clip.
    #[error("{option} {asked}: the clip ends at {end:.3} s (frame {last}), expected a time before that")]
    Past {
        /// Which option.
        option: &'static str,
        /// As it was given.
        asked: String,
        /// When the last frame is due, s.
        end: f64,
        /// The last frame.
        last: usize,
    },
    /// Nothing would be left.
    #[error("--from {from}, --to {to}: found {frames} frames between them, expected at least 2: give a later --to")]
    Nothing {
        /// The first frame.
        from: usize,
        /// The last frame.
        to: usize,
        /// Frames that are left.
        frames: usize,
    },
    /// A number out of range.
    #[error("{option} {found}: expected {expected}")]
    Range {
        /// Which option.
        option: &'static str,
        /// What was given.
        found: f64,
        /// What would do.
        expected: String,
    },
    /// The clip holds no such cycle.
    #[error(
        "--loop: the clip lasts {lasts:.2} s, expected at least {needed:.2} s: {length:.2} s of the cycle and {blend:.2} s before it to blend with. \
         Ask for a shorter --length or --blend"
    )]
    Short {
        /// Length of the clip, s.
        lasts: f64,
        /// What it takes, s.
        needed: f64,
        /// The shortest cycle, s.
        length: f64,
        /// What is blended, s.
        blend: f64,
    },
    /// A robot stands.
    #[error("--in-place: the motion is a robot's, which stays where it is: leave --in-place out")]
    Stands,
}

/// Sets a machine's rotations to what its coordinates show.
pub fn show(clip: &mut Clip, rig: &Rig) {
    if clip.coordinates.is_some() {
        let shown = rig.clip_of(&rig.frames_of(clip), clip.frame_time);
        (clip.root, clip.rotations) = (shown.root, shown.rotations);
    }
}
