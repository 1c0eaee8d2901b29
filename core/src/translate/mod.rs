//! Style translation: linear time-invariant state-space models that turn one manner of moving into another.
//!
//! [Coordinates](crate::rig) go in and come out. The papers have positions (Dong, Aloba, Anthony, Jain 2018; Hsu, Pulli, Popović 2005):
//! `x' = A x + B u`, `y = C x + D u`, with `A` in real modal form. Two forms share one runtime: *per joint*, a bank of models
//! with 3 inputs and 3 outputs, one per row of a frame; *whole body*, one model driven by a few principal coordinates of all rows.
//!
//! A gate says how familiar a frame is, so that the style fades where the motion is unlike the training. A model of several actions has an
//! output stage for each of them, which the gate weights.

mod bank;
mod experts;
mod fixed;
mod float;
mod gate;
mod model;
mod state;
mod step;

pub use model::Translator;
pub use state::{Timing, TranslatorState};
