//! Linear models in fixed point: int16 coefficients, int32 states and sums, for cores without an FPU.
//!
//! Every value is an integer times a scale that the host chose. Sums cannot overflow: the limits below are checked when a
//! pack is loaded, and states are held in their range. Only integer operations, so the bits are the same everywhere.

use core::num::NonZeroUsize;

use kinesic_kernel_arch::scale16;

use crate::model::{LoadError, Pack};

/// Fraction bits of an input: a deviation from the mean is 2^24.
pub const INPUT_BITS: u32 = 24;

/// Inputs are held within this many deviations: with a sign, 28 bits of value.
pub const LARGEST_INPUT: i32 = (1 << 28) - 1;

/// Bits by which an input is cut for the recursion of one joint, whose inputs are int16.
pub const JOINT_INPUT_CUT: u32 = 13;

/// Fraction bits of a transition's entries: below 1 in size.
pub const TRANSITION_BITS: u32 = 15;

/// States are held below `2^29` in size.
pub const STATE_BITS: u32 = 29;

/// Fraction bits of an output in m: 4 micrometres, so that the largest sum that any input could give fits.
pub const OUTPUT_BITS: u32 = 18;

/// Largest sum of the sizes of a row's coefficients: with values below 2^29 the row's sum stays within 2^29.
pub const LARGEST_ROW: u32 = 1 << 16;

/// Largest sum of the sizes of a state's three input coefficients.
pub const LARGEST_JOINT_ROW: u32 = 1 << 15;

/// [`JointBlock`](super::JointBlock) in fixed point, and two shifts: of what the inputs add to the states, of what the states
/// add to the outputs. 36 bytes, in the order in which a step reads them.
pub type FixedBlock = [i16; 18];

/// A transition in fixed point, row-major, [`TRANSITION_BITS`].
pub type FixedTransition = [i16; 4];

/// True for a shift that an int32 has.
pub fn is_shift(shift: i16) -> bool {
    (0..32).contains(&shift)
}

/// The entries as f32: exact.
pub fn transition(entries: FixedTransition) -> super::Block {
    entries.map(|entry| f32::from(entry) * (1.0 / (1u32 << TRANSITION_BITS) as f32))
}

/// True if no input can take the block's sums out of their range: see [`LARGEST_JOINT_ROW`].
pub fn is_bounded(block: &FixedBlock) -> bool {
    let [.., b00, b01, b02, b10, b11, b12, _, _, _, _, _, _, input_shift, output_shift] = *block;
    let rows = [[b00, b01, b02], [b10, b11, b12]];
    rows.iter().all(|row| row_size(row) <= LARGEST_JOINT_ROW) && is_shift(input_shift) && is_shift(output_shift)
}

/// Sum of the sizes of a row's coefficients.
pub fn row_size(row: &[i16]) -> u32 {
    row.iter().fold(0, |sum, weight| sum.saturating_add(u32::from(weight.unsigned_abs())))
}

/// Holds a state's half in its range, and gives the state.
#[inline]
fn hold(half: i32) -> i32 {
    const LIMIT: i32 = 1 << (STATE_BITS - 1);
    half.clamp(-LIMIT, LIMIT - 1) << 1
}

/// One joint's model: `y += C x`, then `x' = A x + B u`, states held in their range. `u` in int16, see
/// [`JOINT_INPUT_CUT`]. Cost: 16 multiply-adds a block.
pub fn advance_joint_fixed(blocks: &[FixedBlock], u: [i32; 3], x: &mut [[i32; 2]], y: &mut [i32; 3]) {
    // Two passes: the values of one do not fit thirteen registers.
    let [mut y0, mut y1, mut y2] = *y;
    for (block, [x0, x1]) in blocks.iter().zip(&*x) {
        let [.., c00, c10, c20, c01, c11, c21, _, output_shift] = *block;
        let output = |c0, c1| scale16(c0, *x0).wrapping_add(scale16(c1, *x1)).wrapping_shr(output_shift as u32);
        y0 = y0.wrapping_add(output(c00, c01));
        y1 = y1.wrapping_add(output(c10, c11));
        y2 = y2.wrapping_add(output(c20, c21));
    }
    *y = [y0, y1, y2];
    let [u0, u1, u2] = u;
    for (block, x) in blocks.iter().zip(x) {
        let [a, b, c, d, b00, b01, b02, b10, b11, b12, .., input_shift, _] = *block;
        let [x0, x1] = *x;
        let input = |b0, b1, b2| {
            let product = |b: i16, u: i32| i32::from(b).wrapping_mul(u);
            product(b0, u0).wrapping_add(product(b1, u1)).wrapping_add(product(b2, u2)).wrapping_shr(input_shift as u32)
        };
        let half = |a0, a1, input: i32| scale16(a0, x0).wrapping_add(scale16(a1, x1)).wrapping_add(input);
        *x = [hold(half(a, b, input(b00, b01, b02))), hold(half(c, d, input(b10, b11, b12)))];
    }
}

