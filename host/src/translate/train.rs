//! Training: from pairs of clips on one rig to a pack.

use std::path::Path;

use rayon::prelude::*;

use super::baseline;
use super::candidate::{AFFINE, Candidate, JUDGE, MACHINE_JUDGE, QUICK};
use super::correspond::{Alignment, OPEN, correspond, correspond_output, correspond_plainly};
use super::cyclic::walks;
use super::dataset::{Correspondence, Sequence};
use super::dynamics::Poles;
use super::fit::Problem;
use super::gate::GateModel;
use super::model::TranslatorModel;
use super::moments::Base;
use super::simulate::simulate;
use crate::align::{AlignError, Ends, Series, aligned_distance, aligned_path};
use crate::pack::Baselines;
use crate::rig::{Locals, Mirror, Rig};
use crate::step_cache::StepCache;

/// Which form to train.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum FormChoice {
    /// The one with the smaller validation error.
    #[default]
    Auto,
    /// A model a joint (Dong 2018).
    PerJoint,
    /// One model for all joints (Hsu 2005).
    WholeBody,
}

/// How to train.
#[derive(Clone, Debug)]
pub struct TrainOptions {
    /// Largest order: states of one joint's model, or of the shared one.
    pub order: Option<usize>,
    /// Form, chosen by validation unless given.
    pub form: FormChoice,
    /// Way in which the clips correspond: in step for walks, else chosen by the error on the training pairs, unless given.
    pub alignment: Option<Alignment>,
    /// Train on mirrored copies too; chosen by validation unless given.
    pub mirror: Option<bool>,
    /// Whether the pack of a body knows how familiar a frame is. Several actions in one pack need it.
    pub gate: bool,
}

impl Default for TrainOptions {
    fn default() -> Self {
        Self { order: None, form: FormChoice::Auto, alignment: None, mirror: None, gate: true }
    }
}

/// Order of a joint's model unless told otherwise (Dong 2018).
pub const DEFAULT_ORDER: usize = 40;
/// Order of the shared model unless told otherwise.
const WHOLE_BODY_ORDER: usize = 64;
/// Part by which a model must be better than the static affine map: less is within what a choice of clips changes.
const MARGIN: f64 = 0.03;
/// Part of the whole-body form's error that the per-joint form may have to replace it: on another take it loses more.
const PER_JOINT: f64 = 0.9;
/// Factor by which a warp of a machine's clips must be better than one even clock: it leaves out a part of every reaction.
const ONE_CLOCK: f64 = 1.5;
/// Times that the styled clip is aligned anew with what the model makes of the source.
const REALIGNMENTS: usize = 2;

/// Why training failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrainError {
    /// No pairs.
    #[error("there is no training pair: give at least one --pair NEUTRAL STYLED")]
    NoPairs,
    /// Two clips cannot be aligned.
    #[error("{neutral} and {styled} cannot be aligned: {error}")]
    Align {
        /// Source clip.
        neutral: String,
        /// Target clip.
        styled: String,
        /// The cause.
        error: AlignError,
    },
    /// Mirrored copies were asked for.
    #[error("left and right of this skeleton are not mirror images: mirrored copies of its motion cannot be made")]
    NoMirror,
    /// Nothing to learn from.
    #[error("the clips do not determine a model: they have too few frames, or nothing moves")]
    Undetermined,
}

/// A training pair on one rig, at one frame rate.
#[derive(Clone, Debug)]
pub struct TrainPair {
    /// Name of the source for messages.
    pub source_name: String,
    /// Name of the target for messages.
    pub target_name: String,
    /// Source motion.
    pub source: Locals,
    /// Styled motion.
    pub target: Locals,
}

/// What came out of training.
#[derive(Debug)]
pub struct Trained {
    /// The model.
    pub model: TranslatorModel,
    /// Offset and affine map fitted on the same pairs.
    pub baselines: Baselines,
    /// How the clips were brought together, and the error on the training pairs of every way that was tried, cm.
    pub alignment: Alignment,
    /// `(alignment, error)` of every way that was tried, cm.
    pub alignments: Vec<(Alignment, f64)>,
    /// Whether mirrored copies were trained on.
    pub mirrored: bool,
    /// The winner of validation and its error, cm.
    pub candidate: (Candidate, f64),
    /// The best candidate of each form and its error, cm.
    pub forms: Vec<(Candidate, f64)>,
    /// Frequency of the main resonance, Hz.
    pub main_frequency: f64,
    /// Number of candidates that were compared.
    pub compared: usize,
}

