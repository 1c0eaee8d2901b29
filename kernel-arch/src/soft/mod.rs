//! Single-precision sums and products for cores without an FPU, in the place of the compiler's: the same bits (IEEE 754, to
//! nearest, ties to even, subnormals kept), in a half to a third of the time.
//!
//! [`portable`] is the definition, in safe Rust, and what runs on RISC-V; ARMv6-M has assembly for what is neither subnormal nor
//! infinite nor NaN, and comes back to the definition for the rest. With the feature `soft-float` the functions have the names
//! that the compiler calls, so all code of the program gets them.

pub mod portable;
#[cfg(kinesic_soft_float = "riscv")]
mod riscv;
#[cfg(kinesic_soft_float = "thumb1")]
mod thumb1;
