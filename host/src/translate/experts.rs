//! One model for several actions: a shared whole-body model, and for each cluster of its gate an output stage of low rank.
//!
//! `y = x + W f + sum w_g (W_g f + b_g)`, `f` the filter states and principal coordinates: one ridge regression over all frames. What the
//! experts write is then kept in its largest directions.

use faer::Mat;

use super::candidate::Candidate;
use super::dataset::Sequence;
use super::dynamics::Dynamics;
use super::features::centred;
use super::gate::{GateModel, Sight};
use super::model::ExpertModel;
use super::moments::Map;

/// Directions in which experts write.
const RANK: usize = 24;
/// An expert's penalty, in the shared model's: what differs between actions is learned first.
const OF_SHARED: f64 = 1.0 / 6.0;
/// The same for what an expert adds to all frames of its cluster alike.
const OF_BIAS: f64 = 1e-2;

/// Shared features, then of every expert its weight and its weight times the features, for each sequence.
pub fn features<'a>(
    gate: &GateModel,
    sequences: impl Iterator<Item = &'a Sequence>,
    mean: &[f64],
    shared: &[Mat<f64>],
) -> Vec<Mat<f64>> {
    let own = |(sequence, shared): (&Sequence, &Mat<f64>)| {
        let (own, width) = (shared.ncols(), shared.ncols() + 1);
        let mut all = Mat::zeros(shared.nrows(), own + gate.clusters() * width);
        for (t, Sight { near, .. }) in gate.look(&centred(&sequence.input, mean)).into_iter().enumerate() {
            (0..own).for_each(|f| all[(t, f)] = shared[(t, f)]);
            for (cluster, weight) in near {
                let first = own + cluster * width;
                all[(t, first)] += weight;
                (0..own).for_each(|f| all[(t, first + 1 + f)] += weight * shared[(t, f)]);
            }
        }
        all
    };
    sequences.zip(shared).map(own).collect()
}

/// Penalty of each of the [`features`].
pub fn penalties(candidate: &Candidate, clusters: usize, states: usize, drives: usize) -> Vec<f64> {
    let shared = candidate.penalties(states, drives);
    let expert: Vec<f64> = std::iter::once(OF_BIAS * candidate.penalty).chain(shared.iter().copied()).collect();
    let experts = (0..clusters).flat_map(|_| expert.iter().map(|penalty| OF_SHARED * penalty));
    shared.iter().copied().chain(experts).collect()
}

/// Splits a fitted map of [`features`] into the shared model's part and the experts, which write in their largest directions on `frames`.
pub fn split(map: Map, dynamics: &Dynamics, clusters: usize, frames: &[Mat<f64>]) -> Option<(Map, ExpertModel)> {
    let shared = dynamics.states() + dynamics.inputs;
    let channels = map.weights.ncols();
    let of_experts = map.weights.subrows(shared, map.weights.nrows() - shared);
    let mut covariance = Mat::<f64>::zeros(channels, channels);
    for frames in frames {
        let written = frames.subcols(shared, frames.ncols() - shared) * of_experts;
        covariance += written.transpose() * &written;
    }
    let eigen = covariance.self_adjoint_eigen(faer::Side::Lower).ok()?;
    let vectors = eigen.U();
    let directions =
        Mat::from_fn(channels, RANK, |c, k| if k < channels { vectors[(c, channels - 1 - k)] } else { 0.0 });
    let inner = of_experts * &directions;
    let (mut input, mut bias) = (Vec::new(), Vec::new());
    for cluster in 0..clusters {
        let first = cluster * (shared + 1);
        bias.extend((0..RANK).map(|k| inner[(first, k)]));
        let weights = inner.subrows(first + 1, shared).to_owned();
        let (of_state, of_input) = dynamics.output_of(&weights);
        input.extend(of_state.iter().zip(&of_input).flat_map(|(x, u)| x.iter().chain(u)).copied());
    }
    let output = (0..channels).flat_map(|c| (0..RANK).map(move |k| (c, k))).map(|at| directions[at]).collect();
    let weights = map.weights.subrows(0, shared).to_owned();
    Some((Map { weights, ..map }, ExpertModel { rank: RANK, input, bias, output }))
}
