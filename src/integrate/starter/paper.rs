//! The start of the paper: Euler steps with the row's own feedback step.

use crate::integrate::coefficients::Weights;
use crate::math::Rational;
use crate::math::Scalar;

/// The row of every step of the start of a row whose `gamma` sums to `gamma_sum`.
pub(super) fn rows<T: Scalar>(sigma: T, gamma_sum: &Rational) -> Vec<Weights<T>> {
    vec![Weights::euler(sigma, gamma_sum)]
}
