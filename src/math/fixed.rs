//! Real numbers with 192 binary places: for figures that doubles lose half their digits on.

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_bigint::BigInt;
use num_traits::{ToPrimitive, Zero};

use super::complex_roots::Real;
use super::rational::Rational;

const BINARY_PLACES: u32 = 192;

/// A fixed-point number: an integer of any size times 2^-192.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Fixed(BigInt);

impl Fixed {
    /// Returns the number rounded down to 192 binary places.
    pub(crate) fn from_rational(value: &Rational) -> Self {
        Self((value.numer() << BINARY_PLACES) / value.denom())
    }

    /// The integer behind the number with 192 more places.
    fn scaled_up(self) -> BigInt {
        self.0 << BINARY_PLACES
    }

    /// Returns 2^exponent, 0 below the last place.
    pub(crate) fn power_of_two(exponent: i64) -> Self {
        let places = i64::from(BINARY_PLACES) + exponent;
        Self(usize::try_from(places).map_or_else(|_| BigInt::zero(), |places| BigInt::from(1) << places))
    }
}

impl Add for Fixed {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl Sub for Fixed {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0)
    }
}

impl Mul for Fixed {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self((self.0 * other.0) >> BINARY_PLACES)
    }
}

/// Division; by zero gives zero, so callers test first where it matters.
impl Div for Fixed {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let scaled = self.scaled_up();
        Self(scaled.checked_div(&other.0).unwrap_or_default())
    }
}

impl Neg for Fixed {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Real for Fixed {
    fn from_f64(value: f64) -> Self {
        Rational::from_float(value).map_or_else(|| Self(BigInt::zero()), |exact| Self::from_rational(&exact))
    }

    fn to_f64(&self) -> f64 {
        // A power of two scales a double without rounding, so only the conversion rounds.
        let half = (-f64::from(BINARY_PLACES) / 2.0).exp2();
        self.0.to_f64().unwrap_or(f64::NAN) * half * half
    }

    fn is_zero(&self) -> bool {
        self.0.is_zero()
    }

    fn resolution() -> f64 {
        (8.0 - f64::from(BINARY_PLACES)).exp2()
    }
}
