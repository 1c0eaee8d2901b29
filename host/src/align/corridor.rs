//! The cells of the search: for each source frame a range of target frames.

use super::dtw::Slack;
use super::steps::Steps;

/// How near to the edge of a corridor a path counts as touching it.
const EDGE: usize = 2;

/// Ranges `[low, high)` of target frames, one for each source frame.
#[derive(Debug, Clone)]
pub(super) struct Corridor {
    pub rows: Vec<(usize, usize)>,
}

impl Corridor {
    /// All cells that a path can pass: with bounded slope a parallelogram between the two corners.
    pub fn reachable(source: usize, target: usize, steps: &Steps, slack: Slack) -> Self {
        let (deletes, repeats) = (steps.delete.len(), steps.repeat.len());
        let rows = (0..source)
            .map(|i| {
                let left = source - 1 - i;
                let from_start = i.saturating_sub(slack.source).div_ceil(deletes);
                // One run more than a path needs: the cells of a run lie left of its last.
                let from_end = (target - 1).saturating_sub(slack.target + repeats * (left + 1));
                let last_start = slack.target + repeats * (i + 1);
                let last_end = target.saturating_sub(left.saturating_sub(slack.source).div_ceil(deletes));
                let low = from_start.max(from_end);
                let high = last_start.min(last_end).min(target);
                // Rows that no path reaches are empty.
                (low.min(high), high)
            })
            .collect();
        Self { rows }
    }

    /// The part of `self` within `radius` target frames of a path whose frames are `scale` times as long.
    ///
    /// Source frames that the path leaves out are interpolated; beyond its ends it goes on at slope `target / source`.
    pub fn around(&self, path: &[(usize, usize)], scale: usize, radius: usize, slope: f64) -> Self {
        let mut centre = vec![(usize::MAX, 0usize); self.rows.len()];
        let mut previous: Option<(usize, usize)> = None;
        for &(i, j) in path {
            let (from, to) = (j * scale, (j + 1) * scale);
            // Rows since the last match hang between it and this one.
            let gap_start = previous.map_or(i, |(p, _)| p + 1).min(i) * scale;
            let gap_low = previous.map_or(from, |(_, q)| q * scale);
            for (n, row) in centre.iter_mut().enumerate().take((i + 1) * scale).skip(gap_start) {
                let low = if n < i * scale { gap_low } else { from };
                *row = (row.0.min(low), row.1.max(to));
            }
            previous = Some((i, j));
        }
        let first = path.first().map_or((0, 0), |p| (p.0 * scale, p.1 * scale));
        let last = path.last().map_or((0, 0), |p| ((p.0 + 1) * scale, (p.1 + 1) * scale));
        let rows = (self.rows.iter().zip(&centre).enumerate())
            .map(|(i, (&(hard_low, hard_high), &(from, to)))| {
                let beyond = if i < first.0 {
                    first.1 as f64 - (first.0 - i) as f64 * slope
                } else {
                    last.1 as f64 + (i + 1).saturating_sub(last.0) as f64 * slope
                };
                let (from, to) = if from <= to { (from as f64, to as f64) } else { (beyond, beyond + 1.0) };
                let low = ((from - radius as f64).max(0.0) as usize).clamp(hard_low, hard_high);
                let high = ((to + radius as f64).max(0.0) as usize).clamp(low, hard_high);
                (low, high)
            })
            .collect();
        Self { rows }
    }

    /// Whether the path comes near an edge beyond which there would be more cells in `reachable`.
    pub fn touched_by(&self, path: &[(usize, usize)], reachable: &Self) -> bool {
        path.iter().any(|&(i, j)| {
            let (Some(&(low, high)), Some(&(hard_low, hard_high))) = (self.rows.get(i), reachable.rows.get(i)) else {
                return false;
            };
            (low > hard_low && j < low + EDGE) || (high < hard_high && j + EDGE >= high)
        })
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.rows.iter().map(|&(low, high)| high - low).sum()
    }
}
