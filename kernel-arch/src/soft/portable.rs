//! Sums, products and quotients on the bits of f32.
//!
//! A significand lies at the top of a word, its leading one in bit 31: eight bits below the 24 that are kept are there to round by.

const SIGN: u32 = 1 << 31;
const INFINITY: u32 = 0xff << 23;
const QUIET_NAN: u32 = INFINITY | 1 << 22;

/// The exponent as it is stored, 0 to 255.
#[inline(always)]
fn exponent(bits: u32) -> i32 {
    (bits << 1 >> 24) as i32
}

/// The significand of a normal number.
#[inline(always)]
fn significand(bits: u32) -> u32 {
    bits << 8 | 1 << 31
}

/// The number with this significand, its leading one in bit 31, rounded to 24 bits: to nearest, ties to even. `signed_exponent` is
/// the stored exponent less one, since the leading one adds one to the field, with the sign in bit 8. Rounding up from the largest
/// number gives infinity, as it must.
#[inline(always)]
fn round(significand: u32, signed_exponent: i32) -> u32 {
    let kept = significand >> 8;
    // All ones below the half, and one more where the kept part is odd: a carry where it must be rounded up.
    let rest = (significand & 0xff) + (kept & 1) + 0x7f;
    kept.wrapping_add(rest >> 8).wrapping_add((signed_exponent as u32) << 23)
}

/// The same with the leading one in bit 30: the carry has a place to go.
#[inline(always)]
fn round_low(significand: u32, signed_exponent: i32) -> u32 {
    let odd = significand >> 7 & 1;
    ((significand + odd + 0x3f) >> 7).wrapping_add((signed_exponent as u32) << 23)
}

/// `a + b`.
#[inline(always)]
pub fn add(a: u32, b: u32) -> u32 {
    let (a, b) = if a << 1 < b << 1 { (b, a) } else { (a, b) };
    let (high, low) = (exponent(a), exponent(b));
    // Sums of what has exponent 254 may overflow; differences of what has less than 32 may be subnormal.
    if high >= 254 || low == 0 || high < 32 {
        return if b << 1 == 0 && high < 255 { add_zero(a, b) } else { rare_add(a, b) };
    }
    let apart = (high - low) as u32;
    if apart > 25 {
        // Less than half of the last place, even below a power of two.
        return a;
    }
    let (large, small) = (significand(a) >> 1, significand(b) >> 1);
    let moved = small >> apart;
    // What is shifted out can only matter where the rest is just half of the last place: one bit stands for all of it.
    let small = moved | u32::from(moved << apart != small);
    let sum = if (a ^ b) & SIGN == 0 { large + small } else { large - small };
    normalise(sum, high + (a >> 31 << 8) as i32)
}

/// `a + b` for `b` zero. Two zeros of different signs make a positive one.
#[inline(always)]
fn add_zero(a: u32, b: u32) -> u32 {
    if a << 1 == 0 { a & b } else { a }
}

/// Rounds a sum whose leading one in bit 31 stands for the stored exponent `exponent + 1`.
#[inline(always)]
fn normalise(mut sum: u32, mut exponent: i32) -> u32 {
    if sum >> 31 != 0 {
        return round(sum, exponent);
    }
    exponent -= 1;
    if sum >> 30 == 0 {
        if sum == 0 {
            return 0;
        }
        // Bit by bit: few are cancelled as a rule, and these cores have no instruction that counts them.
        while sum >> 30 == 0 {
            (sum, exponent) = (sum << 1, exponent - 1);
        }
    }
    round_low(sum, exponent)
}

/// `a * b`.
#[inline(always)]
pub fn mul(a: u32, b: u32) -> u32 {
    let (of_a, of_b) = (exponent(a), exponent(b));
    let sum = of_a + of_b - 127;
    if of_a == 0 || of_b == 0 || of_a == 255 || of_b == 255 || !(1..254).contains(&sum) {
        let zero = a << 1 == 0 || b << 1 == 0;
        return if zero && of_a < 255 && of_b < 255 { (a ^ b) & SIGN } else { rare_mul(a, b) };
    }
    let product = u64::from(significand(a)) * u64::from(significand(b));
    // One bit stands for the low half: what is rounded by is above it.
    let top = (product >> 32) as u32 | u32::from(product as u32 != 0);
    let exponent = sum + ((a ^ b) >> 31 << 8) as i32;
    if top >> 31 != 0 { round(top, exponent) } else { round_low(top, exponent - 1) }
}

