//! Emotion strength (Chan, Shum, Wang, Yi, Wei, Ho 2019): rank motions by how strongly they show something, learn how a motion
//! looks at every strength.
//!
//! | file | holds |
//! |---|---|
//! | [`mod@rank`] | the ranking function: primal Newton over a graph of pairs; faces use it too |
//! | [`Curvature`] | what its Hessian needs of the samples |
//! | `pairs`, [`choose_cost`] | which motion shows more than which; the cost by validation |
//! | [`mod@regress`], `hidden` | strength -> features: ten tanh units, the output layer eliminated |

mod choose;
mod curvature;
mod hidden;
pub mod pairs;
pub mod rank;
pub mod regress;
mod samples;

pub use choose::{Choice, choose_cost};
pub use curvature::Curvature;
pub use pairs::{Pairs, pair_accuracy, spearman};
pub use rank::{RankOptions, Ranked, rank, rank_with};
pub use regress::{RegressOptions, Regressed, Regression, regress};
pub use samples::Samples;