/// `x <- A x + input / 2` for all blocks, states held in their range; `input` in halves of a state's unit. Cost: 4
/// multiply-adds a block.
pub fn advance_fixed(blocks: &[FixedTransition], input: impl Iterator<Item = i32>, x: &mut [[i32; 2]]) {
    let mut input = input;
    for ([a, b, c, d], x) in blocks.iter().zip(x) {
        let [x0, x1] = *x;
        let (first, second) = (input.next().unwrap_or(0), input.next().unwrap_or(0));
        let half = |a0: i16, a1: i16, input: i32| scale16(a0, x0).wrapping_add(scale16(a1, x1)).wrapping_add(input);
        *x = [hold(half(*a, *b, first)), hold(half(*c, *d, second))];
    }
}

/// A row-major int16 matrix; a row's sum is `sum(weight * x / 2^16)`, each product rounded down.
#[derive(Clone, Copy, Debug)]
pub struct Rows<'a> {
    columns: NonZeroUsize,
    weights: &'a [i16],
}

impl<'a> Rows<'a> {
    /// The matrix `name` of a pack, `rows x columns`, each row at most [`LARGEST_ROW`].
    pub fn load(pack: &Pack<'a>, name: &'static str, rows: usize, columns: usize) -> Result<Self, LoadError> {
        let weights: &[i16] = pack.slice(name, rows.saturating_mul(columns))?;
        let columns =
            NonZeroUsize::new(columns).ok_or(LoadError::Shape { tensor: name, found: weights.len(), expected: 0 })?;
        match weights.chunks_exact(columns.get()).position(|row| row_size(row) > LARGEST_ROW) {
            Some(row) => Err(LoadError::Value { tensor: name, index: row.saturating_mul(columns.get()) }),
            None => Ok(Self { columns, weights }),
        }
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns.get()
    }

    /// The rows' sums, in order. Cost: a multiply-add an element. With values below 2^29 no sum leaves 2^29.
    #[inline]
    pub fn sums<'x>(&self, x: &'x [i32]) -> impl Iterator<Item = i32> + use<'a, 'x> {
        self.weights
            .chunks_exact(self.columns.get())
            .map(move |row| row.iter().zip(x).fold(0i32, |sum, (weight, x)| sum.wrapping_add(scale16(*weight, *x))))
    }
}

/// `x` in units of `2^-bits`, cut towards zero and held; 0 for what is not a number. By shifts of the mantissa: a product in
/// software costs more than the whole of it.
#[inline]
pub fn to_fixed(x: f32, bits: u32, largest: i32) -> i32 {
    if cfg!(target_abi = "eabihf") || cfg!(not(any(target_arch = "arm", target_arch = "riscv32"))) {
        return ((x * (1u32 << bits) as f32) as i32).clamp(-largest, largest);
    }
    shifted(x, bits, largest)
}

/// [`to_fixed`] without a product, bit for bit.
fn shifted(x: f32, bits: u32, largest: i32) -> i32 {
    let word = x.to_bits();
    let exponent = (word >> 23) & 0xff;
    let mantissa = word & 0x007f_ffff;
    if exponent == 0xff && mantissa != 0 {
        return 0;
    }
    let mantissa = (mantissa | 0x0080_0000) as i32;
    // x = mantissa * 2^(exponent - 150).
    let shift = exponent as i32 + bits as i32 - 150;
    let size = match shift {
        // What is not normal is far below a unit.
        ..=-24 => 0,
        -23..=-1 => mantissa >> -shift,
        0..=6 => (mantissa << shift).min(largest),
        _ => largest,
    };
    if word >> 31 == 0 { size } else { -size }
}

