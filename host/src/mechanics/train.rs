//! Training: denoising autoencoder on the pool, feature network to its code, stacked, fine-tuned (Boehs 2017, section 3).

use kinesic::mechanics::FEATURES;
use kinesic::model::LoadError;
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use serde::Serialize;

use super::body::{BodyError, body, measured};
use super::dataset::{Rows, signs};
use super::linear::Linear;
use super::model::MechanicsModel;
use super::network::{Layer, Network};
use super::stages::{Data, Networks, fit_all};
use crate::checkpoint::Keep;
use crate::clip::Clip;
use crate::rig::Rig;

/// What is held back together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// Single frames, the paper's way: neighbours of every test frame are trained on.
    Sample,
    /// Whole clips.
    Clip,
    /// All clips of a person: those whose file names begin alike, up to the first `_`.
    Subject,
}

/// How to train.
#[derive(Clone, Debug)]
pub struct TrainOptions {
    /// Units of the autoencoder's hidden layer, the code.
    pub code: usize,
    /// Units of the feature network's hidden layer.
    pub hidden: usize,
    /// Passes over the pool; the feature network and the fine-tuning make as many samples count.
    pub epochs: usize,
    /// Part of the data held back, 0..0.9.
    pub hold_out: f64,
    /// What is held back together.
    pub split: Split,
    /// Seed of weights, order, noise and split.
    pub seed: u64,
}

impl Default for TrainOptions {
    fn default() -> Self {
        Self { code: 300, hidden: 100, epochs: 80, hold_out: 0.3, split: Split::Clip, seed: 1 }
    }
}

/// A clip on the rig.
#[derive(Clone, Debug)]
pub struct NamedClip {
    /// Path, for messages, splits by subject, and the provenance.
    pub name: String,
    /// The motion.
    pub clip: Clip,
    /// Whether it shows body mechanics without expression; the others are the unlabelled pool.
    pub mechanics: bool,
}

/// Why training failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrainError {
    /// Nothing to learn from.
    #[error(
        "there are {found} body-mechanics clips to train on after holding back {held_back}, expected at least {expected}: give more with --clips, or --hold-out 0"
    )]
    TooFew {
        /// Clips (or groups) left.
        found: usize,
        /// Clips held back.
        held_back: usize,
        /// Needed.
        expected: usize,
    },
    /// The body lacks joints.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// The device refuses the body.
    #[error("the body cannot be used: {0}")]
    Refused(#[from] LoadError),
    /// What was kept is of another training.
    #[error("the checkpoint does not fit this training: remove it, or leave out --resume")]
    Checkpoint,
    /// The features say nothing.
    #[error("the clips do not determine a model: they have too few frames, or nothing moves")]
    Undetermined,
}

/// What was measured on the held-back data. Mean squared errors are those of single quaternion components of the joints that
/// move; angles are geodesic, per joint that moves, degrees.
#[derive(Clone, Debug, Serialize)]
pub struct Figures {
    /// Held-back frames of the pool and of the body-mechanics clips.
    pub frames: [usize; 2],
    /// Autoencoder, clean inputs.
    pub autoencoder_mse: f64,
    /// The same with every component stretched to -1..1 over the pool, as MATLAB's networks do by default.
    pub autoencoder_scaled_mse: f64,
    /// Mean pose of the pool, on the same two scales: what an autoencoder without units would do.
    pub pool_mean_mse: [f64; 2],
    /// Features to code (code units lie in -1..1).
    pub feature_mse: f64,
    /// Stacked, before fine-tuning.
    pub stacked_raw_mse: f64,
    /// Stacked and fine-tuned.
    pub stacked_mse: f64,
    /// The same on the stretched scale.
    pub stacked_scaled_mse: f64,
    /// Ridge regression from the features.
    pub linear_mse: f64,
    /// Mean pose of the body-mechanics clips.
    pub mean_pose_mse: f64,
    /// Stacked and fine-tuned.
    pub geodesic_deg: f64,
    /// Ridge regression.
    pub linear_deg: f64,
    /// Mean pose.
    pub mean_pose_deg: f64,
}

/// What came out of training.
#[derive(Debug)]
pub struct Trained {
    /// The model.
    pub model: MechanicsModel,
    /// Mean body-mechanics pose.
    pub mean_pose: Vec<f32>,
    /// Ridge regression on the same frames.
    pub linear: Linear,
    /// On the held-back data; `None` if nothing was held back.
    pub held_back: Option<Figures>,
    /// On the training data.
    pub training: Figures,
    /// For each clip given, whether any of it was trained on.
    pub trained_on: Vec<bool>,
    /// Joints that move, of all but the hips.
    pub moving: usize,
}

