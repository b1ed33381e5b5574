//! Numbers and vectors as URDF writes them, and why a token is none.

use crate::robot::names::quote;

/// Returns the finite number or infinity that `token` writes; `inf` and digits too large for a double both
/// read as infinite. NaN and everything that is not a number is refused with the reason.
pub(super) fn number(token: &str) -> Result<f64, String> {
    let token = trim(token);
    match token.parse::<f64>() {
        Ok(value) if value.is_nan() => Err(format!("{} is not a number", quote(token))),
        Ok(value) => Ok(value),
        Err(_) => Err(unreadable(token)),
    }
}

/// As [`number`], finite.
pub(super) fn finite(token: &str) -> Result<f64, String> {
    let value = number(token)?;
    if value.is_finite() { Ok(value) } else { Err(format!("{} is not finite", quote(trim(token)))) }
}

/// Returns the N finite numbers that stand in `text`, separated by blanks.
pub(super) fn vector<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let mut values = [0.0; N];
    let mut count = 0;
    for token in tokens(text) {
        let value = finite(token).map_err(|reason| format!("{reason}, in {}", quote(text)))?;
        if let Some(place) = values.get_mut(count) {
            *place = value;
        }
        count += 1;
    }
    if count == N {
        return Ok(values);
    }
    Err(format!("expected {N} numbers, found {count} in {}", quote(text)))
}

/// The pieces between XML's blanks.
pub(super) fn tokens(text: &str) -> impl Iterator<Item = &str> {
    text.split([' ', '\t', '\r', '\n']).filter(|token| !token.is_empty())
}

fn trim(token: &str) -> &str {
    token.trim_matches([' ', '\t', '\r', '\n'])
}

fn unreadable(token: &str) -> String {
    let shown = quote(token);
    let lower = token.to_lowercase();
    if token.is_empty() {
        "the value is empty".to_owned()
    } else if token.contains(',') {
        format!(
            "{shown} is not a number: numbers are separated by blanks and written with a point, no commas"
        )
    } else if lower.trim_start_matches(['-', '+']).starts_with("0x") {
        format!("{shown} is not a number: hexadecimal is not read, write it in decimal")
    } else if token.contains("$(") {
        format!("{shown} is not a number: this is xacro that has not been expanded, run `xacro` on it first")
    } else if lower.contains("pi") {
        format!(
            "{shown} is not a number: URDF has no `pi` (xacro has), write 3.141592653589793 or its multiple"
        )
    } else {
        format!("{shown} is not a number")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_what_the_standard_writes() {
        assert_eq!(vector::<3>(" 0 -1.5e-3\t+2.\n").unwrap(), [0.0, -1.5e-3, 2.0]);
        assert_eq!(number("inf").unwrap(), f64::INFINITY);
        assert_eq!(number(" -1e400 ").unwrap(), f64::NEG_INFINITY);
    }

    #[test]
    fn refuses_with_the_token_and_the_reason() {
        let reason = |text: &str| vector::<3>(text).unwrap_err();
        assert_eq!(reason("0 abc 0 1"), "`abc` is not a number, in `0 abc 0 1`");
        assert_eq!(reason("1 2"), "expected 3 numbers, found 2 in `1 2`");
        assert_eq!(reason("1 2 3 4"), "expected 3 numbers, found 4 in `1 2 3 4`");
        assert!(reason("0,5 0 1").contains("no commas"));
        assert!(reason("0x10 0 1").contains("hexadecimal"));
        assert!(reason("0 0 pi/2").contains("xacro"));
        assert!(reason("0 0 nan").contains("`nan` is not a number"));
        assert!(reason("0 0 1e400").contains("`1e400` is not finite"));
        assert!(number("").unwrap_err().contains("empty"));
    }
}
