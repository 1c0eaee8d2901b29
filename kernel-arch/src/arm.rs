//! The loop in assembly. A function of its own rather than inline assembly, because r6 and r7 cannot be operands and ARMv6-M
//! names no register above r7.

use crate::{Inputs, Weights};

unsafe extern "C" {
    /// Reads `groups` elements at each pointer (word aligned) and adds to the four sums. Keeps every register that the procedure
    /// call standard says, 104 bytes of stack at most.
    fn kinesic_tile(weights: *const Weights, inputs: *const Inputs, groups: usize, sums: *mut [i32; 4]);
}

/// See [`portable::tile`](crate::portable::tile): the same bits.
#[inline]
pub fn tile(weights: &[Weights], inputs: &[Inputs], sums: &mut [i32; 4]) {
    let groups = weights.len().min(inputs.len());
    // SAFETY: both slices hold at least `groups` elements of whole, aligned words, `sums` is four words that nobody else sees.
    unsafe { kinesic_tile(weights.as_ptr(), inputs.as_ptr(), groups, sums) }
}

/// What the assembler must be told before it takes SMLAD: nothing on ARMv7E-M; on ARMv8-M the name of a core that has the
/// extension. build.rs has made sure that the target's has it.
#[cfg(all(kinesic_tile = "dsp", kinesic_mainline))]
macro_rules! extension {
    () => {
        ".cpu cortex-m33"
    };
}
#[cfg(all(kinesic_tile = "dsp", not(kinesic_mainline)))]
macro_rules! extension {
    () => {
        ""
    };
}

// Cortex-M4: 28 cycles for 16 multiply-adds (two block loads of 3 and 5, 16 data instructions, 4 for the loop).
#[cfg(kinesic_tile = "dsp")]
core::arch::global_asm!(
    extension!(),
    ".syntax unified",
    ".section .text.kinesic_tile,\"ax\",%progbits",
    ".p2align 2",
    ".global kinesic_tile",
    ".type kinesic_tile,%function",
    ".thumb_func",
    "kinesic_tile:",
    "push {{r3-r11, lr}}",
    "ldm r3, {{r4-r7}}",
    "add r2, r0, r2, lsl #4",
    "cmp r0, r2",
    "beq 2f",
    "1:",
    "ldm r1!, {{r12, lr}}",
    "ldm r0!, {{r8-r11}}",
    "sxtb16 r3, r8",
    "sxtb16 r8, r8, ror #8",
    "smlad r4, r3, r12, r4",
    "sxtb16 r3, r9",
    "sxtb16 r9, r9, ror #8",
    "smlad r5, r3, r12, r5",
    "sxtb16 r3, r10",
    "sxtb16 r10, r10, ror #8",
    "smlad r6, r3, r12, r6",
    "sxtb16 r3, r11",
    "sxtb16 r11, r11, ror #8",
    "smlad r7, r3, r12, r7",
    "smlad r4, r8, lr, r4",
    "smlad r5, r9, lr, r5",
    "smlad r6, r10, lr, r6",
    "smlad r7, r11, lr, r7",
    "cmp r0, r2",
    "bne 1b",
    "2:",
    "pop {{r3}}",
    "stm r3, {{r4-r7}}",
    "pop {{r4-r11, pc}}",
    ".size kinesic_tile, . - kinesic_tile",
    ".text",
);

// Cortex-M0+: 74 cycles for 16 multiply-adds with the one-cycle multiplier. The sums are in r8 to r11: ADD reaches them.
#[cfg(kinesic_tile = "thumb1")]
core::arch::global_asm!(
    ".syntax unified",
    ".macro kinesic_row sum",
    "ldm r0!, {{r2}}",
    "sxtb r3, r2",
    "muls r3, r4, r3",
    "add \\sum, r3",
    "lsls r3, r2, #8",
    "asrs r3, r3, #24",
    "muls r3, r5, r3",
    "add \\sum, r3",
    "lsls r3, r2, #16",
    "asrs r3, r3, #24",
    "muls r3, r6, r3",
    "add \\sum, r3",
    "asrs r2, r2, #24",
    "muls r2, r7, r2",
    "add \\sum, r2",
    ".endm",
    ".section .text.kinesic_tile,\"ax\",%progbits",
    ".p2align 2",
    ".global kinesic_tile",
    ".type kinesic_tile,%function",
    ".thumb_func",
    "kinesic_tile:",
    "push {{r4-r7, lr}}",
    "mov r4, r8",
    "mov r5, r9",
    "mov r6, r10",
    "mov r7, r11",
    "push {{r3-r7}}",
    "ldm r3!, {{r4-r7}}",
    "mov r8, r4",
    "mov r9, r5",
    "mov r10, r6",
    "mov r11, r7",
    "lsls r2, r2, #4",
    "adds r2, r0, r2",
    "mov r12, r2",
    "cmp r0, r12",
    "beq 2f",
    "1:",
    "ldm r1!, {{r4, r6}}",
    "asrs r5, r4, #16",
    "sxth r4, r4",
    "asrs r7, r6, #16",
    "sxth r6, r6",
    "kinesic_row r8",
    "kinesic_row r9",
    "kinesic_row r10",
    "kinesic_row r11",
    "cmp r0, r12",
    "bne 1b",
    "2:",
    "mov r4, r8",
    "mov r5, r9",
    "mov r6, r10",
    "mov r7, r11",
    "pop {{r3}}",
    "stm r3!, {{r4-r7}}",
    "pop {{r4-r7}}",
    "mov r8, r4",
    "mov r9, r5",
    "mov r10, r6",
    "mov r11, r7",
    "pop {{r4-r7, pc}}",
    ".size kinesic_tile, . - kinesic_tile",
    ".text",
);
