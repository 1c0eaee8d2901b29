//! Identification of a stable state-space model from input and output (multi-input, multi-output):
//! [`impulse_response`] (regularised finite impulse response), [`balanced`] (truncation of its Hankel matrix), [`modal`]
//! (real modal form), and the output equation anew by least squares on the simulation. Short clips need the prior; it costs
//! milliseconds and never gives an unstable model.

mod impulse;
mod modal;
mod output;
mod realise;

use std::ops::Range;

use faer::Mat;

use super::dynamics::Dynamics;

pub use impulse::{ImpulseResponse, impulse_response};
pub use modal::{Modal, modal};
pub use output::Identified;
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

/// A whole model of at most `order` states: [`dynamics`], and the output that fits best what they make of the inputs. On short
/// clips this predicts better than the truncated response's own output (`docs/training-speed.md`). `None` without frames.
///
/// `kinesic train` does the same with moments that it keeps for every candidate, and chooses the penalty by validation.
pub fn identify(
    inputs: &[Mat<f64>],
    outputs: &[Mat<f64>],
    covered: &[Range<usize>],
    order: usize,
    fps: f64,
) -> Option<Identified> {
    output::with_output(dynamics(inputs, outputs, covered, order, fps), inputs, outputs, covered)
}
