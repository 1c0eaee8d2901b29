//! RV32IMC (The RISC-V Instruction Set Manual, volume I, chapters "RV32I", "M" and "C").

use super::{Class, Op, Registers, field};

/// The set of one register; `x0` is never waited for.
const fn x(index: u32) -> Registers {
    (1 << (index & 31)) & !1
}

/// Decodes a 32-bit instruction.
pub fn full(word: u32) -> Option<Op> {
    let (d, s1, s2) = (x(word >> 7), x(word >> 15), x(word >> 20));
    let (kind, top) = (word >> 12 & 7, word >> 25);
    Some(match word & 0x7f {
        0x37 | 0x17 => Op::new(Class::Alu, d, 0),
        0x6f if d == 0 => Op::new(Class::Branch, 0, 0),
        0x6f => Op::new(Class::Call, d, 0),
        0x67 if kind == 0 => Op::new(if d == 0 { Class::BranchRegister } else { Class::Call }, d, s1),
        0x63 if !matches!(kind, 2 | 3) => Op::new(Class::BranchIf, 0, s1 | s2),
        0x03 if !matches!(kind, 3 | 6 | 7) => Op::memory(Class::Load, d, 0, s1),
        0x23 if kind < 3 => Op::memory(Class::Store, 0, s2, s1),
        0x13 => Op::new(Class::Alu, d, s1),
        0x33 if top == 1 => Op::new(if kind < 4 { Class::Multiply } else { Class::Divide }, d, s1 | s2),
        0x33 if matches!(top, 0 | 0x20) => Op::new(Class::Alu, d, s1 | s2),
        0x0f | 0x73 => Op::new(Class::System, d, s1),
        _ => return None,
    })
}

/// Decodes a 16-bit instruction.
pub fn compressed(half: u16) -> Option<Op> {
    if half == 0 {
        return None;
    }
    let (sp, ra) = (x(2), x(1));
    let (short_low, short_high) = (x(8 + field(half, 2, 3)), x(8 + field(half, 7, 3)));
    let (d, s2) = (x(field(half, 7, 5)), x(field(half, 2, 5)));
    Some(match (half & 3, half >> 13) {
        (0, 0) => Op::new(Class::Alu, short_low, sp),
        (0, 2) => Op::memory(Class::Load, short_low, 0, short_high),
        (0, 6) => Op::memory(Class::Store, 0, short_low, short_high),
        (1, 0) => Op::new(Class::Alu, d, d),
        (1, 1) => Op::new(Class::Call, ra, 0),
        (1, 2) => Op::new(Class::Alu, d, 0),
        (1, 3) => Op::new(Class::Alu, d, if d == sp { sp } else { 0 }),
        (1, 4) => {
            let register_form = field(half, 10, 2) == 3;
            Op::new(Class::Alu, short_high, short_high | if register_form { short_low } else { 0 })
        }
        (1, 5) => Op::new(Class::Branch, 0, 0),
        (1, 6 | 7) => Op::new(Class::BranchIf, 0, short_high),
        (2, 0) => Op::new(Class::Alu, d, d),
        (2, 2) => Op::memory(Class::Load, d, 0, sp),
        (2, 4) => match (half & 0x1000 != 0, d != 0, s2 != 0) {
            (false, true, false) => Op::new(Class::BranchRegister, 0, d),
            (true, true, false) => Op::new(Class::Call, ra, d),
            (true, false, false) => Op::new(Class::System, 0, 0),
            (false, _, true) => Op::new(Class::Alu, d, s2),
            (true, _, true) => Op::new(Class::Alu, d, d | s2),
            (false, false, false) => return None,
        },
        (2, 6) => Op::memory(Class::Store, 0, s2, sp),
        _ => return None,
    })
}
