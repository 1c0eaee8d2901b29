//! The work of one frame, the same source for the simulated device and for the host.
//!
//! A workload knows nothing about emulators, semihosting or files: it opens a pack, takes a frame of input, steps, and
//! shows its output. `firmware-sim/image` runs it on the device; `kinesic-firmware-sim` runs it on the host and compares.
#![no_std]

pub mod arithmetic;
pub mod by_hand;
mod digest;
pub mod emotion;
pub mod face;
mod frames;
pub mod held;
pub mod kernel;
pub mod machine;
pub mod mechanics;
pub mod modal;
pub mod peer;
pub mod player;
pub mod pose;
pub mod posed;
pub mod servos;

pub use digest::Digest;
pub use frames::Frames;
pub use kinesic::model::{Floats, Integers};

/// The pack does not fit the workload's capacities, or its check failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refused;

/// One thing that a device does every frame.
///
/// [`Workload::load`] and [`Workload::output`] belong to the test bench; the cost of a frame is [`Workload::step`] alone.
pub trait Workload {
    /// What opening the pack gives: a view of the bytes in flash, not a copy.
    type Model<'p>;
    /// Everything that a frame changes. It lives in static RAM, so its size is part of the measured RAM.
    type State: 'static;

    /// Checks the pack. Runs once; its stack is reported apart.
    fn open(pack: &[u8]) -> Result<Self::Model<'_>, Refused>;
    /// The state at power-on.
    fn power_on(model: &Self::Model<'_>) -> Self::State;
    /// Takes one frame of input, as `Frames` gives it.
    fn load(model: &Self::Model<'_>, state: &mut Self::State, input: &[u8]);
    /// The measured work of one frame.
    fn step(model: &Self::Model<'_>, state: &mut Self::State);
    /// Feeds every output bit of the frame to the digest.
    fn output(model: &Self::Model<'_>, state: &Self::State, digest: &mut Digest);
}
