//! What several learners share: order samples by how strongly they show something, and say what belongs to a strength
//! (Chan, Shum, Wang, Yi, Wei, Ho 2019).
//!
//! | file | holds |
//! |---|---|
//! | `cluster` | k-means: how a head is turned, what a body is doing |
//! | [`Samples`] | rows of numbers, one a sample |
//! | [`pairs`], [`choose_cost`] | which sample shows more than which; the cost by validation |
//! | [`mod@rank`] | the ranking function: primal Newton over a graph of pairs |
//! | [`Curvature`] | what its Hessian needs of the samples |
//! | [`mod@regress`], `hidden` | strength -> features: a few tanh units, the output layer eliminated |

mod cluster;
mod cross_validate;
mod curvature;
mod hidden;
pub mod pairs;
pub mod rank;
pub mod regress;
pub(crate) mod samples;

pub use cluster::{Clusters, k_means};
pub use cross_validate::{Choice, choose_cost};
pub use curvature::Curvature;
pub use pairs::{Pairs, pair_accuracy, spearman};
pub use rank::{RankOptions, Ranked, rank, rank_with};
pub use regress::{RegressOptions, Regressed, Regression, regress};
pub use samples::Samples;