/// Stages of training, for progress bars.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Bringing the clips onto one clock.
    Align,
    /// Comparing forms, orders and penalties.
    Validate,
    /// Fitting the winner.
    Fit,
}

/// Trains a translator. `progress` is called when a stage begins.
pub fn train(
    rig: &Rig,
    pairs: &[TrainPair],
    style: &str,
    fps: f64,
    options: &TrainOptions,
    progress: &(dyn Fn(Stage) + Sync),
) -> Result<Trained, TrainError> {
    train_kept(rig, pairs, style, fps, options, progress, &StepCache::nothing())
}

/// The same; what is compared (alignments, candidates, forms) is kept in `cache`, and taken from there where it is known.
pub fn train_kept(
    rig: &Rig,
    pairs: &[TrainPair],
    style: &str,
    fps: f64,
    options: &TrainOptions,
    progress: &(dyn Fn(Stage) + Sync),
    cache: &StepCache,
) -> Result<Trained, TrainError> {
    if pairs.is_empty() {
        return Err(TrainError::NoPairs);
    }
    progress(Stage::Align);
    let partners = partners(rig);
    let ways = options.alignment.map_or_else(|| ways(rig, pairs), |way| vec![way]);
    // Alone, what is in step is judged as it will be; beside others all are judged alike.
    let ends = if let [way] = ways[..] { way.ends() } else { Ends::Closed };
    let align = |way| aligned((way, ends), rig, pairs, &partners, fps);
    let tried: Vec<(Alignment, f64, Option<Vec<Sequence>>)> = ways
        .par_iter()
        .map(|way| {
            let mut made = None;
            let error = cache.number(&format!("align {way:?} {ends:?}"), || {
                let (error, sequences) = align(*way)?;
                made = Some(sequences);
                Ok(error)
            })?;
            Ok((*way, error, made))
        })
        .collect::<Result<_, TrainError>>()?;
    let alignments = tried.iter().map(|(way, error, _)| (*way, 100.0 * error)).collect();
    let handicap = |way| if way != Alignment::Uniform && !rig.frames().travels() { ONE_CLOCK } else { 1.0 };
    let judged = |(way, error, _): &(Alignment, f64, _)| handicap(*way) * error;
    let best = tried.into_iter().min_by(|a, b| judged(a).total_cmp(&judged(b)));
    let (alignment, _, sequences) = best.ok_or(TrainError::NoPairs)?;
    // An earlier run keeps errors, not sequences.
    let sequences = sequences.map_or_else(|| Ok(align(alignment)?.1), Ok)?;

    progress(Stage::Validate);
    let mirror = Mirror::new(rig);
    if options.mirror == Some(true) && mirror.is_none() {
        return Err(TrainError::NoMirror);
    }
    let copies: Vec<Sequence> = mirror.iter().flat_map(|mirror| sequences.iter().map(|s| s.mirrored(mirror))).collect();
    let mirrored = mirror.is_some()
        && options.mirror.unwrap_or_else(|| {
            let error = |copies, name| Problem::new(rig, &sequences, copies, fps).validate(&[QUICK], cache, name)[0];
            error(&copies, "mirrored") < error(&[], "not mirrored")
        });
    let mut problem = Problem::new(rig, &sequences, if mirrored { &copies } else { &[] }, fps);
    let grid = grid(rig, options);
    let errors = problem.validate(&grid, cache, "grid");
    let best_of = |keep: &dyn Fn(&Candidate) -> bool| {
        let kept = grid.iter().zip(&errors).filter(|(candidate, error)| keep(candidate) && error.is_finite());
        kept.min_by(|a, b| a.1.total_cmp(b.1)).map(|(candidate, _)| *candidate)
    };
    let whole_body = best_of(&|c| c.coordinates.is_some());
    let per_joint = best_of(&|c| c.coordinates.is_none());
    // What is in step by choice must not be judged by its ends.
    let ends = alignment.ends();
    let mut forms = Vec::new();
    for candidate in per_joint.into_iter().chain(whole_body) {
        let error = || held_out_error(rig, &problem, &candidate, None, pairs, ends);
        forms.push((candidate, 100.0 * cache.number(&format!("form {candidate:?}"), error)?));
    }
    // The plain affine map, on the plain time warp, must be beaten clearly to be replaced.
    let plain = if alignment.ends() == OPEN { sequences.clone() } else { plain_sequences(rig, pairs)? };
    let plain = Problem::new(rig, &plain, &[], fps);
    if options.form == FormChoice::Auto {
        let error = || held_out_error(rig, &plain, &AFFINE, None, pairs, ends);
        forms.push((AFFINE, 100.0 * cache.number("affine", error)?));
    }
    let handicap = |candidate: &Candidate| if candidate.coordinates.is_some() { PER_JOINT } else { 1.0 };
    let judged = |(candidate, error): &(Candidate, f64)| handicap(candidate) * error;
    let best = *forms.iter().min_by(|a, b| judged(a).total_cmp(&judged(b))).ok_or(TrainError::Undetermined)?;
    let simple = forms.iter().find(|(candidate, error)| *candidate == AFFINE && best.1 > (1.0 - MARGIN) * error);
    let mut candidate = *simple.unwrap_or(&best);
    let gate = options.gate.then(|| problem.gate()).flatten();
    let experts = gate.as_ref().filter(|_| options.form != FormChoice::PerJoint);
    if let Some(found) = experts.and_then(|gate| several(&problem, gate, &candidate.0, options, cache)) {
        problem = problem.alike();
        candidate = (found, 100.0 * held_out_error(rig, &problem, &found, gate.as_ref(), pairs, ends)?);
        forms.push(candidate);
    }

    progress(Stage::Fit);
    let (problem, gate) = match candidate.0 == AFFINE {
        // On another time warp, another mean change.
        true => (&plain, gate.and_then(|_| plain.gate())),
        false => (&problem, gate),
    };
    let model = problem.fit(&candidate.0, style, gate).ok_or(TrainError::Undetermined)?;
    Ok(Trained {
        model,
        baselines: baselines(pairs)?,
        alignment,
        alignments,
        mirrored,
        candidate,
        forms,
        main_frequency: problem.main_frequency(),
        compared: grid.len(),
    })
}

