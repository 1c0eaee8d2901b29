//! The loops in safe Rust: what the assembly must equal.

use crate::{Inputs, Weights};

/// See [`crate::tile`].
#[inline]
pub fn tile(weights: &[Weights], inputs: &[Inputs], sums: &mut [i32; 4]) {
    let [mut s0, mut s1, mut s2, mut s3] = *sums;
    for ([w0, w1, w2, w3], [low, high]) in weights.iter().zip(inputs) {
        let x = [*low as i16, (*low >> 16) as i16, *high as i16, (*high >> 16) as i16].map(i32::from);
        s0 = row(*w0, x, s0);
        s1 = row(*w1, x, s1);
        s2 = row(*w2, x, s2);
        s3 = row(*w3, x, s3);
    }
    *sums = [s0, s1, s2, s3];
}

/// See [`crate::column_tile`].
#[inline]
pub fn column_tile(weights: &[[f32; 8]], x: &[f32]) -> [f32; 8] {
    let mut sums = [0.0; 8];
    for (weights, x) in weights.iter().zip(x) {
        for (sum, weight) in sums.iter_mut().zip(weights) {
            *sum += weight * x;
        }
    }
    sums
}

/// See [`crate::scale16`], from two products of 32 bits.
#[inline(always)]
pub fn scale16(w: i16, x: i32) -> i32 {
    let w = i32::from(w);
    // At most 2^15 * 2^16 in size: neither product can wrap.
    (x >> 16) * w + (((x & 0xffff) * w) >> 16)
}

/// See [`crate::scale32`], from four products of 32 bits.
#[inline(always)]
pub fn scale32(w: i32, x: i32) -> i32 {
    let ([low_w, high_w], [low_x, high_x]) = ([w & 0xffff, w >> 16], [x & 0xffff, x >> 16]);
    let low = (low_w as u32 * low_x as u32) >> 16;
    // At most 2^31 - 2^16 in size: there is room for the low product's upper half.
    let first = low_w * high_x + low as i32;
    let second = high_w * low_x;
    let carry = ((first & 0xffff) + (second & 0xffff) + 0x8000) >> 16;
    (high_w * high_x).wrapping_add((first >> 16) + (second >> 16) + carry)
}

/// See [`crate::sqrt`]: a bit of the root at a time, in words of 32 bits.
pub fn sqrt(x: f32) -> f32 {
    sqrt_by(x, root)
}

/// The root of `rest`, its leading one in bit 24 or 25, to 25 bits.
fn root(mut rest: u32) -> u32 {
    let (mut twice, mut bit) = (0, 1 << 24);
    while bit != 0 {
        let next = twice + bit;
        if next <= rest {
            (twice, rest) = (next + bit, rest - next);
        }
        (rest, bit) = (rest << 1, bit >> 1);
    }
    twice >> 1
}

/// [`sqrt`] with another loop.
#[inline(always)]
pub(crate) fn sqrt_by(x: f32, root: impl Fn(u32) -> u32) -> f32 {
    const INFINITY: u32 = 0xff << 23;
    let bits = x.to_bits();
    if bits << 1 == 0 || bits == INFINITY {
        return x;
    }
    if bits > INFINITY {
        return f32::NAN;
    }
    let (mut exponent, mut rest) = match bits >> 23 {
        0 => {
            let zeros = (bits << 9).leading_zeros();
            (-(zeros as i32), bits << (zeros + 1))
        }
        exponent => (exponent as i32, bits & 0x007f_ffff | 1 << 23),
    };
    // An even power of two is left over.
    exponent -= 127;
    rest <<= 1 + (exponent & 1);
    // 24 bits and one to round by: no root lies half way between two numbers.
    let root = root(rest);
    f32::from_bits(((root + (root & 1)) >> 1).wrapping_add(((exponent >> 1) + 126) as u32 * (1 << 23)))
}

