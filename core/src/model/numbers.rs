//! Which number types a model type reads.

use core::fmt::Debug;
use core::marker::PhantomData;

/// Number types that a model is read in. A product with one pack names its own, and the code of the other is not linked.
pub trait Numbers: Copy + Debug + 'static {
    /// Reads f32.
    const FLOAT: bool;
    /// Reads the integers of quantised packs.
    const INTEGER: bool;
    /// Reads translators that know how familiar a frame is.
    const GATED: bool = true;
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

/// The number types `N`, and no translator that knows how familiar a frame is: those of machines never do, nor does any that was trained with
/// `--no-gate`. The code of the gate is not linked: some 6 kB of flash on a Cortex-M4F.
#[derive(Clone, Copy, Debug)]
pub struct Ungated<N>(PhantomData<N>);

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

impl<N: Numbers> Numbers for Ungated<N> {
    const FLOAT: bool = N::FLOAT;
    const INTEGER: bool = N::INTEGER;
    const GATED: bool = false;
}
