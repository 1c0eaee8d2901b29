//! Numbers of a frame, from bytes: the same bits as [`str::parse`] and sooner.
//!
//! Up to 2^53 whole numbers are exact in f64, and so are powers of ten up to 10^22. One division (or product) of two exact numbers
//! rounds once, so it gives the double next to the decimal number, which is what [`str::parse`] gives. Longer numbers go there.

/// 10^0 to 10^22, all exact.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];
/// Whole numbers up to here are exact.
const EXACT: u64 = 1 << 53;
/// Digits that cannot overflow a u64.
const DIGITS: usize = 19;

/// White space between words, as in [`str::split_ascii_whitespace`].
pub(super) fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\x0c' | b'\r')
}

/// The word at the start as a finite number, and what comes after it.
pub(super) fn number(text: &[u8]) -> Option<(f64, &[u8])> {
    if let Some((value, rest)) = short(text) {
        return Some((value, rest));
    }
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
        let own = number(word.as_bytes()).filter(|(_, rest)| rest.is_empty()).map(|(x, _)| x.to_bits());
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
        assert_eq!(number(b"1.5 2"), Some((1.5, b" 2".as_slice())));
        assert_eq!(number(b"-1e1\r\n"), Some((-10.0, b"\r\n".as_slice())));
        assert_eq!(number(b"1\x0b"), None, "no white space between words");
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
