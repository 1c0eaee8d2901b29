//! Loops compiled for the widest vectors that the machine has.

pub use pulp::NullaryFnOnce as Work;

/// Runs `work` with the vector instructions of this machine. Loops in it are compiled for each kind of machine and chosen when
/// the program runs; every operation is rounded as elsewhere, so that results have the same bits.
///
/// A short closure will do. What is longer than the compiler inlines by itself is a type with an `inline(always)` [`Work::call`].
#[inline(always)]
pub fn vectorised<W: Work>(work: W) -> W::Output {
    pulp::Arch::new().dispatch(work)
}
