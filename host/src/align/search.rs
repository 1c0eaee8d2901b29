//! Where to search: reduced frame rate first, then a corridor that widens until the path lies inside it.

use super::corridor::Corridor;
use super::dtw::{Dtw, Problem, Slack};
use super::error::AlignError;
use super::settings::{Search, Settings};
use super::steps::Steps;
use super::tiles::Tiles;

/// Clips up to this many frames are searched in full at the start; longer ones at a reduced frame rate.
const COARSE: usize = 768;
/// The first corridor is this many times wider. On a real session (12 actions, 2,000 frames) twice was enough to find what the
/// full search finds, once was not (0.9 % more cost).
const FIRST: usize = 4;
/// Rounds of Dinkelbach's method; it converges superlinearly, three are usual.
const PRICE_ROUNDS: usize = 8;

/// How much was searched: for tests of the running time that do not depend on the machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Pairs of frames compared.
    pub cells: u64,
    /// Dynamic programs solved.
    pub searches: u32,
    /// Times a corridor was too narrow and was widened.
    pub widened: u32,
    /// Searches of all reachable cells at full frame rate.
    pub full_searches: u32,
}

type Path = Vec<(usize, usize)>;

/// Finds time warps and remembers what it cost.
#[derive(Debug)]
pub(super) struct Searcher<'a> {
    settings: &'a Settings,
    dtw: Dtw,
    work: Work,
    /// Whether scale and offset were changed more than once.
    settled: bool,
}

impl<'a> Searcher<'a> {
    pub fn new(settings: &'a Settings) -> Self {
        Self { settings, dtw: Dtw::default(), work: Work::default(), settled: false }
    }

    pub fn work(&self) -> Work {
        Work { cells: self.dtw.cells, ..self.work }
    }

    /// The first path, and the price of unmatched frames that it settles: through levels of 4 (at the end 2) times the frame
    /// rate each, so that the work stays linear in the frames.
    pub fn first(&mut self, p: &Problem<'_>, target: &[f32]) -> Result<(Path, f64), AlignError> {
        let Search::Corridor { radius } = self.settings.search else {
            return self.priced(p, None);
        };
        let longest = p.source_frames().max(p.target.frames());
        let mut scale = longest.div_ceil(COARSE).next_power_of_two();
        let radius = radius.saturating_mul(FIRST);
        let mut path = Path::new();
        let mut before = 0;
        while scale > 1 {
            let (source, coarse) = (reduce(p.source, p.channels, scale), reduce(target, p.channels, scale));
            let tiles = Tiles::new(coarse.chunks_exact(p.channels), p.channels);
            let (n, m) = (source.len() / p.channels, tiles.frames());
            let steps = Steps::new(n, m, self.settings.max_stretch, p.steps.weight)?;
            let slack = Slack { source: self.settings.ends.slack(n), target: self.settings.ends.slack(m), price: 0.0 };
            let small = Problem { source: &source, target: &tiles, steps: &steps, slack, ..*p };
            let near = (before > 0).then_some((&path[..], before / scale, radius));
            let (found, _) = self.priced(&small, near)?;
            (path, before) = (found, scale);
            scale = (scale / 4).max(1);
        }
        self.priced(p, (before > 0).then_some((&path[..], before, radius)))
    }

    /// The best path near `path` (its own cells always among those searched).
    pub fn next(&mut self, p: &Problem<'_>, path: &[(usize, usize)]) -> Result<Path, AlignError> {
        let Search::Corridor { radius } = self.settings.search else {
            return self.search(p, None);
        };
        // The first change of scale and offset is the largest.
        let radius = if std::mem::replace(&mut self.settled, true) { radius } else { radius.saturating_mul(2) };
        self.search(p, Some((path, 1, radius)))
    }

    /// Minimises cost / covered frames: Dinkelbach's method, W. Dinkelbach, On nonlinear fractional programming, 1967.
    fn priced(&mut self, p: &Problem<'_>, near: Near<'_>) -> Result<(Path, f64), AlignError> {
        let mut p = *p;
        if p.slack.source == 0 && p.slack.target == 0 {
            return Ok((self.search(&p, near)?, 0.0));
        }
        // The closed path is one of the candidates, so its ratio is an upper bound.
        let mut path = self.search(&Problem { slack: Slack::default(), ..p }, near)?;
        p.slack.price = ratio(&p, &path);
        for _ in 0..PRICE_ROUNDS {
            path = self.search(&p, near)?;
            let price = ratio(&p, &path);
            if price >= p.slack.price * (1.0 - 1e-6) {
                break;
            }
            p.slack.price = price;
        }
        Ok((path, p.slack.price))
    }

    fn search(&mut self, p: &Problem<'_>, near: Near<'_>) -> Result<Path, AlignError> {
        let (n, m) = (p.source_frames(), p.target.frames());
        let reachable = Corridor::reachable(n, m, p.steps, p.slack);
        let slope = m as f64 / n as f64;
        if let Some((path, scale, mut radius)) = near {
            radius = radius.max(1);
            while radius < m {
                let corridor = reachable.around(path, scale, radius, slope);
                // A corridor of nearly all cells saves nothing.
                if corridor.cells() * 4 > reachable.cells() * 3 {
                    break;
                }
                self.work.searches += 1;
                if let Some(found) = self.dtw.search(p, &corridor)
                    && !corridor.touched_by(&found, &reachable)
                {
                    return Ok(found);
                }
                self.work.widened += 1;
                radius = radius.saturating_mul(2);
            }
        }
        self.work.searches += 1;
        self.work.full_searches += 1;
        self.dtw.search(p, &reachable).ok_or(AlignError::Lengths {
            source_frames: n,
            target_frames: m,
            max: p.steps.delete.len().max(p.steps.repeat.len()),
        })
    }
}

