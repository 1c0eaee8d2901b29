//! Which number types a model type reads.

use core::fmt::Debug;

/// Number types that a model is read in. A product with one pack names its own, and the code of the other is not linked.
pub trait Numbers: Copy + Debug + 'static {
    /// Reads f32.
    const FLOAT: bool;
    /// Reads the integers of quantised packs.
    const INTEGER: bool;
}

/// Both: the pack decides.
#[derive(Clone, Copy, Debug)]
pub struct AnyNumbers;

/// f32 alone.
#[derive(Clone, Copy, Debug)]
pub struct Floats;

/// Quantised packs alone.
#[derive(Clone, Copy, Debug)]
pub struct Integers;

impl Numbers for AnyNumbers {
    const FLOAT: bool = true;
    const INTEGER: bool = true;
}

impl Numbers for Floats {
    const FLOAT: bool = true;
    const INTEGER: bool = false;
}

impl Numbers for Integers {
    const FLOAT: bool = false;
    const INTEGER: bool = true;
}
