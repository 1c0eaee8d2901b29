//! What a translator knows of its training: clusters of what the body was doing, by which the device sees how familiar a frame is.
//!
//! The features are the first principal coordinates of the body, travel and height of the root. A cluster says where they were, smoothed, and
//! how fast the coordinates changed. Distances are in units of the spread within clusters, and at least of what another person differs by.

use faer::Mat;

use super::dataset::Sequence;
use super::features::{centred, principal};
use crate::learn::k_means;
use crate::rig::Rig;

/// Principal coordinates among the features; with the root's three they fill one tile of the device's product.
const COORDINATES: usize = 5;
/// Travel to the side, forward, and height.
const ROOT: usize = 3;
const FEATURES: usize = COORDINATES + ROOT;
/// Clusters.
const CLUSTERS: usize = 12;
/// Frames that are clustered at most.
const FRAMES: usize = 4000;
/// Times over which features, speeds and novelty are smoothed, s.
const TIMES: [f64; 3] = [0.2, 0.4, 0.1];
/// What another person may differ by: posture, m of lever; its speed, m/s and part of the mean; travel, m/s; height, m. For a body whose hips
/// are [`HIPS`] high. Chosen so that walks of other people are familiar to a pack of walks and other motions are not: `docs/quality.sh strange`.
const POSTURE: f64 = 0.5;
const SPEED: [f64; 2] = [0.3, 0.4];
const TRAVEL: f64 = 0.35;
const HEIGHT: f64 = 0.12;
const HIPS: f64 = 0.95;
/// Novelty at which half of the style counts: at least so much, and so many times the most that nearly all of the training has.
const NOVELTY: f64 = 8.0;
const OF_TRAINING: f64 = 2.0;
/// Part of the mean change of posture that suits any motion.
const COARSE: f64 = 0.5;
/// Common part of two distributions over clusters under which two motions are different actions.
const COMMON: f64 = 0.3;

/// A gate as a pack holds it, in f64. Matrices are row-major.
#[derive(Clone, Debug)]
pub struct GateModel {
    /// `[features x 3 rows]`, from the centred input.
    pub project: Vec<f64>,
    /// Factor of each feature's change in a frame.
    pub speed: Vec<f64>,
    /// `[clusters x features]`: place and speed.
    pub centres: Vec<[f64; 2]>,
    /// Parts that features, speeds and novelty take of a new value; 1 / the novelty at which half of the style counts.
    pub rates: [f64; 4],
    /// Change that suits any motion, `[3 rows]`.
    pub coarse: Vec<f64>,
}

/// The nearest two of the clusters and their weights, and the distance to the nearest.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    /// Squared distance to the nearest cluster.
    pub distance: f64,
    /// Cluster and weight.
    pub near: [(usize, f64); 2],
}

/// Features before they have a unit: values and speeds of every frame of a clip, `[frames x features]` of `[value, speed]`.
type Points = Vec<Vec<[f64; 2]>>;