/// A path, how many times longer the frames it counts are, and how far around it to search.
type Near<'a> = Option<(&'a [(usize, usize)], usize, usize)>;

/// Cost over covered frames of both clips, each clip counted as long as the target.
fn ratio(p: &Problem<'_>, path: &[(usize, usize)]) -> f64 {
    let cost: f64 = p.path_cost(path);
    let (n, m) = (p.source_frames() as f64, p.target.frames() as f64);
    let covered = |a: Option<usize>, b: Option<usize>| a.zip(b).map_or(0.0, |(a, b)| (b - a + 1) as f64);
    let source = covered(path.first().map(|p| p.0), path.last().map(|p| p.0));
    let target = covered(path.first().map(|p| p.1), path.last().map(|p| p.1));
    cost / (target + source * m / n).max(1.0)
}

/// Means of `scale` frames each; the last may be of fewer.
fn reduce(rows: &[f32], channels: usize, scale: usize) -> Vec<f32> {
    let mut out = Vec::with_capacity(rows.len() / scale + channels);
    for block in rows.chunks(channels * scale) {
        let count = (block.len() / channels) as f32;
        out.extend((0..channels).map(|c| block.iter().skip(c).step_by(channels).sum::<f32>() / count));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cheapest cost of any path, straight from the definition of the steps and ends.
    fn reference(p: &Problem<'_>) -> f64 {
        let (n, m) = (p.source_frames(), p.target.frames());
        let source_price = p.slack.price * m as f64 / n as f64;
        let run = |i: usize, j: usize, r: usize| -> f64 {
            (j + 1 - r..=j).map(|j| p.target.distance(&p.source[i..i + 1], j)).sum()
        };
        let mut cost = vec![vec![f64::INFINITY; m]; n];
        let mut best = f64::INFINITY;
        for i in 0..n {
            for j in 0..m {
                let mut least = f64::INFINITY;
                for (r, penalty) in (1..=j + 1).zip(&p.steps.repeat) {
                    let start = j + 1 - r;
                    let starts = (i == 0 && start <= p.slack.target) || (start == 0 && i <= p.slack.source);
                    if starts {
                        let skipped = i as f64 * source_price + start as f64 * p.slack.price;
                        least = least.min(skipped + run(i, j, r) + penalty);
                    }
                    if i > 0 && start > 0 {
                        least = least.min(cost[i - 1][start - 1] + run(i, j, r) + penalty);
                    }
                }
                for (k, penalty) in (1..=i).zip(&p.steps.delete) {
                    if j > 0 {
                        least = least.min(cost[i - k][j - 1] + run(i, j, 1) + penalty);
                    }
                }
                cost[i][j] = least;
                let (left, rest) = (n - 1 - i, m - 1 - j);
                if (left == 0 && rest <= p.slack.target) || (rest == 0 && left <= p.slack.source) {
                    best = best.min(least + left as f64 * source_price + rest as f64 * p.slack.price);
                }
            }
        }
        best
    }

    #[test]
    fn the_full_search_is_optimal() {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        for round in 0..300 {
            let (n, m) = (2 + (random() * 40.0) as usize, 2 + (random() * 40.0) as usize);
            let source: Vec<f32> = (0..n).map(|_| random()).collect();
            let target: Vec<f32> = (0..m).map(|_| random()).collect();
            let Ok(steps) = Steps::new(n, m, 1.0 + 2.0 * f64::from(random()), 0.02) else {
                continue;
            };
            let (source_slack, target_slack) =
                ((random() * n as f32 / 2.0) as usize, (random() * m as f32 / 2.0) as usize);
            let open = Slack { source: source_slack, target: target_slack, price: 0.1 };
            let slack = if round % 2 == 0 { Slack::default() } else { open };
            let tiles = Tiles::new(target.chunks_exact(1), 1);
            let p = Problem { source: &source, channels: 1, target: &tiles, steps: &steps, slack };
            let settings = Settings::default();
            let path = Searcher::new(&settings).search(&p, None).expect("a path");
            let skipped = super::super::iterate::unmatched(&path, n, m, slack);
            let (found, want) = (p.path_cost(&path) + skipped, reference(&p));
            assert!((found - want).abs() < 1e-4, "{n} x {m}, {slack:?}: {found}, {want}");
        }
    }

    #[test]
    fn a_corridor_around_a_wrong_path_widens_until_it_holds_the_right_one() {
        // A ramp that bends: the right path is up to 60 frames off the diagonal.
        let n = 600;
        let source: Vec<f32> = (0..n).map(|t| t as f32).collect();
        let bend = |j: usize| j as f32 + 60.0 * (j as f32 / 599.0 * std::f32::consts::PI).sin();
        let target: Vec<f32> = (0..n).map(bend).collect();
        let tiles = Tiles::new(target.chunks_exact(1), 1);
        let steps = Steps::new(n, n, 3.0, 1e-3).expect("equal lengths");
        let p = Problem { source: &source, channels: 1, target: &tiles, steps: &steps, slack: Slack::default() };
        let diagonal: Path = (0..n).map(|t| (t, t)).collect();

        let settings = Settings::default();
        let mut searcher = Searcher::new(&settings);
        let found = searcher.search(&p, Some((&diagonal, 1, 4))).expect("a path");
        let work = searcher.work();
        assert!(work.widened >= 3 && work.full_searches == 0, "{work:?}");
        assert_eq!(found, searcher.search(&p, None).expect("a path"));
        assert_eq!(searcher.work().full_searches, 1);
    }
}
