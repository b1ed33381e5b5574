use crate::math::Rational;
use num_traits::{One, ToPrimitive, Zero};
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// The numbers that states are made of: `f64`, `f32`, or an extended type of your own.
///
/// Deliberately smaller than nalgebra's `RealField`, so that a double-double or an arbitrary-precision type needs
/// four methods to take part in an order study.
///
/// ```
/// use kinstep::integrate::Scalar;
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
    /// The nearest representable number to an exact rational.
    fn from_rational(value: &Rational) -> Self;

    /// The number of a step.
    fn from_index(index: usize) -> Self;

    /// The square root; Runge-Kutta tableaus of high order contain it.
    #[must_use]
    fn sqrt(self) -> Self;

    /// Whether the number is neither infinite nor NaN.
    fn is_finite(self) -> bool;
}

impl Scalar for f64 {
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
}

impl Scalar for f32 {
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
}
