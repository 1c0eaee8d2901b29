//! Aligned RMS joint distance: the measure of quality.

use super::error::AlignError;
use super::series::{Series, check_pair};
use super::settings::Ends;
use super::tiles::{TILE, Tiles};

/// Rounds of Dinkelbach's method with open ends.
const ROUNDS: usize = 8;

/// How far apart two motions are when their timing is taken out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AlignedDistance {
    /// `sqrt(sum over path and joints |p - q|^2 / (path length x joints))`, in the unit of the positions.
    pub rms: f64,
    /// Entries of the path.
    pub path_len: usize,
    /// Joints in a frame.
    pub joints: usize,
    /// Frames of both clips left out at the ends; 0 with closed ends.
    pub unmatched: usize,
}

/// The best path to a cell.
#[derive(Debug, Clone, Copy)]
struct Cell {
    cost: f64,
    length: u32,
    /// Frames left out before the path.
    skipped: u32,
}

const NOWHERE: Cell = Cell { cost: f64::INFINITY, length: 0, skipped: 0 };

/// Aligned RMS joint distance of two clips of joint positions, `[frames x 3 joints]` each, in the unit of the positions.
///
/// The path of steps (1, 0), (0, 1), (1, 1) from first to last frames, unconstrained otherwise, with the smallest sum of squared
/// distances; then the root of its mean over path entries and joints. Symmetric in its arguments. O(n m x joints) time and
/// O((n + m) x joints) memory.
///
/// # Errors
/// No frames, values that are not finite, different channels or channels that are no multiple of 3.
pub fn aligned_rms(p: Series<'_>, q: Series<'_>) -> Result<f64, AlignError> {
    aligned_distance(p, q, Ends::Closed).map(|d| d.rms)
}

/// [`aligned_rms`] with a choice of ends and with its path length.
///
/// With open ends the path minimises squared distance over covered frames of both clips, and the RMS is that of the path.
///
/// # Errors
/// As [`aligned_rms`], and a fraction out of its range.
pub fn aligned_distance(p: Series<'_>, q: Series<'_>, ends: Ends) -> Result<AlignedDistance, AlignError> {
    ends.check()?;
    check_pair(p, q, 1)?;
    if !p.channels().is_multiple_of(3) {
        return Err(AlignError::NotPositions { channels: p.channels() });
    }
    let clips = Clips::new(p, q);
    let frames = (p.frames() + q.frames()) as f64;
    let mut found = clips.search([0, 0], 0.0);
    let slack = [ends.slack(p.frames()), ends.slack(q.frames())];
    if slack != [0, 0] {
        let mut price = found.cost / frames;
        for _ in 0..ROUNDS {
            found = clips.search(slack, price);
            let next = found.distance(price) / (frames - f64::from(found.skipped));
            if next >= price * (1.0 - 1e-6) {
                break;
            }
            price = next;
        }
        found.cost = found.distance(price);
    }
    let joints = p.channels() / 3;
    let entries = f64::from(found.length.max(1));
    Ok(AlignedDistance {
        rms: (found.cost.max(0.0) / (entries * joints as f64)).sqrt(),
        path_len: found.length as usize,
        joints,
        unmatched: found.skipped as usize,
    })
}

impl Cell {
    /// The cost without the price of what was left out.
    fn distance(&self, price: f64) -> f64 {
        self.cost - price * f64::from(self.skipped)
    }

    fn better(self, other: Self) -> Self {
        if other.cost < self.cost { other } else { self }
    }
}