impl GateModel {
    /// The gate of training sequences, whose inputs are coordinates times their levers; `None` for a machine, and where there is too little to
    /// tell clusters apart.
    pub fn fit<'a>(
        rig: &Rig,
        sequences: impl Iterator<Item = &'a Sequence> + Clone,
        mean: &[f64],
        fps: f64,
    ) -> Option<Self> {
        if !rig.frames().travels() {
            return None;
        }
        let inputs: Vec<Mat<f64>> = sequences.clone().map(|s| centred(&s.input, mean)).collect();
        let project = projection(&inputs, &rig.levers(), fps);
        let mut gate = Self {
            project,
            speed: vec![fps; FEATURES],
            centres: Vec::new(),
            rates: [TIMES[0], TIMES[1], TIMES[2], 0.0].map(|time| 1.0 - (-1.0 / (fps * time)).exp()),
            coarse: coarse(sequences, mean.len()),
        };
        let points: Points = inputs.iter().flat_map(|input| gate.points(input)).collect();
        let size = mean[1] / rig.levers()[1] / HIPS;
        let spread = gate.cluster(&points, size)?;
        for ((row, speed), [of_value, of_speed]) in
            gate.project.chunks_exact_mut(mean.len()).zip(&mut gate.speed).zip(&spread)
        {
            row.iter_mut().for_each(|weight| *weight /= of_value);
            *speed = if of_speed.is_finite() { fps * of_value / of_speed } else { 0.0 };
        }
        for cluster in gate.centres.chunks_exact_mut(FEATURES) {
            cluster.iter_mut().zip(&spread).for_each(|(centre, spread)| {
                *centre = [centre[0] / spread[0], centre[1] / spread[1]];
            });
        }
        let mut novelty: Vec<f64> = inputs.iter().flat_map(|input| gate.look(input)).map(|s| s.distance).collect();
        novelty.sort_unstable_by(f64::total_cmp);
        let most = novelty.get(novelty.len() * 99 / 100).copied().unwrap_or(0.0);
        gate.rates[3] = 1.0 / NOVELTY.max(OF_TRAINING * most);
        Some(gate)
    }

    /// The projection for an input that is multiplied by `scale` after it was centred.
    pub fn normalise(&mut self, scale: &[f64]) {
        for row in self.project.chunks_exact_mut(scale.len().max(1)) {
            row.iter_mut().zip(scale).for_each(|(weight, scale)| *weight /= scale);
        }
    }

    /// Number of clusters.
    pub fn clusters(&self) -> usize {
        self.centres.len() / FEATURES
    }

    /// Centres, and the spread of every feature and its speed that distances are measured in.
    fn cluster(&mut self, points: &Points, size: f64) -> Option<Vec<[f64; 2]>> {
        let frames = points.len().max(1) as f64;
        let mean = |at: fn(&[f64; 2]) -> f64, f: usize| points.iter().map(|p| at(&p[f])).sum::<f64>() / frames;
        let allowed: Vec<[f64; 2]> = (0..FEATURES)
            .map(|f| match f {
                0..COORDINATES => [POSTURE * size, SPEED[0] * size + SPEED[1] * mean(|p| p[1], f)],
                // How fast travel and height change says little and is mostly noise.
                f if f == FEATURES - 1 => [HEIGHT * size, f64::INFINITY],
                _ => [TRAVEL * size, f64::INFINITY],
            })
            .collect();
        let variance = |f: usize, at: fn(&[f64; 2]) -> f64| {
            let mean = mean(at, f);
            points.iter().map(|p| (at(&p[f]) - mean).powi(2)).sum::<f64>() / frames
        };
        let mut within: Vec<[f64; 2]> = (0..FEATURES).map(|f| [variance(f, |p| p[0]), variance(f, |p| p[1])]).collect();
        let mut spread = Vec::new();
        for _ in 0..3 {
            let unit = |(allowed, within): (&[f64; 2], &[f64; 2])| {
                [0, 1].map(|part| (allowed[part] * allowed[part] + within[part]).sqrt())
            };
            spread = allowed.iter().zip(&within).map(unit).collect::<Vec<[f64; 2]>>();
            let step = points.len().div_ceil(FRAMES).max(1);
            let thinned: Vec<&Vec<[f64; 2]>> = points.iter().step_by(step).collect();
            let scaled = |point: &&Vec<[f64; 2]>| -> Vec<f64> {
                point.iter().zip(&spread).flat_map(|(p, s)| [p[0] / s[0], p[1] / s[1]]).collect()
            };
            let clusters = k_means(&thinned.iter().map(scaled).collect::<Vec<_>>(), CLUSTERS, 1);
            // The weights of two clusters need a third.
            if clusters.count() < 3 {
                return None;
            }
            let unscale = |middle: &Vec<f64>| {
                let parts = middle.as_chunks::<2>().0.iter().zip(&spread);
                parts.map(|([a, b], [s, t])| [a * s, if t.is_finite() { b * t } else { 0.0 }]).collect::<Vec<_>>()
            };
            let centres: Vec<Vec<[f64; 2]>> = clusters.middles.iter().map(unscale).collect();
            within = vec![[0.0; 2]; FEATURES];
            for (point, member) in thinned.iter().zip(&clusters.members) {
                for ((within, p), centre) in within.iter_mut().zip(*point).zip(&centres[*member]) {
                    (0..2).for_each(|part| within[part] += (p[part] - centre[part]).powi(2) / thinned.len() as f64);
                }
            }
            self.centres = centres.concat();
        }
        Some(spread)
    }

    /// Smoothed features of every frame, and their speeds, as the device has them once it has watched: they begin with their means over
    /// the clip's beginning.
    fn points(&self, input: &Mat<f64>) -> Points {
        if input.nrows() < 2 {
            return Points::new();
        }
        let channels = input.ncols();
        let project = Mat::from_fn(channels, FEATURES, |c, f| self.project[f * channels + c]);
        let now = input * project;
        let [of_feature, of_speed, ..] = self.rates;
        let change = |t: usize, f: usize| self.speed[f] * (now[(t, f)] - now[(t - 1, f)]).abs();
        let mean = |frames: usize, of: &dyn Fn(usize) -> f64| (1..=frames).map(of).sum::<f64>() / frames as f64;
        let [few, more] = [of_feature, of_speed].map(|rate| ((1.0 / rate) as usize).clamp(1, input.nrows() - 1));
        let begin = |f| [mean(few, &|t| now[(t, f)]), mean(more, &|t| change(t, f))];
        let mut point: Vec<[f64; 2]> = (0..FEATURES).map(begin).collect();
        let frames = (0..input.nrows()).map(|t| {
            // The first frame has no travel and no change.
            for (f, [value, speed]) in point.iter_mut().enumerate().filter(|_| t > 0) {
                *value += of_feature * (now[(t, f)] - *value);
                *speed += of_speed * (change(t, f) - *speed);
            }
            point.clone()
        });
        frames.collect()
    }

    /// What the device's gate sees in every frame of a centred input.
    pub fn look(&self, input: &Mat<f64>) -> Vec<Sight> {
        self.points(input).iter().map(|point| self.sight(point)).collect()
    }

    fn sight(&self, point: &[[f64; 2]]) -> Sight {
        let far = |centre: &[[f64; 2]]| {
            let parts = point.iter().zip(centre);
            parts.map(|(p, c)| (p[0] - c[0]).powi(2) + (p[1] - c[1]).powi(2)).sum::<f64>()
        };
        let mut all: Vec<(f64, usize)> =
            self.centres.chunks_exact(FEATURES).enumerate().map(|(i, c)| (far(c), i)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let [a, b, c] = [all[0], all[1], all[2]];
        let [first, second] = [a, b].map(|(distance, _)| (c.0 - distance).powi(2));
        let part = if first + second > 0.0 { first / (first + second) } else { 0.5 };
        Sight { distance: a.0, near: [(a.1, part), (b.1, 1.0 - part)] }
    }

    /// Whether the sequences are of different actions: two of them have little in common.
    pub fn several_actions(&self, sequences: &[Sequence], mean: &[f64]) -> bool {
        let shares = |sequence: &Sequence| {
            let mut shares = vec![0.0; self.clusters()];
            let sights = self.look(&centred(&sequence.input, mean));
            sights.iter().flat_map(|sight| sight.near).for_each(|(cluster, weight)| shares[cluster] += weight);
            let frames = sights.len().max(1) as f64;
            shares.into_iter().map(|share| share / frames).collect::<Vec<f64>>()
        };
        let all: Vec<Vec<f64>> = sequences.iter().map(shares).collect();
        let common = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| f64::min(*a, *b)).sum::<f64>();
        all.iter().enumerate().any(|(index, a)| all[..index].iter().any(|b| common(a, b) < COMMON))
    }
}

