//! Doubles as text, at the speed of the disk that takes it.

/// The digits that tell every double from its neighbours.
const SIGNIFICANT: usize = 17;

/// Appends a double with 17 significant digits, as in `-1.2500000000000000e-3`: the shortest decimals that read back as the
/// same double, filled up with zeros.
pub(super) fn push_full(text: &mut Vec<u8>, value: f64) {
    let mut buffer = zmij::Buffer::new();
    let shortest = buffer.format(value).as_bytes();
    if !value.is_finite() {
        text.extend(shortest);
        return;
    }
    let (sign, plain) = if shortest[0] == b'-' { (1, &shortest[1..]) } else { (0, shortest) };
    text.extend(&shortest[..sign]);
    let Decimal { digits, exponent } = Decimal::of(plain);
    let mut mantissa = [b'.'; SIGNIFICANT + 1];
    mantissa[0] = digits[0];
    mantissa[2..].copy_from_slice(&digits[1..]);
    text.extend_from_slice(&mantissa);
    push_exponent(text, exponent);
}

/// A positive number as its significant digits and the power of ten of the first of them.
struct Decimal {
    digits: [u8; SIGNIFICANT],
    exponent: i32,
}

impl Decimal {
    /// Takes decimals apart that have at most 17 significant digits, with or without a point and an exponent.
    fn of(plain: &[u8]) -> Self {
        let end = plain.iter().position(|&byte| byte == b'e').unwrap_or(plain.len());
        let (mantissa, power) = plain.split_at(end);
        let point = mantissa.iter().position(|&byte| byte == b'.').unwrap_or(end);
        let (whole, fraction) = (&mantissa[..point], mantissa.get(point + 1..).unwrap_or_default());
        // The shortest form has two dozen characters.
        let count = |length: usize| i32::from(length as u8);
        let leading = |digits: &[u8]| digits.iter().take_while(|&&digit| digit == b'0').count();
        let mut digits = [b'0'; SIGNIFICANT];
        let mut copy = |from: usize, part: &[u8]| -> usize {
            let length = part.len().min(SIGNIFICANT - from);
            digits[from..from + length].copy_from_slice(&part[..length]);
            from + length
        };
        let first = if whole == b"0" {
            let zeros = leading(fraction);
            copy(0, &fraction[zeros..]);
            if zeros == fraction.len() { 0 } else { -1 - count(zeros) }
        } else {
            let written = copy(0, whole);
            copy(written, fraction);
            count(whole.len()) - 1
        };
        let is_negative = power.get(1) == Some(&b'-');
        let size = power.iter().filter(|byte| byte.is_ascii_digit());
        let size = size.fold(0, |size, digit| 10 * size + i32::from(digit - b'0'));
        Self { digits, exponent: first + if is_negative { -size } else { size } }
    }
}

fn push_exponent(text: &mut Vec<u8>, exponent: i32) {
    text.extend(if exponent < 0 { b"e-".as_slice() } else { b"e" });
    let size = exponent.unsigned_abs();
    let places = [100, 10, 1].into_iter().filter(|&place| place == 1 || size >= place);
    text.extend(places.map(|place| b'0' + (size / place % 10) as u8));
}

/// Appends the shortest decimals that read back as the same double, as YAML 1.1 takes them: a number has a point, and its
/// exponent a sign. Without them it is text to Python.
pub(super) fn push_shortest(text: &mut String, value: f64) {
    let mut buffer = zmij::Buffer::new();
    let shortest = buffer.format(value);
    let Some((mantissa, exponent)) = shortest.split_once('e') else {
        text.push_str(shortest);
        return;
    };
    text.push_str(mantissa);
    text.push_str(if mantissa.contains('.') { "e" } else { ".0e" });
    text.push_str(if exponent.starts_with(['-', '+']) { "" } else { "+" });
    text.push_str(exponent);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn full(value: f64) -> String {
        let mut text = Vec::new();
        push_full(&mut text, value);
        String::from_utf8(text).unwrap()
    }

    proptest! {
        #[test]
        fn seventeen_digits_read_back_and_stand_where_the_standard_has_them(
            value in prop_oneof![any::<f64>(), -1e3..1e3_f64, any::<i32>().prop_map(f64::from)],
        ) {
            let (own, standard) = (full(value), format!("{value:.16e}"));
            prop_assert_eq!(own.len(), standard.len(), "{} {}", own, standard);
            if value.is_nan() {
                return Ok(());
            }
            prop_assert_eq!(own.parse::<f64>().unwrap().to_bits(), value.to_bits(), "{}", own);
            let point = |text: &str| (text.find('.'), text.find('e').map(|at| text[at..].to_owned()));
            prop_assert_eq!(point(&own), point(&standard));
        }

        #[test]
        fn the_shortest_digits_read_back(value in prop_oneof![any::<f64>(), -1e3..1e3_f64]) {
            let mut text = String::new();
            push_shortest(&mut text, value);
            prop_assert!(value.is_nan() || text.parse::<f64>().unwrap().to_bits() == value.to_bits(), "{}", text);
        }
    }

    #[test]
    fn every_power_of_ten_has_its_exponent() {
        for exponent in -323..=308 {
            let value: f64 = format!("1e{exponent}").parse().unwrap();
            assert_eq!(full(value), format!("1.0000000000000000e{exponent}"));
        }
        assert_eq!(full(-0.0), "-0.0000000000000000e0");
        assert_eq!(full(f64::NEG_INFINITY), "-inf");
        assert_eq!(full(f64::NAN), "NaN");
    }
}
