//! Figures as text: what was not measured is a dash, and nothing is minus zero.

/// A figure with so many digits behind the point.
pub fn figure(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "-".to_owned();
    }
    let text = format!("{value:.digits$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.bytes().all(|byte| matches!(byte, b'0' | b'.')) => zero.to_owned(),
        _ => text,
    }
}

/// A share as percent; a dash where nothing was counted.
pub fn percent(share: f64, digits: usize) -> String {
    let text = figure(100.0 * share, digits);
    if text == "-" { text } else { format!("{text} %") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_minus_zero_and_what_is_no_number_is_a_dash() {
        let cases = [(-0.001, "0.00"), (-0.0, "0.00"), (-0.006, "-0.01"), (0.0, "0.00"), (1.234, "1.23")];
        cases.into_iter().for_each(|(value, text)| assert_eq!(figure(value, 2), text));
        assert_eq!([f64::NAN, f64::INFINITY].map(|x| figure(x, 1)), ["-", "-"]);
        assert_eq!((percent(0.5, 2), percent(f64::NAN, 2)), ("50.00 %".to_owned(), "-".to_owned()));
        assert_eq!(figure(-0.4, 0), "0");
    }
}
