//! Dynamic time warping inside a corridor.

use std::ops::Range;

use super::corridor::Corridor;
use super::row::{PAD, Row, Scratch};
use super::steps::Steps;
use super::tiles::Tiles;

/// Frames that may stay unmatched at each end, and what one costs.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Slack {
    pub source: usize,
    pub target: usize,
    /// Price of an unmatched target frame; a source frame costs `target / source` times as much.
    pub price: f64,
}

/// Back-pointers: `1..=63` step (k, 1); `REPEAT + r` step (1, r); `START + r` the path starts here with a run of r.
const REPEAT: u8 = 64;
const START: u8 = 128;
/// Cells up to which all back-pointers are kept: 24 MB.
const KEEP: usize = 24 << 20;

/// Cost, source frame and target frame of the end of a path.
type End = (f64, usize, usize);

/// Storage of the search, kept between calls.
///
/// Memory: a byte for each cell while the corridor has at most [`KEEP`] of them. Beyond that only a block of rows has its
/// back-pointers, and the rows before each block are kept to compute it a second time on the way back:
/// O(target x sqrt(source)).
#[derive(Debug, Default)]
pub(super) struct Dtw {
    back: Vec<u8>,
    /// First back-pointer of each row of the block.
    starts: Vec<usize>,
    scratch: Scratch,
    /// Cells visited since the storage was made.
    pub cells: u64,
}

/// The problem: transformed source rows, the target, steps and ends.
#[derive(Debug, Clone, Copy)]
pub(super) struct Problem<'a> {
    /// `frames x channels`, row-major.
    pub source: &'a [f32],
    pub channels: usize,
    pub target: &'a Tiles,
    pub steps: &'a Steps,
    pub slack: Slack,
}

impl Problem<'_> {
    pub fn source_frames(&self) -> usize {
        self.source.len() / self.channels
    }

    /// Squared distances plus step penalties along a path.
    pub fn path_cost(&self, path: &[(usize, usize)]) -> f64 {
        let distances: f64 = path.iter().map(|&(i, j)| self.target.distance(self.source_row(i), j)).sum();
        distances + self.steps.penalty(path)
    }

    fn source_row(&self, i: usize) -> &[f32] {
        self.source.get(i * self.channels..(i + 1) * self.channels).unwrap_or(&[])
    }

    /// Price of an unmatched source frame.
    fn source_price(&self) -> f64 {
        self.slack.price * self.target.frames() as f64 / self.source_frames() as f64
    }
}

impl Dtw {
    /// The cheapest path in the corridor, `None` where none goes through. O(cells x (channels + steps)).
    pub fn search(&mut self, p: &Problem<'_>, corridor: &Corridor) -> Option<Vec<(usize, usize)>> {
        self.search_in_blocks(p, corridor, block_rows(p, corridor))
    }

