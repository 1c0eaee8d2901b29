//! Sums and products in assembly for ARMv6-M, under the names of the run-time ABI for the Arm architecture. The steps are those of
//! [`portable`](super::portable); what is rare goes there, and so do all checks that the fast way would not survive.

use core::arch::global_asm;

use super::portable::{rare_add, rare_mul};

extern "C" fn add(a: u32, b: u32) -> u32 {
    rare_add(a, b)
}

extern "C" fn mul(a: u32, b: u32) -> u32 {
    rare_mul(a, b)
}

/// The end of all: r1 holds the significand, its leading one in bit 31 or 30, and N its sign; r2 the stored exponent less one for bit
/// 31, the sign in bit 8.
macro_rules! normalise_and_round {
    ($sticky:literal) => {
        concat!("bmi 70f\n", "lsls r1, r1, #1\n", "subs r2, #1\n", "70:\n", round!($sticky))
    };
}

/// The leading one in bit 31. Ties to even: bit 7 rounds up through the carry, and where nothing is below it, the lowest bit of what
/// is kept is cleared. r4 and r5 are given back.
macro_rules! round {
    ($sticky:literal) => {
        concat!(
            "lsls r2, r2, #23\n",
            "lsrs r0, r1, #8\n",
            "adcs r0, r2\n",
            "lsls r1, r1, #25\n",
            "beq 71f\n",
            "72:\n",
            "pop {{r4, r5}}\n",
            "bx lr\n",
            "71:\n",
            "bcc 72b\n",
            $sticky,
            "lsrs r0, r0, #1\n",
            "lsls r0, r0, #1\n",
            "pop {{r4, r5}}\n",
            "bx lr\n",
        )
    };
}

/// r0 and r1, each a number: r0 and r1 become the significands with the leading one in bit 30, the second moved down by r3, what
/// is moved out of it kept as one bit. r5 holds 1 << 31; r4 is overwritten.
macro_rules! align {
    () => {
        concat!(
            "lsls r1, r1, #8\n",
            "orrs r1, r5\n",
            "lsrs r1, r1, #1\n",
            "lsls r0, r0, #8\n",
            "orrs r0, r5\n",
            "lsrs r0, r0, #1\n",
            "cmp r3, #7\n",
            "bls 60f\n",
            "movs r4, r1\n",
            "lsrs r1, r3\n",
            "movs r5, r1\n",
            "lsls r5, r3\n",
            "cmp r4, r5\n",
            "beq 61f\n",
            "movs r4, #1\n",
            "orrs r1, r4\n",
            "b 61f\n",
            "60:\n",
            "lsrs r1, r3\n",
            "61:\n",
        )
    };
}

