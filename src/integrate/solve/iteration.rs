use super::error_norm::ErrorNorm;
use super::fixed_point::FixedPoint;
use super::newton::Newton;
use crate::integrate::affine::{Affine, Solved};
use crate::integrate::field::Field;
use crate::math::Scalar;

/// How many resolutions of the numbers are told apart.
const RESOLUTIONS: f64 = 16.0;
/// The most unknowns for which Newton's method keeps a full matrix.
const MOST_UNKNOWNS: usize = 4096;

/// Solves equations as well as the numbers allow: by putting `x` into the right-hand side again and again, and by Newton's
/// method from the first time on that this does not converge. Memory for the latter is allocated then.
#[derive(Clone, Debug)]
pub(in crate::integrate) struct Iteration<T> {
    fixed_point: FixedPoint<T>,
    newton: Option<Box<Newton<T>>>,
    norm: ErrorNorm,
    guess: Vec<T>,
}

impl<T: Scalar> Iteration<T> {
    /// For fields of so many components, with a second part or without.
    pub(in crate::integrate) fn new(dimension: usize, has_second: bool) -> Self {
        let fixed_point = FixedPoint::for_dimension(dimension, has_second);
        Self {
            fixed_point,
            newton: None,
            norm: ErrorNorm::even(dimension),
            guess: vec![T::zero(); dimension],
        }
    }

    /// Solves for `x`, which holds a first guess; returns [`Solved::Converged`] or [`Solved::NotConverged`].
    pub(in crate::integrate) fn solve(
        &mut self,
        field: &mut impl Field<T>,
        t: T,
        next: Affine<'_, T>,
        x: &mut [T],
    ) -> Solved {
        match &mut self.newton {
            Some(newton) => by_newton((newton, &mut self.norm), field, t, next, x),
            None => self.begin(field, t, next, x),
        }
    }

    /// Solves while it is not known whether putting in converges.
    fn begin(&mut self, field: &mut impl Field<T>, t: T, next: Affine<'_, T>, x: &mut [T]) -> Solved {
        self.guess.copy_from_slice(x);
        let solved = self.fixed_point.solve(field, t, next, x);
        if solved == Solved::Converged || next.second != T::zero() || x.len() > MOST_UNKNOWNS {
            return solved;
        }
        x.copy_from_slice(&self.guess);
        let newton = self.newton.insert(Box::new(Newton::precise(x.len())));
        by_newton((newton, &mut self.norm), field, t, next, x)
    }
}

fn by_newton<T: Scalar>(
    (newton, norm): (&mut Newton<T>, &mut ErrorNorm),
    field: &mut impl Field<T>,
    t: T,
    next: Affine<'_, T>,
    x: &mut [T],
) -> Solved {
    let resolution = RESOLUTIONS * T::RESOLUTION;
    let largest =
        x.iter().chain(next.known).map(|entry| entry.to_f64().abs()).fold(f64::MIN_POSITIVE, f64::max);
    norm.allow(resolution * largest);
    newton.solve(field, norm, t, next, x)
}
