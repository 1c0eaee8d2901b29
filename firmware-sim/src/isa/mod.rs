//! What an instruction is, as far as its cost goes: a class, the registers it moves, what it reads and writes.
//!
//! Only what images execute needs to decode; anything unknown is an error, never a guess.

mod rv32;
mod thumb16;
mod thumb32;
mod vfp;

use serde::Deserialize;

/// The classes that the timing tables price.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Class {
    /// Moves, adds, shifts, logic, compares, extends, packs.
    Alu,
    /// Multiply and multiply-accumulate to 32 or 64 bits.
    Multiply,
    /// Integer division.
    Divide,
    /// One register from memory.
    Load,
    /// Two registers from memory.
    LoadPair,
    /// A list of registers from memory.
    LoadMultiple,
    /// A list that ends in the program counter.
    PopPc,
    /// One register to memory, constant offset.
    Store,
    /// One register to memory, offset in a register.
    StoreIndexed,
    /// Two registers to memory.
    StorePair,
    /// A list of registers to memory.
    StoreMultiple,
    /// A jump that depends on nothing.
    Branch,
    /// A jump on a condition.
    BranchIf,
    /// A jump that keeps its way back.
    Call,
    /// A jump to an address in a register.
    BranchRegister,
    /// A jump through a table.
    BranchTable,
    /// The head of an if-then block.
    IfThen,
    /// Start of a low-overhead loop.
    LoopStart,
    /// End of a low-overhead loop: free on silicon after the first pass.
    LoopEnd,
    /// Barriers, special registers, hints.
    System,
    /// Add, subtract, multiply, compare, convert, negate in the FPU.
    Float,
    /// Multiply-accumulate in the FPU, fused or not.
    FloatMac,
    /// Division and square root in the FPU.
    FloatDivide,
    /// Between core and FPU registers.
    FloatMove,
    /// Two registers between core and FPU.
    FloatMovePair,
    /// One FPU register from memory.
    FloatLoad,
    /// A double-width FPU register from memory.
    FloatLoadPair,
    /// A list of FPU registers from memory.
    FloatLoadMultiple,
    /// One FPU register to memory.
    FloatStore,
    /// A double-width FPU register to memory.
    FloatStorePair,
    /// A list of FPU registers to memory.
    FloatStoreMultiple,
    /// Vector arithmetic (Helium).
    Vector,
    /// Vector load or store (Helium).
    VectorMemory,
}

/// A set of registers: core registers in bits 0..32, single-precision FPU registers in bits 32..64.
pub type Registers = u64;

/// One decoded instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Op {
    /// What the timing table prices.
    pub class: Class,
    /// Registers moved by a multiple; 0 otherwise.
    pub words: u32,
    /// Registers it needs.
    pub reads: Registers,
    /// Registers that its address needs (memory operations).
    pub address: Registers,
    /// Registers it sets.
    pub writes: Registers,
}

impl Op {
    const fn new(class: Class, writes: Registers, reads: Registers) -> Self {
        Self { class, words: 0, reads, address: 0, writes }
    }

    const fn memory(class: Class, writes: Registers, reads: Registers, address: Registers) -> Self {
        Self { class, words: 0, reads: reads | address, address, writes }
    }

    const fn multiple(class: Class, words: u32, writes: Registers, reads: Registers, address: Registers) -> Self {
        Self { class, words, reads: reads | address, address, writes }
    }
}

/// An instruction set with its extensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Isa {
    /// ARMv6-M to ARMv8-M with the single or double FPU, without Helium.
    Thumb,
    /// The same with Helium and low-overhead loops.
    ThumbHelium,
    /// RV32IMC.
    Rv32imc,
}

impl Isa {
    /// The plugin's name for how long instructions are.
    pub fn code(self) -> &'static str {
        match self {
            Self::Thumb | Self::ThumbHelium => "thumb",
            Self::Rv32imc => "riscv",
        }
    }

    /// Decodes one instruction; `None` for what this table does not know.
    pub fn decode(self, bytes: &[u8]) -> Option<Op> {
        let low = u16::from_le_bytes(*bytes.first_chunk()?);
        let high = bytes.get(2..4).map(|high| u16::from_le_bytes([high[0], high[1]]));
        match (self, high) {
            (Self::Thumb | Self::ThumbHelium, None) => thumb16::decode(low),
            (Self::Thumb, Some(high)) => thumb32::decode(low, high, false),
            (Self::ThumbHelium, Some(high)) => thumb32::decode(low, high, true),
            (Self::Rv32imc, None) => rv32::compressed(low),
            (Self::Rv32imc, Some(high)) => rv32::full(u32::from(high) << 16 | u32::from(low)),
        }
    }
}

/// A field of `width` bits of `word` from bit `low`.
fn field(word: u16, low: u32, width: u32) -> u32 {
    (u32::from(word) >> low) & ((1 << width) - 1)
}

/// The set of one core register.
const fn reg(index: u32) -> Registers {
    1 << (index & 31)
}