/// The ways to try: in step alone for walks, since a walk whose left answers right can neither be blended nor masked; each pair by itself
/// where some are walks and some are not.
fn ways(rig: &Rig, pairs: &[TrainPair]) -> Vec<Alignment> {
    let both_walk = |pair: &&TrainPair| walks(rig, &pair.source) && walks(rig, &pair.target);
    match pairs.iter().filter(both_walk).count() {
        0 => Alignment::of(rig),
        all if all == pairs.len() => vec![Alignment::InStep],
        _ => vec![Alignment::Each],
    }
}

/// The best candidate with experts, where the pairs are of several actions and it is better than `plain` on takes that it has not seen.
fn several(
    problem: &Problem,
    gate: &GateModel,
    plain: &Candidate,
    options: &TrainOptions,
    cache: &StepCache,
) -> Option<Candidate> {
    if !gate.several_actions(problem.sequences(), problem.mean()) {
        return None;
    }
    let problem = problem.clone().by_take().alike();
    let limit = options.order.unwrap_or(WHOLE_BODY_ORDER);
    let mut grid = Vec::new();
    let sizes = [(8, Poles::Relaxation), (12, Poles::Relaxation), (12, Poles::Harmonics2), (16, Poles::Harmonics2)];
    for (coordinates, poles) in sizes.into_iter().filter(|(coordinates, poles)| poles.states(*coordinates) <= limit) {
        // The mean is safe as a base: what is unlike the training fades to the source.
        for base in [Base::Identity, Base::Mean] {
            grid.extend([1e-3, 3e-3, 1e-2, 3e-2, 0.1].map(|penalty| Candidate {
                coordinates: Some(coordinates),
                poles,
                base,
                penalty,
                dynamic_penalty: penalty,
                experts: true,
            }));
        }
    }
    let plain = problem.validate(&[*plain], cache, "by take")[0];
    let errors = cache.always("experts", || problem.validate_experts(&grid, gate));
    let best = grid.iter().zip(errors).min_by(|a, b| a.1.total_cmp(&b.1))?;
    (best.1 < plain).then_some(*best.0)
}

