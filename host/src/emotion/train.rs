//! From labelled clips to a model.

use rayon::prelude::*;

use super::coordinates::{self, at_frames, levers, of_frames};
use super::features::Projection;
use super::keyframes::{Curve, Keyframes};
use super::model::{Attribute, EmotionModel, Reading};
use super::motions::{Example, Motion, features, motions, pairs, takes};
use super::play::{Settings, Strengths, play};
use super::segment::{Cut, FRAME_RATE, Segment};
use super::{MAX_KEYS, MAX_WIDTH};
use crate::clip::Clip;
use crate::learn::samples::add_scaled;
use crate::learn::{RankOptions, RegressOptions, Samples, choose_cost, rank, regress};
use crate::pack::{PackFile, Provenance};
use crate::plausible::Bounds;
use crate::rig::{Rig, RigError};
use crate::vector::line;
use kinesic::model::ATTRIBUTES;

/// Share of the training motions that lies below and above the plausible strengths and durations.
const OUTSIDE: f64 = 0.01;
/// Durations may leave the training motions' by this factor: what is synthesised may be slower than all of them.
const MARGIN: f64 = 1.5;
/// Fewer motions teach nothing.
const MOTIONS: usize = 4;

/// What to train.
#[derive(Clone, Debug)]
pub struct TrainOptions {
    /// Keyframes of a motion; the paper has 13.
    pub keyframes: usize,
    /// Principal components of a keyframe; the paper has 40 and 80.
    pub components: usize,
    /// Hidden units of the network; the paper has 10, for a thousand motions. With a few dozen, fewer follow what is asked better:
    /// docs/emotion.md.
    pub hidden: usize,
    /// How clips are cut; `None`: cycles if nearly all are gaits.
    pub cut: Option<Cut>,
    /// Seed of the network's start.
    pub seed: u64,
}

impl Default for TrainOptions {
    fn default() -> Self {
        Self { keyframes: 13, components: 40, hidden: 3, cut: None, seed: 1 }
    }
}

/// Why there is no model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrainError {
    /// An option out of its range.
    #[error("{found} {what}: expected {least} to {most}; the paper has {paper}")]
    Option {
        /// Which option.
        what: &'static str,
        /// What was asked for.
        found: usize,
        /// Least that makes sense.
        least: usize,
        /// Most that the host plays.
        most: usize,
        /// What the paper has.
        paper: &'static str,
    },
    /// The wrong number of attributes.
    #[error("{found} attributes: expected 1 to {ATTRIBUTES}")]
    Attributes {
        /// How many were asked for.
        found: usize,
    },
    /// Too few motions.
    #[error(
        "{found} motions of at least {keyframes} frames at {FRAME_RATE} fps in {clips} clips: expected at least {MOTIONS}. {hint}"
    )]
    Few {
        /// Motions found.
        found: usize,
        /// Frames that each must have.
        keyframes: usize,
        /// Clips looked at.
        clips: usize,
        /// What to do.
        hint: &'static str,
    },
    /// No two motions differ in an attribute.
    #[error("no two motions of one group differ in {attribute:?}: nothing shows more or less of it")]
    Alike {
        /// Which attribute.
        attribute: String,
    },
    /// The device's code refuses the model.
    #[error("the device refuses the model: {0}")]
    Refused(#[from] RigError),
    /// The motions have nothing to do with the labels.
    #[error("the scores do not rise with {attribute:?}: the labels may be in the wrong column or order")]
    Unrelated {
        /// Which attribute.
        attribute: String,
    },
}

/// A model and how it came about.
#[derive(Clone, Debug)]
pub struct Trained {
    /// The model.
    pub model: EmotionModel,
    /// The rig of its pack: coordinates about the mean of the motions.
    pub rig: Rig,
    /// How clips were cut.
    pub cut: Cut,
    /// Motions of each example.
    pub motions: Vec<usize>,
    /// Root mean square distance of a joint from the spline through the keyframes, m.
    pub keyframe_error: f64,
    /// Share of the variance of coordinates and velocities, times levers, that the components hold.
    pub explained: f64,
    /// Cost and held-out pair accuracy of each ranking function.
    pub rankings: Vec<Ranking>,
    /// Root mean square distance of a joint at a keyframe between the network's motion and the training motions, m.
    pub network_error: f64,
    /// Choices that the training made, one sentence each.
    pub notes: Vec<String>,
}

/// How a ranking function was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranking {
    /// Ordered pairs of training motions.
    pub ordered: usize,
    /// Similar pairs.
    pub similar: usize,
    /// Chosen cost.
    pub cost: f64,
    /// Pair accuracy on takes that were held back while the cost was chosen.
    pub validation: f64,
}

