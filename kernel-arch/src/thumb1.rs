//! The square root on ARMv6-M: the loop in assembly, since the compiler moves its five values through the stack.

use core::arch::global_asm;

unsafe extern "C" {
    /// The root of `rest`, its leading one in bit 24 or 25, to 25 bits. Reads and writes no memory.
    safe fn kinesic_root(rest: u32) -> u32;
}

/// See [`portable::sqrt`](crate::portable::sqrt): the same bits. Cortex-M0+: 230 cycles.
#[inline(never)]
pub fn sqrt(x: f32) -> f32 {
    crate::portable::sqrt_by(x, |rest| kinesic_root(rest))
}

// 185 cycles on a Cortex-M0+: five bits a pass.
global_asm!(
    ".syntax unified",
    ".section .text.kinesic_root,\"ax\",%progbits",
    ".p2align 2",
    ".global kinesic_root",
    ".type kinesic_root,%function",
    ".thumb_func",
    "kinesic_root:",
    // Twice the root, and the bit that is tried.
    "movs r1, #0",
    "movs r2, #1",
    "lsls r2, r2, #24",
    "1:",
    ".rept 5",
    "adds r3, r1, r2",
    "cmp r3, r0",
    "bhi 2f",
    "subs r0, r0, r3",
    "adds r1, r3, r2",
    "2:",
    "lsls r0, r0, #1",
    "lsrs r2, r2, #1",
    ".endr",
    "bne 1b",
    "lsrs r0, r1, #1",
    "bx lr",
    ".size kinesic_root, . - kinesic_root",
    ".text",
);
