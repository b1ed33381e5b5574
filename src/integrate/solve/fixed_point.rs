use crate::integrate::affine::{Affine, Solved};
use crate::integrate::field::{Field, Parts};
use crate::math::Rational;
use crate::math::Scalar;
use num_traits::Zero;

/// Iterations before it is given up.
const MOST_ITERATIONS: usize = 200;
/// Two iterates may differ by this many resolutions of the largest component.
const RESOLUTIONS: f64 = 16.0;

/// Solves `x = known + first f(t, x) + second g(t, x)` by putting `x` into the right-hand side again and again, also called
/// functional or Picard iteration.
///
/// Each iteration multiplies the error by about `first L_f + second L_g`, with the Lipschitz constants `L_f` and `L_g` of the
/// two parts: this is for problems that are not stiff. It ends when two iterates differ by at most 16 times the scalar's
/// [resolution](Scalar::RESOLUTION) of the largest component, and gives up where that takes more than 200 iterations or an
/// iterate is not finite. All memory is allocated in [`new`](Self::new).
///
/// ```
/// use kinstep::integrate::{Affine, FixedPoint, Ode, Solved};
/// // The implicit Euler step of x' = -x^2 from x = 1: x = 1 - 0.1 x^2.
/// let mut field = Ode::new(1, |_t, x: &[f64], f: &mut [f64]| f[0] = -x[0] * x[0]);
/// let mut x = [1.0];
/// let next = Affine { known: &[1.0], first: 0.1, second: 0.0 };
/// assert_eq!(FixedPoint::new(&field).solve(&mut field, 0.1, next, &mut x), Solved::Converged);
/// assert!((x[0] - (1.4_f64.sqrt() - 1.0) / 0.2).abs() < 1e-14);
/// ```
#[derive(Clone, Debug)]
pub struct FixedPoint<T> {
    f: Vec<T>,
    g: Vec<T>,
    tolerance: T,
}

impl<T: Scalar> FixedPoint<T> {
    /// The memory for solving for states of `field`.
    pub fn new(field: &impl Field<T>) -> Self {
        Self::for_dimension(field.dimension(), field.parts() != Parts::One)
    }

    /// The same for fields of so many components, with a second part or without.
    pub(in crate::integrate) fn for_dimension(dimension: usize, has_second: bool) -> Self {
        let tolerance = Rational::from_float(RESOLUTIONS * T::RESOLUTION).unwrap_or_else(Rational::zero);
        Self {
            f: vec![T::zero(); dimension],
            g: vec![T::zero(); if has_second { dimension } else { 0 }],
            tolerance: T::from_rational(&tolerance),
        }
    }

    /// Solves for `x`, which holds a first guess; returns [`Solved::Converged`] or [`Solved::NotConverged`].
    pub fn solve(&mut self, field: &mut impl Field<T>, t: T, next: Affine<'_, T>, x: &mut [T]) -> Solved {
        for _ in 0..MOST_ITERATIONS {
            field.evaluate(t, x, &mut self.f, &mut self.g);
            let (change, size) = self.iterate(next, x);
            if !change.is_finite() {
                return Solved::NotConverged;
            }
            if change <= self.tolerance * size {
                return Solved::Converged;
            }
        }
        Solved::NotConverged
    }

    /// Writes the next iterate, and returns the largest change of a component and the largest component.
    fn iterate(&self, next: Affine<'_, T>, x: &mut [T]) -> (T, T) {
        let (mut change, mut size) = (T::zero(), T::zero());
        for (i, entry) in x.iter_mut().enumerate() {
            let mut iterate = next.known[i] + next.first * self.f[i];
            if let Some(&g) = self.g.get(i) {
                iterate += next.second * g;
            }
            change = largest(change, iterate - *entry);
            size = largest(size, iterate);
            *entry = iterate;
        }
        (change, size)
    }
}

/// The larger of a magnitude and that of a number; not finite when either is not.
fn largest<T: Scalar>(magnitude: T, number: T) -> T {
    let other = if number < T::zero() { -number } else { number };
    if magnitude >= other || !magnitude.is_finite() { magnitude } else { other }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::field::Ode;
    use crate::math::DoubleDouble;

    #[test]
    fn extended_numbers_are_solved_to_their_own_resolution() {
        let minus_x = |_t: DoubleDouble, x: &[DoubleDouble], f: &mut [DoubleDouble]| f[0] = -x[0];
        let mut field = Ode::new(1, minus_x);
        let known = [DoubleDouble::from(1.5)];
        let next = Affine { known: &known, first: DoubleDouble::from(0.5), second: DoubleDouble::from(0.0) };
        let mut x = [DoubleDouble::from(0.0)];
        assert_eq!(
            FixedPoint::new(&field).solve(&mut field, DoubleDouble::from(0.0), next, &mut x),
            Solved::Converged
        );
        assert!((x[0] - DoubleDouble::from(1.0)).to_f64().abs() < 1e-29);
    }

    #[test]
    fn what_does_not_contract_is_given_up() {
        for rate in [1.0, 3.0, f64::NAN] {
            let mut field = Ode::new(2, move |_t, x: &[f64], f: &mut [f64]| {
                f[0] = 0.0;
                f[1] = -rate * x[1];
            });
            let next = Affine { known: &[1.0, 1.0], first: 1.0, second: 0.0 };
            let solved = FixedPoint::new(&field).solve(&mut field, 0.0, next, &mut [0.0, 0.0]);
            assert_eq!(solved, Solved::NotConverged, "rate {rate}");
        }
    }
}
