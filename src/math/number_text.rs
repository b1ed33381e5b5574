//! Numbers in sentences.

/// Returns a number as people write it in a sentence: `0.4`, `2`, and with an exponent (`1e300`, `2.5e-12`) where it is very
/// large or small. What is written reads back as the same number.
///
/// ```
/// use kinstep::math::number_text;
/// assert_eq!([0.4, 2.0, 2.5e-12].map(number_text), ["0.4", "2", "2.5e-12"]);
/// ```
pub fn number_text(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").unwrap_or(&text).to_owned()
}

#[cfg(test)]
mod tests {
    use super::number_text;

    #[test]
    fn a_number_takes_no_three_hundred_digits() {
        for (value, text) in [
            (0.4, "0.4"),
            (2.0, "2"),
            (-1e300, "-1e300"),
            (1e-300, "1e-300"),
            (0.03, "0.03"),
            (f64::NAN, "NaN"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(number_text(value), text);
        }
    }
}
