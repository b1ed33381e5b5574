//! Exact rational numbers, and reading them as people write them.

use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{Num, One, ToPrimitive, Zero};

/// An exact fraction of two integers of any size, always in lowest terms with a positive denominator.
pub type Rational = num_rational::BigRational;

/// The most digits a number may be written with, numerator and denominator counted apart.
pub const MAX_DIGITS: usize = 400;

/// Why a text is not an exact number.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ParseRationalError {
    /// The text is empty or only blanks.
    #[error(
        "a number is missing: the text is empty; write an integer, a fraction or a decimal such as \"3\", \"5/24\" or \"0.5\""
    )]
    Empty,
    /// The denominator of a fraction is zero.
    #[error("\"{text}\" divides by zero; the denominator of a fraction must not be 0")]
    ZeroDenominator {
        /// The number as written.
        text: String,
    },
    /// The text is no number in any accepted spelling.
    #[error(
        "\"{text}\" is not an exact number: {found} can not stand here; write an integer, a fraction or a \
         decimal such as \"3\", \"5/24\", \"0.5\" or \"1e-3\""
    )]
    Unreadable {
        /// The number as written, shortened when long.
        text: String,
        /// What is wrong with the text, in words.
        found: String,
    },
    /// The number has more digits than [`MAX_DIGITS`], or an exponent beyond it.
    #[error("\"{text}\" has {digits} digits written out; numbers of up to {MAX_DIGITS} digits are read")]
    TooLong {
        /// The number as written, shortened.
        text: String,
        /// How many digits it has, its exponent written out.
        digits: usize,
    },
}

/// Returns the exact value of a number as people write it: `3`, `-7`, `5/24`, `0.5`, `1e3`, `-2.5e-2`.
///
/// Decimals are read as the fractions they are, so `"0.1"` is one tenth and not the nearest binary number.
/// Blanks around the number and around the slash are allowed.
///
/// # Errors
/// [`ParseRationalError`] for an empty text, a zero denominator, anything that is no number, and numbers of
/// more than [`MAX_DIGITS`] digits.
///
/// ```
/// use kinstep::math::parse_rational;
/// assert_eq!(parse_rational("0.5")?, parse_rational("12/24")?);
/// assert!(parse_rational("1/0").is_err());
/// # Ok::<(), kinstep::math::ParseRationalError>(())
/// ```
pub fn parse_rational(text: &str) -> Result<Rational, ParseRationalError> {
    let trimmed = text.trim();
    if trimmed.is_empty() {
        return Err(ParseRationalError::Empty);
    }
    let Some((numerator, denominator)) = trimmed.split_once('/') else {
        return parse_decimal(trimmed, trimmed);
    };
    let numerator = parse_decimal(numerator.trim(), trimmed)?;
    let denominator = parse_decimal(denominator.trim(), trimmed)?;
    if denominator.is_zero() {
        return Err(ParseRationalError::ZeroDenominator { text: shortened(trimmed) });
    }
    Ok(numerator / denominator)
}

/// Reads one side of a fraction: sign, digits with at most one point, and an optional power of ten.
fn parse_decimal(part: &str, whole: &str) -> Result<Rational, ParseRationalError> {
    let unreadable =
        |found: &str| ParseRationalError::Unreadable { text: shortened(whole), found: found.to_owned() };
    let (mantissa, exponent) = match part.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, parse_exponent(exponent, whole)?),
        None => (part, 0),
    };
    let (negative, magnitude) = match mantissa.strip_prefix('-') {
        Some(rest) => (true, rest),
        None => (false, mantissa.strip_prefix('+').unwrap_or(mantissa)),
    };
    let (integer, fraction) = magnitude.split_once('.').unwrap_or((magnitude, ""));
    if let Some(stranger) = magnitude.chars().find(|c| !c.is_ascii_digit() && *c != '.') {
        return Err(unreadable(&format!("'{}'", stranger.escape_debug())));
    }
    if fraction.contains('.') {
        return Err(unreadable("a second decimal point"));
    }
    if integer.is_empty() && fraction.is_empty() {
        return Err(unreadable("a place without digits"));
    }
    let digits = integer.len() + fraction.len() + exponent.unsigned_abs();
    if digits > MAX_DIGITS {
        return Err(ParseRationalError::TooLong { text: shortened(whole), digits });
    }
    let all_digits = format!("{integer}{fraction}");
    let value = BigInt::from_str_radix(&all_digits, 10).map_err(|_| unreadable("a place without digits"))?;
    let power = exponent - fraction.len().cast_signed();
    let scale = BigInt::from(10).pow(power.unsigned_abs() as u32);
    let value = if power < 0 { Rational::new(value, scale) } else { Rational::from_integer(value * scale) };
    Ok(if negative { -value } else { value })
}

