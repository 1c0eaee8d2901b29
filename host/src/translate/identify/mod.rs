//! Identification of a stable state-space model from input and output (multi-input, multi-output):
//! [`impulse_response`] (regularised finite impulse response), [`balanced`] (truncation of its Hankel matrix), [`modal`]
//! (real modal form). Short clips need the prior; it costs milliseconds and never gives an unstable model.

mod impulse;
mod modal;
mod realise;

use std::ops::Range;

use faer::Mat;

use super::dynamics::Dynamics;

pub use impulse::{ImpulseResponse, impulse_response};
pub use modal::{Modal, modal};
pub use realise::{StateSpace, balanced};

/// Length of the impulse response, s.
const RESPONSE: f64 = 0.8;

/// Modal dynamics of at most `order` states from several sequences: inputs `[frames x m]`, outputs `[covered frames x p]`.
///
/// The output matrix is not kept: the caller fits it, with its own penalty, to the simulation error.
pub fn dynamics(
    inputs: &[Mat<f64>],
    outputs: &[Mat<f64>],
    covered: &[Range<usize>],
    order: usize,
    fps: f64,
) -> Dynamics {
    let taps = (RESPONSE * fps).round().max(2.0) as usize;
    impulse_response(inputs, outputs, covered, taps, fps)
        .map(|response| modal(&balanced(&response, order)).dynamics)
        .unwrap_or_default()
}
