//! Decoding and pricing without an emulator. Encodings are what `llvm-mc -show-encoding` prints for the text beside them.

use std::collections::BTreeMap;

use kinesic_firmware_sim::data::Data;
use kinesic_firmware_sim::isa::{Class, Isa};
use kinesic_firmware_sim::price::{Cycles, PriceError};
use kinesic_firmware_sim::profile::Instruction;

type Encoding = (&'static str, &'static [u8], Class, u32);

const THUMB: [Encoding; 28] = [
    ("adds r1, #1", &[0x01, 0x31], Class::Alu, 0),
    ("muls r1, r0, r1", &[0x41, 0x43], Class::Multiply, 0),
    ("ldr r1, [sp, #4]", &[0x01, 0x99], Class::Load, 0),
    ("str r1, [r2, r3]", &[0xd1, 0x50], Class::StoreIndexed, 0),
    ("ldm r3!, {r1, r2}", &[0x06, 0xcb], Class::LoadMultiple, 2),
    ("push {r4, lr}", &[0x10, 0xb5], Class::StoreMultiple, 2),
    ("pop {r4, pc}", &[0x10, 0xbd], Class::PopPc, 2),
    ("bx lr", &[0x70, 0x47], Class::BranchRegister, 0),
    ("bne #-8", &[0xfc, 0xd1], Class::BranchIf, 0),
    ("b #-8", &[0xfc, 0xe7], Class::Branch, 0),
    ("bl #100", &[0x00, 0xf0, 0x32, 0xf8], Class::Call, 0),
    ("udiv r0, r1, r2", &[0xb1, 0xfb, 0xf2, 0xf0], Class::Divide, 0),
    ("ldrd r0, r1, [r2]", &[0xd2, 0xe9, 0x00, 0x01], Class::LoadPair, 0),
    ("it eq", &[0x08, 0xbf], Class::IfThen, 0),
    ("umull r0, r1, r2, r3", &[0xa2, 0xfb, 0x03, 0x01], Class::Multiply, 0),
    ("ldr.w r0, [r1, r2]", &[0x51, 0xf8, 0x02, 0x00], Class::Load, 0),
    ("vmul.f32 s0, s1, s2", &[0x20, 0xee, 0x81, 0x0a], Class::Float, 0),
    ("vadd.f32 s0, s1, s2", &[0x30, 0xee, 0x81, 0x0a], Class::Float, 0),
    ("vfma.f32 s0, s1, s2", &[0xa0, 0xee, 0x81, 0x0a], Class::FloatMac, 0),
    ("vdiv.f32 s0, s1, s2", &[0x80, 0xee, 0x81, 0x0a], Class::FloatDivide, 0),
    ("vsqrt.f32 s0, s1", &[0xb1, 0xee, 0xe0, 0x0a], Class::FloatDivide, 0),
    ("vcmp.f32 s0, s1", &[0xb4, 0xee, 0x60, 0x0a], Class::Float, 0),
    ("vldr s3, [r0, #4]", &[0xd0, 0xed, 0x01, 0x1a], Class::FloatLoad, 0),
    ("vldmia r0!, {s0 - s3}", &[0xb0, 0xec, 0x04, 0x0a], Class::FloatLoadMultiple, 4),
    ("vpush {d8, d9}", &[0x2d, 0xed, 0x04, 0x8b], Class::FloatStoreMultiple, 4),
    ("vmov r0, s5", &[0x12, 0xee, 0x90, 0x0a], Class::FloatMove, 0),
    ("vmov s4, s5, r0, r1", &[0x41, 0xec, 0x12, 0x0a], Class::FloatMovePair, 0),
    ("vmrs APSR_nzcv, fpscr", &[0xf1, 0xee, 0x10, 0xfa], Class::FloatMove, 0),
];

const RV32IMC: [Encoding; 13] = [
    ("add a0, a1, a2", &[0x33, 0x85, 0xc5, 0x00], Class::Alu, 0),
    ("mul a0, a1, a2", &[0x33, 0x85, 0xc5, 0x02], Class::Multiply, 0),
    ("div a0, a1, a2", &[0x33, 0xc5, 0xc5, 0x02], Class::Divide, 0),
    ("beq a0, a1, 16", &[0x63, 0x08, 0xb5, 0x00], Class::BranchIf, 0),
    ("c.lw a0, 4(a1)", &[0xc8, 0x41], Class::Load, 0),
    ("c.sw a0, 4(a1)", &[0xc8, 0xc1], Class::Store, 0),
    ("c.jal 16", &[0x01, 0x28], Class::Call, 0),
    ("c.j 16", &[0x01, 0xa8], Class::Branch, 0),
    ("c.jr ra", &[0x82, 0x80], Class::BranchRegister, 0),
    ("c.addi a0, 1", &[0x05, 0x05], Class::Alu, 0),
    ("c.bnez a0, 8", &[0x01, 0xe5], Class::BranchIf, 0),
    ("c.swsp a0, 4(sp)", &[0x2a, 0xc2], Class::Store, 0),
    ("c.jalr a0", &[0x02, 0x95], Class::Call, 0),
];

#[test]
fn encodings_have_their_class() {
    for (isa, table) in [(Isa::Thumb, &THUMB[..]), (Isa::ThumbHelium, &THUMB[..]), (Isa::Rv32imc, &RV32IMC[..])] {
        for (text, bytes, class, words) in table {
            let op = isa.decode(bytes).unwrap_or_else(|| panic!("{isa:?} does not know {text}"));
            assert_eq!((op.class, op.words), (*class, *words), "{text}");
        }
    }
}

