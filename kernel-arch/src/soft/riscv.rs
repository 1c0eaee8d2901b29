//! The definition under the names that the compiler calls on RISC-V. Without the F extension floats are passed in integer
//! registers, so words may stand for them.

use super::portable::{add, mul};

/// `a + b`.
// SAFETY: no other function of the program has the name, but for the weak one of the compiler's library.
#[unsafe(no_mangle)]
extern "C" fn __addsf3(a: u32, b: u32) -> u32 {
    add(a, b)
}

/// `a - b`.
// SAFETY: as above.
#[unsafe(no_mangle)]
extern "C" fn __subsf3(a: u32, b: u32) -> u32 {
    add(a, b ^ 1 << 31)
}

/// `a * b`.
// SAFETY: as above.
#[unsafe(no_mangle)]
extern "C" fn __mulsf3(a: u32, b: u32) -> u32 {
    mul(a, b)
}
