//! Single-precision arithmetic for cores without an FPU, in the place of the compiler's: the same bits (IEEE 754, to nearest, ties
//! to even, subnormals kept) but for a NaN's sign and payload, on ARMv6-M in 37 % of the time, on RISC-V in four fifths.
//!
//! [`portable`] is the definition, in safe Rust. It is what runs on RISC-V, but for quotients, which are the compiler's there.
//! ARMv6-M has assembly for what is neither subnormal nor infinite nor NaN, and comes back to the definition for the rest. With the feature `soft-float` the functions have the names
//! that the compiler calls, so all code of the program gets them.

pub mod portable;
#[cfg(kinesic_soft_float = "riscv")]
mod riscv;
#[cfg(kinesic_soft_float = "thumb1")]
mod thumb1;
