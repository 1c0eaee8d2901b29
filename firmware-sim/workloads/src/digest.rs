//! FNV-1a, 64 bits: enough to see one flipped bit, small enough for any core.

/// A running hash over output bits; `Digest::default()` starts one.
#[derive(Clone, Copy, Debug)]
pub struct Digest {
    hash: u64,
    finite: bool,
}

impl Default for Digest {
    fn default() -> Self {
        Self { hash: 0xcbf2_9ce4_8422_2325, finite: true }
    }
}

impl Digest {
    /// Adds the four bytes of a word, lowest first.
    pub fn word(&mut self, word: u32) {
        for byte in word.to_le_bytes() {
            self.hash = (self.hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// Adds the bits of a number, so that -0 and 0 differ and every NaN counts as it is.
    pub fn float(&mut self, value: f32) {
        self.finite &= value.is_finite();
        self.word(value.to_bits());
    }

    /// The hash of everything added so far.
    pub fn value(self) -> u64 {
        self.hash
    }

    /// Whether no number so far was infinite or NaN.
    pub fn is_finite(self) -> bool {
        self.finite
    }
}
