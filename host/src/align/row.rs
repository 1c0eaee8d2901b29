//! A row of the search: accumulated costs of one source frame against a range of target frames.

use super::dtw::Problem;
use super::steps::MAX_STEP;
use super::tiles::TILE;

/// No path reaches the cell.
pub(super) const INFINITY: f32 = f32::INFINITY;
/// Infinite columns before column 0: a step may look as far back.
pub(super) const PAD: usize = MAX_STEP + 1;

/// A row of accumulated costs, relative to `base` so that f32 resolves differences near the best path at any length.
#[derive(Debug, Clone)]
pub(super) struct Row {
    /// Column j is at `j + PAD`; infinite outside `low..high`.
    pub values: Vec<f32>,
    pub low: usize,
    pub high: usize,
    pub base: f64,
}

impl Row {
    /// A row of `frames` columns that no path reaches.
    pub fn empty(frames: usize) -> Self {
        Self { values: vec![INFINITY; frames + PAD], low: 0, high: 0, base: 0.0 }
    }

    /// The costs from column `j` on, less `back` columns.
    pub fn from(&self, j: usize, back: usize) -> &[f32] {
        self.values.get(j + PAD - back..).unwrap_or(&[])
    }

    /// Becomes a finished row; the cheapest cost goes into the base.
    pub fn take(&mut self, scratch: &Scratch, low: usize, base: f64) {
        let lowest = scratch.best.iter().copied().fold(INFINITY, f32::min);
        let shift = if lowest.is_finite() { lowest } else { 0.0 };
        self.values[self.low + PAD..self.high + PAD].fill(INFINITY);
        for (to, &v) in self.values[low + PAD..].iter_mut().zip(&scratch.best) {
            *to = v - shift;
        }
        (self.low, self.high, self.base) = (low, low + scratch.best.len(), base + f64::from(shift));
    }
}

/// One row in the making.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    /// Distances of whole tiles after a pad of infinite ones; column `low` is at `offset`.
    pub local: Vec<f32>,
    pub offset: usize,
    /// Sum of the last r distances, r growing.
    run: Vec<f32>,
    pub best: Vec<f32>,
    /// Back-pointers as wide as the costs: one compare mask serves both.
    pub code: Vec<u32>,
}

impl Scratch {
    pub fn distances(&mut self, p: &Problem<'_>, source: &[f32], low: usize, high: usize, pad: usize) {
        let first = low / TILE;
        let tiles = high.div_ceil(TILE).saturating_sub(first);
        self.local.clear();
        self.local.resize(pad, INFINITY);
        self.local.resize(pad + tiles * TILE, 0.0);
        p.target.distances(source, first, &mut self.local[pad..]);
        self.offset = pad + low - first * TILE;
    }

    pub fn begin(&mut self, width: usize) {
        self.best.clear();
        self.best.resize(width, INFINITY);
        self.code.clear();
        self.code.resize(width, 0);
        self.run.clear();
        self.run.resize(width, 0.0);
    }

    /// Takes `from + add` where it is cheaper.
    pub fn step(&mut self, from: &[f32], add: f32, code: u8) {
        for ((best, back), &from) in self.best.iter_mut().zip(&mut self.code).zip(from) {
            keep_cheaper(best, back, from + add, code);
        }
    }

    /// Takes `from + run + add` where it is cheaper.
    pub fn step_with_run(&mut self, from: &[f32], add: f32, code: u8) {
        for (((best, back), &from), &run) in self.best.iter_mut().zip(&mut self.code).zip(from).zip(&self.run) {
            keep_cheaper(best, back, from + run + add, code);
        }
    }

    pub fn add_distances(&mut self, width: usize) {
        for (best, &d) in self.best.iter_mut().zip(&self.local[self.offset..self.offset + width]) {
            *best += d;
        }
    }

    /// Adds the distance `r - 1` columns back to the run.
    pub fn extend_run(&mut self, r: usize, width: usize) {
        let from = self.offset + 1 - r;
        for (run, &d) in self.run.iter_mut().zip(&self.local[from..from + width]) {
            *run += d;
        }
    }
}

/// Written without a branch, so that it becomes a compare and two blends.
fn keep_cheaper(best: &mut f32, back: &mut u32, cost: f32, code: u8) {
    let better = cost < *best;
    *back = if better { u32::from(code) } else { *back };
    *best = if better { cost } else { *best };
}