/// Principal coordinates of the body without its root, m; travel, m/s; height, m.
fn projection(inputs: &[Mat<f64>], levers: &[f64], fps: f64) -> Vec<f64> {
    let channels = levers.len();
    let mut covariance = Mat::<f64>::zeros(channels, channels);
    inputs.iter().for_each(|input| covariance += input.transpose() * input);
    for root in 0..ROOT {
        covariance.row_mut(root).fill(0.0);
        covariance.col_mut(root).fill(0.0);
    }
    let basis = principal(&covariance, inputs.iter().map(Mat::nrows).sum());
    let mut project = vec![0.0; FEATURES * channels];
    for coordinate in 0..COORDINATES.min(basis.ncols()) {
        let length = (0..channels).map(|c| basis[(c, coordinate)].powi(2)).sum::<f64>().sqrt().max(1e-12);
        (0..channels).for_each(|c| project[coordinate * channels + c] = basis[(c, coordinate)] / length);
    }
    for (row, (channel, factor)) in [(0, fps), (2, fps), (1, 1.0)].into_iter().enumerate() {
        project[(COORDINATES + row) * channels + channel] = factor / levers[channel];
    }
    project
}

/// Half of the mean change; where it goes stays the source's.
fn coarse<'a>(sequences: impl Iterator<Item = &'a Sequence>, channels: usize) -> Vec<f64> {
    let (mut sum, mut frames) = (vec![0.0; channels], 0.0);
    for sequence in sequences {
        let rows = sequence.covered_input().chunks_exact(channels).zip(sequence.output.chunks_exact(channels));
        for (input, output) in rows {
            sum.iter_mut().zip(output).zip(input).for_each(|((sum, y), x)| *sum += y - x);
            frames += 1.0;
        }
    }
    (sum[0], sum[2]) = (0.0, 0.0);
    sum.into_iter().map(|sum| COARSE * sum / f64::max(frames, 1.0)).collect()
}
