//! A layer in integers: int8 weights with a scale a row, int16 activations, int32 sums.
//!
//! `z = ((sum * multiplier + 2^31) >> 32) + bias`. No step rounds by the core's own rules, so the bits are the same everywhere.

use core::num::NonZeroUsize;

use kinesic_kernel_arch::{Inputs, Weights, scale32, tile};

use crate::model::{LoadError, Pack};

/// Rows of one tile, and columns of one group in it.
pub const TILE: usize = 4;

/// Fraction bits of an activation: 1 is 8192. Sums of int8 times this fit 32 bits up to [`MOST_COLUMNS`] columns.
pub const ACTIVATION_BITS: u32 = 13;

/// Fraction bits of what a layer gives before its tanh.
pub const PRE_ACTIVATION_BITS: u32 = 12;

/// Columns up to which no sum can overflow: `128 * 8192 * columns < 2^31`.
pub const MOST_COLUMNS: usize = 2047;

/// Largest activation that a layer may be given, either sign.
pub const LARGEST_ACTIVATION: i16 = 1 << ACTIVATION_BITS;

/// Up to `N` activations on a word boundary, zero at first. The kernel reads whole groups of four: `N` must be a multiple of 4.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(4))]
pub struct Activations<const N: usize>([i16; N]);

impl<const N: usize> Activations<N> {
    /// All zero.
    pub const fn zero() -> Self {
        Self([0; N])
    }

    /// The values, to be written.
    pub fn values(&mut self) -> &mut [i16] {
        &mut self.0
    }

    /// The first `first` values and the `second` behind them, each rounded up to whole groups; `None` if there are not as many.
    pub fn split(&mut self, first: usize, second: usize) -> Option<[&mut [i16]; 2]> {
        let (one, rest) = self.0.split_at_mut_checked(first.checked_next_multiple_of(TILE)?)?;
        Some([one, rest.get_mut(..second.checked_next_multiple_of(TILE)?)?])
    }
}

/// Values on a word boundary as the kernel reads them, in whole groups.
fn groups(x: &[i16]) -> &[Inputs] {
    bytemuck::pod_align_to::<i16, Inputs>(x).1
}

/// A layer `W x + b` with int8 weights, stored as tiles of [`TILE`] rows, columns in groups of four: `tile[t][group][row]`.
#[derive(Clone, Copy, Debug)]
pub struct Quantised<'a> {
    groups: NonZeroUsize,
    tiles: &'a [Weights],
    multipliers: &'a [i32],
    bias: &'a [i32],
}

impl<'a> Quantised<'a> {
    /// A view of `ceil(rows / 4) * ceil(columns / 4)` groups, a multiplier and a bias a row; `None` unless the shapes fit and no
    /// sum can overflow.
    pub fn new(columns: usize, tiles: &'a [Weights], multipliers: &'a [i32], bias: &'a [i32]) -> Option<Self> {
        let groups = NonZeroUsize::new(columns.div_ceil(TILE))?;
        let expected = bias.len().div_ceil(TILE).checked_mul(groups.get())?;
        let fits = columns <= MOST_COLUMNS && tiles.len() == expected && multipliers.len() == bias.len();
        fits.then_some(Self { groups, tiles, multipliers, bias })
    }

    /// The layer whose tensors are `weights`, `multipliers` and `bias`, `rows x columns`.
    pub fn load(
        pack: &Pack<'a>,
        [weights, multipliers, bias]: [&'static str; 3],
        rows: usize,
        columns: usize,
    ) -> Result<Self, LoadError> {
        let expected = rows.div_ceil(TILE).saturating_mul(columns.div_ceil(TILE));
        let tiles = pack.packed(weights, expected)?;
        let layer = Self::new(columns, tiles, pack.slice(multipliers, rows)?, pack.slice(bias, rows)?);
        layer.ok_or(LoadError::Shape { tensor: weights, found: columns, expected: MOST_COLUMNS })
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.bias.len()
    }

    /// Multiply-adds, padding included.
    pub fn multiply_adds(&self) -> usize {
        self.tiles.len().saturating_mul(TILE * TILE)
    }

    /// What the rows make of `x` (on a word boundary, in whole groups of four, as [`Activations`] has it), four rows after four; what
    /// lies behind the last row is zero.
    #[inline]
    pub fn tiles<'x>(&self, x: &'x [i16]) -> impl Iterator<Item = [i32; TILE]> + use<'a, 'x> {
        let rows = self.multipliers.chunks(TILE).zip(self.bias.chunks(TILE));
        self.tiles.chunks_exact(self.groups.get()).zip(rows).map(move |(tiles, (multipliers, bias))| {
            let mut sums = [0; TILE];
            tile(tiles, groups(x), &mut sums);
            let row = |sum, multiplier: i32, bias: i32| scale32(sum, multiplier).wrapping_add(bias);
            // Whole tiles without a check a row.
            if let (&[m0, m1, m2, m3], &[b0, b1, b2, b3]) = (multipliers, bias) {
                let [s0, s1, s2, s3] = sums;
                return [row(s0, m0, b0), row(s1, m1, b1), row(s2, m2, b2), row(s3, m3, b3)];
            }
            let mut out = [0; TILE];
            for (((out, sum), multiplier), bias) in out.iter_mut().zip(sums).zip(multipliers).zip(bias) {
                *out = row(sum, *multiplier, *bias);
            }
            out
        })
    }

