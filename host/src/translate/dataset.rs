//! Training sequences: a source clip's frames, and what the styled clip does at the same moment.

use std::ops::Range;

use crate::rig::{Locals, Mirror, Rig};

/// Which styled moment belongs to which source frame.
#[derive(Clone, Debug)]
pub struct Correspondence {
    /// Source frames that have a partner.
    pub covered: Range<usize>,
    /// Fractional target frame of each covered source frame, never falling.
    pub target: Vec<f64>,
    /// Target frames a source frame lasts, smoothed.
    pub duration: Vec<f64>,
}

/// Input and wanted output of the models: [coordinates](kinesic::rig), each times its lever, so that all are metres and an error
/// counts as much as it moves. Travel is per *source* frame.
#[derive(Clone, Debug)]
pub struct Sequence {
    /// Channels of a row.
    pub channels: usize,
    /// All source frames: filters run through the uncovered ones too.
    pub input: Vec<f64>,
    /// Frames for which there is an output.
    pub covered: Range<usize>,
    /// Rows of the covered frames.
    pub output: Vec<f64>,
    /// log2 of the duration of the covered frames.
    pub log_duration: Vec<f64>,
    /// Sequences of one group are held back together in validation.
    pub group: usize,
}

impl Sequence {
    /// The sequence of a pair.
    pub fn new(rig: &Rig, source: &Locals, target: &Locals, on: &Correspondence, group: usize) -> Self {
        let styled = rig.scaled(&target.coordinates);
        let channels = 3 * rig.rows();
        let last = target.frames().saturating_sub(1);
        let mut output = Vec::with_capacity(on.target.len() * channels);
        for (at, duration) in on.target.iter().zip(&on.duration) {
            let before = (at.floor().max(0.0) as usize).min(last);
            let after = (before + 1).min(last);
            let weight = (at - before as f64).clamp(0.0, 1.0);
            let start = output.len();
            let (a, b) = (&styled[before * channels..][..channels], &styled[after * channels..][..channels]);
            output.extend(a.iter().zip(b).map(|(a, b)| a + weight * (b - a)));
            if rig.frames().travels() {
                output[start] *= duration;
                output[start + 2] *= duration;
            }
        }
        Self {
            channels,
            input: rig.scaled(&source.coordinates),
            covered: on.covered.clone(),
            output,
            log_duration: on.duration.iter().map(|d| d.log2()).collect(),
            group,
        }
    }

    /// The sequence in a mirror: left and right exchanged.
    pub fn mirrored(&self, mirror: &Mirror) -> Self {
        Self {
            input: mirror.rows(&self.input),
            output: mirror.rows(&self.output),
            covered: self.covered.clone(),
            log_duration: self.log_duration.clone(),
            channels: self.channels,
            group: self.group,
        }
    }

    /// Rows of the covered source frames.
    pub fn covered_input(&self) -> &[f64] {
        &self.input[self.covered.start * self.channels..self.covered.end * self.channels]
    }
}

/// Positions `[frames x 3 joints]` in a mirror.
pub fn mirror_positions(positions: &[f64], partners: &[usize]) -> Vec<f64> {
    positions
        .chunks_exact(3 * partners.len())
        .flat_map(|row| {
            partners.iter().flat_map(|partner| [-row[3 * partner], row[3 * partner + 1], row[3 * partner + 2]])
        })
        .collect()
}