/// `(stage, epoch, epochs, training error)`.
pub type Progress<'a> = &'a dyn Fn(&'static str, usize, usize, f64);

/// Trains body mechanics. All clips are on the rig and have the same frame rate.
pub fn train(
    rig: &Rig,
    clips: &[NamedClip],
    name: &str,
    options: &TrainOptions,
    progress: Progress,
) -> Result<Trained, TrainError> {
    train_kept(rig, clips, name, options, progress, &mut ())
}

/// The same, keeping what it has reached in `keep` and going on from what an earlier run has kept there.
pub fn train_kept(
    rig: &Rig,
    clips: &[NamedClip],
    name: &str,
    options: &TrainOptions,
    progress: Progress,
    keep: &mut dyn Keep,
) -> Result<Trained, TrainError> {
    let mut random = ChaCha8Rng::seed_from_u64(options.seed);
    let held = hold_back(clips, options, &mut random);
    let trained_on: Vec<bool> = held.iter().map(|clip| clip.contains(&false)).collect();
    let count = |mechanics: bool, trained: bool| {
        clips.iter().zip(&trained_on).filter(|(c, t)| c.mechanics == mechanics && **t == trained).count()
    };
    if count(true, true) < 1 {
        return Err(TrainError::TooFew { found: 0, held_back: count(true, false), expected: 1 });
    }
    let of = |keep: &dyn Fn(&NamedClip) -> bool| -> Vec<&Clip> {
        clips.iter().zip(&trained_on).filter(|(c, t)| **t && keep(c)).map(|(c, _)| &c.clip).collect()
    };
    let body = measured(&body(rig)?, &of(&|c| c.mechanics));
    let signs = signs(rig, &of(&|_| true));
    let rows: Vec<Rows> =
        clips.iter().map(|c| Rows::of(rig, &body, &c.clip, &signs)).collect::<Result<_, LoadError>>()?;
    let pick = |mechanics_only: bool, test: bool| {
        let mut picked = Rows::default();
        let width = signs.len();
        for ((clip, rows), held) in clips.iter().zip(&rows).zip(&held) {
            let frames = (0..rows.frames()).filter(|f| held[*f] == test && (clip.mechanics || !mechanics_only));
            for frame in frames {
                picked.features.extend_from_slice(&rows.features[frame * FEATURES..][..FEATURES]);
                picked.poses.extend_from_slice(&rows.poses[frame * width..][..width]);
            }
        }
        picked
    };
    let (pool, mechanics) = (pick(false, false), pick(true, false));
    let scale = Scale::of(&pool.poses, signs.len());
    let features = Standard::of(&mechanics.features, FEATURES);
    let linear = Linear::fit(&features.apply(&mechanics.features), &mechanics.poses).ok_or(TrainError::Undetermined)?;
    let data = Data {
        width: signs.len(),
        pool: &scale.normalised(&pool.poses),
        features: &features.apply(&mechanics.features),
        poses: &scale.normalised(&mechanics.poses),
    };
    let network = fit_all(&data, options, random, progress, keep)?;
    let mean_pose = column_means(&mechanics.poses, signs.len()).iter().map(|x| *x as f32).collect();
    let judge = Judge { network: &network, scale: &scale, features: &features, linear: &linear, mean_pose: &mean_pose };
    let held_back = (options.hold_out > 0.0).then(|| judge.figures(&pick(false, true), &pick(true, true)));
    let training = judge.figures(&pool, &mechanics);
    let mut stacked = network.stacked.clone();
    if let Some(decoder) = stacked.layers.last_mut() {
        scale.unfold(decoder);
    }
    let model = MechanicsModel {
        name: name.to_owned(),
        frame_rate: clips.first().map_or(60.0, |c| c.clip.fps()),
        body,
        mean: features.mean.clone(),
        inverse_deviation: features.inverse_deviation.clone(),
        network: stacked,
    };
    let moving = linear.moving().iter().filter(|m| **m).count();
    Ok(Trained { model, mean_pose: mean_pose.clone(), linear, held_back, training, trained_on, moving })
}

/// For every clip and frame, whether it is held back. Body mechanics and the rest are drawn from apart.
fn hold_back(clips: &[NamedClip], options: &TrainOptions, random: &mut ChaCha8Rng) -> Vec<Vec<bool>> {
    let part = options.hold_out.clamp(0.0, 0.9);
    let mut held: Vec<Vec<bool>> = clips.iter().map(|c| vec![false; c.clip.frames()]).collect();
    if options.split == Split::Sample {
        held.iter_mut().flatten().for_each(|h| *h = random.random_bool(part));
        return held;
    }
    for mechanics in [true, false] {
        let mut groups: Vec<(String, Vec<usize>)> = Vec::new();
        for (index, clip) in clips.iter().enumerate().filter(|(_, c)| c.mechanics == mechanics) {
            let file = clip.name.rsplit(['/', '\\']).next().unwrap_or_default();
            let key = match options.split {
                Split::Subject => file.split('_').next().unwrap_or_default().to_owned(),
                _ => clip.name.clone(),
            };
            match groups.iter_mut().find(|(k, _)| *k == key) {
                Some((_, members)) => members.push(index),
                None => groups.push((key, vec![index])),
            }
        }
        for last in (1..groups.len()).rev() {
            groups.swap(last, random.random_range(0..=last));
        }
        let goal = (part * groups.len() as f64).round() as usize;
        for index in groups.iter().take(goal).flat_map(|(_, members)| members) {
            held[*index].iter_mut().for_each(|h| *h = true);
        }
    }
    held
}

/// Poses less their mean, all by one deviation: squared errors keep their proportions.
struct Scale {
    mean: Vec<f32>,
    deviation: f32,
    /// 2 / range of each component.
    stretch: Vec<f32>,
}

fn column_means(values: &[f32], width: usize) -> Vec<f64> {
    let mut mean = vec![0.0; width];
    let rows = (values.len() / width.max(1)).max(1) as f64;
    for row in values.chunks_exact(width.max(1)) {
        mean.iter_mut().zip(row).for_each(|(mean, x)| *mean += f64::from(*x) / rows);
    }
    mean
}

impl Scale {
    fn of(poses: &[f32], width: usize) -> Self {
        let mean: Vec<f32> = column_means(poses, width).iter().map(|x| *x as f32).collect();
        let mut bounds = vec![(f32::MAX, f32::MIN); width];
        let mut squares = 0.0;
        for row in poses.chunks_exact(width.max(1)) {
            for ((x, mean), (low, high)) in row.iter().zip(&mean).zip(&mut bounds) {
                squares += f64::from(x - mean).powi(2);
                (*low, *high) = (low.min(*x), high.max(*x));
            }
        }
        let deviation = (squares / poses.len().max(1) as f64).sqrt().max(1e-6) as f32;
        let stretch = bounds.iter().map(|(low, high)| if high - low > 1e-3 { 2.0 / (high - low) } else { 0.0 });
        Self { mean, deviation, stretch: stretch.collect() }
    }

    fn normalised(&self, poses: &[f32]) -> Vec<f32> {
        poses.iter().zip(self.mean.iter().cycle()).map(|(x, mean)| (x - mean) / self.deviation).collect()
    }

    fn raw(&self, normalised: &[f32]) -> Vec<f32> {
        normalised.iter().zip(self.mean.iter().cycle()).map(|(x, mean)| x * self.deviation + mean).collect()
    }

    /// Makes a layer that gives normalised poses give poses.
    fn unfold(&self, decoder: &mut Layer) {
        decoder.weights.iter_mut().for_each(|w| *w *= self.deviation);
        decoder.bias.iter_mut().zip(&self.mean).for_each(|(b, mean)| *b = *b * self.deviation + mean);
    }
}

/// Each column to mean 0 and deviation 1.
struct Standard {
    mean: Vec<f32>,
    inverse_deviation: Vec<f32>,
}

impl Standard {
    fn of(values: &[f32], width: usize) -> Self {
        let mean = column_means(values, width);
        let mut squares = vec![0.0; width];
        let rows = (values.len() / width).max(1) as f64;
        for row in values.chunks_exact(width) {
            squares.iter_mut().zip(row).zip(&mean).for_each(|((s, x), m)| *s += (f64::from(*x) - m).powi(2) / rows);
        }
        let inverse = |square: f64| if square > 1e-8 { 1.0 / square.sqrt() } else { 0.0 };
        Self {
            mean: mean.iter().map(|x| *x as f32).collect(),
            inverse_deviation: squares.into_iter().map(|s| inverse(s) as f32).collect(),
        }
    }

    fn apply(&self, values: &[f32]) -> Vec<f32> {
        let columns = self.mean.iter().zip(&self.inverse_deviation).cycle();
        values.iter().zip(columns).map(|(x, (mean, scale))| ((x - mean) * scale).clamp(-6.0, 6.0)).collect()
    }
}

struct Judge<'a> {
    network: &'a Networks,
    scale: &'a Scale,
    features: &'a Standard,
    linear: &'a Linear,
    mean_pose: &'a Vec<f32>,
}

