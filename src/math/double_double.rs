//! Real numbers as unevaluated sums of two doubles: about 32 digits at the price of twenty operations.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use num_traits::{One, Zero};

use super::rational::{Rational, rational_from_f64, rational_to_f64};
use super::real::Real;

/// A real number of about 32 digits: high + low with |low| at most half a unit in the last place of high (T. J. Dekker,
/// Numer. Math. 18, 1971; Knuth's two-sum). What overflows a double overflows here too.
///
/// ```
/// use kinstep::math::DoubleDouble;
/// let third = DoubleDouble::from(1.0) / DoubleDouble::from(3.0);
/// let rest = third + third + third - DoubleDouble::from(1.0);
/// assert!(rest.to_f64().abs() < 1e-31);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct DoubleDouble {
    high: f64,
    low: f64,
}

impl From<f64> for DoubleDouble {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Zero for DoubleDouble {
    fn zero() -> Self {
        Self::from(0.0)
    }

    fn is_zero(&self) -> bool {
        self.high == 0.0
    }
}

impl One for DoubleDouble {
    fn one() -> Self {
        Self::from(1.0)
    }
}

impl AddAssign for DoubleDouble {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl DoubleDouble {
    /// The ratio of a circle's circumference to its diameter, to about 32 digits.
    pub const PI: Self = Self { high: std::f64::consts::PI, low: 1.224_646_799_147_353_2e-16 };

    /// Half the spacing of the numbers around one: 2^-106.
    pub const RESOLUTION: f64 = 1.232_595_164_407_831e-32;

    /// Returns the nearest double.
    pub fn to_f64(self) -> f64 {
        self.high
    }

    /// Returns whether the number is neither infinite nor NaN.
    pub fn is_finite(self) -> bool {
        self.high.is_finite() && self.low.is_finite()
    }

    /// Returns the number nearest to an exact one, to about 32 digits.
    pub fn from_rational(value: &Rational) -> Self {
        let high = rational_to_f64(value);
        let rest = rational_from_f64(high).map_or(0.0, |high| rational_to_f64(&(value - high)));
        Self::sum_of_ordered(high, rest)
    }

    /// The number times a power of two, exactly unless it leaves the range of doubles.
    pub(super) fn scaled(self, power_of_two: f64) -> Self {
        Self { high: self.high * power_of_two, low: self.low * power_of_two }
    }

    /// a + b for |a| at least |b|.
    fn sum_of_ordered(a: f64, b: f64) -> Self {
        let high = a + b;
        Self { high, low: b - (high - a) }
    }

    /// a + b, exactly.
    fn sum_of(a: f64, b: f64) -> Self {
        let high = a + b;
        let b_part = high - a;
        Self { high, low: (a - (high - b_part)) + (b - b_part) }
    }

    /// a b, exactly: halves of 26 bits have products without rounding.
    fn product_of(a: f64, b: f64) -> Self {
        let halves = |x: f64| {
            let shifted = 134_217_729.0 * x;
            let top = shifted - (shifted - x);
            (top, x - top)
        };
        let ((a_top, a_rest), (b_top, b_rest)) = (halves(a), halves(b));
        let high = a * b;
        let low = ((a_top * b_top - high) + a_top * b_rest + a_rest * b_top) + a_rest * b_rest;
        Self { high, low }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let highs = Self::sum_of(self.high, other.high);
        let lows = Self::sum_of(self.low, other.low);
        let first = Self::sum_of_ordered(highs.high, highs.low + lows.high);
        Self::sum_of_ordered(first.high, first.low + lows.low)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = Self::product_of(self.high, other.high);
        Self::sum_of_ordered(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        // Long division in three digits of a double each.
        let digit = |rest: Self| Self { high: rest.high / other.high, low: 0.0 };
        let first = digit(self);
        let rest = self - first * other;
        let second = digit(rest);
        let third = digit(rest - second * other);
        first + second + third
    }
}

impl Real for DoubleDouble {
    fn from_f64(value: f64) -> Self {
        value.into()
    }

    fn to_f64(&self) -> f64 {
        self.high
    }

    fn magnitude(&self) -> Self {
        if self.high < 0.0 { -*self } else { *self }
    }

    fn is_zero(&self) -> bool {
        self.high == 0.0
    }

    fn resolution() -> f64 {
        (-102_f64).exp2()
    }
}

#[cfg(test)]
mod tests {
    use num_traits::{Signed, Zero};
    use proptest::prelude::*;

    use super::*;

    fn exact(x: DoubleDouble) -> Rational {
        let part = |x| rational_from_f64(x).expect("finite");
        part(x.high) + part(x.low)
    }

    fn agrees(found: DoubleDouble, expected: &Rational) -> bool {
        let error = (exact(found) - expected).abs();
        error <= expected.abs() * rational_from_f64((-100_f64).exp2()).expect("finite")
    }

    proptest! {
        #[test]
        fn thirty_digits_are_right(a in -1000_i64..1000, b in 1_i64..1000, c in -1000_i64..1000, d in 1_i64..1000) {
            let (x, y) = (Rational::new(a.into(), b.into()), Rational::new(c.into(), d.into()));
            let (u, v) = (DoubleDouble::from_rational(&x), DoubleDouble::from_rational(&y));
            prop_assert!(agrees(u, &x));
            prop_assert!(agrees(u * v, &(exact(u) * exact(v))));
            prop_assert!(agrees(u + v, &(exact(u) + exact(v))));
            if !y.is_zero() {
                prop_assert!(agrees(u / v, &(exact(u) / exact(v))));
            }
            prop_assert_eq!(u < v, exact(u) < exact(v));
        }
    }
}
