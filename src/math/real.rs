//! What root finding asks of numbers: doubles, pairs of doubles and wide floats have it.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Real arithmetic of some precision.
pub(crate) trait Real:
    Clone
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The nearest representable number.
    fn from_f64(value: f64) -> Self;
    /// The nearest double.
    fn to_f64(&self) -> f64;
    /// The magnitude.
    fn magnitude(&self) -> Self;
    /// Whether this is exactly zero.
    fn is_zero(&self) -> bool;
    /// The relative rounding error of a few operations.
    fn resolution() -> f64;
}

impl Real for f64 {
    fn from_f64(value: f64) -> Self {
        value
    }
    fn to_f64(&self) -> f64 {
        *self
    }
    fn magnitude(&self) -> Self {
        f64::abs(*self)
    }
    fn is_zero(&self) -> bool {
        *self == 0.0
    }
    fn resolution() -> f64 {
        2.0 * f64::EPSILON
    }
}
