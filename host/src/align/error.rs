//! What can be wrong with the input of an alignment.

use std::fmt;

/// Which of the two clips an error is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The clip that gives the clock (`u`; the neutral one).
    Source,
    /// The clip that is brought onto it (`v`; the styled one).
    Target,
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Side::Source => "source",
            Side::Target => "target",
        })
    }
}

/// Why two clips cannot be aligned.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AlignError {
    /// The number of values is no multiple of the number of channels.
    #[error(
        "a series of {values} values cannot have {channels} channels: the values must be whole frames; check the channel count"
    )]
    Shape {
        /// Values given.
        values: usize,
        /// Channels given.
        channels: usize,
    },
    /// A clip has too few frames.
    #[error("the {side} clip has {found} frames, at least {needed} are needed; was it cut to nothing?")]
    TooShort {
        /// Which clip.
        side: Side,
        /// Frames found.
        found: usize,
        /// Frames needed.
        needed: usize,
    },
    /// The clips do not have the same channels.
    #[error(
        "the source has {source_channels} channels, the target {target_channels}; map both clips to the same joints first"
    )]
    Channels {
        /// Channels of the source.
        source_channels: usize,
        /// Channels of the target.
        target_channels: usize,
    },
    /// Joint positions need three channels for each joint.
    #[error("{channels} channels are not joint positions: expected x, y, z for each joint, a multiple of 3")]
    NotPositions {
        /// Channels found.
        channels: usize,
    },
    /// A value is NaN, infinite, or beyond 1e12 in magnitude.
    #[error(
        "the {side} clip has the value {value} in frame {frame}, channel {channel}; expected finite numbers up to 1e12: fill or cut gaps first"
    )]
    NotFinite {
        /// Which clip.
        side: Side,
        /// Frame, from 0.
        frame: usize,
        /// Channel, from 0.
        channel: usize,
        /// The value as text (NaN is not equal to itself).
        value: String,
    },
    /// The lengths are too different for the step pattern.
    #[error(
        "{source_frames} source and {target_frames} target frames: the steps reach at most {max} to 1; cut both clips to the same action"
    )]
    Lengths {
        /// Frames of the source.
        source_frames: usize,
        /// Frames of the target.
        target_frames: usize,
        /// Largest step of the pattern.
        max: usize,
    },
    /// A series to resample is not as long as the target was.
    #[error(
        "the series has {found} frames, the warp was made for a target of {expected}; apply it to the clip it was made for"
    )]
    Frames {
        /// Frames found.
        found: usize,
        /// Frames of the target.
        expected: usize,
    },
    /// A setting is out of its range.
    #[error("setting `{name}` is {found}, expected {expected}")]
    Setting {
        /// Field of [`Settings`](super::Settings).
        name: &'static str,
        /// Value found.
        found: f64,
        /// Range in words.
        expected: &'static str,
    },
    /// The equations of scale and offset have no unique solution.
    #[error(
        "scale and offset of channels {first_channel}.. cannot be solved for: the values are too large, or `ridge` is too small"
    )]
    Singular {
        /// First channel of the block that failed.
        first_channel: usize,
    },
}
