//! Eight rows of f32 by block loads.

use core::arch::asm;
use core::mem::MaybeUninit;

/// Two columns: their sixteen weights, each times its `x`, onto the eight sums. VMUL and VADD together are cheaper than VFMA's
/// three cycles, and no result is used by the instruction behind it.
macro_rules! two_columns {
    ($first:literal, $second:literal) => {
        concat!(
            "vldm {weights}!, {{s8-s23}}\n",
            products!($first, "s8" "s9" "s10" "s11" "s12" "s13" "s14" "s15"),
            products!($second, "s16" "s17" "s18" "s19" "s20" "s21" "s22" "s23"),
            sums!("s8" "s9" "s10" "s11" "s12" "s13" "s14" "s15"),
            sums!("s16" "s17" "s18" "s19" "s20" "s21" "s22" "s23"),
        )
    };
}

/// Every weight times `x`, in place.
macro_rules! products {
    ($x:literal, $($weight:literal)*) => {
        concat!($("vmul.f32 ", $weight, ", ", $weight, ", ", $x, "\n",)*)
    };
}

/// `s0..s7 +=` the eight products.
macro_rules! sums {
    ($($product:literal)*) => {
        sums!(@ "s0" "s1" "s2" "s3" "s4" "s5" "s6" "s7"; $($product)*)
    };
    (@ $($sum:literal)*; $($product:literal)*) => {
        concat!($("vadd.f32 ", $sum, ", ", $sum, ", ", $product, "\n",)*)
    };
}

/// See [`portable::column_tile`](crate::portable::column_tile): the same bits.
///
/// Cortex-M4: 209 cycles for eight columns, 64 multiply-adds (block loads of 9 and four of 17, 128 for VMUL and VADD, 4 for the
/// loop), 105 for four, 32 for one.
#[inline]
pub fn column_tile(weights: &[[f32; 8]], x: &[f32]) -> [f32; 8] {
    let columns = weights.len().min(x.len());
    let (eights, four, rest) = (columns / 8, columns & 4, columns % 4);
    let mut sums = MaybeUninit::<[f32; 8]>::uninit();
    // SAFETY: both slices hold at least `columns` elements, aligned for f32 as block loads need it; `8 eights + four + rest` are
    // read. `sums` is eight floats, all written. Every register that is written is named.
    unsafe {
        asm!(
            "vmov s0, {zero}",
            "vmov s1, {zero}",
            "vmov s2, {zero}",
            "vmov s3, {zero}",
            "vmov s4, {zero}",
            "vmov s5, {zero}",
            "vmov s6, {zero}",
            "vmov s7, {zero}",
            "cmp {eights}, #0",
            "beq 3f",
            "2:",
            "vldm {x}!, {{s24-s31}}",
            two_columns!("s24", "s25"),
            two_columns!("s26", "s27"),
            two_columns!("s28", "s29"),
            two_columns!("s30", "s31"),
            "subs {eights}, {eights}, #1",
            "bne 2b",
            "3:",
            "cmp {four}, #0",
            "beq 6f",
            "vldm {x}!, {{s24-s27}}",
            two_columns!("s24", "s25"),
            two_columns!("s26", "s27"),
            "6:",
            "cmp {rest}, #0",
            "beq 5f",
            "4:",
            "vldm {x}!, {{s24}}",
            "vldm {weights}!, {{s8-s15}}",
            products!("s24", "s8" "s9" "s10" "s11" "s12" "s13" "s14" "s15"),
            sums!("s8" "s9" "s10" "s11" "s12" "s13" "s14" "s15"),
            "subs {rest}, {rest}, #1",
            "bne 4b",
            "5:",
            "vstm {sums}, {{s0-s7}}",
            zero = in(reg) 0,
            four = in(reg) four,
            sums = in(reg) sums.as_mut_ptr(),
            weights = inout(reg) weights.as_ptr() => _,
            x = inout(reg) x.as_ptr() => _,
            eights = inout(reg) eights => _,
            rest = inout(reg) rest => _,
            out("s0") _, out("s1") _, out("s2") _, out("s3") _, out("s4") _, out("s5") _, out("s6") _, out("s7") _,
            out("s8") _, out("s9") _, out("s10") _, out("s11") _, out("s12") _, out("s13") _, out("s14") _,
            out("s15") _, out("s16") _, out("s17") _, out("s18") _, out("s19") _, out("s20") _, out("s21") _,
            out("s22") _, out("s23") _, out("s24") _, out("s25") _, out("s26") _, out("s27") _, out("s28") _,
            out("s29") _, out("s30") _, out("s31") _,
            options(nostack),
        );
        sums.assume_init()
    }
}
