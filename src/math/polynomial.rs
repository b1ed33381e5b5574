//! Polynomials with integer coefficients of any size.
//!
//! A polynomial with rational coefficients has the same roots as its integer multiple without common
//! factor, and roots are what is asked here; integers keep every step exact and fast.

use std::fmt;
use std::ops::{Add, Mul, Neg, Sub};

use num_bigint::{BigInt, Sign};
use num_integer::Integer;
use num_traits::{One, Signed, Zero};

use super::rational::{Rational, common_denominator};

/// A polynomial sum of c_k z^k with exact integer coefficients.
///
/// The zero polynomial has no coefficients; every other one has a leading coefficient that is not zero.
///
/// ```
/// use kinstep::math::Polynomial;
/// let p = Polynomial::from_descending(&[1, -3, 2]);
/// assert_eq!(p.to_text("z"), "z^2 - 3 z + 2");
/// ```
#[must_use]
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default)]
pub struct Polynomial {
    /// Lowest power first, no zero at the end.
    ascending: Vec<BigInt>,
}

impl Polynomial {
    /// Returns the polynomial with these coefficients, the constant term first.
    pub fn from_ascending<T: Into<BigInt>>(coefficients: impl IntoIterator<Item = T>) -> Self {
        let mut ascending: Vec<BigInt> = coefficients.into_iter().map(Into::into).collect();
        while ascending.last().is_some_and(Zero::is_zero) {
            ascending.pop();
        }
        Self { ascending }
    }

    /// Returns the polynomial with these coefficients, the highest power first.
    pub fn from_descending<T: Into<BigInt> + Clone>(coefficients: &[T]) -> Self {
        Self::from_ascending(coefficients.iter().rev().cloned())
    }

    /// Returns the primitive integer polynomial with the roots and the sign of a rational one, highest power first.
    pub fn from_rationals_descending(coefficients: &[Rational]) -> Self {
        let denominator = common_denominator(coefficients);
        let integers = coefficients.iter().rev().map(|c| c.numer() * (&denominator / c.denom()));
        Self::from_ascending(integers).primitive_part()
    }

    /// Returns the constant polynomial of this value.
    pub fn constant(value: impl Into<BigInt>) -> Self {
        Self::from_ascending([value.into()])
    }

    /// Returns the polynomial z^power.
    pub fn power(power: usize) -> Self {
        let mut ascending = vec![BigInt::zero(); power];
        ascending.push(BigInt::one());
        Self { ascending }
    }

    /// Returns the coefficients, the constant term first; empty for zero.
    pub fn ascending(&self) -> &[BigInt] {
        &self.ascending
    }

    /// Returns the degree; that of the zero polynomial is given as 0.
    pub fn degree(&self) -> usize {
        self.ascending.len().saturating_sub(1)
    }

    /// Returns whether every coefficient is zero.
    pub fn is_zero(&self) -> bool {
        self.ascending.is_empty()
    }

    /// Returns the coefficient of the highest power, 0 for the zero polynomial.
    pub fn leading(&self) -> BigInt {
        self.ascending.last().cloned().unwrap_or_default()
    }

    /// Returns the coefficient of z^power, 0 above the degree.
    pub fn coefficient(&self, power: usize) -> BigInt {
        self.ascending.get(power).cloned().unwrap_or_default()
    }

    /// Returns the value p(point) at an exact point.
    pub fn value_at(&self, point: &Rational) -> Rational {
        let scale = point.denom().pow(self.degree() as u32);
        Rational::new(self.scaled_value_at(point), scale)
    }

    /// Returns the sign of the value p(point) at an exact point: -1, 0 or 1.
    pub fn sign_at(&self, point: &Rational) -> i32 {
        match self.scaled_value_at(point).sign() {
            Sign::Minus => -1,
            Sign::NoSign => 0,
            Sign::Plus => 1,
        }
    }

    /// The value at n/d times d^degree: an integer of the same sign.
    fn scaled_value_at(&self, point: &Rational) -> BigInt {
        let mut sum = BigInt::zero();
        let mut power = BigInt::one();
        for coefficient in self.ascending.iter().rev() {
            sum = sum * point.numer() + coefficient * &power;
            power *= point.denom();
        }
        sum
    }

