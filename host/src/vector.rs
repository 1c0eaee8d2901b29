//! Loops compiled for the widest vectors that the machine has.

/// Runs `work` with the vector instructions of this machine. Loops in it are compiled for each kind of machine and chosen when
/// the program runs; every operation is rounded as elsewhere, so that results have the same bits.
#[inline(always)]
pub fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}
