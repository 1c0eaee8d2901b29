//! From a table of landmarks to a model.

use std::collections::HashMap;

use kinesic::face::{CONTOUR, FEATURES, FaceFrame, Shape};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rand::seq::SliceRandom;
use rayon::prelude::*;

use super::landmarks::Face;
use super::model::{ClusterModel, FaceModel, MAX_UNITS};
use super::shape::numbers;
use super::strength::{Labelled, Scorer, Standard, common, of_cluster};
use crate::learn::{Clusters, RegressOptions, Regressed, Samples, k_means, regress};

/// Faces that a cluster needs in each half of the labels' range; one with fewer is joined to its neighbours.
const NEEDED: usize = 10;
/// Share of the training faces that lies below and above the plausible strengths.
const OUTSIDE: f64 = 0.01;
/// A landmark may be so much outside the range that it has in the training faces, as a share of it.
const WIDER: f64 = 0.1;

/// What to train.
#[derive(Clone, Debug)]
pub struct TrainOptions {
    /// Clusters of head pose; the paper has 12.
    pub clusters: usize,
    /// Hidden units of a cluster's network; the paper has 10.
    pub hidden: usize,
    /// Seed of the clusters' starts, of the pairs that are drawn and of the networks' starts.
    pub seed: u64,
}

impl Default for TrainOptions {
    fn default() -> Self {
        Self { clusters: 12, hidden: 10, seed: 1 }
    }
}

/// Why there is no model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrainError {
    /// The number of clusters makes no sense.
    #[error("{found} clusters: expected 1 to {faces}, the number of faces")]
    Clusters {
        /// What was asked for.
        found: usize,
        /// Faces in the table.
        faces: usize,
    },
    /// The number of hidden units is out of range.
    #[error("{found} hidden units: expected 1 to {MAX_UNITS}; the paper has 10")]
    Hidden {
        /// What was asked for.
        found: usize,
    },
    /// Too few judged faces.
    #[error(
        "{low} faces in the lower half of the labels and {high} in the upper half: expected at least {NEEDED} of each. Label \
         more faces, from the weakest to the strongest expression"
    )]
    Labels {
        /// Faces labelled below the middle.
        low: usize,
        /// Faces labelled above it.
        high: usize,
    },
    /// The landmarks have nothing to do with the labels.
    #[error(
        "in no cluster of head pose do the landmarks rank the faces as labelled: the labels may be in the wrong column"
    )]
    Unrelated,
}

/// A model and how it came about.
#[derive(Clone, Debug)]
pub struct Trained {
    /// The model.
    pub model: FaceModel,
    /// Faces of each cluster.
    pub faces: Vec<usize>,
    /// Pair accuracy of each cluster's ranking function on people who were held out of it while its cost was chosen.
    pub validation: Vec<f64>,
    /// Root mean square distance of a landmark from the network's, in the face's unit, by cluster.
    pub error: Vec<f64>,
    /// Choices that the training made, one sentence each.
    pub notes: Vec<String>,
}

/// Whom to hold out: `share` of the people, drawn by the seed. True for their faces.
pub fn hold_out(faces: &[Face], share: f64, seed: u64) -> Vec<bool> {
    let mut people: Vec<&str> = faces.iter().map(|face| face.person.as_str()).collect();
    people.sort_unstable();
    people.dedup();
    people.shuffle(&mut ChaCha8Rng::seed_from_u64(seed));
    people.truncate((share.clamp(0.0, 1.0) * people.len() as f64).round() as usize);
    people.sort_unstable();
    faces.iter().map(|face| people.binary_search(&face.person.as_str()).is_ok()).collect()
}

