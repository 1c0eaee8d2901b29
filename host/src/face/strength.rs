//! Ranking functions of strength: one over all faces, then one a cluster that may differ from it.
//!
//! A cluster alone has a few hundred faces for 98 numbers and ranks worse than one function for all. So a cluster's function is
//! `a w0 + v`: `w0` is fitted on pairs within all clusters, `a` costs nothing, and only `v`, by which this head pose differs, is
//! held small.

use kinesic::face::{FEATURES, Shape};
use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;

use super::shape::region_local;
use crate::learn::{Pairs, RankOptions, Samples, choose_cost, rank};
use crate::vector::{dot, line};

/// Pairs that a function is fitted on at most, drawn from all: more change nothing that the faces can tell.
const PAIRS: [usize; 2] = [200_000, 20_000];
/// Deviation of the common score among a cluster's standardised numbers: large, so that its weight is small and free.
const COMMON: f64 = 100.0;

/// What the faces of a training are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Labelled<'a> {
    /// Shapes in the face's frame, `[98]`.
    pub shapes: &'a [Vec<f64>],
    pub labels: &'a [Option<f64>],
    /// Index of the person.
    pub people: &'a [usize],
    pub clusters: &'a [usize],
}

/// A score `weights . shape + bias`, and what validation said about it.
#[derive(Clone, Debug)]
pub(super) struct Scorer {
    /// `[98]`, blind to regions that move as a whole.
    pub weights: Vec<f64>,
    pub bias: f64,
    /// Pair accuracy on people who were held out; NaN where none could be.
    pub accuracy: f64,
}

impl Scorer {
    pub fn score(&self, shape: &[f64]) -> f64 {
        self.bias + self.weights.iter().zip(shape).map(|(w, x)| w * x).sum::<f64>()
    }

    pub fn shape(&self) -> Shape {
        let mut shape = Shape::from([[0.0; 2]; FEATURES / 2]);
        shape.as_flattened_mut().iter_mut().zip(&self.weights).for_each(|(to, from)| *to = *from as f32);
        shape
    }
}

/// Numbers of all faces, region-local and of unit deviation.
pub(super) struct Standard {
    inverse: Vec<f64>,
    values: Vec<f64>,
}

impl Standard {
    pub fn new(shapes: &[Vec<f64>]) -> Self {
        let mut values = Vec::with_capacity(shapes.len() * FEATURES);
        for shape in shapes {
            let mut local = shape.clone();
            region_local(&mut local);
            values.extend(local);
        }
        let count = shapes.len().max(1) as f64;
        let mean = Samples::new(&values, FEATURES).mean();
        let mut spread = vec![0.0; FEATURES];
        for row in values.chunks_exact(FEATURES) {
            spread.iter_mut().zip(row).zip(&mean).for_each(|((s, x), m)| *s += (x - m) * (x - m) / count);
        }
        let inverse: Vec<f64> = spread.iter().map(|s| if *s > 1e-18 { 1.0 / s.sqrt() } else { 0.0 }).collect();
        for row in values.chunks_exact_mut(FEATURES) {
            row.iter_mut().zip(&mean).zip(&inverse).for_each(|((x, m), i)| *x = (*x - m) * i);
        }
        Self { inverse, values }
    }

    fn row(&self, face: usize) -> &[f64] {
        &self.values[face * FEATURES..][..FEATURES]
    }

    /// Weights on standardised numbers as weights on a shape.
    fn on_shape(&self, weights: &[f64]) -> Vec<f64> {
        let mut weights: Vec<f64> = weights.iter().zip(&self.inverse).map(|(w, i)| w * i).collect();
        region_local(&mut weights);
        weights
    }
}

/// The function for all clusters, on standardised numbers.
pub(super) fn common(standard: &Standard, faces: Labelled, seed: u64) -> Vec<f64> {
    let pairs = Pairs::of_levels(faces.labels, faces.clusters, 0.0);
    let pairs = thinned(pairs, PAIRS[0], seed);
    let samples = Samples::new(&standard.values, FEATURES);
    let mut options = RankOptions::default();
    options.cost = choose_cost(&samples, &pairs, faces.people, &options).cost;
    rank(&samples, &pairs, &options, &[]).weights
}

/// The function of one cluster, in units of the labels: a face labelled `l` scores `l` on average. `None` where the cluster's
/// labels do not say which of its faces show more, or its scores do not rise with them.
pub(super) fn of_cluster(
    standard: &Standard,
    common: &[f64],
    faces: Labelled,
    cluster: usize,
    seed: u64,
) -> Option<Scorer> {
    let members: Vec<usize> = (0..faces.shapes.len()).filter(|i| faces.clusters[*i] == cluster).collect();
    let labels: Vec<Option<f64>> = members.iter().map(|i| faces.labels[*i]).collect();
    let people: Vec<usize> = members.iter().map(|i| faces.people[*i]).collect();
    let pairs = thinned(Pairs::of_levels(&labels, &vec![0; members.len()], 0.0), PAIRS[1], seed);
    if pairs.ordered.is_empty() {
        return None;
    }
    let scores: Vec<f64> = members.iter().map(|i| dot(common, standard.row(*i))).collect();
    let factor = COMMON / deviation(&scores)?;
    let mut values = Vec::with_capacity(members.len() * (FEATURES + 1));
    for (face, score) in members.iter().zip(&scores) {
        values.extend_from_slice(standard.row(*face));
        values.push(factor * score);
    }
    let samples = Samples::new(&values, FEATURES + 1);
    let mut options = RankOptions::default();
    let choice = choose_cost(&samples, &pairs, &people, &options);
    options.cost = choice.cost;
    let ranked = rank(&samples, &pairs, &options, &[]);
    let (own, share) = ranked.weights.split_at(FEATURES);
    let share = factor * share.first().copied().unwrap_or_default();
    let weights: Vec<f64> = own.iter().zip(common).map(|(v, w)| v + share * w).collect();
    let mut scorer = Scorer { weights: standard.on_shape(&weights), bias: 0.0, accuracy: choice.accuracy };
    let raw: Vec<(f64, f64)> =
        members.iter().filter_map(|i| Some((faces.labels[*i]?, scorer.score(&faces.shapes[*i])))).collect();
    let (offset, slope) = line(&raw)?;
    if !(slope.is_finite() && slope > 1e-9 && offset.is_finite()) {
        return None;
    }
    scorer.weights.iter_mut().for_each(|w| *w /= slope);
    scorer.bias = -offset / slope;
    Some(scorer)
}

/// At most `most` ordered pairs and as many similar ones.
fn thinned(pairs: Pairs, most: usize, seed: u64) -> Pairs {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut draw = |half: Pairs, count: usize| {
        if count <= most { half } else { half.sample(most as f64 / count as f64, &mut random) }
    };
    let (ordered, similar) = (pairs.ordered.len(), pairs.similar.len());
    let first = draw(Pairs { ordered: pairs.ordered, similar: Vec::new() }, ordered);
    let second = draw(Pairs { ordered: Vec::new(), similar: pairs.similar }, similar);
    Pairs { ordered: first.ordered, similar: second.similar }
}

/// `None` for scores that are all the same.
fn deviation(values: &[f64]) -> Option<f64> {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let deviation = (values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count).sqrt();
    (deviation > 1e-12).then_some(deviation)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_thinned_in_both_kinds() {
        let pairs = Pairs { ordered: vec![[0, 1]; 50], similar: vec![[1, 2]; 7] };
        let thin = thinned(pairs, 10, 1);
        assert_eq!((thin.ordered.len(), thin.similar.len()), (10, 7));
    }
}
