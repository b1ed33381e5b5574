//! Real numbers with 192 significant bits: for figures that doubles lose half their digits on.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use num_bigint::{BigInt, Sign};
use num_traits::{Signed, ToPrimitive, Zero};

use super::rational::Rational;
use super::real::Real;

const SIGNIFICANT_BITS: u64 = 192;

/// A floating-point number mantissa 2^exponent of 192 significant bits, with no bound on the exponent that anything here meets.
#[derive(Debug, Clone)]
pub(crate) struct Wide {
    mantissa: BigInt,
    exponent: i64,
}

impl Wide {
    /// Cuts the mantissa to the significant bits.
    fn rounded(mantissa: BigInt, exponent: i64) -> Self {
        let excess = mantissa.bits().saturating_sub(SIGNIFICANT_BITS);
        if excess == 0 {
            return Self { mantissa, exponent };
        }
        Self { mantissa: mantissa >> excess, exponent: exponent + excess.cast_signed() }
    }

    /// numerator / denominator, 0 when the latter is zero.
    fn quotient(numerator: &BigInt, denominator: &BigInt) -> Self {
        // Enough places that the quotient has all its significant bits.
        let places = (SIGNIFICANT_BITS + 2 + denominator.bits()).saturating_sub(numerator.bits());
        match (numerator << places).checked_div(denominator) {
            Some(quotient) => Self::rounded(quotient, -places.cast_signed()),
            None => Self { mantissa: BigInt::zero(), exponent: 0 },
        }
    }

    /// Returns the nearest such number, rounded down in magnitude.
    pub(crate) fn from_rational(value: &Rational) -> Self {
        Self::quotient(value.numer(), value.denom())
    }

    /// Returns 2^exponent.
    pub(crate) fn power_of_two(exponent: i64) -> Self {
        Self { mantissa: BigInt::from(1), exponent }
    }
}

impl Add for Wide {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        if self.mantissa.is_zero() {
            return other;
        }
        if other.mantissa.is_zero() {
            return self;
        }
        let (high, low) = if self.exponent >= other.exponent { (self, other) } else { (other, self) };
        let gap = (high.exponent - low.exponent).unsigned_abs();
        // Far below the last bit of the larger one, the smaller one changes nothing.
        if gap > 2 * SIGNIFICANT_BITS + low.mantissa.bits() {
            return high;
        }
        Self::rounded((high.mantissa << gap) + low.mantissa, low.exponent)
    }
}

impl Sub for Wide {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Wide {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::rounded(self.mantissa * other.mantissa, self.exponent + other.exponent)
    }
}

/// Division; by zero gives zero, so callers test first where it matters.
impl Div for Wide {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self::quotient(&self.mantissa, &other.mantissa)
            * Self::power_of_two(self.exponent)
            * Self::power_of_two(-other.exponent)
    }
}

impl Neg for Wide {
    type Output = Self;
    fn neg(self) -> Self {
        Self { mantissa: -self.mantissa, exponent: self.exponent }
    }
}

impl PartialEq for Wide {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

impl PartialOrd for Wide {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(match (self.clone() - other.clone()).mantissa.sign() {
            Sign::Minus => Ordering::Less,
            Sign::NoSign => Ordering::Equal,
            Sign::Plus => Ordering::Greater,
        })
    }
}

impl Real for Wide {
    fn from_f64(value: f64) -> Self {
        Rational::from_float(value)
            .map_or_else(|| Self::from_rational(&Rational::zero()), |exact| Self::from_rational(&exact))
    }

    fn to_f64(&self) -> f64 {
        const KEPT: u64 = 64;
        let magnitude = self.mantissa.magnitude();
        let drop = magnitude.bits().saturating_sub(KEPT);
        let mut top = magnitude >> drop;
        // What is dropped must still tell a tie from more than a tie when the rest is rounded to a double.
        if magnitude.trailing_zeros().is_some_and(|zeros| zeros < drop) {
            top.set_bit(0, true);
        }
        let top = top.to_f64().unwrap_or(f64::NAN) * if self.mantissa.is_negative() { -1.0 } else { 1.0 };
        // In two halves, so that neither power leaves the range of doubles before the product does.
        let exponent = (self.exponent + drop.cast_signed()).clamp(-2200, 2200) as i32;
        let half = exponent / 2;
        top * f64::from(half).exp2() * f64::from(exponent - half).exp2()
    }

    fn magnitude(&self) -> Self {
        Self { mantissa: self.mantissa.abs(), exponent: self.exponent }
    }

    fn is_zero(&self) -> bool {
        self.mantissa.is_zero()
    }

    fn resolution() -> f64 {
        (2.0 - SIGNIFICANT_BITS as f64).exp2()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_product_next_to_a_tie_is_rounded_as_doubles_are() {
        let (a, b) = (72_922_266.524_176_37_f64, -313_751_580.240_410_75_f64);
        assert_eq!((Wide::from_f64(a) * Wide::from_f64(b)).to_f64(), a * b);
    }

    proptest! {
        #[test]
        fn computes_as_doubles_do_but_longer(a in -1e9_f64..1e9, b in -1e9_f64..1e9, tiny in 1e-200_f64..1e-190) {
            let (x, y) = (Wide::from_f64(a), Wide::from_f64(b));
            prop_assert_eq!((x.clone() + y.clone()).to_f64(), a + b);
            prop_assert_eq!((x.clone() * y.clone()).to_f64(), a * b);
            prop_assert_eq!(x.partial_cmp(&y), a.partial_cmp(&b));
            if b != 0.0 {
                prop_assert!(((x.clone() / y).to_f64() - a / b).abs() <= f64::EPSILON * (a / b).abs());
            }
            let product = Wide::from_f64(tiny) * Wide::from_f64(tiny);
            prop_assert!(!product.is_zero() && (product / Wide::from_f64(tiny)).to_f64() == tiny);
        }
    }
}
