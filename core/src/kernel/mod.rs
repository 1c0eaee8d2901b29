//! The inner loops. Nothing else in the crate is hot.
//!
//! Every loop keeps one order of summation and writes `a * b + c` plainly (two roundings), so that host and target agree
//! bit for bit.

mod activation;
mod fixed;
mod modal;
mod quantised;
mod tiled;

pub use activation::{quadrant_angle, sin_cos, tanh};
pub use fixed::{
    FixedBlock, FixedTransition, INPUT_BITS, JOINT_INPUT_CUT, LARGEST_INPUT, LARGEST_JOINT_ROW, LARGEST_ROW,
    OUTPUT_BITS, Rows, STATE_BITS, TRANSITION_BITS, advance_fixed, advance_joint_fixed, from_output, is_bounded,
    is_shift, row_size, to_fixed, transition,
};
pub use modal::{Block, JointBlock, advance, advance_joint, is_stable, settle};
pub use quantised::{
    ACTIVATION_BITS, Activations, LARGEST_ACTIVATION, MOST_COLUMNS, PRE_ACTIVATION_BITS, Quantised, TILE, tanh_fixed,
};
pub use tiled::{ROWS, Tiled};

pub(crate) use kinesic_kernel_arch::{scale16, sqrt};

/// `sum(a[i] * b[i])` in index order over the shorter length. Cost: one multiply-add per element.
pub fn dot(a: &[f32], b: &[f32]) -> f32 {
    let mut sum = 0.0;
    for (a, b) in a.iter().zip(b) {
        sum += a * b;
    }
    sum
}
