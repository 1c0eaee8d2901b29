//! What an alignment found.

use std::ops::Range;

use super::banded::LANES;
use super::clock;
use super::error::AlignError;
use super::iterate::{Energy, Progress};
use super::search::Work;
use super::series::Series;
use super::settings::Settings;
use super::space::SpaceWarp;
use super::standard::Standard;

/// A time warp with scale and offset of each channel, `W (U a + b) = v` as nearly as the smoothness allows.
#[derive(Debug, Clone, PartialEq)]
pub struct Warp {
    path: Vec<(usize, usize)>,
    target_frames: usize,
    clock_raw: Vec<f64>,
    clock: Vec<f64>,
    scale: Vec<f64>,
    offset: Vec<f64>,
    history: Vec<Progress>,
    converged: bool,
    work: Work,
}

impl Warp {
    #[expect(clippy::too_many_arguments, reason = "called once, by the iteration")]
    pub(super) fn new(
        path: Vec<(usize, usize)>,
        u: &Standard,
        v: &Standard,
        space: &SpaceWarp,
        settings: &Settings,
        history: Vec<Progress>,
        converged: bool,
        work: Work,
    ) -> Self {
        let (mut scale, mut offset) = (Vec::new(), Vec::new());
        for frame in 0..u.frames {
            for channel in 0..u.channels {
                // v' = a u' + b with u' = (u - mu) / su and v' = (v - mv) / sv
                let [a, b] = space.at(channel / LANES, frame).map(|lane| lane[channel % LANES]);
                let a = a * v.deviation[channel] / u.deviation[channel];
                scale.push(a);
                offset.push(b * v.deviation[channel] + v.mean[channel] - a * u.mean[channel]);
            }
        }
        let clock_raw = clock::clock(&path, u.frames);
        let mut warp = Self {
            path,
            target_frames: v.frames,
            clock: Vec::new(),
            clock_raw,
            scale,
            offset,
            history,
            converged,
            work,
        };
        warp.clock = warp.smoothed_clock(settings.clock_smoothing);
        warp
    }

    /// Matches `(source frame, target frame)`. Every target frame between the first and the last match occurs once, in order;
    /// a source frame occurs several times (repetition) or not at all (deletion).
    pub fn path(&self) -> &[(usize, usize)] {
        &self.path
    }

    /// Cost after each half iteration: never rises.
    pub fn history(&self) -> &[Progress] {
        &self.history
    }

    /// The final cost.
    pub fn energy(&self) -> Energy {
        self.history.last().map_or_else(Energy::default, |p| p.energy)
    }

    /// Iterations done.
    pub fn iterations(&self) -> usize {
        self.history.last().map_or(0, |p| p.iteration)
    }

    /// Whether the tolerance was reached before the number of iterations ran out.
    pub fn converged(&self) -> bool {
        self.converged
    }

    /// How much was searched.
    pub fn work(&self) -> Work {
        self.work
    }

    /// Scale `a`, `[source frames x channels]`, target units per source unit.
    pub fn scale(&self) -> &[f64] {
        &self.scale
    }

    /// Offset `b`, `[source frames x channels]`, in target units.
    pub fn offset(&self) -> &[f64] {
        &self.offset
    }

    /// Source frames between the first and the last match; all of them with closed ends.
    pub fn covered(&self) -> Range<usize> {
        match (self.path.first(), self.path.last()) {
            (Some(a), Some(b)) => a.0..b.0 + 1,
            _ => 0..0,
        }
    }

    /// Target frames between the first and the last match; all of them with closed ends.
    pub fn covered_target(&self) -> Range<usize> {
        match (self.path.first(), self.path.last()) {
            (Some(a), Some(b)) => a.1..b.1 + 1,
            _ => 0..0,
        }
    }

    /// For every source frame a fractional target frame, never falling, `[source frames]`.
    ///
    /// The mean over repetitions, linear across deletions, then smoothed by [`Settings::clock_smoothing`]; the first and the
    /// last match are exact. Outside [`covered`](Self::covered) it stays at the nearest matched frame.
    pub fn target_on_source(&self) -> &[f64] {
        &self.clock
    }

    /// The local speed d(target frame) / d(source frame), `[source frames]`, never negative: the timing to be learned.
    ///
    /// The clock is smoothed by a triangular kernel of `half_window` frames on either side first (8 to 15 at 60 fps take the
    /// steps of whole frames out). Outside [`covered`](Self::covered) the nearest value. O(frames x half_window).
    pub fn slope(&self, half_window: usize) -> Vec<f64> {
        let covered = self.covered();
        let smoothed = self.smoothed_clock(half_window);
        let inner = clock::slope(smoothed.get(covered.clone()).unwrap_or(&[]));
        extend(&inner, covered.start, self.clock_raw.len())
    }

    /// Resamples a series on the target's clock, `[target frames x any channels]`, to the source's: `[source frames x the
    /// same channels]`, row-major, linear between frames. O(frames x channels).
    ///
    /// # Errors
    /// [`AlignError::Frames`] where the series is not as long as the target.
    pub fn apply(&self, series: Series<'_>) -> Result<Vec<f64>, AlignError> {
        if series.frames() != self.target_frames {
            return Err(AlignError::Frames { found: series.frames(), expected: self.target_frames });
        }
        let mut out = Vec::with_capacity(self.clock.len() * series.channels());
        for &at in &self.clock {
            let at = at.max(0.0);
            let (frame, part) = (at as usize, at.fract());
            let here = series.row(frame).unwrap_or(&[]);
            let next = series.row(frame + 1).unwrap_or(here);
            out.extend(here.iter().zip(next).map(|(a, b)| a + (b - a) * part));
        }
        Ok(out)
    }

    /// The source with scale and offset applied, `a u + b`, `[source frames x channels]` in target units: what the target
    /// would be on the source's clock if the styles differed by the smooth scale and offset only.
    ///
    /// # Errors
    /// [`AlignError::Shape`] where `source` is not the series the warp was made from.
    pub fn fitted(&self, source: Series<'_>) -> Result<Vec<f64>, AlignError> {
        let values = source.data();
        if values.len() != self.scale.len() || source.frames() != self.clock.len() {
            return Err(AlignError::Shape { values: values.len(), channels: source.channels() });
        }
        Ok(values.iter().zip(&self.scale).zip(&self.offset).map(|((u, a), b)| a * u + b).collect())
    }

    fn smoothed_clock(&self, half: usize) -> Vec<f64> {
        let covered = self.covered();
        let inner = clock::smooth(self.clock_raw.get(covered.clone()).unwrap_or(&[]), half);
        extend(&inner, covered.start, self.clock_raw.len())
    }
}

/// Puts `inner` at `start` of `length` values and repeats its ends.
fn extend(inner: &[f64], start: usize, length: usize) -> Vec<f64> {
    let last = inner.len().saturating_sub(1);
    (0..length).map(|t| inner.get(t.saturating_sub(start).min(last)).copied().unwrap_or(0.0)).collect()
}
