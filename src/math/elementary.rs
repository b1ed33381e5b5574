//! Square root, exponential, logarithm, sine and cosine to double-double precision.

use num_traits::{One, Zero};

use super::double_double::DoubleDouble;

/// The natural logarithm of 2 in three parts, so that a thousand of it can be taken off without loss.
const LN_2: [f64; 3] = [std::f64::consts::LN_2, 2.319_046_813_846_299_6e-17, 5.707_708_438_416_212e-34];
/// A quarter of a turn in three parts, so that a few thousand turns can be taken off without loss.
const QUARTER_TURN: [f64; 3] =
    [std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17, -1.497_384_904_859_169_8e-33];
/// Numbers this near to one have their logarithm by series.
const NEAR_ONE: f64 = 0.125;
/// The exponential is squared this many times.
const SQUARINGS: i32 = 9;

fn number(value: f64) -> DoubleDouble {
    DoubleDouble::from(value)
}

impl DoubleDouble {
    /// Returns the square root; NaN for negative numbers.
    #[must_use]
    pub fn sqrt(self) -> Self {
        let first = self.to_f64().sqrt();
        if first == 0.0 || !first.is_finite() {
            return number(first);
        }
        // One step of Newton's method doubles the digits.
        let first = number(first);
        first + (self - first * first) / (first + first)
    }

    /// Returns e to the power of the number.
    #[must_use]
    pub fn exp(self) -> Self {
        const LARGEST: f64 = 709.0;
        let high = self.to_f64();
        if !(high.abs() <= LARGEST) {
            return number(high.exp());
        }
        // exp(x) = 2^k exp(r)^(2^9) with r below 1/1400.
        let doublings = (high / LN_2[0]).round();
        let rest = LN_2.iter().fold(self, |rest, &part| rest - number(doublings) * number(part));
        let small = rest * number((-f64::from(SQUARINGS)).exp2());
        let mut less_one = DoubleDouble::zero();
        for n in (1..=11).rev() {
            less_one = small / number(f64::from(n)) * (DoubleDouble::one() + less_one);
        }
        for _ in 0..SQUARINGS {
            less_one = less_one + less_one + less_one * less_one;
        }
        (less_one + DoubleDouble::one()) * number(doublings.exp2())
    }

    /// Returns the natural logarithm; NaN for negative numbers.
    #[must_use]
    pub fn ln(self) -> Self {
        let above = self - DoubleDouble::one();
        if above.to_f64().abs() < NEAR_ONE {
            return logarithm_near_one(above);
        }
        let first = self.to_f64().ln();
        if !first.is_finite() {
            return number(first);
        }
        let first = number(first);
        let ratio = self * (-first).exp() - DoubleDouble::one();
        first + ratio - ratio * ratio * number(0.5)
    }

    /// Returns sine and cosine of an angle \[rad\]. Beyond some thousand radians not all digits are right.
    #[must_use]
    pub fn sin_cos(self) -> (Self, Self) {
        let quarters = (self.to_f64() / QUARTER_TURN[0]).round();
        let rest = QUARTER_TURN.iter().fold(self, |rest, &part| rest - number(quarters) * number(part));
        let (sine, cosine) = (series(rest, 1), series(rest, 0));
        match quarters.rem_euclid(4.0) as u8 {
            0 => (sine, cosine),
            1 => (cosine, -sine),
            2 => (-sine, -cosine),
            _ => (-cosine, sine),
        }
    }
}

/// ln(1 + x) = 2 artanh(x/(2 + x)) by its series: near one the step from a logarithm in doubles would lose digits.
fn logarithm_near_one(x: DoubleDouble) -> DoubleDouble {
    const TERMS: u32 = 14;
    let ratio = x / (x + number(2.0));
    let square = ratio * ratio;
    let mut sum = DoubleDouble::zero();
    for k in (0..TERMS).rev() {
        sum = sum * square + DoubleDouble::one() / number(f64::from(2 * k + 1));
    }
    number(2.0) * ratio * sum
}

/// The series `x^first/first! - x^(first+2)/(first+2)! + ...` of sine (1) or cosine (0) below an eighth of a turn.
fn series(x: DoubleDouble, first: u32) -> DoubleDouble {
    const TERMS: u32 = 14;
    let square = x * x;
    let mut sum = DoubleDouble::one();
    for k in (1..=TERMS).rev() {
        let n = f64::from(2 * k + first);
        sum = DoubleDouble::one() - square / number(n * (n - 1.0)) * sum;
    }
    if first == 1 { x * sum } else { sum }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::parse_rational;
    use proptest::prelude::*;

    fn near(a: DoubleDouble, b: DoubleDouble, tolerance: f64) -> bool {
        (a - b).to_f64().abs() <= tolerance * (1.0 + b.to_f64().abs())
    }

    fn digits(text: &str) -> DoubleDouble {
        DoubleDouble::from_rational(&parse_rational(text).expect("a number"))
    }

    #[test]
    fn agrees_with_tables() {
        // Digits from the OEIS: A002193, A001113, A002392, A049469, A049470.
        let one = DoubleDouble::one();
        assert!(near(number(2.0).sqrt(), digits("1.41421356237309504880168872420969807857"), 1e-31));
        assert!(near(one.exp(), digits("2.71828182845904523536028747135266249775"), 1e-31));
        assert!(near(number(10.0).ln(), digits("2.30258509299404568401799145468436420760"), 1e-31));
        assert!(near(one.sin_cos().0, digits("0.84147098480789650665250232163029899962"), 1e-31));
        assert!(near(one.sin_cos().1, digits("0.54030230586813971740093660744297660373"), 1e-31));
        assert!(near(DoubleDouble::PI, digits("3.14159265358979323846264338327950288420"), 1e-31));
    }

    #[test]
    fn what_has_no_value_is_not_a_number() {
        assert!(!number(-1.0).sqrt().is_finite() && !number(-1.0).ln().is_finite());
        assert!(!number(f64::NAN).exp().is_finite() && !number(f64::INFINITY).sin_cos().0.is_finite());
        assert!(number(-1e4).exp().to_f64() == 0.0 && !number(1e4).exp().is_finite());
        assert!(number(0.0).sqrt().is_zero());
    }

    proptest! {
        #[test]
        fn functions_satisfy_their_identities(x in -30.0..30.0_f64, y in -3.0..3.0_f64) {
            let (x, y) = (number(x), number(y) * DoubleDouble::PI);
            let (sine, cosine) = x.sin_cos();
            prop_assert!(near(sine * sine + cosine * cosine, DoubleDouble::one(), 1e-30));
            let (sum, other) = ((x + y).sin_cos().0, y.sin_cos());
            prop_assert!(near(sum, sine * other.1 + cosine * other.0, 1e-29));
            prop_assert!(near(x.exp() * (-x).exp(), DoubleDouble::one(), 1e-30));
            prop_assert!(near(x.exp().ln(), x, 1e-29));
            prop_assert!(near((x * x).sqrt() * (x * x).sqrt(), x * x, 1e-30));
            prop_assert!((x.exp().to_f64() / x.to_f64().exp() - 1.0).abs() < 1e-15);
            prop_assert!((sine.to_f64() - x.to_f64().sin()).abs() < 1e-15);
        }
    }
}