    /// Returns the largest common factor of the coefficients, 0 for the zero polynomial.
    pub fn content(&self) -> BigInt {
        let mut content = BigInt::zero();
        for coefficient in &self.ascending {
            content = content.gcd(coefficient);
            if content.is_one() {
                break;
            }
        }
        content
    }

    /// Returns the polynomial divided by its content; signs are kept.
    pub fn primitive_part(&self) -> Self {
        let content = self.content();
        if content.is_zero() || content.is_one() {
            return self.clone();
        }
        Self { ascending: self.ascending.iter().map(|c| c / &content).collect() }
    }

    /// Returns the primitive part with a positive leading coefficient: one spelling for one set of roots.
    pub fn normalised(&self) -> Self {
        let primitive = self.primitive_part();
        if primitive.leading().is_negative() { -primitive } else { primitive }
    }

    /// Returns the derivative p'(z).
    pub fn derivative(&self) -> Self {
        Self::from_ascending(self.ascending.iter().enumerate().skip(1).map(|(k, c)| c * BigInt::from(k)))
    }

    /// Returns z^degree p(1/z): the coefficients in the opposite order.
    pub fn reversed(&self) -> Self {
        Self::from_ascending(self.ascending.iter().rev().cloned())
    }

    /// Returns p(z) / z^m and m, the multiplicity of the root 0.
    pub fn without_zero_roots(&self) -> (Self, usize) {
        let multiplicity = self.ascending.iter().take_while(|c| c.is_zero()).count();
        (Self { ascending: self.ascending[multiplicity..].to_vec() }, multiplicity)
    }

    /// Returns p divided by (z - point)^m, up to an integer factor, and m, the multiplicity of the root.
    pub fn without_root(&self, point: &Rational) -> (Self, usize) {
        let factor = Self::from_ascending([-point.numer(), point.denom().clone()]);
        let mut rest = self.clone();
        let mut multiplicity = 0;
        while !rest.is_zero() && rest.degree() > 0 {
            let Some(quotient) = rest.primitive_part().exact_quotient(&factor) else { break };
            rest = quotient;
            multiplicity += 1;
        }
        (rest, multiplicity)
    }

    /// Returns the quotient by a divisor, `None` when the division leaves a rest or fractions, or the divisor is zero.
    pub fn exact_quotient(&self, divisor: &Self) -> Option<Self> {
        let divisor_leading = divisor.ascending.last()?;
        let Some(gap) = self.ascending.len().checked_sub(divisor.ascending.len()) else {
            return self.is_zero().then(Self::default);
        };
        let mut rest = self.ascending.clone();
        let mut quotient = vec![BigInt::zero(); gap + 1];
        for shift in (0..=gap).rev() {
            let (factor, remainder) = rest[shift + divisor.degree()].div_rem(divisor_leading);
            if !remainder.is_zero() {
                return None;
            }
            for (k, c) in divisor.ascending.iter().enumerate() {
                rest[shift + k] -= &factor * c;
            }
            quotient[shift] = factor;
        }
        rest.iter().all(Zero::is_zero).then(|| Self::from_ascending(quotient))
    }

    /// Returns a multiple of p(a + b z), by Taylor shift and scaling; `b` must not be zero.
    pub fn shifted_and_scaled(&self, a: &Rational, b: &Rational) -> Self {
        // With z = (numer / d), d the common denominator: p(numer/d) d^n is integer when numer = A + B z.
        let d = common_denominator([a, b]);
        let shift = a.numer() * (&d / a.denom());
        let scale = b.numer() * (&d / b.denom());
        let homogeneous = {
            let mut power = BigInt::one();
            let mut list: Vec<BigInt> = self.ascending.clone();
            for coefficient in list.iter_mut().rev() {
                *coefficient *= &power;
                power *= &d;
            }
            list
        };
        let mut shifted = taylor_shift(homogeneous, &shift);
        let mut power = BigInt::one();
        for coefficient in &mut shifted {
            *coefficient *= &power;
            power *= &scale;
        }
        Self::from_ascending(shifted)
    }