/// A number that is neither zero nor infinite nor NaN: its significand with the leading one in bit 31, and its exponent, below 1
/// for what is subnormal.
fn parts(bits: u32) -> (u32, i32) {
    match exponent(bits) {
        0 => {
            let zeros = (bits << 8).leading_zeros() as i32;
            (bits << 8 << zeros, 1 - zeros)
        }
        exponent => (significand(bits), exponent),
    }
}

/// The number with this significand, its leading one in bit 31, the lowest bit sticky, and any exponent.
fn round_any(significand: u32, exponent: i32, sign: u32) -> u32 {
    if exponent >= 255 {
        return sign | INFINITY;
    }
    if exponent >= 1 {
        return sign | round(significand, exponent - 1);
    }
    // Subnormal: the leading one has its own place in the field, and rounding may carry into the exponent.
    let shift = (1 - exponent) as u32;
    let (moved, lost) = if shift < 32 { (significand >> shift, significand << (32 - shift)) } else { (0, significand) };
    let moved = moved | u32::from(lost != 0);
    sign | round(moved, 0)
}

/// [`add`] for all numbers.
#[cold]
#[inline(never)]
pub fn rare_add(a: u32, b: u32) -> u32 {
    let (a, b) = if a << 1 < b << 1 { (b, a) } else { (a, b) };
    if a & !SIGN > INFINITY {
        return a | QUIET_NAN;
    }
    if a & !SIGN == INFINITY {
        return if b == a ^ SIGN { QUIET_NAN } else { a };
    }
    if b << 1 == 0 {
        return add_zero(a, b);
    }
    let ((large, high), (small, low)) = (parts(a), parts(b));
    // In 64 bits: 32 more below the significands, where at most 25 of them are needed to round right.
    let apart = (high - low).min(40) as u32;
    let large = u64::from(large) << 31;
    let small = u64::from(small) << 31;
    let moved = small >> apart;
    let moved = moved | u64::from(moved << apart != small);
    let sum = if (a ^ b) & SIGN == 0 { large + moved } else { large - moved };
    if sum == 0 {
        return 0;
    }
    let zeros = sum.leading_zeros();
    let sum = sum << zeros;
    let top = (sum >> 32) as u32 | u32::from(sum as u32 != 0);
    round_any(top, high + 1 - zeros as i32, a & SIGN)
}

/// [`mul`] for all numbers.
#[cold]
#[inline(never)]
pub fn rare_mul(a: u32, b: u32) -> u32 {
    let sign = (a ^ b) & SIGN;
    let (size_a, size_b) = (a & !SIGN, b & !SIGN);
    if size_a > INFINITY || size_b > INFINITY {
        return QUIET_NAN;
    }
    if size_a == 0 || size_b == 0 {
        return if size_a == INFINITY || size_b == INFINITY { QUIET_NAN } else { sign };
    }
    if size_a == INFINITY || size_b == INFINITY {
        return sign | INFINITY;
    }
    let ((of_a, high), (of_b, low)) = (parts(a), parts(b));
    let product = u64::from(of_a) * u64::from(of_b);
    let zeros = product.leading_zeros();
    let product = product << zeros;
    let top = (product >> 32) as u32 | u32::from(product as u32 != 0);
    round_any(top, high + low - 126 - zeros as i32, sign)
}

