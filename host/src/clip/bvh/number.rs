//! Numbers of a frame, from bytes: the same bits as [`str::parse`] and sooner.
//!
//! Up to 2^53 whole numbers are exact in f64, and so are powers of ten up to 10^22. One division (or product) of two exact numbers
//! rounds once, so it gives the double next to the decimal number, which is what [`str::parse`] gives. Longer numbers go there.

/// 10^0 to 10^22, all exact.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];
/// By how much a number grows when so many digits, at most seven, are put behind it.
const WHOLE: [u64; 8] = [1, 10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000];
/// Whole numbers up to here are exact.
const EXACT: u64 = 1 << 53;
/// Digits that cannot overflow a u64.
const DIGITS: usize = 19;

/// White space between words, as in [`str::split_ascii_whitespace`].
pub(super) fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\x0c' | b'\r')
}

/// The word at `at` as a finite number, and where it ends.
pub(super) fn number(text: &[u8], at: usize) -> Option<(f64, usize)> {
    common(text, at).or_else(|| {
        let word = text.get(at..)?;
        let (value, rest) = short(word).or_else(|| any(word))?;
        Some((value, text.len() - rest.len()))
    })
}

/// A number as nearly all are: up to eight digits, a point, up to seven digits. Not at the very end of the text.
#[inline(always)]
fn common(text: &[u8], mut at: usize) -> Option<(f64, usize)> {
    let negative = *text.get(at)? == b'-';
    at += usize::from(negative);
    let start = at;
    let mut all = 0u64;
    while let Some(digit) = text.get(at).map(|byte| byte.wrapping_sub(b'0')).filter(|digit| *digit < 10) {
        all = all.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    let (before, mut after) = (at - start, 0);
    if text.get(at) == Some(&b'.') {
        at += 1;
        let (part, count) = leading(u64::from_le_bytes(*text.get(at..at + 8)?.first_chunk()?));
        all = all.wrapping_mul(*WHOLE.get(count)?).wrapping_add(part);
        at += count;
        after = count;
    }
    if before > 8 || before + after == 0 || text.get(at).is_some_and(|byte| !is_space(*byte)) {
        return None;
    }
    let size = all as f64 / POWERS.get(after)?;
    Some((if negative { -size } else { size }, at))
}

/// The number that the first of eight bytes are, and how many of them are digits: without a branch on how many there are.
#[inline(always)]
fn leading(eight: u64) -> (u64, usize) {
    let every = |byte: u8| u64::from_le_bytes([byte; 8]);
    let cells = eight ^ every(b'0');
    // The high bit of each byte that is no digit; a carry only reaches bytes behind the first of these.
    let other = (cells.wrapping_add(every(0x76)) | cells) & every(0x80);
    let count = other.trailing_zeros() / 8;
    // Zeros in front: the last digit is in the highest byte.
    let cells = cells.checked_shl(64 - 8 * count).unwrap_or(0) & every(0x0f);
    // Digits to pairs, pairs to fours, fours to eight.
    let pairs = cells.wrapping_mul(1 + (10 << 8)) >> 8;
    let fours = (pairs & 0x00ff_00ff_00ff_00ff).wrapping_mul(1 + (100 << 16)) >> 16;
    let all = (fours & 0x0000_ffff_0000_ffff).wrapping_mul(1 + (10_000 << 32)) >> 32;
    (all, count as usize)
}

/// Whatever [`str::parse`] takes and is finite, and what comes after it.
fn any(text: &[u8]) -> Option<(f64, &[u8])> {
    let end = text.iter().position(|b| is_space(*b)).unwrap_or(text.len());
    let (word, rest) = text.split_at_checked(end)?;
    let value = std::str::from_utf8(word).ok()?.parse::<f64>().ok().filter(|x| x.is_finite())?;
    Some((value, rest))
}

/// A decimal number of few digits; none where it is anything else.
fn short(text: &[u8]) -> Option<(f64, &[u8])> {
    let (negative, rest) = sign(text);
    let (whole, rest, before) = digits(0, rest);
    let (digits_, rest, after) = match rest {
        [b'.', rest @ ..] => digits(whole, rest),
        _ => (whole, rest, 0),
    };
    if before + after == 0 || before + after > DIGITS || digits_ > EXACT {
        return None;
    }
    let (exponent, rest) = match rest {
        [b'e' | b'E', rest @ ..] => {
            let (down, rest) = sign(rest);
            let (exponent, rest, count) = digits(0, rest);
            if !(1..=3).contains(&count) {
                return None;
            }
            (if down { -(exponent as i64) } else { exponent as i64 }, rest)
        }
        _ => (0, rest),
    };
    if rest.first().is_some_and(|b| !is_space(*b)) {
        return None;
    }
    let shift = exponent - after as i64;
    let power = POWERS.get(usize::try_from(shift.unsigned_abs()).ok()?)?;
    let size = if shift < 0 { digits_ as f64 / power } else { digits_ as f64 * power };
    Some((if negative { -size } else { size }, rest))
}

/// Whether the text starts with a minus sign, and what comes after a sign.
fn sign(text: &[u8]) -> (bool, &[u8]) {
    match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, text),
    }
}

