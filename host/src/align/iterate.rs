//! Time warp and space warp by turns.

use super::dtw::{Problem, Slack};
use super::error::AlignError;
use super::search::Searcher;
use super::series::{Series, check_pair};
use super::settings::Settings;
use super::space::{Parts, SpaceWarp, runs};
use super::standard::Standard;
use super::steps::Steps;
use super::tiles::Tiles;
use super::warp::Warp;

/// The parts of the cost, in variances of a channel summed over channels and frames.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energy {
    /// `|W (U a + b) - v|^2`
    pub data: f64,
    /// `|F a|^2 + ridge |a - 1|^2`
    pub scale: f64,
    /// `|G b|^2 + ridge |b|^2`
    pub offset: f64,
    /// Penalty of the steps that are faster or slower than the average.
    pub timing: f64,
    /// Price of the unmatched frames; zero with closed ends.
    pub unmatched: f64,
}

impl Energy {
    /// What never rises.
    pub fn total(&self) -> f64 {
        self.data + self.scale + self.offset + self.timing + self.unmatched
    }
}

/// Which half of an iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Half {
    /// W was improved, a and b kept.
    Time,
    /// a and b were improved, W kept.
    Space,
}

/// The state after half an iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// From 1.
    pub iteration: usize,
    /// What was done.
    pub half: Half,
    /// The cost after it.
    pub energy: Energy,
}

/// Aligns `target` (`[m x d]`, the styled clip v) to `source` (`[n x d]`, the neutral clip u): iterative motion warping.
///
/// Minimises `|W (U a + b) - v|^2 + |F a|^2 + |G b|^2` by turns over the time warp W and over scale a and offset b, which
/// are smooth in time (E. Hsu, K. Pulli, J. Popovic, Style Translation for Human Motion, 2005; used so by
/// Dong, Aloba, Anthony and Jain, 2018). The units of the channels do not matter unless [`Settings::standardise`] is off.
///
/// Cost of an iteration: O(n x radius x d) for the time warp where a corridor is enough, at worst O(n m d); O((n + m) d)
/// for the space warp. Memory O((n + m) d + n x radius); where the whole table is searched, O(m sqrt(n)) more.
///
/// # Errors
/// Any [`AlignError`] but `Frames`: fewer than two frames, values that are not finite, different channels, lengths
/// further apart than the step pattern reaches, or a setting out of range.
pub fn align(source: Series<'_>, target: Series<'_>, settings: &Settings) -> Result<Warp, AlignError> {
    align_with(source, target, settings, |_| {})
}

/// [`align`], telling `observer` the cost after each half iteration.
///
/// # Errors
/// As [`align`].
pub fn align_with(
    source: Series<'_>,
    target: Series<'_>,
    settings: &Settings,
    mut observer: impl FnMut(&Progress),
) -> Result<Warp, AlignError> {
    settings.check()?;
    check_pair(source, target, 2)?;
    let (n, m, channels) = (source.frames(), target.frames(), source.channels());
    let steps = Steps::new(n, m, settings.max_stretch, settings.timing * channels as f64)?;
    let mut slack = Slack { source: settings.ends.slack(n), target: settings.ends.slack(m), price: 0.0 };
    let u = Standard::new(source, settings.standardise);
    let v = Standard::new(target, settings.standardise);
    let target_rows = v.rows(|_, _, v| v);
    let tiles = Tiles::new(target_rows.chunks_exact(channels), channels);

    let mut space = SpaceWarp::new(&u, settings);
    let mut searcher = Searcher::new(settings);
    let energy = |parts: &Parts, path: &[(usize, usize)], slack: Slack| -> Energy {
        let sum = |k: usize| parts.iter().map(|block| block[k].iter().sum::<f64>()).sum();
        let timing = steps.penalty(path);
        Energy { data: sum(0), scale: sum(1), offset: sum(2), timing, unmatched: unmatched(path, n, m, slack) }
    };
    let mut history: Vec<Progress> = Vec::new();
    let (mut path, mut groups, mut parts) = (Vec::new(), Vec::new(), Vec::new());
    let mut before = f64::INFINITY;
    let mut converged = false;
    for iteration in 1..=settings.max_iterations {
        let warped = u.rows(|block, t, u| {
            let [a, b] = space.at(block, t);
            std::array::from_fn(|l| a[l] * u[l] + b[l])
        });
        let problem = Problem { source: &warped, channels, target: &tiles, steps: &steps, slack };
        let mut changed = true;
        if iteration == 1 {
            (path, slack.price) = searcher.first(&problem, &target_rows)?;
            groups = runs(&path, n);
            parts = space.energy(&u, &v, &groups);
        } else {
            let found = searcher.next(&problem, &path)?;
            changed = found != path;
            if changed {
                let new_groups = runs(&found, n);
                let new_parts = space.energy(&u, &v, &new_groups);
                // The search adds in f32; where the new path is better by rounding only, the old one stays.
                changed = energy(&new_parts, &found, slack).total() < before;
                if changed {
                    (path, groups, parts) = (found, new_groups, new_parts);
                }
            }
        }
        let mut record = |half, energy: Energy| {
            let progress = Progress { iteration, half, energy };
            observer(&progress);
            history.push(progress);
            energy.total()
        };
        record(Half::Time, energy(&parts, &path, slack));
        // With the path a and b stay too: they are already the best for it, and so would every further iteration leave them.
        if changed {
            space.update(&u, &v, &groups, &mut parts)?;
        }
        let after = record(Half::Space, energy(&parts, &path, slack));
        let slow = before.is_finite() && settings.tolerance > 0.0 && before - after <= settings.tolerance * before;
        if !changed || slow {
            converged = true;
            break;
        }
        before = after;
    }
    Ok(Warp::new(path, &u, &v, &space, settings, history, converged, searcher.work()))
}

/// Price of the frames beyond the ends of the path.
pub(super) fn unmatched(path: &[(usize, usize)], n: usize, m: usize, slack: Slack) -> f64 {
    let (Some(first), Some(last)) = (path.first(), path.last()) else {
        return 0.0;
    };
    let source = (first.0 + n - 1 - last.0) as f64 * m as f64 / n as f64;
    let target = (first.1 + m - 1 - last.1) as f64;
    slack.price * (source + target)
}
