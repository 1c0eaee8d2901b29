//! From two clips to a model.

use faer::Mat;
use kinesic::Pack;
use kinesic::model::LoadError;

use super::count::{Choice, choose_kept, fits, kept};
use super::factor::{Factors, column, column_mut, flat, unflat};
use super::learn::{Learned, Optimiser, learn, noise};
use super::matrix::{FRAME_RATE, Motion};
use super::measure::{content_distance, style_distance};
use super::model::ComponentsModel;
use super::objective::{Objective, Terms, Weights};
use super::play::{Settings, play, play_stored};
use super::sparse::{Sparse, Sparsity};
use crate::align::{AlignError, Ends};
use crate::clip::Clip;
use crate::measure::{Degrees, Measurable, compare};
use crate::pack::{PackFile, Provenance};
use crate::plausible::{Bounds, Plausible};
use crate::rig::{HostFrame, Rig};
use crate::step_cache::{StepCache, Unreadable};

/// Largest strength that is tried.
const LIMIT: f64 = 2.0;

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
    /// The clips cannot be compared.
    #[error(transparent)]
    Align(#[from] AlignError),
    /// The device's code refuses the model.
    #[error("the device refuses the model: {0}")]
    Refused(#[from] LoadError),
    /// A checkpoint whose steps are none of this training.
    #[error(transparent)]
    Checkpoint(#[from] Unreadable),
}

/// A model and how it came about.
#[derive(Clone, Debug)]
pub struct Trained {
    /// The model.
    pub model: ComponentsModel,
    /// Strengths that are plausible, and what ends them.
    pub strengths: Plausible,
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
    /// `|Gram(C_S) - Gram(C_C)| / |Gram(C_S)|`: doing nothing.
    pub style_distance_before: f64,
    /// `|C_C - C_X| / |C_C|`.
    pub content_distance: f64,
    /// From the content to the style, over frames matched by dynamic time warping.
    pub degrees_before: Degrees,
    /// From the stored stream at strength 1 to the style, matched alike.
    pub degrees_after: Degrees,
}

/// Learns components of `style` for the motion of `content`, both on `rig` at [`FRAME_RATE`]. `rig` should be
/// [centred](Rig::centred) on both: its coordinates are what is learned.
pub fn train(
    rig: &Rig,
    content: &Clip,
    style: &Clip,
    name: &str,
    options: &TrainOptions,
) -> Result<Trained, TrainError> {
    train_kept(rig, content, style, name, options, &StepCache::nothing())
}

/// The same; every factorisation and the learned components are kept in `cache`, and taken from there where they are known.
pub fn train_kept(
    rig: &Rig,
    content: &Clip,
    style: &Clip,
    name: &str,
    options: &TrainOptions,
    cache: &StepCache,
) -> Result<Trained, TrainError> {
    check(options)?;
    let [locals, style_locals] = [content, style].map(|clip| rig.locals_of(clip));
    let clips = [content, style];
    let content = Motion::new(rig, &locals);
    let other = Motion::scaled(rig, &style_locals, content.deviation);
    for (which, motion) in [("content", &content), ("style", &other)] {
        if motion.values.squared_norm_l2() <= 1e-9 {
            return Err(TrainError::Still { which });
        }
    }
    cache.check(|name, result| match name.split_once(' ') {
        Some(("content", count)) => fits(&content, count, result),
        Some(("style", count)) => fits(&other, count, result),
        _ => result.iter().all(|x| x.is_finite()),
    })?;
    let most = content.channels().min(content.frames()).min(super::play::MAX_COMPONENTS);
    let (choice, own) = match options.count {
        None => choose_kept(&content, &options.sparsity, cache),
        Some(count) if count == 0 || count > most => return Err(TrainError::Count { found: count, most }),
        Some(count) => {
            let choice = Choice { count, reason: "as asked for".to_owned(), tried: Vec::new() };
            (choice, kept(&content, count, &options.sparsity, cache, "content"))
        }
    };
    let wanted = kept(&other, choice.count.min(other.frames()), &options.sparsity, cache, "style");
    let shift: Vec<f64> = content.mean.iter().zip(&other.mean).map(|(a, b)| options.posture * (b - a)).collect();
    let objective = Objective::new(&own.factors, &wanted.factors, options.weights);
    let start = || start(&own.factors, &wanted.factors, options.optimiser.seed);
    let needed = 4 + content.channels() * choice.count;
    cache.check(|name, result| !name.starts_with("learn") || result.len() >= needed)?;
    let learned = learned(&objective, start, &options.optimiser, cache, "learn");
    let mut model = ComponentsModel {
        style: name.to_owned(),
        frame_rate: FRAME_RATE,
        mean: content.mean.clone(),
        shift,
        scale: content.scale.clone(),
        content: own.factors.clone(),
        learned: learned.components.clone(),
        track: track(&rig.frames_of(clips[0])),
        strength: [0.0, 1.0],
    };
    let file = PackFile::from_bytes(&model.pack(rig, &Provenance::default()));
    let strengths = plausible(&file.pack()?, rig, clips)?;
    model.strength = strengths.range();
    let result = play_stored(&file.pack()?, rig, &Settings::default())?;
    let target = Measurable::new(rig, clips[1]);
    let to_style =
        |clip: &Clip| compare(rig, &Measurable::new(rig, clip), &target, Ends::Closed).map(|distance| distance.degrees);
    Ok(Trained {
        reconstruction_error: own.factors.error(content.values.as_ref()),
        style_distance: style_distance(&wanted.factors.components, &learned.components),
        style_distance_before: style_distance(&wanted.factors.components, &own.factors.components),
        content_distance: content_distance(&own.factors.components, &learned.components),
        degrees_before: to_style(clips[0])?,
        degrees_after: to_style(&result)?,
        model,
        strengths,
        choice,
        content: own,
        style: wanted,
        learned,
    })
}

/// Noise where the content or the style moves, 0 elsewhere: a channel that neither moves stays as it is, travel above all.
fn start(content: &Factors, style: &Factors, seed: u64) -> Mat<f64> {
    let mut start = noise(content.components.nrows(), content.count(), seed);
    let moves = |of: &Factors, c: usize| (0..of.count()).any(|k| column(&of.components, k)[c] != 0.0);
    for c in (0..start.nrows()).filter(|c| !moves(content, *c) && !moves(style, *c)) {
        (0..start.ncols()).for_each(|k| column_mut(&mut start, k)[c] = 0.0);
    }
    start
}

/// [`learn`] from `start`, or what an earlier run has learned.
fn learned(
    objective: &Objective,
    start: impl FnOnce() -> Mat<f64>,
    optimiser: &Optimiser,
    cache: &StepCache,
    name: &str,
) -> Learned {
    let found = cache.always(name, || {
        let Learned { components, history, terms } = learn(objective, start(), optimiser);
        let Terms { content, style, smooth } = terms;
        let head = [components.nrows() as f64, components.ncols() as f64, content, style, smooth];
        [&head[..], &flat(&components), &history].concat()
    });
    let (head, rest) = found.split_first_chunk().map_or(([0.0; 5], &[][..]), |(head, rest)| (*head, rest));
    let [rows, columns, content, style, smooth] = head;
    let (components, history) = rest.split_at(rows as usize * columns as usize);
    let terms = Terms { content, style, smooth };
    Learned { components: unflat(components, columns as usize), history: history.to_vec(), terms }
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
}

/// The trade-off curve of a trained pair over `weights`; every point starts from the same noise.
pub fn trade_off(trained: &Trained, options: &TrainOptions, weights: &[f64], cache: &StepCache) -> Vec<TradeOff> {
    let (content, wanted) = (&trained.content.factors, &trained.style.factors);
    let point = |style: &f64| {
        let objective = Objective::new(content, wanted, Weights { style: *style, ..options.weights });
        let start = || start(content, wanted, options.optimiser.seed);
        let learned = learned(&objective, start, &options.optimiser, cache, &format!("learn with {style}")).components;
        TradeOff {
            style_weight: *style,
            style_distance: style_distance(&wanted.components, &learned),
            content_distance: content_distance(&content.components, &learned),
        }
    };
    weights.iter().map(point).collect()
}

/// Coordinates `mean + strength shift + W (C_C + strength (C_X - C_C))`, row-major `[frames x 3 rows]`.
pub fn composed(model: &ComponentsModel, strength: f64) -> Vec<f64> {
    let components = &model.content.components * faer::Scale(1.0 - strength) + &model.learned * faer::Scale(strength);
    let values = Factors { weights: model.content.weights.clone(), components }.product();
    let at = |f: usize, c: usize| model.mean[c] + strength * model.shift[c] + model.scale[c] * values[(f, c)];
    (0..values.nrows()).flat_map(|f| (0..values.ncols()).map(move |c| (f, c))).map(|(f, c)| at(f, c)).collect()
}

fn check(options: &TrainOptions) -> Result<(), TrainError> {
    let Weights { content, style, smooth } = options.weights;
    let settings = [
        ("the content weight", content),
        ("the style weight", style),
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

/// Strengths at which the stored stream and the content, restyled live, stay within what both clips do.
fn plausible(pack: &Pack, rig: &Rig, [content, style]: [&Clip; 2]) -> Result<Plausible, LoadError> {
    let bounds = Bounds::new(rig, std::iter::once(content), std::iter::once(style));
    let played = |strength: f64| {
        let mut settings = Settings::default();
        settings.controls.strength = strength as f32;
        Ok(vec![play_stored(pack, rig, &settings)?, play(pack, rig, content, &settings)?])
    };
    bounds.largest(rig, LIMIT, played)
}

/// Path of the content: travel in the heading's axes and turn, since the frame before.
fn track(frames: &[HostFrame]) -> Vec<[f32; 4]> {
    let before = frames.iter().take(1).chain(frames);
    let step = |(frame, before): (&HostFrame, &HostFrame)| {
        let ([x, _, z], [sin, cos]) = (frame.rows[0], frame.heading.turn_from(before.heading));
        [x, z, sin, cos]
    };
    frames.iter().zip(before).map(step).collect()
}
