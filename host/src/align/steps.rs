//! The step pattern of the time warp: every target frame is matched once, source frames repeat or are left out.

use super::error::AlignError;

/// Largest number of frames one step can leave out or repeat: back-pointers are bytes with two flag bits.
pub(super) const MAX_STEP: usize = 63;

/// Steps `(k, 1)`, k = 1..=deletes: the next target frame takes the source frame k further on.
/// Steps `(1, r)`, r = 2..=repeats: the next source frame is used for r target frames.
///
/// Every step moves on in both clips, so a row of the search depends on earlier rows only and vectorises, and the slope is
/// bounded without a further state. The number of residuals is always the number of target frames: `|W (U a + b) - v|^2`
/// with one 1 in each row of W (Hsu 2005), so that leaving frames out cannot make a path cheaper by being shorter.
#[derive(Debug, Clone)]
pub(super) struct Steps {
    /// `delete[k - 1]`: penalty of step (k, 1).
    pub delete: Vec<f64>,
    /// `repeat[r - 1]`: penalty of step (1, r).
    pub repeat: Vec<f64>,
    /// Factor of the penalties.
    pub weight: f64,
}

impl Steps {
    pub fn new(source: usize, target: usize, stretch: f64, weight: f64) -> Result<Self, AlignError> {
        let ratio = source as f64 / target.max(1) as f64;
        let count = |average: f64| (stretch * average).ceil().max(2.0);
        // A closed path over few frames must still be able to end in the corner.
        let corner = |a: usize, b: usize| (a.saturating_sub(1)).div_ceil(b.saturating_sub(1).max(1)) as f64;
        let deletes = count(ratio).max(corner(source, target));
        let repeats = count(1.0 / ratio).max(target.div_ceil(source.max(1)) as f64);
        if deletes > MAX_STEP as f64 || repeats > MAX_STEP as f64 {
            return Err(AlignError::Lengths {
                source_frames: source,
                target_frames: target,
                max: (MAX_STEP as f64 / stretch) as usize,
            });
        }
        let cost = |advance: f64| weight * (advance / ratio).ln().powi(2);
        Ok(Self {
            delete: (1..=deletes as usize).map(|k| cost(k as f64)).collect(),
            repeat: (1..=repeats as usize).map(|r| cost(1.0 / r as f64)).collect(),
            weight,
        })
    }

    /// Sum of the penalties along a path.
    pub fn penalty(&self, path: &[(usize, usize)]) -> f64 {
        let mut sum = 0.0;
        let mut previous = None;
        for run in path.chunk_by(|p, q| p.0 == q.0) {
            let Some(&(i, _)) = run.first() else { continue };
            let advance = previous.map_or(1, |p| i - p);
            let list = if advance > 1 { self.delete.get(advance - 1) } else { self.repeat.get(run.len() - 1) };
            sum += list.copied().unwrap_or(0.0);
            previous = Some(i);
        }
        sum
    }
}
