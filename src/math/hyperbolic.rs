//! Hyperbolic functions to double-double precision.

use num_traits::One;

use super::double_double::DoubleDouble;

/// Below this the series of the hyperbolic sine keeps the digits that the difference of two exponentials would lose.
const SMALL: f64 = 1.0;
/// Terms of that series: the first left out is below 1e-33 of the first.
const TERMS: u32 = 15;
/// Beyond this the hyperbolic tangent is one to all digits.
const FLAT: f64 = 40.0;

impl DoubleDouble {
    /// Returns the hyperbolic sine.
    #[must_use]
    pub fn sinh(self) -> Self {
        if self.to_f64().abs() >= SMALL {
            let (growing, falling) = (self.exp(), (-self).exp());
            return (growing - falling) * Self::from(0.5);
        }
        let square = self * self;
        let mut sum = Self::one();
        for k in (1..=TERMS).rev() {
            let n = f64::from(2 * k + 1);
            sum = Self::one() + square / Self::from(n * (n - 1.0)) * sum;
        }
        self * sum
    }

    /// Returns the hyperbolic cosine.
    #[must_use]
    pub fn cosh(self) -> Self {
        (self.exp() + (-self).exp()) * Self::from(0.5)
    }

    /// Returns the hyperbolic tangent.
    #[must_use]
    pub fn tanh(self) -> Self {
        if self.to_f64().abs() > FLAT {
            return Self::from(self.to_f64().signum());
        }
        self.sinh() / self.cosh()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn functions_satisfy_their_identities(x in -60.0..60.0_f64, y in -2.0..2.0_f64) {
            let number = DoubleDouble::from;
            let off = |a: DoubleDouble, b: DoubleDouble| ((a - b) / b).to_f64().abs();
            let (x, y) = (number(x), number(y));
            let sum = x.sinh() * y.cosh() + x.cosh() * y.sinh();
            let size = (x.cosh() * y.cosh()).to_f64();
            prop_assert!(((x + y).sinh() - sum).to_f64().abs() < 2e-30 * size);
            prop_assert!(off(x.cosh() * x.cosh() - x.sinh() * x.sinh(), number(1.0)) < 1e-29 * (2.0 * x.to_f64().abs()).exp());
            let twice = number(2.0) * y.tanh() / (number(1.0) + y.tanh() * y.tanh());
            prop_assert!(y.to_f64() == 0.0 || off((y + y).tanh(), twice) < 1e-30);
        }
    }
}
