//! Four rows of an int8 matrix times a vector of int16: the inner loop of kinesic's quantised networks.
//!
//! [`portable::tile`] is the definition, in safe Rust. On ARMv7E-M [`tile`] is a loop
//! around SMLAD, on ARMv6-M one around MULS, both in assembly, because the compiler finds neither; on every other core it is the
//! portable loop. The bits are the same: all arithmetic is modulo 2^32. Without the feature `asm` the portable loop is used
//! everywhere and the crate holds no unsafe code.
#![no_std]

#[cfg(kinesic_tile)]
mod arm;
pub mod portable;

/// Sixteen weights, four rows by four columns: a word a row, its bytes the columns 0, 2, 1, 3 (lowest byte first), so that
/// one SXTB16 gives columns 0 and 1 and another, rotated by eight bits, columns 2 and 3.
pub type Weights = [u32; 4];

/// Four activations: two words of two int16 each, the lower column in the lower half.
pub type Inputs = [u32; 2];

/// `sums[row] += sum over columns of weight * input`, modulo 2^32, over the shorter of `weights` and `inputs`. Bit-equal to
/// [`portable::tile`] on every core.
#[cfg(not(kinesic_tile))]
#[inline]
pub fn tile(weights: &[Weights], inputs: &[Inputs], sums: &mut [i32; 4]) {
    portable::tile(weights, inputs, sums);
}

#[cfg(kinesic_tile)]
pub use arm::tile;

/// The word of a row: its four columns in the order that [`Weights`] has.
pub const fn pack_weights([c0, c1, c2, c3]: [i8; 4]) -> u32 {
    u32::from_le_bytes([c0 as u8, c2 as u8, c1 as u8, c3 as u8])
}
