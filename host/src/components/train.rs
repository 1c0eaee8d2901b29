//! From two clips to a model.

use kinesic::pose::{Heading, World, forward};

use super::count::{Choice, choose_kept, fits, kept};
use super::factor::{Factors, flat, unflat};
use super::learn::{Learned, Optimiser, learn, noise};
use super::matrix::{FRAME_RATE, Motion};
use super::measure::{BoneError, bone_error, content_distance, style_distance};
use super::model::ComponentsModel;
use super::objective::{Bone, Objective, Terms, Weights, bones};
use super::sparse::{Sparse, Sparsity};
use crate::clip::Clip;
use crate::reached::{Reached, Unreadable};
use crate::rig::{MAX_JOINTS, Rig};

/// Mean bone error, percent, up to which an exaggerated strength counts as plausible before the bones are restored.
const PLAUSIBLE: f64 = 5.0;

/// What to train.
#[derive(Clone, Debug)]
pub struct TrainOptions {
    /// Number of components; `None`: chosen from the content clip.
    pub count: Option<usize>,
    /// The factorisation.
    pub sparsity: Sparsity,
    /// Weights of style learning.
    pub weights: Weights,
    /// The descent of style learning.
    pub optimiser: Optimiser,
    /// How much of the difference of the mean poses belongs to the style: 1 takes over a stoop, 0 (the paper) leaves it.
    pub posture: f64,
}

impl Default for TrainOptions {
    fn default() -> Self {
        Self {
            count: None,
            sparsity: Sparsity::default(),
            weights: Weights::default(),
            optimiser: Optimiser::default(),
            posture: 1.0,
        }
    }
}

/// Why there is no model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrainError {
    /// The number of components is out of range.
    #[error(
        "{found} components: expected 1 to {most}, the channels of the content clip or the frames, whichever are fewer"
    )]
    Count {
        /// What was asked for.
        found: usize,
        /// The largest number that makes sense.
        most: usize,
    },
    /// A weight or a share is not a number, or negative.
    #[error("{name} is {found}: expected a finite number from 0 up")]
    Setting {
        /// Which.
        name: &'static str,
        /// Its value.
        found: f64,
    },
    /// Not a share.
    #[error("the density is {found}: expected a share from 0 to 1")]
    Density {
        /// Its value.
        found: f64,
    },
    /// A clip in which nothing moves has no components.
    #[error("the {which} clip does not move: choose one with motion in it")]
    Still {
        /// `content` or `style`.
        which: &'static str,
    },
    /// A checkpoint whose steps are none of this training.
    #[error(transparent)]
    Checkpoint(#[from] Unreadable),
}

/// A model and how it came about.
#[derive(Clone, Debug)]
pub struct Trained {
    /// The model.
    pub model: ComponentsModel,
    /// Number of components, and why.
    pub choice: Choice,
    /// Sparse components of the content.
    pub content: Sparse,
    /// Sparse components of the style, in the content's deviations.
    pub style: Sparse,
    /// The style learning.
    pub learned: Learned,
    /// `|M - W C| / |M|` of the content.
    pub reconstruction_error: f64,
    /// `|Gram(C_S) - Gram(C_X)| / |Gram(C_S)|`.
    pub style_distance: f64,
    /// `|C_C - C_X| / |C_C|`.
    pub content_distance: f64,
    /// Of `mean + W C_X`, before the device restores the bones.
    pub composed_bones: BoneError,
}

/// Learns components of `style` for the motion of `content`, both on `rig` at [`FRAME_RATE`].
pub fn train(
    rig: &Rig,
    content: &Clip,
    style: &Clip,
    name: &str,
    options: &TrainOptions,
) -> Result<Trained, TrainError> {
    train_kept(rig, content, style, name, options, &Reached::nothing())
}