impl Judge<'_> {
    fn figures(&self, pool: &Rows, mechanics: &Rows) -> Figures {
        let normalised = self.scale.normalised(&pool.poses);
        let decoded = self.scale.raw(&self.network.autoencoder.apply(&normalised));
        let [autoencoder_mse, autoencoder_scaled_mse] = self.errors(&decoded, &pool.poses);
        let frames = mechanics.frames();
        let encoder = Network { layers: self.network.autoencoder.layers[..1].to_vec() };
        let codes = encoder.apply(&self.scale.normalised(&mechanics.poses));
        let features = self.features.apply(&mechanics.features);
        let found = self.network.features.apply(&features);
        let squares: f64 = found.iter().zip(&codes).map(|(a, b)| f64::from(a - b).powi(2)).sum();
        let stacked_raw = self.scale.raw(&self.network.stacked_raw.apply(&features));
        let stacked = self.scale.raw(&self.network.stacked.apply(&features));
        let linear: Vec<f32> = features.chunks_exact(FEATURES).flat_map(|f| self.linear.apply(f)).collect();
        let mean = self.mean_pose.repeat(frames);
        let [stacked_mse, stacked_scaled_mse] = self.errors(&stacked, &mechanics.poses);
        let degrees = |poses: &[f32]| mean_angle(poses, &mechanics.poses, &self.linear.moving());
        Figures {
            frames: [pool.frames(), frames],
            autoencoder_mse,
            autoencoder_scaled_mse,
            pool_mean_mse: self.errors(&self.scale.mean.repeat(pool.frames()), &pool.poses),
            feature_mse: squares / codes.len().max(1) as f64,
            stacked_raw_mse: self.errors(&stacked_raw, &mechanics.poses)[0],
            stacked_mse,
            stacked_scaled_mse,
            linear_mse: self.errors(&linear, &mechanics.poses)[0],
            mean_pose_mse: self.errors(&mean, &mechanics.poses)[0],
            geodesic_deg: degrees(&stacked),
            linear_deg: degrees(&linear),
            mean_pose_deg: degrees(&mean),
        }
    }

    /// Mean squared error of the moving joints' components, as they are and stretched.
    fn errors(&self, found: &[f32], wanted: &[f32]) -> [f64; 2] {
        let moving = self.linear.moving();
        let columns = moving.iter().flat_map(|m| [*m; 4]).zip(&self.scale.stretch).collect::<Vec<_>>();
        let (mut plain, mut stretched, mut count) = (0.0, 0.0, 0usize);
        for ((found, wanted), (moves, stretch)) in found.iter().zip(wanted).zip(columns.iter().cycle()) {
            if *moves {
                let error = f64::from(found - wanted);
                plain += error * error;
                stretched += (error * f64::from(**stretch)).powi(2);
                count += 1;
            }
        }
        [plain, stretched].map(|sum| sum / count.max(1) as f64)
    }
}