    fn search_in_blocks(&mut self, p: &Problem<'_>, corridor: &Corridor, stride: usize) -> Option<Vec<(usize, usize)>> {
        let (n, m) = (p.source_frames(), p.target.frames());
        let mut ring = vec![Row::empty(m); p.steps.delete.len()];
        // The ring before each block.
        let mut kept = Vec::new();
        let mut end: Option<End> = None;
        for first in (0..n).step_by(stride) {
            if stride < n {
                kept.push(ring.clone());
            }
            let found = self.rows(p, corridor, &mut ring, first..(first + stride).min(n));
            end = [end, found].into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0));
        }
        let (_, mut i, mut j) = end?;
        let mut block = (n - 1) / stride;
        let mut path = Vec::new();
        loop {
            while i < block * stride {
                block -= 1;
                if i >= block * stride {
                    let ring = kept.get_mut(block)?;
                    self.rows(p, corridor, ring, block * stride..(block + 1) * stride);
                }
            }
            let (low, _) = *corridor.rows.get(i)?;
            let code = *self.back.get(self.starts.get(i - block * stride)? + j.checked_sub(low)?)?;
            let (advance, run) = match code {
                0 => return None,
                c if c > START => (0, usize::from(c - START)),
                c if c > REPEAT => (1, usize::from(c - REPEAT)),
                c => (usize::from(c), 1),
            };
            path.extend((0..run).map(|r| (i, j - r)));
            if advance == 0 {
                path.reverse();
                return Some(path);
            }
            i = i.checked_sub(advance)?;
            j = j.checked_sub(run)?;
        }
    }

    /// Computes a block of rows and its back-pointers; the cheapest end among them.
    fn rows(&mut self, p: &Problem<'_>, corridor: &Corridor, ring: &mut [Row], block: Range<usize>) -> Option<End> {
        let mut scratch = std::mem::take(&mut self.scratch);
        let (deletes, repeats) = (p.steps.delete.len(), p.steps.repeat.len());
        let mut best_end: Option<End> = None;
        self.back.clear();
        self.starts.clear();
        for i in block {
            let (low, high) = corridor.rows[i];
            let width = high - low;
            self.starts.push(self.back.len());
            self.cells += width as u64;
            let base = if i == 0 { 0.0 } else { ring[(i - 1) % deletes].base };
            scratch.distances(p, p.source_row(i), low, high, repeats);
            scratch.begin(width);

            for (k, &penalty) in (1..=deletes.min(i)).zip(&p.steps.delete) {
                let row = &ring[(i - k) % deletes];
                scratch.step(row.from(low, 1), (row.base - base + penalty) as f32, k as u8);
            }
            scratch.add_distances(width);
            if i > 0 {
                let row = &ring[(i - 1) % deletes];
                for (r, &penalty) in (1..=repeats).zip(&p.steps.repeat) {
                    scratch.extend_run(r, width);
                    if r > 1 {
                        scratch.step_with_run(row.from(low, r), penalty as f32, REPEAT + r as u8);
                    }
                }
            }
            self.start_here(p, i, (low, high), base, &mut scratch);
            let row = &mut ring[i % deletes];
            row.take(&scratch, low, base);
            self.back.extend(scratch.code.iter().map(|&c| c as u8));
            best_end = [best_end, end_in(p, i, row)].into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0));
        }
        self.scratch = scratch;
        best_end
    }

    /// Lets a path begin in row `i`: in the corner, or with open ends in the first row or column.
    fn start_here(&self, p: &Problem<'_>, i: usize, (low, high): (usize, usize), base: f64, scratch: &mut Scratch) {
        if i > p.slack.source {
            return;
        }
        let last = if i == 0 { p.slack.target } else { 0 };
        for start in 0..=last {
            let mut cost = i as f64 * p.source_price() + start as f64 * p.slack.price - base;
            for (r, &penalty) in (1..=p.steps.repeat.len()).zip(&p.steps.repeat) {
                let j = start + r - 1;
                if j >= high || start < low {
                    break;
                }
                cost += f64::from(scratch.local[scratch.offset + j - low]);
                let total = (cost + penalty) as f32;
                if total < scratch.best[j - low] {
                    scratch.best[j - low] = total;
                    scratch.code[j - low] = u32::from(START) + r as u32;
                }
            }
        }
    }
}

/// The cheapest end of a path in a row: the corner, or with open ends the last row or column.
fn end_in(p: &Problem<'_>, i: usize, row: &Row) -> Option<End> {
    let (n, m) = (p.source_frames(), p.target.frames());
    let left = n - 1 - i;
    if left > p.slack.source || row.high < m {
        return None;
    }
    let first = if left == 0 { (m - 1).saturating_sub(p.slack.target) } else { m - 1 };
    (first.max(row.low)..m)
        .map(|j| {
            let skipped = left as f64 * p.source_price() + (m - 1 - j) as f64 * p.slack.price;
            (f64::from(row.values[j + PAD]) + row.base + skipped, i, j)
        })
        .filter(|end| end.0.is_finite())
        .min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Rows whose back-pointers are kept together: all, or so many that they take as much memory as the rows kept between.
fn block_rows(p: &Problem<'_>, corridor: &Corridor) -> usize {
    let n = p.source_frames();
    if corridor.cells() <= KEEP {
        return n;
    }
    let row_bytes = size_of::<f32>() * p.steps.delete.len();
    ((n * row_bytes) as f64).sqrt().ceil() as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_give_the_path_of_the_whole() {
        let (n, m, channels) = (150, 170, 2);
        let walk = |seed: u32, frames: usize| -> Vec<f32> {
            let (mut state, mut value) = (seed, 0.0);
            let mut next = || {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                value += (state >> 8) as f32 / (1 << 24) as f32 - 0.5;
                value
            };
            (0..frames * channels).map(|_| next()).collect()
        };
        let (source, target) = (walk(1, n), walk(2, m));
        let tiles = Tiles::new(target.chunks_exact(channels), channels);
        let steps = Steps::new(n, m, 3.0, 0.01).expect("similar lengths");
        for slack in [Slack::default(), Slack { source: 20, target: 30, price: 0.1 }] {
            let p = Problem { source: &source, channels, target: &tiles, steps: &steps, slack };
            let corridor = Corridor::reachable(n, m, &steps, slack);
            let whole = Dtw::default().search_in_blocks(&p, &corridor, n).expect("a path");
            for stride in [1, 2, 7, 50, 149] {
                let found = Dtw::default().search_in_blocks(&p, &corridor, stride);
                assert_eq!(found.as_ref(), Some(&whole), "blocks of {stride}");
            }
        }
    }
}