/// The same; every factorisation and the learned components are kept in `reached`, and taken from there where they are known.
pub fn train_kept(
    rig: &Rig,
    content: &Clip,
    style: &Clip,
    name: &str,
    options: &TrainOptions,
    reached: &Reached,
) -> Result<Trained, TrainError> {
    check(options)?;
    let poses = rig.poses(content);
    let content = Motion::new(&rig.locals(&poses));
    let other = Motion::scaled(&rig.locals(&rig.poses(style)), content.scale);
    for (which, motion) in [("content", &content), ("style", &other)] {
        if motion.values.squared_norm_l2() <= 1e-9 {
            return Err(TrainError::Still { which });
        }
    }
    reached.check(|name, result| match name.split_once(' ') {
        Some(("content", count)) => fits(&content, count, result),
        Some(("style", count)) => fits(&other, count, result),
        _ => result.iter().all(|x| x.is_finite()),
    })?;
    let most = content.channels().min(content.frames()).min(super::play::MAX_COMPONENTS);
    let (choice, own) = match options.count {
        None => choose_kept(&content, &options.sparsity, reached),
        Some(count) if count == 0 || count > most => return Err(TrainError::Count { found: count, most }),
        Some(count) => {
            let choice = Choice { count, reason: "as asked for".to_owned(), tried: Vec::new() };
            (choice, kept(&content, count, &options.sparsity, reached, "content"))
        }
    };
    let wanted = kept(&other, choice.count.min(other.frames()), &options.sparsity, reached, "style");
    let bones = bones(rig);
    let shift: Vec<f64> = content.mean.iter().zip(&other.mean).map(|(a, b)| options.posture * (b - a)).collect();
    let mean: Vec<f64> = content.mean.iter().zip(&shift).map(|(a, b)| a + b).collect();
    let objective = Objective::new(&own.factors, &wanted.factors, &bones, &mean, content.scale, options.weights);
    let needed = 4 + content.channels() * choice.count;
    reached.check(|name, result| !name.starts_with("learn") || result.len() >= needed)?;
    let learned = learned(&objective, content.channels(), choice.count, &options.optimiser, reached, "learn");
    let mut model = ComponentsModel {
        style: name.to_owned(),
        frame_rate: FRAME_RATE,
        mean: content.mean.clone(),
        shift,
        scale: content.scale,
        content: own.factors.clone(),
        learned: learned.components.clone(),
        track: track(rig, &poses),
        reference: reference(rig, &poses, &content),
        strength: [0.0, 1.0],
    };
    let composed_bones = bone_error(&composed(&model, 1.0), content.channels(), &bones);
    model.strength[1] = safe_strength(&model, &bones);
    Ok(Trained {
        reconstruction_error: own.factors.error(content.values.as_ref()),
        style_distance: style_distance(&wanted.factors.components, &learned.components),
        content_distance: content_distance(&own.factors.components, &learned.components),
        composed_bones,
        model,
        choice,
        content: own,
        style: wanted,
        learned,
    })
}

/// [`learn`] from noise, or what an earlier run has learned.
fn learned(
    objective: &Objective,
    channels: usize,
    count: usize,
    optimiser: &Optimiser,
    reached: &Reached,
    name: &str,
) -> Learned {
    let found = reached.always(name, || {
        let Learned { components, history, terms } =
            learn(objective, noise(channels, count, optimiser.seed), optimiser);
        let Terms { content, style, bones, smooth } = terms;
        [&[content, style, bones, smooth][..], &flat(&components), &history].concat()
    });
    let (terms, rest) = found.split_first_chunk().map_or(([0.0; 4], &[][..]), |(terms, rest)| (*terms, rest));
    let [content, style, bones, smooth] = terms;
    let (components, history) = rest.split_at(channels * count);
    let terms = Terms { content, style, bones, smooth };
    Learned { components: unflat(components, count), history: history.to_vec(), terms }
}

/// What training ends at for each weight of the style, content weight 1: the trade-off that the paper sets by hand.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct TradeOff {
    /// Weight `s`.
    pub style_weight: f64,
    /// `|Gram(C_S) - Gram(C_X)| / |Gram(C_S)|`.
    pub style_distance: f64,
    /// `|C_C - C_X| / |C_C|`.
    pub content_distance: f64,
    /// Of `mean + W C_X`.
    pub bone_error_mean_percent: f64,
}

