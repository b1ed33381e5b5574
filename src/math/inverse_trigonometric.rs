//! Angles of points, sines and cosines to double-double precision.

use num_traits::One;

use super::double_double::DoubleDouble;

impl DoubleDouble {
    /// Returns the angle in (-pi, pi] \[rad\] of the point (`x`, self), to about 31 digits.
    ///
    /// One step from the angle in doubles: with its sine s and cosine c the rest is atan((y c - x s)/(x c + y s)), so small that
    /// the quotient stands for its arc tangent.
    #[must_use]
    pub fn atan2(self, x: Self) -> Self {
        let first = self.to_f64().atan2(x.to_f64());
        let size = self.to_f64().abs().max(x.to_f64().abs());
        if !(size > 0.0 && size.is_finite()) {
            return quarter_turns(first);
        }
        // Products of large or tiny numbers leave the range of doubles; powers of two change no digits.
        let scale = (-size.log2().round()).clamp(-1000.0, 1000.0).exp2();
        let (y, x) = (self.scaled(scale), x.scaled(scale));
        let first = Self::from(first);
        let (sine, cosine) = first.sin_cos();
        first + (y * cosine - x * sine) / (x * cosine + y * sine)
    }

    /// Returns the angle in [-pi/2, pi/2] \[rad\] with this sine; NaN beyond one.
    #[must_use]
    pub fn asin(self) -> Self {
        self.atan2(self.opposite())
    }

    /// Returns the angle in [0, pi] \[rad\] with this cosine; NaN beyond one.
    #[must_use]
    pub fn acos(self) -> Self {
        self.opposite().atan2(self)
    }

    /// sqrt(1 - x^2), as accurate near one as elsewhere.
    fn opposite(self) -> Self {
        ((Self::one() - self) * (Self::one() + self)).sqrt()
    }
}

/// Where a coordinate is infinite or both are zero, the angle is a multiple of an eighth of a turn.
fn quarter_turns(first: f64) -> DoubleDouble {
    let eighths = (first / std::f64::consts::FRAC_PI_4).round();
    DoubleDouble::PI * DoubleDouble::from(eighths / 4.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn off(a: DoubleDouble, b: DoubleDouble) -> f64 {
        (a - b).to_f64().abs() / (f64::MIN_POSITIVE + b.to_f64().abs())
    }

    #[test]
    fn corners_have_their_angles() {
        let number = DoubleDouble::from;
        let quarter = DoubleDouble::PI * number(0.5);
        assert_eq!(number(1.0).asin(), quarter);
        assert!(off(number(-1.0).acos(), DoubleDouble::PI) < 1e-31);
        assert!(off(number(0.0).acos(), quarter) < 1e-31 && number(0.0).asin() == number(0.0));
        assert!(number(1.5).acos().to_f64().is_nan() && number(-1.5).asin().to_f64().is_nan());
        assert!(off(number(f64::INFINITY).atan2(number(1.0)), quarter) < 1e-31);
        assert!(off(number(1e300).atan2(number(1e300)), quarter * number(0.5)) < 1e-31);
        assert!(off(number(1e-300).atan2(number(-1e-300)), quarter * number(1.5)) < 1e-31);
    }

    proptest! {
        #[test]
        fn angles_undo_sines_and_cosines(angle in -3.1..3.1_f64, size in -8.0..8.0_f64, low in -1.0..1.0_f64) {
            let angle = DoubleDouble::from(angle) + DoubleDouble::from(1e-17 * low);
            let size = DoubleDouble::from(size.exp());
            let (sine, cosine) = angle.sin_cos();
            prop_assert!(off((size * sine).atan2(size * cosine), angle) < 1e-30);
            prop_assert!((sine.asin().sin_cos().0 - sine).to_f64().abs() < 1e-31 && off(cosine.acos().sin_cos().1, cosine) < 1e-29);
        }
    }
}