/// Mean geodesic angle of the moving joints, degrees. Rows of quaternions x, y, z, w; `found` need not be of length one.
pub(super) fn mean_angle(found: &[f32], wanted: &[f32], moving: &[bool]) -> f64 {
    let (mut sum, mut count) = (0.0, 0usize);
    for ((a, b), moves) in found.as_chunks::<4>().0.iter().zip(wanted.as_chunks::<4>().0).zip(moving.iter().cycle()) {
        if *moves {
            sum += angle_between(a, b).to_degrees();
            count += 1;
        }
    }
    sum / count.max(1) as f64
}

/// Geodesic angle of two quaternions, rad, from their difference (accurate for small angles too).
pub(super) fn angle_between(a: &[f32; 4], b: &[f32; 4]) -> f64 {
    let unit = |q: &[f32; 4]| {
        let norm = q.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>().sqrt().max(1e-12);
        q.map(|x| f64::from(x) / norm)
    };
    let (a, b) = (unit(a), unit(b));
    let sign = if a.iter().zip(&b).map(|(a, b)| a * b).sum::<f64>() < 0.0 { -1.0 } else { 1.0 };
    let squares = |s: f64| a.iter().zip(&b).map(|(a, b)| (a + s * b).powi(2)).sum::<f64>().sqrt();
    4.0 * squares(-sign).atan2(squares(sign))
}
