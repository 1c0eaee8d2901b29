//! Elementary functions from `+ - * /` alone, so that host and target agree bit for bit.

use core::f32::consts::FRAC_2_PI;

use kinesic_kernel_arch::sqrt;

/// Where the rational tanh is cut: just below where it would reach 1.
const TANH_END: f32 = 4.97;

/// `tanh(x)` by the seventh convergent of Lambert's continued fraction. Absolute error below 1e-4, below 1e-6 for
/// `|x| <= 2`; odd, rising, within -1..1. Cost: 8 multiply-adds and a division.
#[inline]
pub fn tanh(x: f32) -> f32 {
    let x = if x.abs() > TANH_END { TANH_END.copysign(x) } else { x };
    let t = x * x;
    // By turns: no result is used by the instruction behind it.
    let (up, down) = (378.0 + t, 3_150.0 + t * 28.0);
    let (up, down) = (17_325.0 + t * up, 62_370.0 + t * down);
    let (up, down) = (135_135.0 + t * up, 135_135.0 + t * down);
    // At most 1 - 5e-7 in size: for all floats up to the end the quotient stays below 1.
    x * up / down
}

/// `(sin x, cos x)`: quarter turns taken off, then Taylor polynomials of degree 9 and 8. Absolute error below 3e-7 for
/// `|x| <= 100`. Cost: 15 multiply-adds.
pub fn sin_cos(x: f32) -> (f32, f32) {
    let turns = x * FRAC_2_PI;
    let quarter = (turns + if turns < 0.0 { -0.5 } else { 0.5 }) as i32;
    let n = quarter as f32;
    // pi / 2 in two parts: the first has few bits, so that its multiples are exact.
    let r = (x - n * 1.570_312_5) - n * 4.838_268e-4;
    let t = r * r;
    let sin = r * (1.0 + t * (-1.0 / 6.0 + t * (1.0 / 120.0 + t * (-1.0 / 5_040.0 + t * (1.0 / 362_880.0)))));
    let cos = 1.0 + t * (-0.5 + t * (1.0 / 24.0 + t * (-1.0 / 720.0 + t * (1.0 / 40_320.0))));
    match quarter & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Angle of the vector `(cos, sin)` of length `norm` in the first quadrant, 0..pi/2: the half of the half angle by a square root,
/// then the Taylor series of the arc tangent to degree 15. Absolute error below 1e-6; pi/2 where the sine is no number. Cost: 12
/// multiply-adds, two divisions, a root.
pub fn quadrant_angle(sin: f32, cos: f32, norm: f32) -> f32 {
    // At most 1: rounding may make the sine the longer.
    let half = (sin / (norm + cos)).min(1.0);
    let u = half / (1.0 + sqrt(1.0 + half * half));
    let t = u * u;
    let high = 1.0 / 9.0 + t * (-1.0 / 11.0 + t * (1.0 / 13.0 - t * (1.0 / 15.0)));
    4.0 * u * (1.0 + t * (-1.0 / 3.0 + t * (1.0 / 5.0 + t * (-1.0 / 7.0 + t * high))))
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    #[test]
    fn tanh_keeps_its_stated_error() {
        let mut last = -1.0;
        for step in -200_000..=200_000 {
            let x = step as f32 * 1e-4;
            let y = tanh(x);
            let error = (f64::from(y) - f64::from(x).tanh()).abs();
            assert!(error < if x.abs() <= 2.0 { 1e-6 } else { 1e-4 }, "tanh {x}: {error}");
            assert!(y >= last - 1e-6 && y == -tanh(-x));
            last = y;
        }
        assert_eq!(tanh(f32::INFINITY), tanh(1e30));
        // The last few thousand floats before the end: where a quotient could round to more than 1.
        for below in 0..100_000 {
            assert!(tanh(f32::from_bits(TANH_END.to_bits() - below)) < 1.0);
        }
        assert!(tanh(f32::MAX) < 1.0);
    }

    #[test]
    fn sine_and_cosine_keep_their_stated_error() {
        for step in -100_000..=100_000 {
            let x = step as f32 * 1e-3;
            let (sin, cos) = sin_cos(x);
            let (exact_sin, exact_cos) = f64::from(x).sin_cos();
            assert!((f64::from(sin) - exact_sin).abs() < 3e-7, "sin {x}");
            assert!((f64::from(cos) - exact_cos).abs() < 3e-7, "cos {x}");
        }
        let _ = sin_cos(f32::MAX);
        let _ = sin_cos(f32::NAN);
    }

    #[test]
    fn angles_keep_their_stated_error() {
        for step in 0..=100_000 {
            let angle = f64::from(step) * (core::f64::consts::FRAC_PI_2 / 1e5);
            for norm in [1.0, 3e-3, 700.0] {
                let [sin, cos] = [angle.sin(), angle.cos()].map(|x| (x * norm) as f32);
                let found = quadrant_angle(sin, cos, norm as f32);
                assert!((f64::from(found) - angle).abs() < 1e-6, "{angle} {norm}");
            }
        }
    }
}