#[inline(always)]
fn row(word: u32, [x0, x1, x2, x3]: [i32; 4], sum: i32) -> i32 {
    let [c0, c2, c1, c3] = word.to_le_bytes().map(|byte| i32::from(byte as i8));
    // A product fits 24 bits: it cannot wrap, only the sum can.
    sum.wrapping_add(c0 * x0).wrapping_add(c1 * x1).wrapping_add(c2 * x2).wrapping_add(c3 * x3)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::pack_weights;

    #[test]
    fn equals_the_definition_in_64_bits() {
        let mut seed = 1u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            seed >> 8
        };
        for groups in 0..20 {
            let columns = 4 * groups;
            let mut rows = [[0i8; 80]; 4];
            rows.iter_mut().flatten().for_each(|weight| *weight = next() as i8);
            let mut x = [0i16; 80];
            x.iter_mut().for_each(|x| *x = next() as i16);
            let mut weights = [[0u32; 4]; 20];
            let mut inputs = [[0u32; 2]; 20];
            for group in 0..groups {
                let at = 4 * group;
                let word = |row: &[i8; 80]| pack_weights([row[at], row[at + 1], row[at + 2], row[at + 3]]);
                weights[group] = [word(&rows[0]), word(&rows[1]), word(&rows[2]), word(&rows[3])];
                let pair = |at: usize| u32::from(x[at] as u16) | u32::from(x[at + 1] as u16) << 16;
                inputs[group] = [pair(at), pair(at + 2)];
            }
            let mut sums = [1, -2, 3, i32::MAX];
            let before = sums;
            tile(&weights[..groups], &inputs[..groups], &mut sums);
            let mut public = before;
            crate::tile(&weights[..groups], &inputs[..groups], &mut public);
            assert_eq!(public, sums);
            for row in 0..4 {
                let exact: i64 = (0..columns).map(|c| i64::from(rows[row][c]) * i64::from(x[c])).sum();
                assert_eq!(sums[row], (i64::from(before[row]) + exact) as i32, "row {row} of {columns} columns");
            }
        }
    }

    #[test]
    fn both_ways_to_scale_round_down() {
        let values = [0, 1, -1, 2, 65_535, 65_536, -65_536, 12_345_678, -12_345_679, i32::MAX, i32::MIN];
        for w in (i16::MIN..=i16::MAX).step_by(13).chain([i16::MAX]) {
            for x in values {
                let exact = (i64::from(w) * i64::from(x)).div_euclid(65_536);
                assert_eq!(i64::from(scale16(w, x)), exact, "{w} {x}");
                assert_eq!(i64::from(crate::scale16(w, x)), exact, "{w} {x}");
            }
        }
        let mut seed = 1u32;
        for step in 0..1_000_000 {
            let mut next = || {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                (seed ^ seed >> 15) as i32
            };
            let value = |drawn: i32| values[drawn as usize % values.len()];
            let (w, x) = if step % 3 == 0 { (value(next()), value(next())) } else { (next(), next()) };
            let exact = (i64::from(w) * i64::from(x) + (1 << 31)).div_euclid(1 << 32);
            assert_eq!(i64::from(scale32(w, x)), exact, "{w} {x}");
            assert_eq!(i64::from(crate::scale32(w, x)), exact, "{w} {x}");
        }
    }

    #[test]
    fn roots_are_those_of_the_fpu() {
        let near = |bits: u32| (0..200_000).map(move |step| bits.wrapping_add(step).wrapping_sub(100_000));
        let all = (0..u32::MAX)
            .step_by(1_009)
            .chain([0, 1 << 23, 127 << 23, 128 << 23, 0xff << 23].into_iter().flat_map(near));
        for bits in all {
            let x = f32::from_bits(bits);
            let (own, exact) = (sqrt(x), x.sqrt());
            assert!(own.to_bits() == exact.to_bits() || own.is_nan() && exact.is_nan(), "{x}: {own}, not {exact}");
        }
    }

    #[test]
    fn columns_are_added_in_order_with_two_roundings() {
        let mut seed = 1u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / 8_388_608.0 - 1.0
        };
        for columns in 0..40 {
            let mut weights = [[0.0; 8]; 40];
            weights.iter_mut().flatten().for_each(|weight| *weight = next());
            let x: [f32; 40] = core::array::from_fn(|_| next());
            // The longer of the two is cut.
            let sums = column_tile(&weights[..columns], &x);
            assert_eq!(crate::column_tile(&weights, &x[..columns]), sums);
            for row in 0..8 {
                let mut sum = 0.0;
                for column in 0..columns {
                    let product = f64::from(weights[column][row]) * f64::from(x[column]);
                    sum = (f64::from(sum) + f64::from(product as f32)) as f32;
                }
                assert_eq!(sums[row], sum, "row {row} of {columns} columns");
            }
        }
    }
}