/// Reads digits behind those of `value`, and counts them. Beyond [`DIGITS`] the value is of no use, and never used.
fn digits(mut value: u64, mut text: &[u8]) -> (u64, &[u8], usize) {
    let mut count = 0;
    while let [byte @ b'0'..=b'9', rest @ ..] = text {
        value = value.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
        text = rest;
        count += 1;
    }
    (value, text, count)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// What the whole word is to [`str::parse`], and to us.
    fn both(word: &str) -> [Option<u64>; 2] {
        let std = word.parse::<f64>().ok().filter(|x| x.is_finite()).map(f64::to_bits);
        let whole = |text: &str| number(text.as_bytes(), 0).filter(|n| n.1 == word.len()).map(|n| n.0.to_bits());
        let own = whole(word);
        // Within a text a word is read another way than at its end.
        assert_eq!(own, whole(&format!("{word} 12345678")), "{word}");
        assert_eq!(own, whole(&format!("{word}\r\n-0.1234567 ")), "{word}");
        [std, own]
    }

    #[test]
    fn words_at_the_edges() {
        let words = [
            "0",
            "-0",
            "-0.0",
            "+1",
            "5.",
            ".5",
            "-.5",
            ".",
            "-",
            "",
            "e5",
            "1e5",
            "1E-5",
            "1e",
            "1e+",
            "1e22",
            "1e23",
            "1e-22",
            "1e-23",
            "9007199254740992",
            "9007199254740993",
            "9007199254740993e1",
            "9007199254740992e22",
            "1e400",
            "nan",
            "inf",
            "-infinity",
            "1.5-2.5",
            "1,5",
            "0x10",
            "1_000",
            "00000000000000000000000000001.5",
            "1.00000000000000000000000000001",
            "18446744073709551616",
            "1e0005",
            "1e-0005",
            "0.1e1000",
            "4.9e-324",
            "2.2250738585072011e-308",
            "1.7976931348623157e308",
            "123456789012345678901234567890e-30",
            "1..2",
            "1.2.3",
            "--1",
            "+-1",
            "1 ",
            "\u{661}",
        ];
        for word in words.iter().filter(|w| !w.contains(' ')) {
            let [std, own] = both(word);
            assert_eq!(std, own, "{word}");
        }
        assert_eq!(number(b"1.5 2", 0), Some((1.5, 3)));
        assert_eq!(number(b" -1e1\r\n", 1), Some((-10.0, 5)));
        assert_eq!(number(b"1\x0b", 0), None, "no white space between words");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn any_double_comes_back(bits: u64) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            for word in [format!("{value}"), format!("{value:e}"), format!("{value:.6}"), format!("{value:.15e}")] {
                let [std, own] = both(&word);
                prop_assert_eq!(std, own, "{}", word);
            }
        }

        #[test]
        fn decimal_words(word in "[-+]?[0-9]{0,20}[.]?[0-9]{0,20}([eE][-+]?[0-9]{0,4})?") {
            let [std, own] = both(&word);
            prop_assert_eq!(std, own, "{}", word);
        }

        #[test]
        fn numbers_as_clips_have_them(whole in -999i32..1000, part in 0u32..1_000_000, places in 0usize..8) {
            let word = format!("{whole}.{:0places$}", part % 10u32.pow(places.min(6) as u32));
            let [std, own] = both(&word);
            prop_assert_eq!(std, own, "{}", word);
        }

        #[test]
        fn any_word(word in "[-+.eE0-9a-z,]{0,12}") {
            let [std, own] = both(&word);
            prop_assert_eq!(std, own, "{}", word);
        }
    }
}