/// Aligned RMS joint distance of what a candidate makes of the folds that it has not seen, root mean square of the pairs, m.
fn held_out_error(
    rig: &Rig,
    problem: &Problem,
    candidate: &Candidate,
    gate: Option<&GateModel>,
    pairs: &[TrainPair],
    ends: Ends,
) -> Result<f64, TrainError> {
    let predicted = problem.held_out(candidate, gate).ok_or(TrainError::Undetermined)?;
    let mut error = 0.0;
    for (pair, predicted) in pairs.iter().zip(&predicted) {
        let series = |values| Series::new(values, pair.source.channels());
        let predicted = rig.positions(predicted);
        let distance = || Ok(aligned_distance(series(&predicted)?, series(&pair.target.positions)?, ends)?.rms);
        error += distance().map_err(|error| pair.failed(error))?.powi(2) / pairs.len() as f64;
    }
    Ok(error.sqrt())
}

/// Pairs whose source names begin alike, up to the first `_`, are of one person or one content: held back together.
fn groups(pairs: &[TrainPair]) -> Vec<usize> {
    let key = |pair: &TrainPair| {
        let stem =
            Path::new(&pair.source_name).file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        stem.split('_').next().unwrap_or_default().to_owned()
    };
    let keys: Vec<String> = pairs.iter().map(key).collect();
    keys.iter().map(|k| keys.iter().position(|other| other == k).unwrap_or(0)).collect()
}

/// The mirror partner of every joint; a joint without one is its own.
pub fn partners(rig: &Rig) -> Vec<usize> {
    (0..rig.joints()).map(|joint| rig.map.mirror_partner(joint).unwrap_or(joint)).collect()
}

/// Sequences of all pairs under one way of alignment, refined, and the error on the pairs, m, of a small model that has not
/// seen the block it speaks of.
fn aligned(
    (way, ends): (Alignment, Ends),
    rig: &Rig,
    pairs: &[TrainPair],
    partners: &[usize],
    fps: f64,
) -> Result<(f64, Vec<Sequence>), TrainError> {
    let groups = groups(pairs);
    let sequences = |on: &dyn Fn(usize, &TrainPair) -> Result<Correspondence, AlignError>| {
        let of = |(index, pair): (usize, &TrainPair)| {
            let correspondence = on(index, pair).map_err(|error| pair.failed(error))?;
            Ok(Sequence::new(rig, &pair.source, &pair.target, &correspondence, groups[index]))
        };
        pairs.iter().enumerate().map(of).collect::<Result<Vec<_>, TrainError>>()
    };
    let mut current = sequences(&|_, pair| correspond(way, &pair.source, &pair.target, rig, partners, fps))?;
    let quick = |sequences: &[Sequence]| {
        let model = Problem::new(rig, sequences, &[], fps).fit(&QUICK, "", None).ok_or(TrainError::Undetermined)?;
        Ok::<_, TrainError>(pairs.iter().map(|pair| rig.positions(&simulate(&model, &pair.source))).collect::<Vec<_>>())
    };
    // Evenly performed motions of a machine are on one clock: a warp would only hide how fast its servos react.
    let one_clock = way == Alignment::Uniform && !rig.frames().travels();
    for _ in 0..if one_clock { 0 } else { REALIGNMENTS } {
        let styled = quick(&current)?;
        let again = |index: usize, pair: &TrainPair| {
            correspond_output(way, &styled[index], (&pair.source, &pair.target), rig, fps)
        };
        current = sequences(&again)?;
    }
    let judge = if rig.frames().travels() { JUDGE } else { MACHINE_JUDGE };
    Ok((held_out_error(rig, &Problem::new(rig, &current, &[], fps), &judge, None, pairs, ends)?, current))
}

