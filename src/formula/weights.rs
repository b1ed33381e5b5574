//! The numbers of a row, as the mathematics wants them.

use crate::math::Rational;

/// The weights of a row, normalised so that alpha_0 = 1, newest sample first, three lists of one length.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Weights {
    pub(crate) alpha: Vec<Rational>,
    pub(crate) beta: Vec<Rational>,
    pub(crate) gamma: Vec<Rational>,
}