fn parse_exponent(exponent: &str, whole: &str) -> Result<isize, ParseRationalError> {
    let digits = exponent.strip_prefix(['-', '+']).unwrap_or(exponent);
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
        let found = format!("the exponent '{}'", shortened(exponent));
        return Err(ParseRationalError::Unreadable { text: shortened(whole), found });
    }
    exponent
        .parse::<isize>()
        .ok()
        .filter(|e| e.unsigned_abs() <= MAX_DIGITS)
        .ok_or_else(|| ParseRationalError::TooLong { text: shortened(whole), digits: too_many(digits) })
}

/// The digits that an exponent beyond the bound would write out, saturated.
fn too_many(exponent: &str) -> usize {
    exponent.parse::<usize>().unwrap_or(usize::MAX)
}

/// Cuts a long text for an error message.
pub(crate) fn shortened(text: &str) -> String {
    const SHOWN: usize = 40;
    if text.chars().count() <= SHOWN {
        return text.to_owned();
    }
    let head: String = text.chars().take(SHOWN).collect();
    format!("{head}...")
}

/// Returns the exact value of a finite double, `None` for NaN and the infinities.
pub fn rational_from_f64(value: f64) -> Option<Rational> {
    Rational::from_float(value)
}

/// Returns the double nearest to an exact number, an infinity where that is beyond the range of doubles.
pub fn rational_to_f64(value: &Rational) -> f64 {
    value.to_f64().unwrap_or(f64::NAN)
}

/// Returns the least common multiple of the denominators.
pub(crate) fn common_denominator<'a>(values: impl IntoIterator<Item = &'a Rational>) -> BigInt {
    values.into_iter().fold(BigInt::one(), |lcm, value| lcm.lcm(value.denom()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fraction(n: i64, d: i64) -> Rational {
        Rational::new(n.into(), d.into())
    }

    #[test]
    fn reads_every_spelling_exactly() {
        for (text, n, d) in [
            ("3", 3, 1),
            ("-7", -7, 1),
            ("+2", 2, 1),
            ("5/24", 5, 24),
            (" -5 / 10 ", -1, 2),
            ("0.1", 1, 10),
            (".5", 1, 2),
            ("5.", 5, 1),
            ("1e3", 1000, 1),
            ("-2.5E-2", -1, 40),
            ("0.5/0.25", 2, 1),
            ("1/-2", -1, 2),
        ] {
            assert_eq!(parse_rational(text), Ok(fraction(n, d)), "{text}");
        }
    }

    #[test]
    fn refuses_what_is_no_number() {
        assert_eq!(parse_rational("  "), Err(ParseRationalError::Empty));
        assert!(matches!(parse_rational("1/0"), Err(ParseRationalError::ZeroDenominator { .. })));
        assert!(matches!(parse_rational("1/0.0"), Err(ParseRationalError::ZeroDenominator { .. })));
        for text in [
            "½", "NaN", "inf", "-", ".", "1/2/3", "1 2", "0x10", "1_000", "1,5", "e3", "1e", "1e2.5", "--1",
            "1.2.3",
        ] {
            assert!(matches!(parse_rational(text), Err(ParseRationalError::Unreadable { .. })), "{text}");
        }
    }

    #[test]
    fn bounds_the_digits_and_the_exponent() {
        assert!(parse_rational(&"9".repeat(MAX_DIGITS)).is_ok());
        assert!(matches!(
            parse_rational(&"9".repeat(MAX_DIGITS + 1)),
            Err(ParseRationalError::TooLong { digits: 401, .. })
        ));
        for text in ["1e401", "1e-999999999999", "1e99999999999999999999999999"] {
            assert!(matches!(parse_rational(text), Err(ParseRationalError::TooLong { .. })), "{text}");
        }
    }

    proptest! {
        #[test]
        fn a_printed_fraction_reads_back(n in any::<i64>(), d in 1_i64..i64::MAX) {
            let value = fraction(n, d);
            prop_assert_eq!(parse_rational(&value.to_string()), Ok(value));
        }
    }
}