/// Learns how strongly faces show `attribute`, and how that moves their landmarks.
pub fn train(faces: &[Face], attribute: &str, options: &TrainOptions) -> Result<Trained, TrainError> {
    check(faces, options)?;
    let (labels, people) = (faces.iter().map(|face| face.label).collect::<Vec<_>>(), people(faces));
    let (contours, shapes) = normalised(faces);
    let mut notes = Vec::new();
    let mut clusters = k_means(&contours, options.clusters, options.seed);
    let middle = middle(&labels);
    while let Some(poor) = poorest(&clusters, &labels, middle) {
        notes.push(format!(
            "one of {} clusters had fewer than {NEEDED} faces labelled below {middle} or above: joined to its neighbours",
            clusters.count()
        ));
        clusters = clusters.without(poor, &contours);
    }
    let standard = Standard::new(&shapes);
    let (scorers, clusters) = loop {
        let labelled = Labelled { shapes: &shapes, labels: &labels, people: &people, clusters: &clusters.members };
        let common = common(&standard, labelled, options.seed);
        let one = |cluster| of_cluster(&standard, &common, labelled, cluster, options.seed);
        let found: Vec<Option<Scorer>> = (0..clusters.count()).into_par_iter().map(one).collect();
        match found.iter().position(Option::is_none) {
            None => break (found.into_iter().flatten().collect::<Vec<_>>(), clusters),
            Some(_) if clusters.count() == 1 => return Err(TrainError::Unrelated),
            Some(cluster) => {
                notes.push("the scores of one cluster did not rise with the labels: joined to its neighbours".into());
                clusters = clusters.without(cluster, &contours);
            }
        }
    };
    let strengths: Vec<f64> =
        clusters.members.iter().zip(&shapes).map(|(cluster, shape)| scorers[*cluster].score(shape)).collect();
    let network = |cluster| {
        let of = |i: &usize| clusters.members[*i] == cluster;
        let members: Vec<usize> = (0..faces.len()).filter(of).collect();
        let inputs: Vec<f64> = members.iter().map(|i| strengths[*i]).collect();
        let outputs: Vec<f64> = members.iter().flat_map(|i| shapes[*i].iter().copied()).collect();
        let settings = RegressOptions { hidden: options.hidden, seed: options.seed, ..RegressOptions::default() };
        (members.len(), regress(&Samples::new(&inputs, 1), &Samples::new(&outputs, FEATURES), &settings))
    };
    let networks: Vec<(usize, Regressed)> = (0..clusters.count()).into_par_iter().map(network).collect();
    let strength = hold(plausible(&strengths), &shapes, &networks, &mut notes);
    let model = |((middle, scorer), (_, network)): ((&Vec<f64>, &Scorer), &(usize, Regressed))| {
        cluster_model(middle, scorer, network)
    };
    Ok(Trained {
        model: FaceModel {
            attribute: attribute.to_owned(),
            strength,
            clusters: clusters.middles.iter().zip(&scorers).zip(&networks).map(model).collect(),
        },
        faces: networks.iter().map(|(count, _)| *count).collect(),
        validation: scorers.iter().map(|scorer| scorer.accuracy).collect(),
        // Of one coordinate; a landmark has two.
        error: networks.iter().map(|(_, network)| std::f64::consts::SQRT_2 * network.error).collect(),
        notes,
    })
}

fn check(faces: &[Face], options: &TrainOptions) -> Result<(), TrainError> {
    if options.clusters == 0 || options.clusters > faces.len() {
        return Err(TrainError::Clusters { found: options.clusters, faces: faces.len() });
    }
    if options.hidden == 0 || options.hidden > MAX_UNITS {
        return Err(TrainError::Hidden { found: options.hidden });
    }
    let labels: Vec<Option<f64>> = faces.iter().map(|face| face.label).collect();
    let [low, high] = halves(labels.iter().flatten(), middle(&labels));
    if low < NEEDED || high < NEEDED { Err(TrainError::Labels { low, high }) } else { Ok(()) }
}

/// Contours and shapes in the face's own frame.
fn normalised(faces: &[Face]) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
    let one = |face: &Face| {
        // Reading refuses what is no face.
        let frame = FaceFrame::of(&face.landmarks)?;
        let contour = frame.contour(&face.landmarks).as_flattened().iter().map(|x| f64::from(*x)).collect();
        Some((contour, numbers(&frame.shape(&face.landmarks))))
    };
    let nothing = || (vec![0.0; 2 * CONTOUR], vec![0.0; FEATURES]);
    faces.iter().map(|face| one(face).unwrap_or_else(nothing)).unzip()
}

