//! The two loops that kinesic's matrices run through: [`tile`], four rows of int8 times int16, and [`column_tile`], eight rows
//! of f32; and the square root, [`sqrt`].
//!
//! [`portable`] is the definition of the loops, in safe Rust. Where the compiler does not find the right instructions there is
//! assembly: SMLAD on cores with the DSP extension, VMLADAVA on those with Helium, MULS on ARMv6-M, block loads and VSQRT of the single-precision FPU. On every
//! other core the portable loops run. The bits are the same: integers are modulo 2^32, floats have one order and two roundings a
//! multiply-add, roots are correctly rounded. [`soft`] is f32 arithmetic for cores without an FPU. Without the features `asm` and
//! `soft-float` the crate holds no unsafe code.
#![no_std]

#[cfg(kinesic_tile)]
mod arm;
#[cfg(kinesic_tile = "helium")]
mod helium;
pub mod portable;
pub mod soft;
#[cfg(kinesic_tile = "thumb1")]
mod thumb1;
#[cfg(kinesic_root)]
mod vfp;

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

/// `sum of weights[column][row] * x[column]` a row, columns in order, over the shorter of `weights` and `x`. Bit-equal to
/// [`portable::column_tile`] on every core.
#[cfg(not(kinesic_column_tile))]
#[inline]
pub fn column_tile(weights: &[[f32; 8]], x: &[f32]) -> [f32; 8] {
    portable::column_tile(weights, x)
}

#[cfg(kinesic_column_tile)]
pub use vfp::column_tile;

/// Square root, correctly rounded: the same bits on every core, but for the sign of the NaN below zero.
#[cfg(not(any(kinesic_root, kinesic_narrow_multiply)))]
#[inline]
pub fn sqrt(x: f32) -> f32 {
    libm::sqrtf(x)
}

/// Square root, correctly rounded: `libm`'s needs products of 64 bits.
#[cfg(all(kinesic_narrow_multiply, not(kinesic_tile)))]
pub use portable::sqrt;

#[cfg(kinesic_tile = "thumb1")]
pub use thumb1::sqrt;

#[cfg(kinesic_root)]
pub use vfp::sqrt;

/// The word of a row: its four columns in the order that [`Weights`] has.
pub const fn pack_weights([c0, c1, c2, c3]: [i8; 4]) -> u32 {
    u32::from_le_bytes([c0 as u8, c2 as u8, c1 as u8, c3 as u8])
}

/// `w * x / 2^16`, rounded down: SMULW on ARMv7E-M.
#[cfg(not(kinesic_narrow_multiply))]
#[inline(always)]
pub fn scale16(w: i16, x: i32) -> i32 {
    ((i64::from(w) * i64::from(x)) >> 16) as i32
}

/// `w * x / 2^16`, rounded down, in two products of 32 bits: the core has no wider ones.
#[cfg(kinesic_narrow_multiply)]
pub use portable::scale16;

/// `w * x / 2^32`, rounded to nearest, ties up.
#[cfg(not(kinesic_narrow_multiply))]
#[inline(always)]
pub fn scale32(w: i32, x: i32) -> i32 {
    ((i64::from(w) * i64::from(x) + (1 << 31)) >> 32) as i32
}

/// `w * x / 2^32`, rounded to nearest, ties up, in four products of 32 bits.
#[cfg(kinesic_narrow_multiply)]
pub use portable::scale32;
