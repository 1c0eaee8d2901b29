//! A borrowed table of frames x channels.

use super::error::{AlignError, Side};

/// Largest magnitude of a value.
const LARGEST: f64 = 1e12;

/// A view of `frames x channels` values, row-major: all channels of frame 0, then of frame 1, and so on.
///
/// `[frames x N joints x 3]` positions are a series of `3 N` channels.
#[derive(Debug, Clone, Copy)]
pub struct Series<'a> {
    data: &'a [f64],
    channels: usize,
}

impl<'a> Series<'a> {
    /// Views `data` as whole frames of `channels` values each. O(1).
    ///
    /// # Errors
    /// [`AlignError::Shape`] where `channels` is zero or does not divide the number of values.
    pub fn new(data: &'a [f64], channels: usize) -> Result<Self, AlignError> {
        if channels == 0 || !data.len().is_multiple_of(channels) {
            return Err(AlignError::Shape { values: data.len(), channels });
        }
        Ok(Self { data, channels })
    }

    /// Number of frames.
    pub fn frames(&self) -> usize {
        self.data.len() / self.channels
    }

    /// Values in a frame.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The values, row-major.
    pub fn data(&self) -> &'a [f64] {
        self.data
    }

    /// The frames in order, each a slice of `channels` values.
    pub fn rows(&self) -> std::slice::ChunksExact<'a, f64> {
        self.data.chunks_exact(self.channels)
    }

    /// One frame; `None` beyond the end.
    pub fn row(&self, frame: usize) -> Option<&'a [f64]> {
        let start = frame.checked_mul(self.channels)?;
        self.data.get(start..start.checked_add(self.channels)?)
    }

    /// Refuses short clips and values that are not finite or so large that squared distances leave the range of f32.
    pub(super) fn check(&self, side: Side, needed: usize) -> Result<(), AlignError> {
        if self.frames() < needed {
            return Err(AlignError::TooShort { side, found: self.frames(), needed });
        }
        match self.data.iter().position(|v| !(-LARGEST..=LARGEST).contains(v)) {
            None => Ok(()),
            Some(at) => Err(AlignError::NotFinite {
                side,
                frame: at / self.channels,
                channel: at % self.channels,
                value: self.data.get(at).map_or_else(String::new, f64::to_string),
            }),
        }
    }
}

/// Both clips must be finite, long enough and have the same channels.
pub(super) fn check_pair(source: Series<'_>, target: Series<'_>, needed: usize) -> Result<(), AlignError> {
    if source.channels != target.channels {
        return Err(AlignError::Channels { source_channels: source.channels, target_channels: target.channels });
    }
    source.check(Side::Source, needed)?;
    target.check(Side::Target, needed)
}