/// `a / b`, bit by bit. ARMv6-M comes here for what is rare alone, RISC-V never: it has the compiler's.
#[cold]
#[inline(never)]
pub fn div(a: u32, b: u32) -> u32 {
    let sign = (a ^ b) & SIGN;
    let (size_a, size_b) = (a & !SIGN, b & !SIGN);
    if size_a > INFINITY || size_b > INFINITY || size_a == size_b && (size_a == 0 || size_a == INFINITY) {
        return QUIET_NAN;
    }
    if size_a == INFINITY || size_b == 0 {
        return sign | INFINITY;
    }
    if size_a == 0 || size_b == INFINITY {
        return sign;
    }
    let ((of_a, high), (of_b, low)) = (parts(a), parts(b));
    let (mut rest, by) = (of_a >> 8, of_b >> 8);
    let mut exponent = high - low + 127;
    if rest < by {
        (rest, exponent) = (rest << 1, exponent - 1);
    }
    let mut quotient = 0;
    for _ in 0..26 {
        quotient <<= 1;
        if rest >= by {
            (rest, quotient) = (rest - by, quotient | 1);
        }
        rest <<= 1;
    }
    round_any(quotient << 6 | u32::from(rest != 0), exponent, sign)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    /// Words of which sums and products are hard: all exponents, significands of few and of many ones, neighbours of powers of two.
    fn words(count: usize) -> impl Iterator<Item = [u32; 2]> {
        let mut seed = 0x9e37_79b9_7f4a_7c15u64;
        let mut next = move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 32) as u32
        };
        (0..count).map(move |_| {
            let (a, b, choice) = (next(), next(), next());
            let shaped = |word: u32, choice: u32| match choice & 7 {
                0 => word,
                1 => word & 0xff80_0000,
                2 => (word & 0xff80_0000).wrapping_sub(1 + (choice >> 8 & 3)),
                3 => word & 0xff80_0000 | (1 + (choice >> 8 & 3)),
                4 => word & 0xfff0_0000,
                5 => word & 0x807f_ffff,
                6 => word & 0x807f_ffff | 0x7f00_0000,
                _ => word & 0xffff_f000,
            };
            let b = match choice >> 16 & 7 {
                // Near to `a`, so that much is cancelled; or a few binades away, where rounding is decided by few bits.
                0 => a ^ SIGN ^ (b & 7),
                1 => (a ^ SIGN) & 0xff80_0000 | b & 0x007f_ffff,
                2..=4 => (a ^ b & SIGN).wrapping_sub(((b >> 3) % 30) << 23),
                _ => shaped(b, choice >> 3),
            };
            [shaped(a, choice), b]
        })
    }

    fn equal(own: u32, core: f32, what: &str, [a, b]: [u32; 2]) {
        let same = if core.is_nan() { f32::from_bits(own).is_nan() } else { own == core.to_bits() };
        assert!(same, "{a:08x} {what} {b:08x}: {own:08x}, not {:08x}", core.to_bits());
    }

    #[test]
    fn sums_products_and_quotients_are_those_of_the_fpu() {
        for pair in words(10_000_000) {
            let [a, b] = pair;
            let (x, y) = (f32::from_bits(a), f32::from_bits(b));
            equal(add(a, b), x + y, "+", pair);
            equal(rare_add(a, b), x + y, "+ (rare)", pair);
            equal(mul(a, b), x * y, "*", pair);
            equal(rare_mul(a, b), x * y, "* (rare)", pair);
            equal(div(a, b), x / y, "/", pair);
        }
    }

    #[test]
    fn every_exponent_meets_every_other() {
        for high in 0..=255u32 {
            for low in 0..=255u32 {
                for [of_a, of_b] in [[0, 0], [0, 1], [1, 0x007f_ffff], [0x007f_ffff; 2], [0x0040_0000, 0x003f_ffff]] {
                    for signs in [0, SIGN] {
                        let pair = [high << 23 | of_a, low << 23 | of_b | signs];
                        let [a, b] = pair;
                        let (x, y) = (f32::from_bits(a), f32::from_bits(b));
                        equal(add(a, b), x + y, "+", pair);
                        equal(mul(a, b), x * y, "*", pair);
                        equal(div(a, b), x / y, "/", pair);
                    }
                }
            }
        }
    }
}
