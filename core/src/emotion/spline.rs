//! A C1 spline through keyframes at uneven times: cubic Hermite pieces, whose tangents are those of the parabola through a
//! keyframe and its two neighbours.
//!
//! A point between keyframes `k` and `k + 1` is a weighted sum of the four keyframes `k - 1` to `k + 2`, whatever a keyframe
//! holds: the eight weights are computed once a frame. Training measures its keyframes with this very code.

/// Weights of the four keyframes around a point, and of its rate of change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taps {
    /// Weights of keyframes `k - 1, k, k + 1, k + 2` for the value; they add up to 1.
    pub value: [f32; 4],
    /// The same for its derivative by time, 1/s; they add up to 0.
    pub rate: [f32; 4],
}

impl Taps {
    /// The point at `part` (0 to 1) of the piece between keyframes `k` and `k + 1`.
    ///
    /// `durations`: of the piece before, of this one, of the piece after, s, each greater than 0; but 0 before the first piece
    /// and after the last one, where the tangent is that of the parabola through the end (a straight line if there is one
    /// piece alone), and the weight of the keyframe that is not there is 0. Cost: about 60 multiply-adds, 6 divisions.
    pub fn new([before, own, after]: [f32; 3], part: f32) -> Self {
        // Tangents times the piece's duration, as weights of the four keyframes.
        let chord = [0.0, -1.0, 1.0, 0.0];
        let (mut first, mut last) = (chord, chord);
        if before > 0.0 {
            let [a, b, c] = tangent(before, own, own);
            first = [a, b, c, 0.0];
        }
        if after > 0.0 {
            let [a, b, c] = tangent(own, after, own);
            last = [0.0, a, b, c];
        }
        // The parabola through an end and the tangent at the other end of the piece.
        let other = |tangent: [f32; 4]| {
            let mut other = tangent;
            for (other, chord) in other.iter_mut().zip(chord) {
                *other = 2.0 * chord - *other;
            }
            other
        };
        match (before > 0.0, after > 0.0) {
            (false, true) => first = other(last),
            (true, false) => last = other(first),
            _ => {}
        }
        let u = part;
        let (v, rate) = (1.0 - u, 1.0 / own);
        // Hermite basis: start, its tangent, end, its tangent; and the derivatives by time.
        let basis = [v * v * (1.0 + 2.0 * u), u * v * v, u * u * (3.0 - 2.0 * u), -u * u * v];
        let slope = [-6.0 * u * v * rate, v * (1.0 - 3.0 * u) * rate, 6.0 * u * v * rate, u * (3.0 * u - 2.0) * rate];
        Self { value: combine(basis, &first, &last), rate: combine(slope, &first, &last) }
    }

    /// The point: `rows` are the four keyframes' values of one channel.
    pub fn value(&self, rows: [f32; 4]) -> f32 {
        weigh(&self.value, rows)
    }

    /// Its derivative by time, 1/s.
    pub fn rate(&self, rows: [f32; 4]) -> f32 {
        weigh(&self.rate, rows)
    }
}

/// Weights of three keyframes, `h0` and `h1` apart, for the parabola's slope at the middle one, times `scale`.
fn tangent(h0: f32, h1: f32, scale: f32) -> [f32; 3] {
    let sum = h0 + h1;
    let (a, c) = (-scale * h1 / (h0 * sum), scale * h0 / (h1 * sum));
    [a, -(a + c), c]
}

fn combine([p0, m0, p1, m1]: [f32; 4], first: &[f32; 4], last: &[f32; 4]) -> [f32; 4] {
    let mut taps = [0.0, p0, p1, 0.0];
    for ((tap, first), last) in taps.iter_mut().zip(first).zip(last) {
        *tap += m0 * first + m1 * last;
    }
    taps
}

fn weigh([a, b, c, d]: &[f32; 4], [p, q, r, s]: [f32; 4]) -> f32 {
    a * p + b * q + c * r + d * s
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIMES: [f32; 5] = [0.0, 0.1, 0.35, 0.4, 0.7];

    fn at(piece: usize, part: f32, value: impl Fn(f32) -> f32) -> [f32; 2] {
        let duration = |k: Option<usize>| k.and_then(|k| Some(TIMES.get(k + 1)? - TIMES.get(k)?)).unwrap_or(0.0);
        let taps = Taps::new([duration(piece.checked_sub(1)), duration(Some(piece)), duration(Some(piece + 1))], part);
        let row = |k: Option<usize>| k.and_then(|k| TIMES.get(k)).map_or(1e3, |t| value(*t));
        let rows = [row(piece.checked_sub(1)), row(Some(piece)), row(Some(piece + 1)), row(Some(piece + 2))];
        [taps.value(rows), taps.rate(rows)]
    }

    #[test]
    fn parabolas_are_exact_to_the_ends() {
        let (f, g) = (|t: f32| 2.0 - 3.0 * t + 5.0 * t * t, |t: f32| -3.0 + 10.0 * t);
        for piece in 0..4 {
            for step in 0..=10 {
                let part = step as f32 * 0.1;
                let t = TIMES[piece] + part * (TIMES[piece + 1] - TIMES[piece]);
                let [value, rate] = at(piece, part, f);
                assert!((value - f(t)).abs() < 1e-5 && (rate - g(t)).abs() < 1e-3, "{piece} {part}: {value} {rate}");
            }
        }
    }

    #[test]
    fn it_goes_through_the_keyframes_and_its_slope_has_no_corner() {
        let value = |t: f32| libm::sinf(20.0 * t);
        for piece in 0..3 {
            let (end, start) = (at(piece, 1.0, value), at(piece + 1, 0.0, value));
            assert!((end[0] - value(TIMES[piece + 1])).abs() < 1e-6 && (end[0] - start[0]).abs() < 1e-6);
            assert!((end[1] - start[1]).abs() < 1e-3 * (1.0 + start[1].abs()), "{end:?} {start:?}");
        }
    }

    #[test]
    fn the_rate_is_the_values_slope() {
        let value = |t: f32| libm::sinf(20.0 * t);
        for piece in 0..4 {
            let own = TIMES[piece + 1] - TIMES[piece];
            for step in 1..10 {
                let part = step as f32 * 0.1;
                let numeric = (at(piece, part + 5e-3, value)[0] - at(piece, part - 5e-3, value)[0]) / (1e-2 * own);
                assert!((numeric - at(piece, part, value)[1]).abs() < 2e-2, "{piece} {part}");
            }
        }
    }

    #[test]
    fn one_piece_alone_is_a_straight_line() {
        let taps = Taps::new([0.0, 0.5, 0.0], 0.25);
        assert_eq!(taps.value([9.0, 1.0, 3.0, 9.0]), 1.5);
        assert_eq!(taps.rate([9.0, 1.0, 3.0, 9.0]), 4.0);
    }
}