/// The matches `(frame of p, frame of q)` of the path of [`aligned_rms`], from first to last frames.
///
/// O(n m x joints) time and a byte for each of the `n m` pairs of frames.
///
/// # Errors
/// As [`aligned_rms`].
pub fn aligned_path(p: Series<'_>, q: Series<'_>) -> Result<Vec<(usize, usize)>, AlignError> {
    check_pair(p, q, 1)?;
    let clips = Clips::new(p, q);
    let m = clips.tiles.frames();
    let mut local = vec![0.0f32; m.div_ceil(TILE) * TILE];
    let mut above = vec![f64::INFINITY; m];
    let mut steps: Vec<[bool; 2]> = Vec::with_capacity(p.frames() * m);
    for (i, source) in clips.rows.chunks_exact(clips.channels).enumerate() {
        clips.tiles.distances(source, 0, &mut local);
        let (mut left, mut diagonal) = (f64::INFINITY, f64::INFINITY);
        for (j, (cell, &d)) in above.iter_mut().zip(&local).enumerate() {
            let up = *cell;
            // Equal costs take the diagonal, the shorter path.
            let (from, step) = if diagonal <= up && diagonal <= left {
                (diagonal, [true, true])
            } else if up <= left {
                (up, [true, false])
            } else {
                (left, [false, true])
            };
            let from = if i + j == 0 { 0.0 } else { from };
            *cell = from + f64::from(d);
            (left, diagonal) = (*cell, up);
            steps.push(step);
        }
    }
    let (mut i, mut j) = (p.frames() - 1, m - 1);
    let mut path = vec![(i, j)];
    while (i, j) != (0, 0) {
        let [back_i, back_j] = steps[i * m + j];
        (i, j) = (i - usize::from(back_i), j - usize::from(back_j));
        path.push((i, j));
    }
    path.reverse();
    Ok(path)
}

struct Clips {
    rows: Vec<f32>,
    channels: usize,
    tiles: Tiles,
}

impl Clips {
    /// Both clips about their common mean, where f32 resolves a millionth of the motion's extent.
    fn new(p: Series<'_>, q: Series<'_>) -> Self {
        let channels = p.channels();
        let frames = (p.frames() + q.frames()) as f64;
        let mut mean = vec![0.0; channels];
        for row in p.rows().chain(q.rows()) {
            mean.iter_mut().zip(row).for_each(|(m, v)| *m += v / frames);
        }
        let centred = |s: Series<'_>| -> Vec<f32> {
            s.rows().flat_map(|row| row.iter().zip(&mean).map(|(v, m)| (v - m) as f32)).collect()
        };
        let (rows, other) = (centred(p), centred(q));
        let tiles = Tiles::new(other.chunks_exact(channels), channels);
        Self { rows, channels, tiles }
    }

    /// The cheapest path where up to `slack` frames may be left out at each end for `price` each. Equal costs take the
    /// diagonal, the shorter path.
    fn search(&self, slack: [usize; 2], price: f64) -> Cell {
        let (n, m) = (self.rows.len() / self.channels, self.tiles.frames());
        let mut local = vec![0.0f32; m.div_ceil(TILE) * TILE];
        let mut previous = vec![NOWHERE; m];
        let mut row = vec![NOWHERE; m];
        let mut best = NOWHERE;
        for (i, source) in self.rows.chunks_exact(self.channels).enumerate() {
            self.tiles.distances(source, 0, &mut local);
            let (mut left, mut diagonal) = (NOWHERE, NOWHERE);
            for (j, ((cell, &above), &d)) in row.iter_mut().zip(&previous).zip(&local).enumerate() {
                let mut from = diagonal.better(above).better(left);
                if (i == 0 && j <= slack[1]) || (j == 0 && i <= slack[0]) {
                    let skipped = (i + j) as u32;
                    from = from.better(Cell { cost: price * f64::from(skipped), length: 0, skipped });
                }
                *cell = Cell { cost: from.cost + f64::from(d), length: from.length + 1, ..from };
                (left, diagonal) = (*cell, above);
            }
            let rest = n - 1 - i;
            if rest <= slack[0] {
                let first = if rest == 0 { (m - 1).saturating_sub(slack[1]) } else { m - 1 };
                for (j, cell) in row.iter().enumerate().skip(first) {
                    let skipped = (rest + m - 1 - j) as u32;
                    let cost = cell.cost + price * f64::from(skipped);
                    best = best.better(Cell { cost, skipped: cell.skipped + skipped, ..*cell });
                }
            }
            std::mem::swap(&mut previous, &mut row);
        }
        best
    }
}
