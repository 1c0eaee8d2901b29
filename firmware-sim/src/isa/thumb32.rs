//! 32-bit Thumb encodings without the coprocessor space (ARM DDI 0403, chapter A5.3; DDI 0553 for ARMv8.1-M loops).

use super::{Class, Op, Registers, field, reg, vfp};

const PC: Registers = reg(15);
const LR: Registers = reg(14);

/// Decodes two halfwords; `helium` allows vector instructions and low-overhead loops.
pub fn decode(first: u16, second: u16, helium: bool) -> Option<Op> {
    match (first >> 11, field(first, 4, 7)) {
        (29, op) if op & 0x64 == 0x00 => Some(multiple(first, second)),
        (29, op) if op & 0x64 == 0x04 => pair_or_table(first, second),
        (29, op) if op & 0x60 == 0x20 => Some(alu(first, second, true)),
        (30, op) if second & 0x8000 == 0 => Some(immediate(first, second, op)),
        (30, op) => branch(first, second, op, helium),
        (31, op) if op & 0x71 == 0x00 => Some(store(first, second)),
        (31, op) if matches!(op & 0x67, 0x01 | 0x03 | 0x05) => Some(load(first, second)),
        (31, op) if op & 0x70 == 0x20 => Some(alu(first, second, true)),
        (31, op) if op & 0x78 == 0x30 => Some(multiply(first, second)),
        (31, op) if op & 0x78 == 0x38 => Some(long_multiply_or_divide(first, second, op)),
        (29 | 31, op) if op & 0x40 != 0 => vfp::decode(first, second, helium),
        _ => None,
    }
}

fn n(first: u16) -> Registers {
    reg(field(first, 0, 4))
}

/// A destination; 15 stands for "flags only" or "no register".
fn d(second: u16, at: u32) -> Registers {
    reg(field(second, at, 4)) & !PC
}

fn multiple(first: u16, second: u16) -> Op {
    let list = u64::from(second);
    let back = if first & 0x20 == 0 { 0 } else { n(first) };
    match (first & 0x10 != 0, list & PC != 0) {
        (true, true) => Op::multiple(Class::PopPc, list.count_ones(), list | back, 0, n(first)),
        (true, false) => Op::multiple(Class::LoadMultiple, list.count_ones(), list | back, 0, n(first)),
        (false, _) => Op::multiple(Class::StoreMultiple, list.count_ones(), back, list, n(first)),
    }
}

fn pair_or_table(first: u16, second: u16) -> Option<Op> {
    let (t, t2, load) = (d(second, 12), d(second, 8), first & 0x10 != 0);
    let back = if first & 0x20 == 0 { 0 } else { n(first) };
    Some(if first & 0x120 != 0 {
        if load {
            Op::memory(Class::LoadPair, t | t2 | back, 0, n(first))
        } else {
            Op::memory(Class::StorePair, back, t | t2, n(first))
        }
    } else if first & 0xfff0 == 0xe8d0 && second & 0xffe0 == 0xf000 {
        Op::memory(Class::BranchTable, PC, 0, n(first) | d(second, 0))
    } else if first & 0xfff0 == 0xe840 {
        Op::memory(Class::Store, t2, t, n(first)) // STREX
    } else if first & 0xfff0 == 0xe850 || first & 0xfff0 == 0xe8d0 {
        Op::memory(Class::Load, t, 0, n(first)) // LDREX and kin
    } else if first & 0xfff0 == 0xe8c0 {
        Op::memory(Class::Store, d(second, 0), t, n(first))
    } else {
        return None;
    })
}

fn alu(first: u16, second: u16, with_m: bool) -> Op {
    let m = if with_m { d(second, 0) } else { 0 };
    Op::new(Class::Alu, d(second, 8), (n(first) & !PC) | m)
}

fn immediate(first: u16, second: u16, op: u32) -> Op {
    // MOVW writes without reading; MOVT (0x2c) and the bit-field inserts keep part of the destination.
    let keeps = op & 0x20 != 0 && matches!(op & 0x1f, 0x0c | 0x16);
    let no_source = op & 0x20 != 0 && op & 0x1f == 0x04;
    let mut result = alu(first, second, false);
    if keeps {
        result.reads |= result.writes;
    } else if no_source {
        result.reads = 0;
    }
    result
}

fn branch(first: u16, second: u16, op: u32, helium: bool) -> Option<Op> {
    match second & 0xd000 {
        0x8000 if op & 0x38 != 0x38 => Some(Op::new(Class::BranchIf, PC, 0)),
        // MSR, hints, barriers, MRS.
        0x8000 if matches!(op, 0x38..=0x3f) => Some(Op::new(Class::System, d(second, 8), 0)),
        0x9000 => Some(Op::new(Class::Branch, PC, 0)),
        0xd000 => Some(Op::new(Class::Call, PC | LR, 0)),
        0xc000 if helium && second & 1 == 1 => Some(match first & 0xffcf {
            0xf00f => Op::new(Class::LoopEnd, PC | LR, LR),
            _ => Op::new(Class::LoopStart, LR, n(first)),
        }),
        _ => None,
    }
}

/// Address registers of a single load or store, and whether it writes its base back.
fn single(first: u16, second: u16) -> (Registers, Registers, bool) {
    let literal = field(first, 0, 4) == 15;
    if literal || first & 0x80 != 0 {
        (n(first), 0, false)
    } else if second & 0x800 != 0 {
        (n(first), if second & 0x100 == 0 { 0 } else { n(first) }, false)
    } else {
        (n(first) | d(second, 0), 0, true)
    }
}

fn store(first: u16, second: u16) -> Op {
    let (address, back, indexed) = single(first, second);
    Op::memory(if indexed { Class::StoreIndexed } else { Class::Store }, back, d(second, 12), address)
}

fn load(first: u16, second: u16) -> Op {
    let (address, back, _) = single(first, second);
    let to_pc = field(second, 12, 4) == 15 && first & 0x60 == 0x40;
    let t = if to_pc { PC } else { d(second, 12) };
    let mut op = Op::memory(if to_pc { Class::PopPc } else { Class::Load }, t | back, 0, address);
    op.words = u32::from(to_pc);
    op
}

fn multiply(first: u16, second: u16) -> Op {
    Op::new(Class::Multiply, d(second, 8), n(first) | d(second, 0) | d(second, 12))
}

fn long_multiply_or_divide(first: u16, second: u16, op: u32) -> Op {
    if matches!(op & 7, 1 | 3) {
        Op::new(Class::Divide, d(second, 8), n(first) | d(second, 0))
    } else {
        let pair = d(second, 8) | d(second, 12);
        // The accumulating forms (SMLAL, UMLAL, UMAAL) also read the pair.
        Op::new(Class::Multiply, pair, n(first) | d(second, 0) | if op & 4 == 0 { 0 } else { pair })
    }
}