/// The trade-off curve of a trained pair over `weights`; every point starts from the same noise.
pub fn trade_off(
    rig: &Rig,
    trained: &Trained,
    options: &TrainOptions,
    weights: &[f64],
    reached: &Reached,
) -> Vec<TradeOff> {
    let bones = bones(rig);
    let model = &trained.model;
    let mean: Vec<f64> = model.mean.iter().zip(&model.shift).map(|(a, b)| a + b).collect();
    let point = |style: &f64| {
        let weights = Weights { style: *style, ..options.weights };
        let objective =
            Objective::new(&trained.content.factors, &trained.style.factors, &bones, &mean, model.scale, weights);
        let (count, step) = (trained.choice.count, format!("learn with {style}"));
        let learned = learned(&objective, mean.len(), count, &options.optimiser, reached, &step).components;
        let model = ComponentsModel { learned, ..model.clone() };
        TradeOff {
            style_weight: *style,
            style_distance: style_distance(&trained.style.factors.components, &model.learned),
            content_distance: content_distance(&trained.content.factors.components, &model.learned),
            bone_error_mean_percent: bone_error(&composed(&model, 1.0), mean.len(), &bones).mean_percent,
        }
    };
    weights.iter().map(point).collect()
}

/// Positions `mean + strength shift + W (C_C + strength (C_X - C_C))` before the bones are restored, m,
/// row-major `[frames x 3 joints]`.
pub fn composed(model: &ComponentsModel, strength: f64) -> Vec<f64> {
    let components = &model.content.components * faer::Scale(1.0 - strength) + &model.learned * faer::Scale(strength);
    let values = Factors { weights: model.content.weights.clone(), components }.product();
    let at = |f: usize, c: usize| model.mean[c] + strength * model.shift[c] + model.scale * values[(f, c)];
    (0..values.nrows()).flat_map(|f| (0..values.ncols()).map(move |c| (f, c))).map(|(f, c)| at(f, c)).collect()
}

fn check(options: &TrainOptions) -> Result<(), TrainError> {
    let Weights { content, style, bones, smooth } = options.weights;
    let settings = [
        ("the content weight", content),
        ("the style weight", style),
        ("the bone weight", bones),
        ("the smoothness weight", smooth),
        ("the sparsity", options.sparsity.penalty),
        ("the posture", options.posture),
    ];
    if let Some(found) = options.sparsity.density.filter(|density| !(0.0..=1.0).contains(density)) {
        return Err(TrainError::Density { found });
    }
    match settings.into_iter().find(|(_, value)| !(value.is_finite() && *value >= 0.0)) {
        Some((name, found)) => Err(TrainError::Setting { name, found }),
        None => Ok(()),
    }
}

/// The largest strength of 1, 1.25, ... 2 at which the composed bones stay plausible.
fn safe_strength(model: &ComponentsModel, bones: &[Bone]) -> f64 {
    let plausible =
        |strength: &f64| bone_error(&composed(model, *strength), model.mean.len(), bones).mean_percent < PLAUSIBLE;
    [1.25, 1.5, 1.75, 2.0].into_iter().take_while(plausible).last().unwrap_or(1.0)
}

/// Path of the content: travel in the heading's axes and turn, since the frame before.
fn track(rig: &Rig, poses: &[kinesic::Pose<MAX_JOINTS>]) -> Vec<[f32; 4]> {
    let mut track = Vec::with_capacity(poses.len());
    let mut world = World::<MAX_JOINTS>::identity();
    let mut before: Option<(Heading, nalgebra::Vector3<f32>)> = None;
    for pose in poses {
        forward(&rig.device(), pose, &mut world);
        let (last, root) = before.unwrap_or_else(|| (Heading::default().follow(&rig.device(), &world), pose.root));
        let heading = last.follow(&rig.device(), &world);
        let travel = heading.to_local(pose.root - root);
        let [sin, cos] = heading.turn_from(last);
        track.push([travel.x, travel.z, sin, cos]);
        before = Some((heading, pose.root));
    }
    track
}

/// The pose nearest to the mean, facing +Z.
fn reference(rig: &Rig, poses: &[kinesic::Pose<MAX_JOINTS>], content: &Motion) -> Vec<[f32; 4]> {
    let distance = |f: usize| content.values.row(f).squared_norm_l2();
    let nearest = (0..poses.len()).min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(0);
    let Some(pose) = poses.get(nearest) else { return vec![[0.0, 0.0, 0.0, 1.0]; rig.joints()] };
    let mut world = World::<MAX_JOINTS>::identity();
    forward(&rig.device(), pose, &mut world);
    let heading = Heading::default().follow(&rig.device(), &world);
    let mut rotations: Vec<[f32; 4]> = pose.rotations[..rig.joints()].iter().map(|q| q.coords.into()).collect();
    rotations[0] = (heading.rotation().inverse() * pose.rotations[0]).coords.into();
    rotations
}
