//! The f32 loop in assembly: the compiler loads weights one by one, at two cycles each on a Cortex-M4, where a block load
//! takes one a weight.

use core::arch::asm;

/// `s12..s19 *= x`: the products of a column that was loaded there.
macro_rules! first_products {
    ($x:literal) => {
        concat!(
            "vmul.f32 s12, s12, ",
            $x,
            "\n",
            "vmul.f32 s13, s13, ",
            $x,
            "\n",
            "vmul.f32 s14, s14, ",
            $x,
            "\n",
            "vmul.f32 s15, s15, ",
            $x,
            "\n",
            "vmul.f32 s16, s16, ",
            $x,
            "\n",
            "vmul.f32 s17, s17, ",
            $x,
            "\n",
            "vmul.f32 s18, s18, ",
            $x,
            "\n",
            "vmul.f32 s19, s19, ",
            $x,
            "\n",
        )
    };
}

/// `s20..s27 *= x`.
macro_rules! second_products {
    ($x:literal) => {
        concat!(
            "vmul.f32 s20, s20, ",
            $x,
            "\n",
            "vmul.f32 s21, s21, ",
            $x,
            "\n",
            "vmul.f32 s22, s22, ",
            $x,
            "\n",
            "vmul.f32 s23, s23, ",
            $x,
            "\n",
            "vmul.f32 s24, s24, ",
            $x,
            "\n",
            "vmul.f32 s25, s25, ",
            $x,
            "\n",
            "vmul.f32 s26, s26, ",
            $x,
            "\n",
            "vmul.f32 s27, s27, ",
            $x,
            "\n",
        )
    };
}

/// `s0..s7 += s12..s19`.
macro_rules! add_first {
    () => {
        concat!(
            "vadd.f32 s0, s0, s12\n",
            "vadd.f32 s1, s1, s13\n",
            "vadd.f32 s2, s2, s14\n",
            "vadd.f32 s3, s3, s15\n",
            "vadd.f32 s4, s4, s16\n",
            "vadd.f32 s5, s5, s17\n",
            "vadd.f32 s6, s6, s18\n",
            "vadd.f32 s7, s7, s19\n",
        )
    };
}

/// `s0..s7 += s20..s27`.
macro_rules! add_second {
    () => {
        concat!(
            "vadd.f32 s0, s0, s20\n",
            "vadd.f32 s1, s1, s21\n",
            "vadd.f32 s2, s2, s22\n",
            "vadd.f32 s3, s3, s23\n",
            "vadd.f32 s4, s4, s24\n",
            "vadd.f32 s5, s5, s25\n",
            "vadd.f32 s6, s6, s26\n",
            "vadd.f32 s7, s7, s27\n",
        )
    };
}

/// See [`portable::column_tile`](crate::portable::column_tile): the same bits.
///
/// Cortex-M4: 107 cycles for four columns, 32 multiply-adds (block loads of 5, 17 and 17, 64 for VMUL and VADD, which together
/// are cheaper than VFMA's 3, 4 for the loop). No result is used by the instruction behind it.
#[inline]
pub fn column_tile(weights: &[[f32; 8]], x: &[f32], sums: &mut [f32; 8]) {
    let columns = weights.len().min(x.len());
    let (fours, rest) = (columns / 4, columns % 4);
    // SAFETY: both slices hold at least `columns` elements, aligned for f32 as block loads need it; `4 fours + rest` are read.
    // `sums` is eight floats that nobody else sees. Every register that is written is named.
    unsafe {
        asm!(
            "vldm {sums}, {{s0-s7}}",
            "cmp {fours}, #0",
            "beq 3f",
            "2:",
            "vldm {x}!, {{s8-s11}}",
            "vldm {weights}!, {{s12-s27}}",
            first_products!("s8"),
            second_products!("s9"),
            add_first!(),
            add_second!(),
            "vldm {weights}!, {{s12-s27}}",
            first_products!("s10"),
            second_products!("s11"),
            add_first!(),
            add_second!(),
            "subs {fours}, {fours}, #1",
            "bne 2b",
            "3:",
            "cmp {rest}, #0",
            "beq 5f",
            "4:",
            "vldm {x}!, {{s8}}",
            "vldm {weights}!, {{s12-s19}}",
            first_products!("s8"),
            add_first!(),
            "subs {rest}, {rest}, #1",
            "bne 4b",
            "5:",
            "vstm {sums}, {{s0-s7}}",
            sums = in(reg) sums.as_mut_ptr(),
            weights = inout(reg) weights.as_ptr() => _,
            x = inout(reg) x.as_ptr() => _,
            fours = inout(reg) fours => _,
            rest = inout(reg) rest => _,
            out("s0") _, out("s1") _, out("s2") _, out("s3") _, out("s4") _, out("s5") _, out("s6") _,
            out("s7") _, out("s8") _, out("s9") _, out("s10") _, out("s11") _, out("s12") _, out("s13") _,
            out("s14") _, out("s15") _, out("s16") _, out("s17") _, out("s18") _, out("s19") _, out("s20") _,
            out("s21") _, out("s22") _, out("s23") _, out("s24") _, out("s25") _, out("s26") _, out("s27") _,
            options(nostack),
        );
    }
}
