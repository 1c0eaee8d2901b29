//! How long an instruction is.
//!
//! QEMU 7.2 reports too many bytes for the last Thumb instruction before a page ends: its translator peeks at the next
//! halfword to see whether that one crosses the page, and the plugin layer books the peek as part of the current one.

/// An encoding of instructions in 2 or 4 bytes.
#[derive(Clone, Copy)]
pub enum Code {
    /// Thumb: 4 bytes where the first halfword starts with 0b11101, 0b11110 or 0b11111.
    Thumb,
    /// RISC-V with compressed instructions: 4 bytes where the lowest two bits are set.
    Riscv,
}

impl Code {
    /// By the name in the plugin's arguments.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "thumb" => Some(Self::Thumb),
            "riscv" => Some(Self::Riscv),
            _ => None,
        }
    }

    /// The bytes of the instruction alone.
    pub fn trim(self, bytes: &[u8]) -> &[u8] {
        let long = match (self, bytes) {
            (Self::Thumb, [_, high, ..]) => high >> 3 >= 0b11101,
            (Self::Riscv, [low, ..]) => low & 3 == 3,
            _ => false,
        };
        bytes.get(..if long { 4 } else { 2 }).unwrap_or(bytes)
    }
}
