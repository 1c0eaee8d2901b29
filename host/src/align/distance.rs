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

/// How a path came to a cell.
#[derive(Debug, Clone, Copy)]
enum Step {
    /// It begins here.
    Start,
    /// Both clips went on.
    Both,
    /// The first clip went on.
    First,
    /// The second clip went on.
    Second,
}

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
    check(p, q, ends)?;
    let clips = Clips::new(p, q);
    let (found, _) = clips.best(ends, [p.frames(), q.frames()]);
    Ok(found.distance(p.channels()))
}

/// The matches `(frame of p, frame of q)` of the path of [`aligned_rms`], from first to last frames.
///
/// O(n m x joints) time and a byte for each of the `n m` pairs of frames.
///
/// # Errors
/// As [`aligned_rms`].
pub fn aligned_path(p: Series<'_>, q: Series<'_>) -> Result<Vec<(usize, usize)>, AlignError> {
    aligned(p, q, Ends::Closed).map(|(_, path)| path)
}

/// [`aligned_distance`] and the matches of its path, `(frame of p, frame of q)`.
///
/// O(n m x joints) time and a byte for each of the `n m` pairs of frames.
///
/// # Errors
/// As [`aligned_distance`].
pub fn aligned(p: Series<'_>, q: Series<'_>, ends: Ends) -> Result<(AlignedDistance, Vec<(usize, usize)>), AlignError> {
    check(p, q, ends)?;
    let clips = Clips::new(p, q);
    let frames = [p.frames(), q.frames()];
    let (found, price) = clips.best(ends, frames);
    let mut steps = Vec::with_capacity(frames[0] * frames[1]);
    let slack = frames.map(|frames| ends.slack(frames));
    let end = clips.search(slack, price, |step| steps.push(step)).end;
    Ok((found.distance(p.channels()), path(&steps, end, frames[1])))
}

fn check(p: Series<'_>, q: Series<'_>, ends: Ends) -> Result<(), AlignError> {
    ends.check()?;
    check_pair(p, q, 1)?;
    match p.channels() {
        channels if channels.is_multiple_of(3) => Ok(()),
        channels => Err(AlignError::NotPositions { channels }),
    }
}

/// The path that ends in a cell of the table of steps, `[frames of p x frames of q]`.
fn path(steps: &[Step], (mut i, mut j): (usize, usize), width: usize) -> Vec<(usize, usize)> {
    let mut path = vec![(i, j)];
    loop {
        match steps[i * width + j] {
            Step::Start => break,
            Step::Both => (i, j) = (i - 1, j - 1),
            Step::First => i -= 1,
            Step::Second => j -= 1,
        }
        path.push((i, j));
    }
    path.reverse();
    path
}

/// The cheapest path, without the price of what it left out.
#[derive(Clone, Copy, Debug)]
struct Found {
    cost: f64,
    length: u32,
    skipped: u32,
    /// Its last cell.
    end: (usize, usize),
}

impl Found {
    fn distance(&self, channels: usize) -> AlignedDistance {
        let joints = channels / 3;
        let entries = f64::from(self.length.max(1));
        AlignedDistance {
            rms: (self.cost.max(0.0) / (entries * joints as f64)).sqrt(),
            path_len: self.length as usize,
            joints,
            unmatched: self.skipped as usize,
        }
    }
}

impl Cell {
    fn better(self, other: Self) -> Self {
        if other.cost < self.cost { other } else { self }
    }
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

    /// The cheapest path between these ends, and the price of a frame that it leaves out.
    fn best(&self, ends: Ends, frames: [usize; 2]) -> (Found, f64) {
        let slack = frames.map(|frames| ends.slack(frames));
        let mut found = self.search([0, 0], 0.0, |_| {});
        if slack == [0, 0] {
            return (found, 0.0);
        }
        let frames = (frames[0] + frames[1]) as f64;
        let mut price = found.cost / frames;
        let mut paid = price;
        for _ in 0..ROUNDS {
            paid = price;
            found = self.search(slack, paid, |_| {});
            let next = found.cost / (frames - f64::from(found.skipped));
            if next >= price * (1.0 - 1e-6) {
                break;
            }
            price = next;
        }
        (found, paid)
    }

    /// The cheapest path where up to `slack` frames may be left out at each end for `price` each. Equal costs take the
    /// diagonal, the shorter path. `keep` hears of the step into every cell, row by row.
    fn search(&self, slack: [usize; 2], price: f64, mut keep: impl FnMut(Step)) -> Found {
        let (n, m) = (self.rows.len() / self.channels, self.tiles.frames());
        let mut local = vec![0.0f32; m.div_ceil(TILE) * TILE];
        let mut previous = vec![NOWHERE; m];
        let mut row = vec![NOWHERE; m];
        let (mut best, mut end) = (NOWHERE, (0, 0));
        for (i, source) in self.rows.chunks_exact(self.channels).enumerate() {
            self.tiles.distances(source, 0, &mut local);
            let (mut left, mut diagonal) = (NOWHERE, NOWHERE);
            for (j, ((cell, &above), &d)) in row.iter_mut().zip(&previous).zip(&local).enumerate() {
                let mut from = diagonal.better(above).better(left);
                let mut step = if diagonal.cost <= from.cost {
                    Step::Both
                } else if above.cost <= from.cost {
                    Step::First
                } else {
                    Step::Second
                };
                if (i == 0 && j <= slack[1]) || (j == 0 && i <= slack[0]) {
                    let skipped = (i + j) as u32;
                    let start = Cell { cost: price * f64::from(skipped), length: 0, skipped };
                    if start.cost < from.cost {
                        (from, step) = (start, Step::Start);
                    }
                }
                keep(step);
                *cell = Cell { cost: from.cost + f64::from(d), length: from.length + 1, ..from };
                (left, diagonal) = (*cell, above);
            }
            let rest = n - 1 - i;
            if rest <= slack[0] {
                let first = if rest == 0 { (m - 1).saturating_sub(slack[1]) } else { m - 1 };
                for (j, cell) in row.iter().enumerate().skip(first) {
                    let skipped = (rest + m - 1 - j) as u32;
                    let cost = cell.cost + price * f64::from(skipped);
                    if cost < best.cost {
                        (best, end) = (Cell { cost, skipped: cell.skipped + skipped, ..*cell }, (i, j));
                    }
                }
            }
            std::mem::swap(&mut previous, &mut row);
        }
        let cost = best.cost - price * f64::from(best.skipped);
        Found { cost, length: best.length, skipped: best.skipped, end }
    }
}
