//! Emotion strength (Chan, Shum, Wang, Yi, Wei, Ho 2019): rank motions by how strongly they show something, learn how a motion
//! looks at every strength.
//!
//! | file | holds |
//! |---|---|
//! | [`labels`] | tables of labelled clips |
//! | [`segment`] | clips -> motions: whole, or cycle by cycle |
//! | [`motions`] | labelled clips, cut, with their pairs |
//! | [`keyframes`] | the moments between which the spline draws all motions best |
//! | [`features`] | keyframes -> positions and velocities -> principal components |
//! | [`mod@rank`] | the ranking function: primal Newton over a graph of pairs; faces use it too |
//! | [`Curvature`] | what its Hessian needs of the samples |
//! | `pairs`, [`choose_cost`] | which motion shows more than which; the cost by validation |
//! | [`mod@regress`], `hidden` | strength -> features: a few tanh units, the output layer eliminated |
//! | [`train()`] | from labelled clips to a model |
//! | [`evaluate`] | reads the strength of clips; pair accuracy, rank correlation |
//! | [`compare_motions`] | played motions against recorded ones: centimetres and degrees |
//! | [`EmotionModel`] | what training makes, as a pack and back |
//! | [`play`] | playback through the device's code |
//! | [`made`] | a made model for tests and firmware workloads |

mod choose;
mod compare;
mod curvature;
pub mod evaluate;
pub mod features;
mod hidden;
pub mod keyframes;
pub mod labels;
pub mod made;
mod model;
pub mod motions;
pub mod pairs;
pub mod play;
pub mod rank;
pub mod regress;
mod samples;
pub mod segment;
mod train;

pub use choose::{Choice, choose_cost};
pub use compare::{CompareError, Distances, compare_motions};
pub use curvature::Curvature;
pub use model::{Attribute, EmotionModel, HostEmotion, MAX_KEYS, MAX_WIDTH};
pub use pairs::{Pairs, pair_accuracy, spearman};
pub use rank::{RankOptions, Ranked, rank, rank_with};
pub use regress::{RegressOptions, Regressed, Regression, regress};
pub use samples::Samples;
pub use train::{Ranking, TrainError, TrainOptions, Trained, train};