    /// Writes what `each` makes of the rows, in order; what lies behind them is left alone.
    #[inline]
    pub fn apply<T>(&self, x: &[i16], out: &mut [T], each: impl Fn(i32) -> T) {
        let Some(out) = out.get_mut(..self.rows()) else { return };
        for (rows, out) in self.tiles(x).zip(out.chunks_mut(TILE)) {
            if let Ok(out) = <&mut [T; TILE]>::try_from(&mut *out) {
                *out = rows.map(&each);
                continue;
            }
            for (row, out) in rows.into_iter().zip(out) {
                *out = each(row);
            }
        }
    }

    /// [`apply`](Self::apply) through [`tanh_fixed`]: the activations of the next layer.
    pub fn apply_tanh(&self, x: &[i16], out: &mut [i16]) {
        self.apply(x, out, tanh_fixed);
    }
}

/// Fraction bits that a step of the table spans: 1/32.
const STEP_BITS: u32 = PRE_ACTIVATION_BITS - 5;

/// tanh at multiples of 1/32 up to 8, in units of 2^-13.
static TANH: [i16; 257] = tanh_table();

/// `tanh(x)` in fixed point: `x` in units of 2^-12, the result in units of 2^-13. A table of 257 values and a straight line
/// between them; absolute error below 2.5e-4 over all inputs; odd, rising. Cost: a multiply.
pub fn tanh_fixed(x: i32) -> i16 {
    // From 8 on the table is 1: the last step holds.
    let size = x.unsigned_abs().min((8 << PRE_ACTIVATION_BITS) - 1);
    let at = (size >> STEP_BITS) as usize;
    let part = (size & ((1 << STEP_BITS) - 1)) as i32;
    let value = |at: usize| i32::from(TANH.get(at).copied().unwrap_or(LARGEST_ACTIVATION));
    let (low, high) = (value(at), value(at + 1));
    let y = low + (((high - low) * part + (1 << (STEP_BITS - 1))) >> STEP_BITS);
    (if x < 0 { -y } else { y }) as i16
}

const fn tanh_table() -> [i16; 257] {
    let mut table = [0; 257];
    let mut at = 0;
    while at < 257 {
        let x = at as f64 / 32.0;
        // Lambert's continued fraction, from a term where what is cut off is far below f64's rounding.
        let mut term = 81.0;
        let mut down = term;
        while term > 1.0 {
            term -= 2.0;
            down = term + x * x / down;
        }
        table[at] = (x / down * (1u32 << ACTIVATION_BITS) as f64 + 0.5) as i16;
        at += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use kinesic_kernel_arch::pack_weights;

    #[test]
    fn tanh_keeps_its_stated_error_over_all_inputs() {
        let mut last = -LARGEST_ACTIVATION;
        let mut worst = 0.0f64;
        for x in -70_000..=70_000 {
            let y = tanh_fixed(x);
            worst = worst.max((f64::from(y) / 8192.0 - (f64::from(x) / 4096.0).tanh()).abs());
            assert!(y >= last && y == -tanh_fixed(-x));
            last = y;
        }
        assert!(worst < 2.5e-4, "{worst}");
        for x in [i32::MIN, i32::MIN + 1, i32::MAX] {
            assert_eq!(tanh_fixed(x).unsigned_abs(), 8192);
        }
    }

    #[test]
    fn is_the_layer_that_it_says() {
        // 5 x 6: one full tile and one row of the next, two groups.
        let entry = |row: usize, column: usize| if row < 5 && column < 6 { (7 * row + column) as i8 - 20 } else { 0 };
        let tiles: std::vec::Vec<Weights> = (0..4)
            .map(|at| {
                let word = |row| pack_weights(core::array::from_fn(|c| entry(at / 2 * 4 + row, at % 2 * 4 + c)));
                [word(0), word(1), word(2), word(3)]
            })
            .collect();
        let (multipliers, bias) = ([1 << 30; 5], [100, 0, -100, 5, 7]);
        let layer = Quantised::new(6, &tiles, &multipliers, &bias).unwrap();
        let mut x = Activations::<8>::zero();
        let values = [8192, -8192, 100, 3, -5, 77];
        x.values()[..6].copy_from_slice(&values);
        let mut out = [0i32; 6];
        layer.apply(x.values(), &mut out, |z| z);
        for row in 0..5 {
            let sum: i64 = (0..6).map(|c| i64::from(entry(row, c)) * i64::from(values[c])).sum();
            assert_eq!(i64::from(out[row]), (sum + 2).div_euclid(4) + i64::from(bias[row]), "row {row}");
        }
        assert_eq!(out[5], 0);
    }

    #[test]
    fn refuses_what_does_not_fit() {
        let tiles = [[0; 4]; 4];
        assert!(Quantised::new(6, &tiles, &[0; 5], &[0; 5]).is_some());
        assert!(Quantised::new(6, &tiles, &[0; 4], &[0; 5]).is_none());
        assert!(Quantised::new(6, &tiles, &[0; 9], &[0; 9]).is_none());
        assert!(Quantised::new(0, &[], &[0; 5], &[0; 5]).is_none());
        assert!(Quantised::new(2048, &[[0; 4]; 512], &[0; 4], &[0; 4]).is_none(), "could overflow");
    }
}
