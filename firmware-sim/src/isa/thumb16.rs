//! 16-bit Thumb encodings (ARM DDI 0419, chapter A5.2).

use super::{Class, Op, Registers, field, reg};

const SP: Registers = reg(13);
const LR: Registers = reg(14);
const PC: Registers = reg(15);

/// Decodes one halfword.
pub fn decode(hw: u16) -> Option<Op> {
    let low = |at| reg(field(hw, at, 3));
    let alu = |writes, reads| Some(Op::new(Class::Alu, writes, reads));
    match hw >> 11 {
        0..=2 => alu(low(0), low(3)),
        3 => alu(low(0), low(3) | if hw & 1 << 10 == 0 { low(6) } else { 0 }),
        4 => alu(low(8), 0),
        5 => alu(0, low(8)),
        6 | 7 => alu(low(8), low(8)),
        8 if hw & 1 << 10 == 0 => data(hw),
        8 => special(hw),
        9 => Some(Op::memory(Class::Load, low(8), 0, PC)),
        10 | 11 => match field(hw, 9, 3) {
            0..=2 => Some(Op::memory(Class::StoreIndexed, 0, low(0), low(3) | low(6))),
            _ => Some(Op::memory(Class::Load, low(0), 0, low(3) | low(6))),
        },
        12 | 14 | 16 => Some(Op::memory(Class::Store, 0, low(0), low(3))),
        13 | 15 | 17 => Some(Op::memory(Class::Load, low(0), 0, low(3))),
        18 => Some(Op::memory(Class::Store, 0, low(8), SP)),
        19 => Some(Op::memory(Class::Load, low(8), 0, SP)),
        20 => alu(low(8), PC),
        21 => alu(low(8), SP),
        22 | 23 => misc(hw),
        24 => Some(Op::multiple(Class::StoreMultiple, list(hw).count_ones(), low(8), list(hw), low(8))),
        25 => Some(Op::multiple(Class::LoadMultiple, list(hw).count_ones(), low(8) | list(hw), 0, low(8))),
        26 | 27 => match field(hw, 8, 4) {
            14 => None, // permanently undefined
            15 => Some(Op::new(Class::System, 0, 0)),
            _ => Some(Op::new(Class::BranchIf, PC, 0)),
        },
        28 => Some(Op::new(Class::Branch, PC, 0)),
        _ => None,
    }
}

fn list(hw: u16) -> Registers {
    u64::from(hw & 0xff)
}

fn data(hw: u16) -> Option<Op> {
    let (dn, m) = (reg(field(hw, 0, 3)), reg(field(hw, 3, 3)));
    Some(match field(hw, 6, 4) {
        8 | 10 | 11 => Op::new(Class::Alu, 0, dn | m), // TST, CMP, CMN
        9 | 15 => Op::new(Class::Alu, dn, m),          // RSB, MVN
        13 => Op::new(Class::Multiply, dn, dn | m),
        _ => Op::new(Class::Alu, dn, dn | m),
    })
}

fn special(hw: u16) -> Option<Op> {
    let (d, m) = (reg(field(hw, 0, 3) | field(hw, 7, 1) << 3), reg(field(hw, 3, 4)));
    let to_pc = d == PC;
    Some(match field(hw, 8, 2) {
        0 | 2 if to_pc => Op::new(Class::BranchRegister, PC, m),
        0 => Op::new(Class::Alu, d, d | m),
        1 => Op::new(Class::Alu, 0, d | m),
        2 => Op::new(Class::Alu, d, m),
        _ if hw & 0x80 != 0 => Op::new(Class::BranchRegister, PC | LR, m),
        _ => Op::new(Class::BranchRegister, PC, m),
    })
}

fn misc(hw: u16) -> Option<Op> {
    let (d, m) = (reg(field(hw, 0, 3)), reg(field(hw, 3, 3)));
    Some(match hw >> 8 {
        0xb0 => Op::new(Class::Alu, SP, SP),
        0xb1 | 0xb3 | 0xb9 | 0xbb => Op::new(Class::BranchIf, PC, d),
        0xb2 => Op::new(Class::Alu, d, m),
        0xb4 | 0xb5 => {
            let list = list(hw) | if hw & 0x100 == 0 { 0 } else { LR };
            Op::multiple(Class::StoreMultiple, list.count_ones(), SP, list, SP)
        }
        0xb6 if hw & 0xffe8 == 0xb660 => Op::new(Class::System, 0, 0),
        0xba if field(hw, 6, 2) != 2 => Op::new(Class::Alu, d, m),
        0xbc => Op::multiple(Class::LoadMultiple, list(hw).count_ones(), SP | list(hw), 0, SP),
        0xbd => Op::multiple(Class::PopPc, list(hw).count_ones() + 1, SP | PC | list(hw), 0, SP),
        0xbe => Op::new(Class::System, 0, 0),
        0xbf if hw & 15 != 0 => Op::new(Class::IfThen, 0, 0),
        0xbf => Op::new(Class::System, 0, 0),
        _ => return None,
    })
}
