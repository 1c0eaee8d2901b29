//! Sums, differences, products and quotients that are hard to round: what the functions of `kernel-arch`'s `soft` must get right.

use crate::{Digest, Refused, Workload};

/// Pairs of numbers a frame.
pub const PAIRS: u32 = 256;

/// Four operations a pair.
#[derive(Clone, Copy, Debug)]
pub struct Arithmetic;

/// The generator, and a hash over all results of a frame.
#[derive(Clone, Copy, Debug)]
pub struct Drawn {
    seed: u64,
    hash: u32,
}

impl Drawn {
    fn next(&mut self) -> u32 {
        self.seed = self.seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.seed >> 32) as u32
    }

    fn add(&mut self, value: f32) {
        // Every NaN counts as one: cores differ in its sign and its payload.
        let bits = if value.is_nan() { f32::NAN.to_bits() } else { value.to_bits() };
        self.hash = (self.hash ^ bits).wrapping_mul(0x0100_0193);
    }
}

/// All exponents, significands of few and of many ones, neighbours of powers of two, subnormals, infinities, NaN.
fn shaped(word: u32, choice: u32) -> u32 {
    match choice & 7 {
        0 => word,
        1 => word & 0xff80_0000,
        2 => (word & 0xff80_0000).wrapping_sub(1 + (choice >> 8 & 3)),
        3 => word & 0xff80_0000 | (1 + (choice >> 8 & 3)),
        4 => word & 0xfff0_0000,
        5 => word & 0x807f_ffff,
        6 => word & 0x807f_ffff | 0x7f00_0000,
        _ => word & 0xffff_f000,
    }
}

/// The number beside `a`: near its negative, so that much is cancelled; a few binades away, where rounding hangs on few bits; or any.
fn partner(a: u32, b: u32, choice: u32) -> u32 {
    let sign = 1 << 31;
    match choice & 7 {
        0 => a ^ sign ^ (b & 7),
        1 => (a ^ sign) & 0xff80_0000 | b & 0x007f_ffff,
        2..=4 => (a ^ b & sign).wrapping_sub(((b >> 3) % 30) << 23),
        _ => shaped(b, choice >> 3),
    }
}

/// An input frame is a seed.
impl Workload for Arithmetic {
    type Model<'p> = ();
    type State = Drawn;

    fn open(_: &[u8]) -> Result<Self::Model<'_>, Refused> {
        Ok(())
    }

    fn power_on((): &Self::Model<'_>) -> Self::State {
        Drawn { seed: 0, hash: 0 }
    }

    fn load((): &Self::Model<'_>, drawn: &mut Self::State, input: &[u8]) {
        let words = input.as_chunks::<4>().0.iter().map(|bytes| u32::from_le_bytes(*bytes));
        // Rounds repeat the frames: numbers go on from where they were.
        drawn.seed = words.fold(drawn.seed, |seed, word| seed.wrapping_add(u64::from(word)));
    }

    fn step((): &Self::Model<'_>, drawn: &mut Self::State) {
        for _ in 0..PAIRS {
            let [a, b, choice] = [drawn.next(), drawn.next(), drawn.next()];
            let a = shaped(a, choice);
            let [a, b] = [a, partner(a, b, choice >> 16)].map(f32::from_bits);
            drawn.add(a + b);
            drawn.add(a - b);
            drawn.add(a * b);
            drawn.add(a / b);
        }
    }

    fn output((): &Self::Model<'_>, drawn: &Self::State, digest: &mut Digest) {
        digest.word(drawn.hash);
    }
}