/// Learns how strongly motions show the `attributes` of the examples, and how a motion looks at every strength.
pub fn train(
    rig: &Rig,
    motion: &str,
    attributes: &[String],
    examples: &[Example],
    options: &TrainOptions,
) -> Result<Trained, TrainError> {
    check(attributes, options)?;
    let mut notes = Vec::new();
    let cut = options.cut.unwrap_or_else(|| {
        let cut = Cut::suggested(rig, examples.iter().map(|example| &example.clip));
        notes.push(match cut {
            Cut::Cycles => {
                "nearly all clips are gaits: every stride is a motion, and what is synthesised goes on for ever".into()
            }
            Cut::Whole => "not all clips are gaits: every clip is one motion".into(),
        });
        cut
    });
    let all = motions(rig, examples, cut);
    let segments: Vec<&Segment> = all.iter().map(|motion| &motion.segment).collect();
    let long = segments.iter().filter(|segment| segment.frames() >= options.keyframes).count();
    if long < MOTIONS {
        let hint = match cut {
            Cut::Cycles => "A gait needs whole strides; for what is no gait, cut whole clips",
            Cut::Whole => "Label more clips",
        };
        return Err(TrainError::Few { found: long, keyframes: options.keyframes, clips: examples.len(), hint });
    }
    let keyframes = Keyframes::learn(rig, &segments, options.keyframes);
    let (motions, rows) = features(all, &keyframes);
    let counts: Vec<usize> =
        examples.iter().map(|e| motions.iter().filter(|motion| std::ptr::eq(motion.example, e)).count()).collect();
    for (example, _) in examples.iter().zip(&counts).filter(|(_, count)| **count == 0) {
        notes.push(format!("{}: no whole stride of {} frames, left out", example.name, options.keyframes));
    }
    let projection = Projection::learn(&Samples::new(&rows, 6 * rig.joints()), options.components);
    let projected = projection.coordinates(&rows);
    let samples = Samples::new(&projected, options.keyframes * projection.count());
    let found: Vec<(Ranking, Scale)> = (0..attributes.len())
        .into_par_iter()
        .map(|attribute| ranking(&samples, &motions, attribute, &attributes[attribute]))
        .collect::<Result<_, _>>()?;
    let (rankings, scales): (Vec<Ranking>, Vec<Scale>) = found.into_iter().unzip();
    let strengths: Vec<f64> = samples.iter().flat_map(|row| scales.iter().map(|scale| scale.strength(row))).collect();
    let inputs = Samples::new(&strengths, attributes.len());

    let material = Material::new(rig, &motions, &keyframes);
    let made = Projection::learn(&Samples::new(&material.rows, 2 * material.levers.len()), options.components);
    let targets = made.coordinates(&material.rows);
    let settings = RegressOptions { hidden: options.hidden, seed: options.seed, ..RegressOptions::default() };
    let network = regress(&inputs, &Samples::new(&targets, options.keyframes * made.count()), &settings).network;

    let columns = |attribute: usize| inputs.iter().map(move |row| row[attribute]).collect::<Vec<f64>>();
    let plain = |values: Vec<f64>| quantiles(values).map(|x| x as f32);
    let back = material.back(made.scale);
    let model = EmotionModel {
        motion: motion.to_owned(),
        frame_rate: FRAME_RATE as f32,
        attributes: attributes
            .iter()
            .enumerate()
            .map(|(index, name)| Attribute { name: name.clone(), strength: plain(columns(index)) })
            .collect(),
        keyframes: options.keyframes,
        cycle: cut == Cut::Cycles,
        duration: durations(&motions, &keyframes),
        // Row-major [2 channels x D]: a component a column.
        basis: (back.iter().enumerate())
            .flat_map(|(c, back)| {
                made.components.chunks_exact(made.mean.len()).map(move |component| component[c] * back)
            })
            .collect(),
        mean: made.mean.iter().zip(material.back(1.0)).map(|(mean, back)| mean * back).collect(),
        reading: Reading {
            parts: keyframes.parts.clone(),
            postures: keyframes.postures.clone(),
            rank: scales.iter().flat_map(|scale| scale.of_features(&projection).0).collect(),
            bias: scales.iter().map(|scale| scale.of_features(&projection).1).collect(),
        },
        levers: material.levers.clone(),
        network,
    };
    notes.extend(broken_at(&model, &material.rig, &motions)?);
    Ok(Trained {
        keyframe_error: keyframe_error(&motions, &keyframes),
        network_error: material.error(&made, &model, &inputs),
        explained: made.explained,
        motions: counts,
        rig: material.rig,
        cut,
        rankings,
        notes,
        model,
    })
}

