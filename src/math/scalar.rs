use super::double_double::DoubleDouble;
use super::rational::Rational;
use num_traits::{One, ToPrimitive, Zero};
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// The numbers that states are made of: `f64`, `f32`, or an extended type of your own.
///
/// Deliberately smaller than nalgebra's `RealField`, so that a double-double or an arbitrary-precision type needs
/// six methods and a number to take part in an order study.
///
/// ```
/// use kinstep::math::Scalar;
/// assert_eq!(<f32 as Scalar>::from_index(3), 3.0);
/// ```
pub trait Scalar:
    Copy
    + Debug
    + PartialOrd
    + Zero
    + One
    + AddAssign
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// How far apart numbers around one are.
    const RESOLUTION: f64;

    /// The nearest representable number to an exact rational.
    fn from_rational(value: &Rational) -> Self;

    /// The number of a step.
    fn from_index(index: usize) -> Self;

    /// The square root; Runge-Kutta tableaus of high order contain it.
    #[must_use]
    fn sqrt(self) -> Self;

    /// Whether the number is neither infinite nor NaN.
    fn is_finite(self) -> bool;

    /// The nearest double, for norms and for decisions that need no more.
    fn to_f64(self) -> f64;

    /// The nearest number to a double.
    fn from_f64(value: f64) -> Self;
}

impl Scalar for f64 {
    const RESOLUTION: f64 = f64::EPSILON;

    fn from_rational(value: &Rational) -> Self {
        value.to_f64().unwrap_or(f64::NAN)
    }

    fn from_index(index: usize) -> Self {
        index as f64
    }

    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }

    fn to_f64(self) -> f64 {
        self
    }

    fn from_f64(value: f64) -> Self {
        value
    }
}

impl Scalar for f32 {
    const RESOLUTION: f64 = f32::EPSILON as f64;

    fn from_rational(value: &Rational) -> Self {
        value.to_f64().unwrap_or(f64::NAN) as f32
    }

    fn from_index(index: usize) -> Self {
        index as f32
    }

    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }

    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }

    fn to_f64(self) -> f64 {
        self.into()
    }

    fn from_f64(value: f64) -> Self {
        value as f32
    }
}

impl Scalar for DoubleDouble {
    const RESOLUTION: f64 = 4.0 * Self::RESOLUTION;

    fn from_rational(value: &Rational) -> Self {
        Self::from_rational(value)
    }

    fn from_index(index: usize) -> Self {
        (index as f64).into()
    }

    fn sqrt(self) -> Self {
        self.sqrt()
    }

    fn is_finite(self) -> bool {
        self.is_finite()
    }

    fn to_f64(self) -> f64 {
        self.to_f64()
    }

    fn from_f64(value: f64) -> Self {
        value.into()
    }
}

/// A scalar with the functions that right-hand sides are written with.
pub trait Elementary: Scalar {
    /// Sine and cosine of an angle \[rad\].
    fn sin_cos(self) -> (Self, Self);

    /// The exponential.
    #[must_use]
    fn exp(self) -> Self;

    /// The natural logarithm; NaN for negative numbers.
    #[must_use]
    fn ln(self) -> Self;

    /// The angle in \[-pi/2, pi/2\] \[rad\] with this sine; NaN beyond one.
    #[must_use]
    fn asin(self) -> Self;

    /// The angle in \[0, pi\] \[rad\] with this cosine; NaN beyond one.
    #[must_use]
    fn acos(self) -> Self;

    /// The angle in (-pi, pi\] \[rad\] of the point (`x`, self).
    #[must_use]
    fn atan2(self, x: Self) -> Self;

    /// The hyperbolic sine.
    #[must_use]
    fn sinh(self) -> Self;

    /// The hyperbolic cosine.
    #[must_use]
    fn cosh(self) -> Self;

    /// The hyperbolic tangent.
    #[must_use]
    fn tanh(self) -> Self;

    /// The number to a real power; NaN for negative numbers, unless the power is whole.
    #[must_use]
    fn power(self, exponent: Self) -> Self;

    /// The ratio of a circle's circumference to its diameter.
    fn pi() -> Self;

    /// The nearest of these numbers to one of 32 digits.
    fn from_extended(value: DoubleDouble) -> Self;

    /// The number with 32 digits.
    fn to_extended(self) -> DoubleDouble;
}

/// Every function is the number type's own.
macro_rules! own_functions {
    () => {
        fn sin_cos(self) -> (Self, Self) {
            self.sin_cos()
        }

        fn exp(self) -> Self {
            self.exp()
        }

        fn ln(self) -> Self {
            self.ln()
        }

        fn asin(self) -> Self {
            self.asin()
        }

        fn acos(self) -> Self {
            self.acos()
        }

        fn atan2(self, x: Self) -> Self {
            self.atan2(x)
        }

        fn sinh(self) -> Self {
            self.sinh()
        }

        fn cosh(self) -> Self {
            self.cosh()
        }

        fn tanh(self) -> Self {
            self.tanh()
        }
    };
}

impl Elementary for f64 {
    own_functions!();

    fn power(self, exponent: Self) -> Self {
        self.powf(exponent)
    }

    fn pi() -> Self {
        std::f64::consts::PI
    }

    fn from_extended(value: DoubleDouble) -> Self {
        value.to_f64()
    }

    fn to_extended(self) -> DoubleDouble {
        self.into()
    }
}

impl Elementary for DoubleDouble {
    own_functions!();

    fn power(self, exponent: Self) -> Self {
        self.power(exponent)
    }

    fn pi() -> Self {
        Self::PI
    }

    fn from_extended(value: DoubleDouble) -> Self {
        value
    }

    fn to_extended(self) -> DoubleDouble {
        self
    }
}
