//! Which styled moment belongs to which source frame: the four ways in which two clips can correspond.

use crate::align::{self, AlignError, Ends, Series, Settings, Warp, aligned_path};
use crate::clip::Canonical;
use crate::rig::{Locals, Rig};

use super::cyclic::walks;
use super::dataset::{Correspondence, mirror_positions};

/// How the frames of two clips are brought together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alignment {
    /// Iterative motion warping of the positions, first frame to first and last to last (Hsu 2005).
    Warp,
    /// Evenly: both clips run from beginning to end at the same relative speed.
    Uniform,
    /// By the phase of the limbs, in step: clips that start on different feet overlap only in part.
    InStep,
    /// By the phase of the limbs in a mirror, first to first and last to last: where the styled clip starts on the other
    /// foot, its right answers to the source's left.
    Opposite,
    /// Each pair by itself: in step where both clips are walks, else by warping.
    Each,
}

impl Alignment {
    /// Every way that the motions of a rig can correspond. A machine that stands has no steps to be in.
    pub fn of(rig: &Rig) -> Vec<Self> {
        let mut ways = vec![Self::Warp, Self::Uniform];
        ways.extend(rig.frames().travels().then_some([Self::InStep, Self::Opposite]).into_iter().flatten());
        ways
    }

    /// The way of one pair.
    fn of_pair(self, source: &Locals, target: &Locals, rig: &Rig) -> Self {
        match self {
            Self::Each if walks(rig, source) && walks(rig, target) => Self::InStep,
            Self::Each => Self::Warp,
            way => way,
        }
    }

    /// Ends of clips that are brought together in this way: what is in step must not be judged by its ends.
    pub fn ends(self) -> Ends {
        if matches!(self, Self::InStep | Self::Each) { OPEN } else { Ends::Closed }
    }
}

/// Frames over which the slope of the clock is averaged, s.
const SLOPE_WINDOW: f64 = 0.2;
/// Durations beyond these bounds are artefacts of standing still.
const DURATION: [f64; 2] = [1.0 / 3.0, 3.0];
/// Part of a clip that may stay unmatched at either end.
pub const OPEN: Ends = Ends::Open { max_fraction: 0.35 };

/// The correspondence of two clips on one rig.
pub fn correspond(
    alignment: Alignment,
    source: &Locals,
    target: &Locals,
    rig: &Rig,
    partners: &[usize],
    fps: f64,
) -> Result<Correspondence, AlignError> {
    let channels = source.channels();
    let limbs = |positions: &[f64]| limb_phase(positions, channels, rig, fps);
    let phase = |target: &[f64], ends| -> Result<Correspondence, AlignError> {
        let (u, v) = (limbs(&source.positions), limbs(target));
        let width = u.len() / source.frames().max(1);
        let settings = Settings { ends, standardise: false, ..Settings::default() };
        Ok(on_source(&align::align(Series::new(&u, width)?, Series::new(&v, width)?, &settings)?, fps))
    };
    match alignment.of_pair(source, target, rig) {
        Alignment::Warp | Alignment::Each => {
            let (u, v) = (Series::new(&source.positions, channels)?, Series::new(&target.positions, channels)?);
            Ok(on_source(&align::align(u, v, &Settings::default())?, fps))
        }
        Alignment::Uniform => Ok(uniform(source.frames(), target.frames())),
        Alignment::InStep => phase(&target.positions, OPEN),
        Alignment::Opposite => phase(&mirror_positions(&target.positions, partners), OPEN),
    }
}

/// The correspondence of the positions that a model makes of the source with the target: how a fit is refined.
pub fn correspond_output(
    alignment: Alignment,
    styled: &[f64],
    (source, target): (&Locals, &Locals),
    rig: &Rig,
    fps: f64,
) -> Result<Correspondence, AlignError> {
    let ends = alignment.of_pair(source, target, rig).ends();
    let settings = Settings { ends, standardise: false, max_iterations: 1, ..Settings::default() };
    let channels = target.channels();
    let warp = align::align(Series::new(styled, channels)?, Series::new(&target.positions, channels)?, &settings)?;
    Ok(on_source(&warp, fps))
}

/// The correspondence by plain dynamic time warping of positions, first to first and last to last; the timing is even.
pub fn correspond_plainly(source: &Locals, target: &Locals) -> Result<Correspondence, AlignError> {
    let channels = target.channels();
    let path = aligned_path(Series::new(&source.positions, channels)?, Series::new(&target.positions, channels)?)?;
    let mut sums = vec![(0.0, 0.0); source.frames()];
    for (i, j) in path {
        sums[i] = (sums[i].0 + j as f64, sums[i].1 + 1.0);
    }
    let target_frames = sums.iter().map(|(sum, count)| sum / f64::max(*count, 1.0)).collect();
    Ok(Correspondence { target: target_frames, ..uniform(source.frames(), target.frames()) })
}

fn on_source(warp: &Warp, fps: f64) -> Correspondence {
    let covered = warp.covered();
    let slope = warp.slope((SLOPE_WINDOW * fps).round() as usize);
    Correspondence {
        target: warp.target_on_source()[covered.clone()].to_vec(),
        duration: slope[covered.clone()].iter().map(|s| s.clamp(DURATION[0], DURATION[1])).collect(),
        covered,
    }
}

fn uniform(source: usize, target: usize) -> Correspondence {
    let rate = target.saturating_sub(1) as f64 / source.saturating_sub(1).max(1) as f64;
    Correspondence {
        covered: 0..source,
        target: (0..source).map(|frame| frame as f64 * rate).collect(),
        duration: vec![rate.clamp(DURATION[0], DURATION[1]); source],
    }
}

/// Positions and velocities of the limbs, each channel centred, all on one scale: what tells the phase of a movement.
fn limb_phase(positions: &[f64], channels: usize, rig: &Rig, fps: f64) -> Vec<f64> {
    use Canonical::*;
    const LIMBS: [Canonical; 12] =
        [LHip, LKnee, LAnkle, LToe, RHip, RKnee, RAnkle, RToe, LElbow, LWrist, RElbow, RWrist];
    let joints: Vec<usize> = LIMBS.into_iter().filter_map(|limb| rig.map.joint(limb)).collect();
    let frames = positions.len() / channels.max(1);
    // Every joint of a machine is a limb.
    let columns: Vec<usize> = match joints.is_empty() {
        true => (0..channels).collect(),
        false => joints.iter().flat_map(|j| 3 * j..3 * j + 3).collect(),
    };
    let mean: Vec<f64> = columns
        .iter()
        .map(|c| (0..frames).map(|t| positions[t * channels + c]).sum::<f64>() / frames.max(1) as f64)
        .collect();
    let at = |t: usize, i: usize| positions[t * channels + columns[i]] - mean[i];
    let square: f64 =
        (0..frames).flat_map(|t| (0..columns.len()).map(move |i| (t, i))).map(|(t, i)| at(t, i).powi(2)).sum();
    let scale = (square / (frames * columns.len()).max(1) as f64).sqrt().max(1e-6);
    // Velocity in units that make a movement of 0.75 Hz, a usual stride, as large as its position.
    let rate = fps / (std::f64::consts::TAU * 0.75);
    let mut features = Vec::with_capacity(2 * frames * columns.len());
    for t in 0..frames {
        features.extend((0..columns.len()).map(|i| at(t, i) / scale));
        let (before, after) = (t.saturating_sub(1), (t + 1).min(frames - 1));
        let span = (after - before).max(1) as f64;
        features.extend((0..columns.len()).map(|i| (at(after, i) - at(before, i)) / span * rate / scale));
    }
    features
}