fn check(attributes: &[String], options: &TrainOptions) -> Result<(), TrainError> {
    if attributes.is_empty() || attributes.len() > ATTRIBUTES {
        return Err(TrainError::Attributes { found: attributes.len() });
    }
    let hidden = MAX_WIDTH - attributes.len();
    for (what, found, least, most, paper) in [
        ("keyframes", options.keyframes, 3, MAX_KEYS, "13"),
        ("components", options.components, 1, MAX_WIDTH, "40 and 80"),
        ("hidden units", options.hidden, 1, hidden, "10"),
    ] {
        if !(least..=most).contains(&found) {
            return Err(TrainError::Option { what, found, least, most, paper });
        }
    }
    Ok(())
}

/// A ranking function in units of the levels: a motion of level `l` scores `l` on average.
struct Scale {
    weights: Vec<f64>,
    bias: f64,
}

impl Scale {
    fn strength(&self, coordinates: &[f64]) -> f64 {
        self.bias + crate::vector::dot(&self.weights, coordinates)
    }

    /// The same function of the features themselves: weights and constant.
    fn of_features(&self, projection: &Projection) -> (Vec<f64>, f64) {
        let (width, half) = (projection.mean.len(), projection.mean.len() / 2);
        let (mut weights, mut bias) = (Vec::new(), self.bias);
        for row in self.weights.chunks_exact(projection.count()) {
            let mut key = vec![0.0; width];
            for (w, component) in row.iter().zip(projection.components.chunks_exact(width)) {
                add_scaled(&mut key, *w, component);
            }
            key[half..].iter_mut().for_each(|w| *w /= projection.scale);
            bias -= crate::vector::dot(&key, &projection.mean);
            weights.extend(key);
        }
        (weights, bias)
    }
}

/// What the network learns to make: coordinates of the motions on a rig about their mean.
struct Material {
    rig: Rig,
    levers: Vec<f64>,
    /// `[motions x (keyframes x 2 channels)]`: see [`at_frames`].
    rows: Vec<f64>,
}

impl Material {
    fn new(rig: &Rig, motions: &[Motion], keyframes: &Keyframes) -> Self {
        let clip =
            |Motion { example, segment }: &Motion| example.clip.slice(segment.start..segment.start + segment.frames());
        let clips: Vec<Clip> = motions.par_iter().map(clip).collect();
        let poses: Vec<_> = clips.par_iter().map(|clip| rig.poses(clip)).collect();
        let rig = rig.centred(&poses.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let levers = levers(&rig);
        let row = |(motion, clip): (&Motion, &Clip)| {
            let frames = keyframes.find(&motion.segment).unwrap_or_default();
            at_frames(&of_frames(&rig, &rig.frames_of(clip)), &levers, &frames, motion.segment.frame_time)
        };
        let rows = motions.par_iter().zip(&clips).flat_map_iter(row).collect();
        Self { rows, levers, rig }
    }

    /// What makes keyframes of scaled ones: by levers, of velocities by their scale.
    fn back(&self, scale: f64) -> Vec<f64> {
        let velocities = self.levers.iter().map(|_| scale);
        self.levers.iter().map(|lever| 1.0 / lever).chain(velocities).collect()
    }

    /// Root mean square distance of a joint at a keyframe between the network's motion and the motions, m.
    fn error(&self, projection: &Projection, model: &EmotionModel, inputs: &Samples) -> f64 {
        let channels = self.levers.len();
        let positions = |keyframes: &[f64]| {
            let keys = keyframes.chunks_exact(2 * channels);
            let rows: Vec<f64> =
                keys.flat_map(|key| key.iter().zip(&self.levers).map(|(x, lever)| x / lever)).collect();
            coordinates::positions(&self.rig, &rows)
        };
        let motions = self.rows.chunks_exact(model.keyframes * 2 * channels);
        let all: Vec<[f64; 2]> = inputs
            .iter()
            .zip(motions)
            .map(|(strength, real)| {
                let (made, real) = (positions(&projection.features(&model.network.apply(strength))), positions(real));
                let squares = made.iter().zip(&real).map(|(a, b)| (a - b) * (a - b)).sum();
                [squares, (real.len() / 3) as f64]
            })
            .collect();
        let sum = |of: usize| all.iter().map(|x| x[of]).sum::<f64>();
        (sum(0) / sum(1).max(1.0)).sqrt()
    }
}

fn ranking(
    samples: &Samples,
    motions: &[Motion],
    attribute: usize,
    name: &str,
) -> Result<(Ranking, Scale), TrainError> {
    let pairs = pairs(motions, attribute);
    if pairs.ordered.is_empty() {
        return Err(TrainError::Alike { attribute: name.to_owned() });
    }
    let mut options = RankOptions::default();
    let choice = choose_cost(samples, &pairs, &takes(motions), &options);
    options.cost = choice.cost;
    let ranked = rank(samples, &pairs, &options, &[]);
    let scores = ranked.scores(samples);
    let levels = motions.iter().map(|motion| motion.example.levels[attribute]);
    let points: Vec<(f64, f64)> = levels.zip(scores).filter_map(|(level, score)| Some((level?, score))).collect();
    let unrelated = || TrainError::Unrelated { attribute: name.to_owned() };
    let (offset, slope) = line(&points).filter(|(_, slope)| *slope > 1e-9).ok_or_else(unrelated)?;
    let weights = ranked.weights.iter().map(|w| w / slope).collect();
    let ranking = Ranking {
        ordered: pairs.ordered.len(),
        similar: pairs.similar.len(),
        cost: choice.cost,
        validation: choice.accuracy,
    };
    Ok((ranking, Scale { weights, bias: -offset / slope }))
}

/// What nearly all values lie between; never an empty range.
fn quantiles(mut values: Vec<f64>) -> [f64; 2] {
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1) as f64;
    let [low, high] =
        [OUTSIDE, 1.0 - OUTSIDE].map(|share| values.get((share * last).round() as usize).copied().unwrap_or_default());
    if high - low > 1e-3 { [low, high] } else { [low - 1e-3, high + 1e-3] }
}

