//! Emotion strength (Chan, Shum, Wang, Yi, Wei, Ho 2019): rank motions by how strongly they show something, learn how a motion
//! looks at every strength.
//!
//! | file | holds |
//! |---|---|
//! | [`labels`] | tables of labelled clips |
//! | [`segment`] | clips -> motions: whole, or cycle by cycle |
//! | [`motions`] | labelled clips, cut, with their pairs |
//! | [`keyframes`] | the moments between which the spline draws all motions best |
//! | [`features`] | keyframes -> positions and velocities -> principal components, by which motions are ranked |
//! | [`coordinates`] | keyframes -> coordinates and velocities, of which motions are made |
//! | [`train()`] | from labelled clips to a model; ranking and regression are those of [`learn`](crate::learn) |
//! | [`evaluate`] | reads the strength of clips; pair accuracy, rank correlation |
//! | [`compare_motions`] | played motions against recorded ones: centimetres and degrees |
//! | [`EmotionModel`] | what training makes, as a pack and back |
//! | [`play`] | playback through the device's code |
//! | [`synthetic`] | a made-up model for tests and firmware workloads |

mod compare;
pub mod coordinates;
pub mod evaluate;
pub mod features;
pub mod keyframes;
pub mod labels;
mod model;
pub mod motions;
pub mod play;
pub mod segment;
pub mod synthetic;
mod train;

pub use compare::{CompareError, Distances, compare_motions};
pub use model::{Attribute, EmotionModel, HostEmotion, MAX_KEYS, MAX_WIDTH};
pub use train::{Ranking, TrainError, TrainOptions, Trained, train};
