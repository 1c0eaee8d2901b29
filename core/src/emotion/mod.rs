//! Strength of an emotion in a motion: strength -> keyframes -> spline -> coordinates, at any frame rate.
//!
//! A motion (one step cycle, one wave) is `K` keyframes of `D` principal components each; a small network says what they are at
//! a strength (Chan, Shum, Wang, Yi, Wei, Ho 2019, the body part). Evaluated when a strength changes, not every frame: the
//! components become [coordinates](crate::rig) and velocities, the velocities the times between keyframes. A frame is then a point
//! on a spline through coordinates. The paper's keyframes hold joint positions; with coordinates heads, hands and twists are styled,
//! and bones keep their length.
//!
//! A keyframe of a body that travels holds the root's place and heading in the frame of the motion's first keyframe; a machine
//! that stands has neither.
//!
//! A strength may change while the motion plays: the phase is kept, and what coordinates and their velocities were ahead or behind
//! fades out within [`FADE`] seconds, so that nothing jumps. A cycle goes on from where it ended, farther on and turned as it turns.
//!
//! Strengths are in units of the ranking function that the model was trained with.

mod engine;
mod model;
mod motion;
mod place;
pub mod spline;
mod state;
mod step;

pub use model::Emotion;
pub use place::Place;
pub use state::{EmotionState, FADE};
