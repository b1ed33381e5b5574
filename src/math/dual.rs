//! Numbers that carry a derivative along.

use super::double_double::DoubleDouble;
use super::rational::Rational;
use super::scalar::{Elementary, Scalar};
use num_traits::{One, Zero};
use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A number `a + b e` with `e^2 = 0`: a function of it gives its value and, as the factor of `e`, its derivative (forward-mode automatic
/// differentiation). Comparisons see the value alone.
///
/// ```
/// use kinstep::math::{Dual, Elementary};
/// let x = Dual::variable(0.5_f64);
/// let y = (x * x).exp();
/// assert_eq!((y.value, y.derivative), (0.25_f64.exp(), 0.25_f64.exp()));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Dual<T> {
    /// The number.
    pub value: T,
    /// Its derivative.
    pub derivative: T,
}

impl<T: Scalar> Dual<T> {
    /// A number that does not depend on the variable.
    pub fn constant(value: T) -> Self {
        Self { value, derivative: T::zero() }
    }

    /// The variable itself.
    pub fn variable(value: T) -> Self {
        Self { value, derivative: T::one() }
    }

    /// A function of this number, from its value and its derivative by this number.
    fn through(self, value: T, slope: T) -> Self {
        Self { value, derivative: self.chain(slope) }
    }

    /// Where nothing depends on the variable an infinite slope does not matter.
    fn chain(self, slope: T) -> T {
        if self.derivative == T::zero() { T::zero() } else { slope * self.derivative }
    }
}

impl<T: Scalar> PartialEq for Dual<T> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<T: Scalar> PartialOrd for Dual<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl<T: Scalar> Add for Dual<T> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, derivative: self.derivative + other.derivative }
    }
}

impl<T: Scalar> AddAssign for Dual<T> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Scalar> Sub for Dual<T> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, derivative: self.derivative - other.derivative }
    }
}

impl<T: Scalar> Mul for Dual<T> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let derivative = self.chain(other.value) + other.chain(self.value);
        Self { value: self.value * other.value, derivative }
    }
}

impl<T: Scalar> Div for Dual<T> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, derivative: (self.derivative - other.chain(value)) / other.value }
    }
}

impl<T: Scalar> Neg for Dual<T> {
    type Output = Self;

    fn neg(self) -> Self {
        Self { value: -self.value, derivative: -self.derivative }
    }
}

impl<T: Scalar> Zero for Dual<T> {
    fn zero() -> Self {
        Self::constant(T::zero())
    }

    fn is_zero(&self) -> bool {
        self.value.is_zero()
    }
}

impl<T: Scalar> One for Dual<T> {
    fn one() -> Self {
        Self::constant(T::one())
    }
}

impl<T: Scalar> Scalar for Dual<T> {
    const RESOLUTION: f64 = T::RESOLUTION;

    fn from_rational(value: &Rational) -> Self {
        Self::constant(T::from_rational(value))
    }

    fn from_index(index: usize) -> Self {
        Self::constant(T::from_index(index))
    }

    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.through(root, T::one() / (root + root))
    }

    fn is_finite(self) -> bool {
        self.value.is_finite() && self.derivative.is_finite()
    }

    fn to_f64(self) -> f64 {
        self.value.to_f64()
    }

    fn from_f64(value: f64) -> Self {
        Self::constant(T::from_f64(value))
    }
}

impl<T: Elementary> Elementary for Dual<T> {
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = self.value.sin_cos();
        (self.through(sine, cosine), self.through(cosine, -sine))
    }

    fn exp(self) -> Self {
        let power = self.value.exp();
        self.through(power, power)
    }

    fn ln(self) -> Self {
        self.through(self.value.ln(), T::one() / self.value)
    }

    fn asin(self) -> Self {
        let slope = T::one() / (T::one() - self.value * self.value).sqrt();
        self.through(self.value.asin(), slope)
    }

    fn acos(self) -> Self {
        let slope = -T::one() / (T::one() - self.value * self.value).sqrt();
        self.through(self.value.acos(), slope)
    }

    fn atan2(self, x: Self) -> Self {
        let square = self.value * self.value + x.value * x.value;
        let derivative = self.chain(x.value / square) - x.chain(self.value / square);
        Self { value: self.value.atan2(x.value), derivative }
    }

    fn sinh(self) -> Self {
        self.through(self.value.sinh(), self.value.cosh())
    }

    fn cosh(self) -> Self {
        self.through(self.value.cosh(), self.value.sinh())
    }

    fn tanh(self) -> Self {
        let value = self.value.tanh();
        self.through(value, T::one() - value * value)
    }

    fn power(self, exponent: Self) -> Self {
        let value = self.value.power(exponent.value);
        let of_base = self.chain(exponent.value * self.value.power(exponent.value - T::one()));
        let of_exponent = exponent.chain(value * self.value.ln());
        Self { value, derivative: of_base + of_exponent }
    }

    fn pi() -> Self {
        Self::constant(T::pi())
    }

    fn from_extended(value: DoubleDouble) -> Self {
        Self::constant(T::from_extended(value))
    }

    fn to_extended(self) -> DoubleDouble {
        self.value.to_extended()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type Function = fn(Dual<f64>) -> Dual<f64>;

    const FUNCTIONS: [Function; 15] = [
        |x| x * x - x / (x + Dual::from_f64(3.0)),
        |x| -x,
        |x| x.sqrt(),
        |x| x.sin_cos().0,
        |x| x.sin_cos().1,
        Elementary::exp,
        Elementary::ln,
        Elementary::asin,
        Elementary::acos,
        |x| x.atan2(Dual::from_f64(2.0) - x),
        Elementary::sinh,
        Elementary::cosh,
        Elementary::tanh,
        |x| x.power(Dual::from_f64(2.7)),
        |x| (x + Dual::one()).power(x),
    ];

    proptest! {
        #[test]
        fn derivatives_are_those_of_differences(at in 0.05..0.9_f64, which in 0..FUNCTIONS.len()) {
            let (f, step) = (FUNCTIONS[which], 1e-6);
            let value = |x: f64| f(Dual::from_f64(x)).value;
            let difference = (value(at + step) - value(at - step)) / (2.0 * step);
            let derivative = f(Dual::variable(at)).derivative;
            prop_assert!((derivative - difference).abs() < 1e-7 * (1.0 + difference.abs()), "{derivative} {difference}");
            prop_assert_eq!(f(Dual::from_f64(at)).derivative, 0.0);
        }
    }
}