impl TrainPair {
    fn failed(&self, error: AlignError) -> TrainError {
        TrainError::Align { neutral: self.source_name.clone(), styled: self.target_name.clone(), error }
    }
}

/// Rows of the matches of the plain time warp of positions, source and target, `[matches x 3 joints]`.
fn plain_matches(pair: &TrainPair) -> Result<(Vec<f64>, Vec<f64>), TrainError> {
    let channels = pair.source.channels();
    let (from, to) = (&pair.source.positions, &pair.target.positions);
    let path = || aligned_path(Series::new(from, channels)?, Series::new(to, channels)?);
    let path = path().map_err(|error| pair.failed(error))?;
    let row = |rows: &[f64], at: usize| rows[at * channels..(at + 1) * channels].to_vec();
    Ok((path.iter().flat_map(|(i, _)| row(from, *i)).collect(), path.iter().flat_map(|(_, j)| row(to, *j)).collect()))
}

/// Baselines on the plain time warp, which is what a user without this program would do.
fn baselines(pairs: &[TrainPair]) -> Result<Baselines, TrainError> {
    let (mut source, mut target) = (Vec::new(), Vec::new());
    for pair in pairs {
        let (from, to) = plain_matches(pair)?;
        source.extend(from);
        target.extend(to);
    }
    Ok(baseline::fit(&source, &target, pairs.first().map_or(0, |pair| pair.source.channels / 3)))
}

/// Training sequences on the plain time warp: the mean match of each source frame, and the clips' average timing.
fn plain_sequences(rig: &Rig, pairs: &[TrainPair]) -> Result<Vec<Sequence>, TrainError> {
    let groups = groups(pairs);
    let of = |(pair, group): (&TrainPair, &usize)| {
        let on = correspond_plainly(&pair.source, &pair.target).map_err(|error| pair.failed(error))?;
        Ok(Sequence::new(rig, &pair.source, &pair.target, &on, *group))
    };
    pairs.iter().zip(&groups).map(of).collect()
}

/// Everything that validation compares.
fn grid(rig: &Rig, options: &TrainOptions) -> Vec<Candidate> {
    let mut grid = Vec::new();
    let mut add = |coordinates: Option<usize>, poles: &[Poles], bases: &[Base], limit: usize| {
        for poles in poles.iter().filter(|p| p.states(coordinates.unwrap_or(3)) <= limit) {
            for base in bases {
                for penalty in [1e-3, 1e-2, 1e-1, 0.3, 1.0, 10.0] {
                    let factors: &[f64] = if *poles == Poles::Static { &[1.0] } else { &[1.0, 10.0] };
                    grid.extend(factors.iter().map(|factor| Candidate {
                        coordinates,
                        poles: *poles,
                        base: *base,
                        penalty,
                        dynamic_penalty: factor * penalty,
                        experts: false,
                    }));
                }
            }
        }
    };
    if options.form != FormChoice::PerJoint {
        let limit = options.order.unwrap_or(WHOLE_BODY_ORDER);
        let mut poles = vec![Poles::Static, Poles::Relaxation, Poles::Harmonics2, Poles::Harmonics3];
        if !rig.frames().travels() {
            // A machine has no gait: its servos' own dynamics count, and there are few enough of them to find these from the data.
            poles.extend([Poles::Identified(limit.min(24)), Poles::Identified(limit)]);
        }
        for coordinates in [4, 8, 12] {
            add(Some(coordinates), &poles, &[Base::Mean, Base::Identity, Base::Channel, Base::Joint], limit);
        }
    }
    if options.form != FormChoice::WholeBody {
        let limit = options.order.unwrap_or(DEFAULT_ORDER);
        let poles = [
            Poles::Static,
            Poles::Relaxation,
            Poles::Harmonics3,
            Poles::Full,
            Poles::Identified(limit.min(12)),
            Poles::Identified(limit),
        ];
        add(None, &poles, &[Base::Mean, Base::Identity, Base::Channel, Base::Joint], limit);
    }
    grid
}
