//! A made emotion model, where no recorded motions may be: tests and the firmware workloads.

use std::f64::consts::TAU;

use kinesic::Pose;

use super::coordinates::{channels, levers, of_frames, positions};
use super::model::{Attribute, EmotionModel, Reading};
use crate::clip::JointMap;
use crate::gait::{Manner, skeleton, walk};
use crate::learn::Regression;
use crate::rig::{MAX_JOINTS, Rig};

/// Keyframes, the paper's.
pub const KEYS: usize = 13;
/// Components of a keyframe, the paper's.
pub const COMPONENTS: usize = 40;
/// Hidden units, the paper's.
pub const UNITS: usize = 10;
/// Frames a second of the made walks, so that a keyframe is near a frame.
const FPS: f64 = 480.0;

/// Keyframes, components of a keyframe and hidden units.
pub type Size = [usize; 3];

/// [`sized`] as the paper has it.
pub fn model(attributes: usize) -> (EmotionModel, Rig) {
    sized(attributes, [KEYS, COMPONENTS, UNITS])
}

/// A cycle of the made gait with one or two attributes: weary from 0 to 1, swaying from -1 to 1. The
/// keyframes are those of made walks, the network joins them; nothing is trained.
pub fn sized(attributes: usize, [keys, components, units]: Size) -> (EmotionModel, Rig) {
    let skeleton = skeleton();
    let map = JointMap::detect(&skeleton).unwrap_or_else(|| unreachable!("the gait's joints have known names"));
    let rig = Rig::new(&skeleton, &map).unwrap_or_else(|error| unreachable!("the gait is a rig: {error}"));
    let swaying = Manner { sway: 0.3, arms: 0.9, ..Manner::NEUTRAL };
    let manners = [Manner::NEUTRAL, Manner::WEARY, swaying].into_iter().take(attributes + 1);
    let moments = manners.map(|manner| -> Vec<Moment> {
        let seconds = 1.0 / manner.cadence;
        let poses = rig.poses(&walk(&manner, seconds + 0.1, FPS, 0.0, 1));
        let frame = |key: usize| (seconds * FPS * key as f64 / (keys - 1) as f64).round() as usize;
        (0..keys).map(|key| (frame(key) as f64 / FPS, poses[frame(key)])).collect()
    });
    let moments: Vec<Vec<Moment>> = moments.collect();
    let poses: Vec<Vec<_>> = moments.iter().map(|moments| moments.iter().map(|(_, pose)| *pose).collect()).collect();
    let rig = rig.centred(&poses.iter().map(Vec::as_slice).collect::<Vec<_>>());
    (over(&rig, &moments, [components, units]), rig)
}

/// A time of a cycle, s, and the pose there.
pub type Moment = (f64, Pose<MAX_JOINTS>);

/// The same over other motions: the first is neutral, each other one a full strength of its attribute. `moments`: the keyframes
/// of each, as many of one as of the other. The coordinates are those of `rig`.
pub fn over(rig: &Rig, moments: &[Vec<Moment>], [components, units]: [usize; 2]) -> EmotionModel {
    let (levers, width) = (levers(rig), 2 * channels(rig));
    let cycles: Vec<Cycle> = moments.iter().map(|moments| Cycle::new(rig, &levers, moments)).collect();
    let (attributes, keys) = (cycles.len() - 1, moments[0].len());
    let features: Vec<&[f64]> = cycles.iter().flat_map(|cycle| cycle.keyframes.iter().map(Vec::as_slice)).collect();
    let mean: Vec<f64> =
        (0..width).map(|c| features.iter().map(|row| row[c]).sum::<f64>() / features.len() as f64).collect();
    let directions = directions(&features, &mean, components);
    let coordinates = |cycle: &Cycle| -> Vec<f64> {
        let row = |row: &Vec<f64>| directions.iter().map(|d| dot_from(row, &mean, d)).collect::<Vec<f64>>();
        cycle.keyframes.iter().flat_map(row).collect()
    };
    let neutral = coordinates(&cycles[0]);
    let changes: Vec<Vec<f64>> = cycles[1..]
        .iter()
        .map(|cycle| coordinates(cycle).iter().zip(&neutral).map(|(to, from)| to - from).collect())
        .collect();
    let motion = neutral.len();
    // Along a change the score rises by one: the part of it that the other change does not share is not needed here.
    let seen = &cycles[0].features;
    let rank: Vec<f64> = cycles[1..]
        .iter()
        .flat_map(|cycle| {
            let change = cycle.features.iter().zip(seen).map(|(to, from)| to - from);
            let square: f64 = change.clone().map(|x| x * x).sum();
            change.map(move |x| x / square)
        })
        .collect();
    let bias = rank.chunks_exact(seen.len()).map(|w| -w.iter().zip(seen).map(|(w, x)| w * x).sum::<f64>());
    let wave = |at: usize| (at as f64 * 0.7 + 0.3).sin();
    EmotionModel {
        motion: "made walk".to_owned(),
        frame_rate: 60.0,
        attributes: [("weary", [0.0, 1.0]), ("swaying", [-1.0, 1.0])]
            .into_iter()
            .take(attributes)
            .map(|(name, strength)| Attribute { name: name.to_owned(), strength })
            .collect(),
        keyframes: keys,
        cycle: true,
        duration: [0.02, 0.5],
        network: Regression {
            inputs: attributes,
            hidden: (0..units * attributes).map(|at| 2.0 * wave(at)).collect(),
            hidden_bias: (0..units).map(|at| wave(3 * at + 1)).collect(),
            output: (0..motion * units).map(|at| 2e-3 * wave(at)).collect(),
            linear: (0..motion).flat_map(|at| changes.iter().map(move |change| change[at])).collect(),
            bias: neutral.clone(),
        },
        basis: (0..width)
            .flat_map(|c| {
                let back = levers.get(c).map_or(1.0, |lever| 1.0 / lever);
                directions.iter().map(move |d| d[c] * back)
            })
            .collect(),
        mean: mean.iter().enumerate().map(|(c, mean)| levers.get(c).map_or(*mean, |lever| mean / lever)).collect(),
        reading: Reading {
            parts: (0..keys).map(|key| key as f64 / (keys - 1) as f64).collect(),
            postures: cycles[0].postures.clone(),
            bias: bias.collect(),
            rank,
        },
        levers,
    }
}