/// Plays five strengths of every range, the other attributes in the middle of theirs, and says at which the motion leaves what the training motions
/// do. The range stays that of the recordings: a dial goes as far as they went.
fn broken_at(model: &EmotionModel, rig: &Rig, motions: &[Motion]) -> Result<Vec<String>, RigError> {
    let clip = |motion: &Motion| {
        let start = motion.segment.start;
        motion.example.clip.slice(start..start + motion.segment.frames())
    };
    let clips: Vec<Clip> = motions.iter().map(clip).collect();
    let bounds = Bounds::new(rig, clips.iter(), std::iter::empty());
    let file = PackFile::from_bytes(&model.pack(rig, &Provenance::default()));
    let pack = file.pack()?;
    let mut middle = Strengths::default();
    middle.iter_mut().zip(&model.attributes).for_each(|(to, a)| *to = a.strength[0].midpoint(a.strength[1]));
    let mut notes = Vec::new();
    for (index, attribute) in model.attributes.iter().enumerate() {
        let once = |strength: f64| {
            let mut strengths = middle;
            strengths[index] = strength as f32;
            let still = Settings { from: strengths, to: strengths, fps: FRAME_RATE, seconds: Some(0.0) };
            let seconds = f64::from(play(&pack, &still)?.round[0]);
            Ok::<_, RigError>(play(&pack, &Settings { seconds: Some(seconds), ..still })?.clip)
        };
        let [low, high] = attribute.strength.map(f64::from);
        for quarter in [0.0, 1.0, 2.0, 3.0, 4.0] {
            let strength = low + quarter / 4.0 * (high - low);
            if let Some(broken) = bounds.broken(rig, &[once(strength)?]) {
                // Nothing is minus zero.
                let strength = (100.0 * strength).round() / 100.0 + 0.0;
                notes.push(format!("{}: at strength {strength:.2}, {broken}", attribute.name));
            }
        }
    }
    Ok(notes)
}

/// Shortest and longest time from one keyframe to the next.
fn durations(motions: &[Motion], keyframes: &Keyframes) -> [f32; 2] {
    let pieces = |motion: &Motion| {
        let found = keyframes.find(&motion.segment).unwrap_or_default();
        found.windows(2).map(|pair| (pair[1] - pair[0]) as f64 * motion.segment.frame_time).collect::<Vec<_>>()
    };
    let mut all: Vec<f64> = motions.iter().flat_map(pieces).collect();
    all.sort_by(f64::total_cmp);
    let (shortest, longest) = (all.first().copied().unwrap_or(0.01), all.last().copied().unwrap_or(1.0));
    [(shortest / MARGIN).max(0.002) as f32, (longest * MARGIN).min(30.0) as f32]
}

fn keyframe_error(motions: &[Motion], keyframes: &Keyframes) -> f64 {
    let errors: Vec<f64> = motions
        .par_iter()
        .filter_map(|motion| Some(Curve::of(&motion.segment).error(&keyframes.find(&motion.segment)?).powi(2)))
        .collect();
    (errors.iter().sum::<f64>() / errors.len().max(1) as f64).sqrt()
}
