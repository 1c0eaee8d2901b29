//! The space warp: scale and offset over time for a given time warp.

use super::banded::{BandedSolver, LANES, Lane, Row};
use super::error::AlignError;
use super::settings::{Settings, Smoothness};
use super::standard::Standard;

/// `P = F^T F + ridge I`: five diagonals, of which three are kept.
#[derive(Debug)]
struct Penalty {
    weights: Smoothness,
    ridge: f64,
    diagonal: Vec<f64>,
    /// Elements (t, t + 1) and (t, t + 2).
    above: [Vec<f64>; 2],
}

impl Penalty {
    fn new(frames: usize, weights: Smoothness, ridge: f64) -> Self {
        let mut diagonal = vec![ridge; frames];
        let mut above = [vec![0.0; frames], vec![0.0; frames]];
        for (stencil, weight) in [(&[-1.0, 1.0][..], weights.first), (&[1.0, -2.0, 1.0][..], weights.second)] {
            for start in 0..(frames + 1).saturating_sub(stencil.len()) {
                for (k, x) in stencil.iter().enumerate() {
                    diagonal[start + k] += weight * x * x;
                    for (d, y) in stencil.iter().skip(k + 1).enumerate() {
                        above[d][start + k] += weight * x * y;
                    }
                }
            }
        }
        Self { weights, ridge, diagonal, above }
    }

    /// Element t of `P x`.
    fn times(&self, t: usize, x: impl Fn(usize) -> Lane) -> Lane {
        let mut sum = [0.0; LANES];
        let mut add = |weight: f64, at: usize| {
            for (s, v) in sum.iter_mut().zip(x(at)) {
                *s += weight * v;
            }
        };
        add(self.diagonal[t], t);
        for (above, d) in self.above.iter().zip(1..) {
            if t >= d {
                add(above[t - d], t - d);
            }
            if t + d < self.diagonal.len() {
                add(above[t], t + d);
            }
        }
        sum
    }

    /// `x^T P x`, from the differences: without the cancellation of the product.
    fn energy(&self, x: impl Fn(usize) -> Lane) -> Lane {
        let mut sum = [0.0; LANES];
        for t in 0..self.diagonal.len() {
            let here = x(t);
            let back = if t >= 1 { x(t - 1) } else { here };
            let second = if t >= 2 { x(t - 2) } else { [0.0; LANES] };
            for l in 0..LANES {
                sum[l] += self.ridge * here[l].powi(2) + self.weights.first * (here[l] - back[l]).powi(2);
                if t >= 2 {
                    sum[l] += self.weights.second * (here[l] - 2.0 * back[l] + second[l]).powi(2);
                }
            }
        }
        sum
    }
}

/// Target frames matched by each source frame: first and count.
pub(super) type Runs = Vec<(usize, usize)>;

/// Groups a path by source frame.
pub(super) fn runs(path: &[(usize, usize)], frames: usize) -> Runs {
    let mut runs = vec![(0, 0); frames];
    for run in path.chunk_by(|p, q| p.0 == q.0) {
        if let Some(&(i, j)) = run.first() {
            runs[i] = (j, run.len());
        }
    }
    runs
}

/// Parts of the energy that depend on scale and offset, of each block: residuals, `|F a|^2`, `|G b|^2` (with their ridges).
pub(super) type Parts = Vec<[Lane; 3]>;

/// Scale and offset of all channels, in standardised units.
#[derive(Debug)]
pub(super) struct SpaceWarp {
    /// `[block][frame][a - 1, b]`
    values: Vec<[Lane; 2]>,
    frames: usize,
    scale: Penalty,
    offset: Penalty,
    solver: BandedSolver,
    trial: Vec<[Lane; 2]>,
}

impl SpaceWarp {
    /// The identity.
    pub fn new(source: &Standard, settings: &Settings) -> Self {
        let frames = source.frames;
        Self {
            values: vec![[[0.0; LANES]; 2]; frames * source.blocks()],
            frames,
            scale: Penalty::new(frames, settings.scale, settings.ridge),
            offset: Penalty::new(frames, settings.offset, settings.ridge),
            solver: BandedSolver::default(),
            trial: Vec::new(),
        }
    }

    /// Scale and offset of a block of channels in a frame.
    pub fn at(&self, block: usize, frame: usize) -> [Lane; 2] {
        let [a, b] = self.values[block * self.frames + frame];
        [a.map(|a| 1.0 + a), b]
    }

    fn block(&self, block: usize) -> &[[Lane; 2]] {
        &self.values[block * self.frames..(block + 1) * self.frames]
    }

