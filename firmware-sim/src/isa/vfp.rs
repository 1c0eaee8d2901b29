//! The coprocessor space: the scalar FPU (ARM DDI 0403, chapter A6) and, coarsely, Helium (DDI 0553).

use super::{Class, Op, Registers, field, reg};

/// Registers of FPU operand `at` (its four-bit field) with extra bit `extra`; a double covers two singles.
fn float(word: u16, at: u32, extra: u32, double: bool) -> Registers {
    let four = field(word, at, 4);
    if double {
        // D16 to D31 do not exist on these cores: the extra bit is 0.
        0b11 << (32 + 2 * four)
    } else {
        1 << (32 + 2 * four + extra)
    }
}

/// Decodes two halfwords of the coprocessor space.
pub fn decode(first: u16, second: u16, helium: bool) -> Option<Op> {
    let scalar = matches!(field(second, 8, 4), 9..=11) && first & 0x0f00 < 0x0f00;
    let upper = first & 0x1000 != 0;
    match (scalar, first & 0x0f00, upper) {
        (true, 0x0c00 | 0x0d00, false) => memory(first, second),
        (true, 0x0e00, false) if second & 0x10 != 0 => Some(transfer(first, second)),
        (true, 0x0e00, false) => data(first, second),
        // VSEL, VMAXNM, VMINNM, VRINT, VCVT with rounding.
        (true, 0x0e00, true) if second & 0x10 == 0 => Some(three(Class::Float, first, second)),
        (_, 0x0c00 | 0x0d00, _) if helium => Some(Op::new(Class::VectorMemory, 0, reg(field(first, 0, 4)))),
        _ if helium => Some(Op::new(Class::Vector, 0, 0)),
        _ => None,
    }
}

fn double(second: u16) -> bool {
    second & 0x100 != 0
}

fn three(class: Class, first: u16, second: u16) -> Op {
    let wide = double(second);
    let d = float(second, 12, field(first, 6, 1), wide);
    let n = float(first, 0, field(second, 7, 1), wide);
    let m = float(second, 0, field(second, 5, 1), wide);
    Op::new(class, d, n | m | if class == Class::FloatMac { d } else { 0 })
}

fn data(first: u16, second: u16) -> Option<Op> {
    Some(match field(first, 4, 4) & 0b1011 {
        0 | 1 | 9 | 10 => three(Class::FloatMac, first, second),
        2 | 3 => three(Class::Float, first, second),
        8 => three(Class::FloatDivide, first, second),
        11 => {
            let wide = double(second);
            let d = float(second, 12, field(first, 6, 1), wide);
            let m = float(second, 0, field(second, 5, 1), wide);
            let (kind, sub) = (field(first, 0, 4), field(second, 6, 2));
            match (kind, sub) {
                (_, 0 | 2) => Op::new(Class::Float, d, 0), // VMOV of a constant
                (1, 3) => Op::new(Class::FloatDivide, d, m),
                (4 | 5, _) => Op::new(Class::Float, 0, d | m), // VCMP
                _ => Op::new(Class::Float, d, m),
            }
        }
        _ => return None,
    })
}

fn transfer(first: u16, second: u16) -> Op {
    let core = reg(field(second, 12, 4));
    let float = float(first, 0, field(second, 7, 1), false);
    if field(first, 5, 3) == 7 {
        Op::new(Class::FloatMove, 0, 0) // VMRS, VMSR
    } else if first & 0x10 == 0 {
        Op::new(Class::FloatMove, float, core)
    } else {
        Op::new(Class::FloatMove, core, float)
    }
}

fn memory(first: u16, second: u16) -> Option<Op> {
    let base = reg(field(first, 0, 4));
    let load = first & 0x10 != 0;
    if first & 0xffe0 == 0xec40 {
        let core = reg(field(second, 12, 4)) | base;
        let m = float(second, 0, field(second, 5, 1), double(second)) * if double(second) { 1 } else { 3 };
        return Some(Op::new(Class::FloatMovePair, if load { core } else { m }, if load { m } else { core }));
    }
    let (pre, back) = (first & 0x100 != 0, first & 0x20 != 0);
    if pre && !back {
        let t = float(second, 12, field(first, 6, 1), double(second));
        return Some(match (load, double(second)) {
            (true, false) => Op::memory(Class::FloatLoad, t, 0, base),
            (true, true) => Op::memory(Class::FloatLoadPair, t, 0, base),
            (false, false) => Op::memory(Class::FloatStore, 0, t, base),
            (false, true) => Op::memory(Class::FloatStorePair, 0, t, base),
        });
    }
    let words = u32::from(second & 0xff);
    if words == 0 || words > 32 {
        return None;
    }
    let lowest = float(second, 12, field(first, 6, 1), double(second)).trailing_zeros();
    let registers = (((1u128 << words) - 1) << lowest) as u64;
    let updated = if back { base } else { 0 };
    Some(if load {
        Op::multiple(Class::FloatLoadMultiple, words, registers | updated, 0, base)
    } else {
        Op::multiple(Class::FloatStoreMultiple, words, updated, registers, base)
    })
}