// Cortex-M0+: a sum 51 to 58 cycles, a product 57, call and return included, where nothing is rare.
global_asm!(
    ".syntax unified",
    ".section .text.kinesic_soft_float,\"ax\",%progbits",
    ".p2align 2",
    ".global __aeabi_fsub",
    ".type __aeabi_fsub,%function",
    ".thumb_func",
    "__aeabi_fsub:",
    "movs r2, #1",
    "lsls r2, r2, #31",
    "eors r1, r2",
    ".global __aeabi_fadd",
    ".type __aeabi_fadd,%function",
    ".thumb_func",
    "__aeabi_fadd:",
    "push {{r4, r5}}",
    // The larger one to r0.
    "lsls r2, r0, #1",
    "lsls r3, r1, #1",
    "cmp r2, r3",
    "bhs 1f",
    "movs r4, r0",
    "movs r0, r1",
    "movs r1, r4",
    "movs r4, r2",
    "movs r2, r3",
    "movs r3, r4",
    "1:",
    "lsrs r2, r2, #24",
    "cmp r2, #254",
    "bhs 9f",
    "lsrs r3, r3, #24",
    "beq 8f",
    "subs r3, r2, r3",
    "cmp r3, #25",
    "bhi 7f",
    "movs r5, #1",
    "lsls r5, r5, #31",
    "movs r4, r0",
    "eors r4, r1",
    "bmi 2f",
    // One sign: the sum's leading one is in bit 30, with the larger exponent, or in bit 31.
    "lsrs r4, r0, #31",
    "lsls r4, r4, #8",
    "adds r2, r2, r4",
    align!(),
    "adds r1, r0, r1",
    normalise_and_round!(""),
    // Two signs.
    "2:",
    "cmp r2, #32",
    "blo 9f",
    "lsrs r4, r0, #31",
    "lsls r4, r4, #8",
    "adds r2, r2, r4",
    align!(),
    "subs r1, r0, r1",
    "beq 6f",
    // At least one place: the leading one is below bit 31. As a rule one or two.
    "3:",
    "subs r2, #1",
    "lsls r1, r1, #1",
    "bpl 3b",
    round!(""),
    "6:",
    "movs r0, #0",
    "7:",
    "pop {{r4, r5}}",
    "bx lr",
    // The smaller one is subnormal, or zero: then the other is the sum. Two zeros of different signs make a positive one.
    "8:",
    "lsls r3, r1, #1",
    "bne 9f",
    "lsls r3, r0, #1",
    "bne 7b",
    "ands r0, r1",
    "b 7b",
    "9:",
    "pop {{r4, r5}}",
    "ldr r2, 10f",
    "bx r2",
    ".p2align 2",
    "10:",
    ".word {add}",
    ".size __aeabi_fadd, . - __aeabi_fadd",
    ".global __aeabi_fmul",
    ".type __aeabi_fmul,%function",
    ".thumb_func",
    "__aeabi_fmul:",
    "push {{r4, r5}}",
    "lsls r2, r0, #1",
    "lsrs r2, r2, #24",
    "lsls r3, r1, #1",
    "lsrs r3, r3, #24",
    "beq 8f",
    "cmp r2, #0",
    "beq 8f",
    "cmp r2, #255",
    "beq 9f",
    "cmp r3, #255",
    "beq 9f",
    "adds r2, r2, r3",
    "subs r2, #128",
    "cmp r2, #252",
    "bhi 9f",
    "movs r3, r0",
    "eors r3, r1",
    "lsrs r3, r3, #31",
    "lsls r3, r3, #8",
    "adds r2, r2, r3",
    "adds r2, #1",
    // The significands as 16 bits above and 8 below: four products of 32 bits.
    "movs r3, #1",
    "lsls r3, r3, #31",
    "uxtb r4, r0",
    "uxtb r5, r1",
    "lsls r0, r0, #8",
    "orrs r0, r3",
    "lsrs r0, r0, #16",
    "lsls r1, r1, #8",
    "orrs r1, r3",
    "lsrs r1, r1, #16",
    "movs r3, r4",
    "muls r3, r5",
    "muls r4, r1",
    "muls r5, r0",
    "muls r1, r0",
    "adds r4, r4, r5",
    "lsrs r5, r3, #8",
    "adds r4, r4, r5",
    "lsrs r5, r4, #8",
    "adds r1, r1, r5",
    // What is below r1 is in the low bytes of r3 and r4: looked at only where it decides.
    normalise_and_round!("orrs r3, r4\nuxtb r3, r3\ncmp r3, #0\nbne 72b\n"),
    // One of them is zero or subnormal.
    "8:",
    "cmp r2, #255",
    "beq 9f",
    "cmp r3, #255",
    "beq 9f",
    "lsls r2, r0, #1",
    "beq 7f",
    "lsls r2, r1, #1",
    "bne 9f",
    "7:",
    "eors r0, r1",
    "lsrs r0, r0, #31",
    "lsls r0, r0, #31",
    "pop {{r4, r5}}",
    "bx lr",
    "9:",
    "pop {{r4, r5}}",
    "ldr r2, 10f",
    "bx r2",
    ".p2align 2",
    "10:",
    ".word {mul}",
    ".size __aeabi_fmul, . - __aeabi_fmul",
    ".text",
    add = sym add,
    mul = sym mul,
);