#[test]
fn registers_are_seen() {
    let op = |bytes: &[u8]| Isa::Thumb.decode(bytes).unwrap();
    let s = |index: u32| 1u64 << (32 + index);
    let multiply = op(&[0x20, 0xee, 0x81, 0x0a]);
    assert_eq!((multiply.writes, multiply.reads), (s(0), s(1) | s(2)));
    let fused = op(&[0xa0, 0xee, 0x81, 0x0a]);
    assert_eq!((fused.writes, fused.reads), (s(0), s(0) | s(1) | s(2)), "an accumulator is read too");
    let load = op(&[0xd0, 0xed, 0x01, 0x1a]);
    assert_eq!((load.writes, load.address), (s(3), 1));
    let x0 = Isa::Rv32imc.decode(&[0x33, 0x05, 0x00, 0x00]).unwrap();
    assert_eq!((x0.writes, x0.reads), (1 << 10, 0), "x0 is never waited for");
}

#[test]
fn what_is_unknown_is_none() {
    // Permanently undefined; and Helium (vadd.i32 q0, q1, q2) without Helium.
    assert_eq!(Isa::Thumb.decode(&[0x00, 0xde]), None);
    assert_eq!(Isa::Thumb.decode(&[0x22, 0xef, 0x44, 0x08]), None);
    assert_eq!(Isa::ThumbHelium.decode(&[0x22, 0xef, 0x44, 0x08]).map(|op| op.class), Some(Class::Vector));
    assert_eq!(Isa::Rv32imc.decode(&[0x00, 0x00]), None);
    // fadd.s: there is no FPU.
    assert_eq!(Isa::Rv32imc.decode(&[0x53, 0x75, 0xb5, 0x00]), None);
}

/// Instructions one behind the other from address 0, each executed once, and taken as often as said.
fn once(code: &[(&'static str, u64)]) -> BTreeMap<u64, Instruction> {
    let mut at = 0;
    let mut all = BTreeMap::new();
    for (text, taken) in code {
        let (_, bytes, ..) = THUMB.iter().chain(&RV32IMC).find(|(known, ..)| known == text).unwrap();
        let one = Instruction { bytes: bytes.to_vec(), all: (1, *taken), longest: (1, *taken) };
        all.insert(at, one);
        at += bytes.len() as u64;
    }
    all
}

fn price(timing: &str, isa: Isa, code: &[(&'static str, u64)]) -> [f64; 3] {
    let data = Data::read(None).unwrap();
    let Cycles { low, middle, high } = data.timings[timing].price(isa, &once(code), |one| one.longest).unwrap();
    [low, middle, high]
}

#[test]
fn prices_are_the_manuals() {
    let m4 = |code: &[(&'static str, u64)]| price("m4", Isa::Thumb, code);
    assert_eq!(m4(&[("vfma.f32 s0, s1, s2", 0)]), [3.0; 3]);
    assert_eq!(m4(&[("vldmia r0!, {s0 - s3}", 0)]), [5.0; 3]);
    assert_eq!(m4(&[("vsqrt.f32 s0, s1", 0)]), [14.0; 3]);
    assert_eq!(m4(&[("bne #-8", 0)]), [1.0; 3]);
    assert_eq!(m4(&[("bne #-8", 1)]), [2.0, 3.0, 4.0], "the refill is 1 to 3");
    assert_eq!(m4(&[("ldr r1, [sp, #4]", 0), ("ldr.w r0, [r1, r2]", 0)]), [4.0; 3], "the address is what was loaded");
    assert_eq!(m4(&[("ldr.w r0, [r1, r2]", 0), ("ldr r1, [sp, #4]", 0)]), [3.0; 3], "pipelined");
    // s0, then vmov r0, s5: no hazard; vcmp reads s0: one.
    assert_eq!(m4(&[("vmul.f32 s0, s1, s2", 0), ("vmov r0, s5", 0)]), [2.0; 3]);
    assert_eq!(m4(&[("vmul.f32 s0, s1, s2", 0), ("vcmp.f32 s0, s1", 0)]), [2.0, 3.0, 3.0]);
    let m0 = |code: &[(&'static str, u64)]| price("m0plus", Isa::Thumb, code);
    assert_eq!(m0(&[("pop {r4, pc}", 1)]), [5.0; 3], "3 + N with N = 1, the pc apart");
    assert_eq!(m0(&[("bl #100", 1)]), [3.0; 3]);
    let rv = |code: &[(&'static str, u64)]| price("hazard3", Isa::Rv32imc, code);
    assert_eq!(rv(&[("c.lw a0, 4(a1)", 0), ("c.addi a0, 1", 0)]), [3.0; 3], "a load used at once waits");
    assert_eq!(rv(&[("c.bnez a0, 8", 1)]), [2.0; 3]);
}

#[test]
fn nothing_is_priced_by_guess() {
    let data = Data::read(None).unwrap();
    let timing = &data.timings["m0plus"];
    let no_price = timing.price(Isa::Thumb, &once(&[("vmul.f32 s0, s1, s2", 0)]), |one| one.longest);
    assert!(matches!(no_price, Err(PriceError::NoPrice { class: Class::Float, .. })), "{no_price:?}");
    let mut code = once(&[("adds r1, #1", 0)]);
    code.get_mut(&0).unwrap().bytes = vec![0x00, 0xde];
    let unknown = timing.price(Isa::Thumb, &code, |one| one.longest);
    assert!(matches!(unknown, Err(PriceError::Unknown { address: 0, .. })), "{unknown:?}");
}