/// Keyframes of one cycle.
struct Cycle {
    /// Channels times levers, then velocities since the keyframe before.
    keyframes: Vec<Vec<f64>>,
    /// Positions, then velocities since the keyframe before, keyframe by keyframe.
    features: Vec<f64>,
    /// Positions seen from the root, along its heading.
    postures: Vec<f64>,
}

impl Cycle {
    fn new(rig: &Rig, levers: &[f64], moments: &[Moment]) -> Self {
        let poses: Vec<_> = moments.iter().map(|(_, pose)| *pose).collect();
        let rows = of_frames(rig, &rig.read(&poses));
        let weighted: Vec<f64> = rows
            .chunks_exact(levers.len())
            .flat_map(|row| row.iter().zip(levers).map(|(x, lever)| x * lever))
            .collect();
        let coordinates: Vec<f64> =
            rows.chunks_exact(levers.len()).flat_map(|row| row[..3 * rig.rows()].to_vec()).collect();
        let bodies = rig.positions(&coordinates);
        let postures = bodies.chunks_exact(3 * rig.joints()).flat_map(|body| {
            let root = [body[0], body[1], body[2]];
            body.iter().zip(root.into_iter().cycle()).map(|(x, root)| x - root).collect::<Vec<_>>()
        });
        Self {
            keyframes: with_rates(&weighted, levers.len(), moments),
            features: with_rates(&positions(rig, &rows), 3 * rig.joints(), moments).concat(),
            postures: postures.collect(),
        }
    }
}

/// Numbers of each keyframe, then their rates since the keyframe before; the first one has the second's.
fn with_rates(rows: &[f64], width: usize, moments: &[Moment]) -> Vec<Vec<f64>> {
    let row = |key: usize| &rows[key * width..][..width];
    let keyframe = |key: usize| {
        let at = key.max(1);
        let time = moments[at].0 - moments[at - 1].0;
        let rates = row(at).iter().zip(row(at - 1)).map(|(to, from)| (to - from) / time);
        row(key).iter().copied().chain(rates).collect()
    };
    (0..moments.len()).map(keyframe).collect()
}

/// Directions at right angles that span the features, by Gram and Schmidt; seeded ones where these are used up.
fn directions(features: &[&[f64]], mean: &[f64], count: usize) -> Vec<Vec<f64>> {
    let mut directions: Vec<Vec<f64>> = Vec::new();
    let centred = features.iter().map(|row| row.iter().zip(mean).map(|(x, m)| x - m).collect::<Vec<f64>>());
    let seeded = (0..).map(|n| (0..mean.len()).map(|c| (TAU * 0.618 * (n * c + n + c) as f64).sin()).collect());
    for mut row in centred.chain(seeded) {
        if directions.len() == count {
            break;
        }
        // Twice is enough for right angles to rounding.
        for _ in 0..2 {
            for d in &directions {
                let along: f64 = row.iter().zip(d).map(|(x, d)| x * d).sum();
                row.iter_mut().zip(d).for_each(|(x, d)| *x -= along * d);
            }
        }
        let norm = row.iter().map(|x| x * x).sum::<f64>().sqrt();
        if norm > 1e-3 {
            directions.push(row.iter().map(|x| x / norm).collect());
        }
    }
    directions
}

fn dot_from(row: &[f64], mean: &[f64], direction: &[f64]) -> f64 {
    row.iter().zip(mean).zip(direction).map(|((x, m), d)| (x - m) * d).sum()
}