    /// Energy for a time warp. O((source + target frames) x channels).
    pub fn energy(&self, source: &Standard, target: &Standard, runs: &Runs) -> Parts {
        (0..source.blocks()).map(|k| self.block_energy(self.block(k), source.block(k), target.block(k), runs)).collect()
    }

    fn block_energy(&self, x: &[[Lane; 2]], u: &[Lane], v: &[Lane], runs: &Runs) -> [Lane; 3] {
        let mut data = [0.0; LANES];
        for ((&(from, count), u), [a, b]) in runs.iter().zip(u).zip(x) {
            let fitted: Lane = std::array::from_fn(|l| u[l] + a[l] * u[l] + b[l]);
            for v in &v[from..from + count] {
                for l in 0..LANES {
                    data[l] += (fitted[l] - v[l]).powi(2);
                }
            }
        }
        [data, self.scale.energy(|t| x[t][0]), self.offset.energy(|t| x[t][1])]
    }

    /// Minimises over scale and offset, each channel by itself, in O(frames) for each. A channel whose energy rounding would
    /// raise keeps its values, so that the total never rises.
    ///
    /// The equations are solved for the *change*: what one solve loses to rounding, the next iteration's makes good.
    ///
    /// `parts` is the energy for `runs`, and is kept up to date.
    pub fn update(
        &mut self,
        source: &Standard,
        target: &Standard,
        runs: &Runs,
        parts: &mut Parts,
    ) -> Result<(), AlignError> {
        for (block, parts) in parts.iter_mut().enumerate() {
            let (u, v) = (source.block(block), target.block(block));
            let range = block * self.frames..(block + 1) * self.frames;
            let x = &self.values[range.clone()];
            let (scale, offset) = (&self.scale, &self.offset);
            // The solver asks for the rows in order: a_t's, then b_t's.
            let mut second = None;
            let change = self.solver.solve(2 * self.frames, |r| {
                second.take().unwrap_or_else(|| {
                    let [first, next] = equations(r / 2, x, u, v, runs, scale, offset);
                    second = Some(next);
                    first
                })
            });
            let change = change.ok_or(AlignError::Singular { first_channel: block * LANES })?;
            self.trial.clear();
            self.trial.extend(
                x.iter()
                    .zip(change.as_chunks::<2>().0)
                    .map(|(x, d)| std::array::from_fn(|k| std::array::from_fn(|l| x[k][l] + d[k][l]))),
            );
            let after = self.block_energy(&self.trial, u, v, runs);
            for l in 0..LANES {
                if total(&after, l) < total(parts, l) {
                    for (part, new) in parts.iter_mut().zip(&after) {
                        part[l] = new[l];
                    }
                    for (to, from) in self.values[range.clone()].iter_mut().zip(&self.trial) {
                        (to[0][l], to[1][l]) = (from[0][l], from[1][l]);
                    }
                }
            }
        }
        Ok(())
    }
}

fn total(parts: &[Lane; 3], lane: usize) -> f64 {
    parts.iter().map(|p| p[lane]).sum()
}

/// Rows 2 t and 2 t + 1 of the normal equations, unknowns `a_0, b_0, a_1, b_1, ..`; on the right the negative gradient.
fn equations(
    t: usize,
    x: &[[Lane; 2]],
    u: &[Lane],
    v: &[Lane],
    runs: &Runs,
    scale: &Penalty,
    offset: &Penalty,
) -> [Row; 2] {
    let (from, count) = runs[t];
    let weight = count as f64;
    let (u, [a, b]) = (u[t], x[t]);
    let mut residual: Lane = std::array::from_fn(|l| weight * (u[l] + a[l] * u[l] + b[l]));
    for v in &v[from..from + count] {
        for l in 0..LANES {
            residual[l] -= v[l];
        }
    }
    let smooth = [scale.times(t, |t| x[t][0]), offset.times(t, |t| x[t][1])];
    let left = |penalty: &Penalty, beside: Lane| {
        let mut left = [beside, [0.0; LANES], [0.0; LANES], [0.0; LANES]];
        for (above, d) in penalty.above.iter().zip(1..) {
            if t >= d {
                left[2 * d - 1] = [above[t - d]; LANES];
            }
        }
        left
    };
    [
        Row {
            diagonal: u.map(|u| weight * u * u + scale.diagonal[t]),
            left: left(scale, [0.0; LANES]),
            right: std::array::from_fn(|l| -(u[l] * residual[l] + smooth[0][l])),
        },
        Row {
            diagonal: [weight + offset.diagonal[t]; LANES],
            left: left(offset, u.map(|u| weight * u)),
            right: std::array::from_fn(|l| -(residual[l] + smooth[1][l])),
        },
    ]
}