    /// Returns the polynomial as text, highest power first, such as `32 h^2 + 108 h - 81`.
    pub fn to_text(&self, variable: &str) -> String {
        let mut text = String::new();
        for (power, coefficient) in self.ascending.iter().enumerate().rev().filter(|(_, c)| !c.is_zero()) {
            let sign = match (text.is_empty(), coefficient.is_negative()) {
                (true, true) => "-",
                (true, false) => "",
                (false, true) => " - ",
                (false, false) => " + ",
            };
            let magnitude = coefficient.abs();
            let factor = match power {
                0 => magnitude.to_string(),
                _ if magnitude.is_one() => String::new(),
                _ => format!("{magnitude} "),
            };
            let symbol = match power {
                0 => String::new(),
                1 => variable.to_owned(),
                _ => format!("{variable}^{power}"),
            };
            text.extend([sign, &factor, &symbol]);
        }
        if text.is_empty() { "0".to_owned() } else { text }
    }
}

/// Returns the coefficients of p(z + shift), lowest power first.
pub(crate) fn taylor_shift(mut ascending: Vec<BigInt>, shift: &BigInt) -> Vec<BigInt> {
    if shift.is_zero() {
        return ascending;
    }
    let unit = shift.is_one();
    for start in 0..ascending.len().saturating_sub(1) {
        for k in (start..ascending.len() - 1).rev() {
            let carry = if unit { ascending[k + 1].clone() } else { &ascending[k + 1] * shift };
            ascending[k] += carry;
        }
    }
    ascending
}

impl fmt::Display for Polynomial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.to_text("z"))
    }
}

impl Add for &Polynomial {
    type Output = Polynomial;
    fn add(self, other: Self) -> Polynomial {
        let length = self.ascending.len().max(other.ascending.len());
        Polynomial::from_ascending((0..length).map(|k| self.coefficient(k) + other.coefficient(k)))
    }
}

impl Sub for &Polynomial {
    type Output = Polynomial;
    fn sub(self, other: Self) -> Polynomial {
        let length = self.ascending.len().max(other.ascending.len());
        Polynomial::from_ascending((0..length).map(|k| self.coefficient(k) - other.coefficient(k)))
    }
}

impl Mul for &Polynomial {
    type Output = Polynomial;
    fn mul(self, other: Self) -> Polynomial {
        if self.is_zero() || other.is_zero() {
            return Polynomial::default();
        }
        let mut product = vec![BigInt::zero(); self.ascending.len() + other.ascending.len() - 1];
        for (i, a) in self.ascending.iter().enumerate() {
            for (j, b) in other.ascending.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        Polynomial::from_ascending(product)
    }
}

impl Neg for Polynomial {
    type Output = Polynomial;
    fn neg(self) -> Polynomial {
        Polynomial { ascending: self.ascending.into_iter().map(|c| -c).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn small() -> impl Strategy<Value = Polynomial> {
        proptest::collection::vec(-9_i64..=9, 1..5).prop_map(Polynomial::from_ascending)
    }

    #[test]
    fn prints_as_people_write() {
        assert_eq!(Polynomial::from_descending(&[-1, 0, 1, -7]).to_text("h"), "-h^3 + h - 7");
        assert_eq!(Polynomial::default().to_text("h"), "0");
        assert_eq!(Polynomial::constant(1).to_text("h"), "1");
    }

    proptest! {
        #[test]
        fn division_undoes_multiplication(a in small(), b in small()) {
            prop_assume!(!b.is_zero());
            prop_assert_eq!((&a * &b).exact_quotient(&b), Some(a));
        }

        #[test]
        fn shifting_moves_the_argument(p in small(), a in -5_i64..5, d in 1_i64..5, b in 1_i64..5, at in -5_i64..5) {
            let (shift, scale) = (Rational::new(a.into(), d.into()), Rational::new(b.into(), 3.into()));
            let point = Rational::from_integer(at.into());
            let moved = p.shifted_and_scaled(&shift, &scale);
            prop_assert_eq!(moved.sign_at(&point), p.sign_at(&(&shift + &scale * &point)));
            prop_assert_eq!(moved.is_zero(), p.is_zero());
        }
    }
}
