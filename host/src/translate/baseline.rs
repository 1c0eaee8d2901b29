//! What simpler models do: mean offset, and the best affine map of each joint. Fitted on the training pairs, kept in the pack.

use faer::Mat;
use faer::linalg::solvers::Solve;

use crate::pack::Baselines;

/// Baselines from aligned frames: `source` and `target` are `[frames x 3 joints]`, m, of all training pairs together.
pub fn fit(source: &[f64], target: &[f64], joints: usize) -> Baselines {
    let channels = 3 * joints;
    let frames = source.len().checked_div(channels).unwrap_or(0).max(1);
    let mut offset = vec![0.0; channels];
    for (source, target) in source.chunks_exact(channels).zip(target.chunks_exact(channels)) {
        for ((sum, s), t) in offset.iter_mut().zip(source).zip(target) {
            *sum += (t - s) / frames as f64;
        }
    }
    let affine = (0..joints).flat_map(|joint| affine(source, target, channels, joint)).collect();
    Baselines { offset: offset.iter().map(|x| *x as f32).collect(), affine }
}

/// Variance below which a movement is noise, m^2. Without this ridge, joints that hardly move get wild slopes and the
/// baseline is weaker (19.8 cm instead of 14.6 on the proud walk of `docs/quality.md`).
const NOISE: f64 = 1e-4;

/// Ridge regression of one joint: row-major 3 x 3, then the translation.
fn affine(source: &[f64], target: &[f64], channels: usize, joint: usize) -> [f32; 12] {
    let rows = |of: &[f64]| -> Vec<[f64; 3]> {
        of.chunks_exact(channels).map(|row| [row[3 * joint], row[3 * joint + 1], row[3 * joint + 2]]).collect()
    };
    let (source, target) = (rows(source), rows(target));
    let frames = source.len().max(1) as f64;
    let mean = |rows: &[[f64; 3]]| [0, 1, 2].map(|d| rows.iter().map(|row| row[d]).sum::<f64>() / frames);
    let (from, to) = (mean(&source), mean(&target));
    let covariance = |a: &[[f64; 3]], b: &[[f64; 3]], (ma, mb): ([f64; 3], [f64; 3])| {
        Mat::from_fn(3, 3, |i, j| a.iter().zip(b).map(|(a, b)| (a[i] - ma[i]) * (b[j] - mb[j])).sum::<f64>() / frames)
    };
    let mut normal = covariance(&source, &source, (from, from));
    (0..3).for_each(|d| normal[(d, d)] += NOISE);
    let Ok(cholesky) = normal.llt(faer::Side::Lower) else { return [0.0; 12] };
    let slope = cholesky.solve(&covariance(&source, &target, (from, to)));
    let mut map = [0.0; 12];
    for row in 0..3 {
        for column in 0..3 {
            map[3 * row + column] = slope[(column, row)] as f32;
        }
        map[9 + row] = (to[row] - (0..3).map(|column| slope[(column, row)] * from[column]).sum::<f64>()) as f32;
    }
    map
}

/// The offset baseline of positions `[frames x 3 joints]`, m.
pub fn apply_offset(baselines: &Baselines, positions: &[f64]) -> Vec<f64> {
    let channels = baselines.offset.len().max(1);
    positions
        .chunks_exact(channels)
        .flat_map(|row| row.iter().zip(&baselines.offset).map(|(x, d)| x + f64::from(*d)))
        .collect()
}

/// The affine baseline of positions `[frames x 3 joints]`, m.
pub fn apply_affine(baselines: &Baselines, positions: &[f64]) -> Vec<f64> {
    let maps = baselines.affine.as_chunks::<12>().0;
    let joints = maps.iter().cycle().zip(positions.as_chunks::<3>().0);
    joints
        .flat_map(|(map, p)| {
            [0, 1, 2].map(|row| {
                let linear: f64 = (0..3).map(|column| f64::from(map[3 * row + column]) * p[column]).sum();
                linear + f64::from(map[9 + row])
            })
        })
        .collect()
}