/// People numbered in the order in which they appear.
fn people(faces: &[Face]) -> Vec<usize> {
    let mut known = HashMap::new();
    let number = |face: &Face| {
        let next = known.len();
        *known.entry(face.person.clone()).or_insert(next)
    };
    faces.iter().map(number).collect()
}

/// Middle of the labels' range.
fn middle(labels: &[Option<f64>]) -> f64 {
    let [low, high] =
        labels.iter().flatten().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| [l.min(*x), h.max(*x)]);
    (low + high) / 2.0
}

/// How many lie below the middle and above.
fn halves<'a>(labels: impl Iterator<Item = &'a f64>, middle: f64) -> [usize; 2] {
    labels.fold([0, 0], |[low, high], label| [low + usize::from(*label < middle), high + usize::from(*label > middle)])
}

/// The cluster with the fewest faces in a half, if too few.
fn poorest(clusters: &Clusters, labels: &[Option<f64>], middle: f64) -> Option<usize> {
    let least = |cluster: usize| {
        let members = clusters.members.iter().zip(labels).filter(|(member, _)| **member == cluster);
        let [low, high] = halves(members.filter_map(|(_, label)| label.as_ref()), middle);
        low.min(high)
    };
    let poorest = (0..clusters.count()).map(|cluster| (least(cluster), cluster)).min();
    poorest.filter(|(count, _)| *count < NEEDED && clusters.count() > 1).map(|(_, cluster)| cluster)
}

fn plausible(strengths: &[f64]) -> [f32; 2] {
    let mut sorted = strengths.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1) as f64;
    [OUTSIDE, 1.0 - OUTSIDE]
        .map(|share| sorted.get((share * last).round() as usize).copied().unwrap_or_default() as f32)
}

/// Plays the ends of the range in every cluster, and brings an end in by eighths of the way to the middle, as long as a landmark leaves the
/// range that it has in the training faces. Half of the way stays.
fn hold(range: [f32; 2], shapes: &[Vec<f64>], networks: &[(usize, Regressed)], notes: &mut Vec<String>) -> [f32; 2] {
    let mut seen = vec![[f64::INFINITY, f64::NEG_INFINITY]; FEATURES];
    for shape in shapes {
        seen.iter_mut().zip(shape).for_each(|([low, high], x)| (*low, *high) = (low.min(*x), high.max(*x)));
    }
    let inside = |strength: f32| {
        let within = |(x, [low, high]): (f64, &[f64; 2])| {
            let past = WIDER * (high - low);
            (low - past..=high + past).contains(&x)
        };
        let cluster = |(_, regressed): &(usize, Regressed)| {
            regressed.network.apply(&[f64::from(strength)]).into_iter().zip(&seen).all(within)
        };
        networks.iter().all(cluster)
    };
    let middle = range[0].midpoint(range[1]);
    range.map(|end| {
        let at = |eighths: u8| middle + f32::from(eighths) / 8.0 * (end - middle);
        let held = [8, 7, 6, 5].map(at).into_iter().find(|strength| inside(*strength)).unwrap_or(at(4));
        if held != end {
            notes.push(format!(
                "the plausible strengths end at {held:.2}, not {end:.2}: a landmark goes where it is in no face"
            ));
        }
        held
    })
}

fn cluster_model(middle: &[f64], scorer: &Scorer, regressed: &Regressed) -> ClusterModel {
    let network = &regressed.network;
    let mut contour = [[0.0; 2]; CONTOUR];
    fill(contour.as_flattened_mut(), middle);
    let shape = |values: &[f64]| {
        let mut shape: Shape = [[0.0; 2]; FEATURES / 2];
        fill(shape.as_flattened_mut(), values);
        shape
    };
    let unit = |(weight, bias): (&f64, &f64)| [*weight as f32, *bias as f32];
    ClusterModel {
        contour,
        rank: scorer.shape(),
        rank_bias: scorer.bias as f32,
        linear: shape(&network.linear),
        hidden: network.hidden.iter().zip(&network.hidden_bias).map(unit).collect(),
        output: network.output.iter().map(|x| *x as f32).collect(),
        output_bias: shape(&network.bias),
    }
}

fn fill(to: &mut [f32], from: &[f64]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to = *from as f32);
}