/// An output in m, exact to f32's rounding of the integer.
#[inline]
pub fn from_output(y: i32) -> f32 {
    // A power of two less in the exponent: a product in software costs more.
    if y == 0 { 0.0 } else { f32::from_bits((y as f32).to_bits().wrapping_sub(OUTPUT_BITS << 23)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::{JointBlock, advance_joint};

    #[test]
    fn joint_model_is_the_one_in_f32_to_rounding() {
        let block: FixedBlock = [
            29_000, 14_000, -14_000, 29_000, 900, -400, 300, -200, 70, 1_200, 20_000, -9_000, 77, 5_000, -3, 31_000, 1,
            3,
        ];
        // Units of the integers: X' = 2 (a X / 2^16 + b u / 2^1), y = (c X / 2^16) / 2^3.
        let float: JointBlock = core::array::from_fn(|at| {
            f32::from(block[at])
                * if at < 4 {
                    1.0 / 32_768.0
                } else if at < 10 {
                    1.0
                } else {
                    1.0 / 524_288.0
                }
        });
        let (mut x, mut state) = ([[0i32; 2]], [[0.0f32; 2]]);
        let mut farthest = 0.0f32;
        for frame in 0..400 {
            let u: [i32; 3] = core::array::from_fn(|at| (frame * (at as i32 + 3) * 37) % 8_000 - 4_000);
            let (mut y, mut out) = ([5, -5, 0], [5.0, -5.0, 0.0]);
            advance_joint_fixed(&[block], u, &mut x, &mut y);
            advance_joint(&[float], u.map(|u| u as f32), &mut state, &mut out);
            for (x, state) in x.as_flattened().iter().zip(state.as_flattened()) {
                assert!((*x as f32 - state).abs() < 200.0, "{frame}: {x} {state}");
                farthest = farthest.max(state.abs());
            }
            for (y, out) in y.iter().zip(out) {
                assert!((*y as f32 - out).abs() < 20.0, "{frame}: {y} {out}");
            }
        }
        assert!(farthest > 1e6);
    }

    #[test]
    fn no_input_and_no_state_overflows() {
        let most = i16::MAX;
        let least = i16::MIN;
        for sign in [most, least] {
            let third = sign / 3;
            let block = [
                sign, sign, sign, sign, third, third, third, third, third, third, sign, sign, sign, sign, sign, sign,
                0, 31,
            ];
            assert!(is_bounded(&block));
            let mut x = [[(1 << STATE_BITS) - 1; 2]];
            for u in [i32::from(most), i32::from(least)] {
                for _ in 0..100 {
                    let mut y = [0; 3];
                    advance_joint_fixed(&[block], [u; 3], &mut x, &mut y);
                    assert!(x.iter().flatten().all(|x| x.unsigned_abs() <= 1 << STATE_BITS), "{x:?}");
                }
            }
        }
        let mut steep = [0; 18];
        steep[4..7].copy_from_slice(&[most, 2, 0]);
        assert!(!is_bounded(&steep), "inputs that could overflow");
        let mut shifted = [0; 18];
        shifted[17] = 32;
        assert!(!is_bounded(&shifted));
        shifted[17] = -1;
        assert!(!is_bounded(&shifted));
    }

    #[test]
    fn conversions_are_the_products_that_they_stand_for() {
        let mut word = 1u32;
        for _ in 0..200_000 {
            word = word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let x = f32::from_bits(word);
            let product = ((x * 16_777_216.0) as i32).clamp(-LARGEST_INPUT, LARGEST_INPUT);
            assert_eq!(shifted(x, INPUT_BITS, LARGEST_INPUT), product, "{x}");
            let near = (word >> 8) as f32 / 16_777_216.0 * 40.0 - 20.0;
            let product = ((near * 16_777_216.0) as i32).clamp(-LARGEST_INPUT, LARGEST_INPUT);
            assert_eq!(shifted(near, INPUT_BITS, LARGEST_INPUT), product, "{near}");
            assert_eq!(from_output(word as i32), word as i32 as f32 / 262_144.0);
        }
    }

    #[test]
    fn what_is_not_a_number_is_zero() {
        assert_eq!(to_fixed(f32::NAN, INPUT_BITS, LARGEST_INPUT), 0);
        assert_eq!(to_fixed(f32::INFINITY, INPUT_BITS, LARGEST_INPUT), LARGEST_INPUT);
        assert_eq!(to_fixed(-1.0, INPUT_BITS, LARGEST_INPUT), -(1 << INPUT_BITS));
        assert_eq!(from_output(1 << 18), 1.0);
    }
}
