//! Real powers to double-double precision.

use num_traits::{One, Zero};

use super::double_double::DoubleDouble;

/// Whole parts of exponents up to this are multiplied out, which keeps more digits than the logarithm.
const MULTIPLIED_OUT: f64 = 64.0;

impl DoubleDouble {
    /// Returns the number to a real power, exp(y ln x); NaN for negative numbers, unless the power is whole. Zero to the power
    /// of zero is one.
    ///
    /// The relative error grows with |y ln x|: 30 digits are right while that is below a hundred.
    #[must_use]
    pub fn power(self, exponent: Self) -> Self {
        let whole = exponent.to_f64().round();
        let rest = exponent - Self::from(whole);
        if rest.is_zero() && whole.abs() <= f64::from(i32::MAX) {
            return self.whole_power(whole as i32);
        }
        if self.is_zero() {
            let limit = if exponent.to_f64() > 0.0 { 0.0 } else { f64::INFINITY };
            return Self::from(limit);
        }
        if whole.abs() <= MULTIPLIED_OUT {
            return self.whole_power(whole as i32) * (rest * self.ln()).exp();
        }
        (exponent * self.ln()).exp()
    }

    /// The number to a whole power, by squaring.
    fn whole_power(self, exponent: i32) -> Self {
        let (mut result, mut square, mut rest) = (Self::one(), self, exponent.unsigned_abs());
        while rest > 0 {
            if rest % 2 == 1 {
                result = result * square;
            }
            square = square * square;
            rest /= 2;
        }
        if exponent < 0 { Self::one() / result } else { result }
    }
}
