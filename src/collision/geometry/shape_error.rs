//! Why numbers make no shape.

use nalgebra::Vector3;
use thiserror::Error;

use crate::math::number_text;
use crate::robot::unbelievable;

/// Why numbers make no shape.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A number that is not finite, or beyond any arm.
    #[error("`{what}`: {cause}")]
    Number {
        /// What the number is.
        what: &'static str,
        /// What is wrong with it.
        cause: String,
    },
    /// A radius below zero.
    #[error("`radius` is {}: a radius is a length [m], zero or more (zero is a point, or a segment)", number_text(*.radius))]
    NegativeRadius {
        /// The radius \[m\].
        radius: f64,
    },
    /// A box with a side that is not positive.
    #[error("`size` has the side {}: the sides of a box are lengths [m] above zero; give a plate its thickness",
            number_text(*.side))]
    NoSide {
        /// The side \[m\].
        side: f64,
    },
    /// A half-space whose normal has no direction.
    #[error(
        "`normal` is zero: it has no direction; give the direction that points out of the solid, such as [0, 0, 1] for a \
             floor"
    )]
    ZeroNormal,
}

/// Checks that every number of a vector is finite and of believable size.
pub(super) fn believable(what: &'static str, vector: &Vector3<f64>) -> Result<(), ShapeError> {
    match vector.iter().find_map(|&number| unbelievable(number)) {
        Some(cause) => Err(ShapeError::Number { what, cause }),
        None => Ok(()),
    }
}

/// Checks that a radius is one.
pub(super) fn radius(radius: f64) -> Result<(), ShapeError> {
    match unbelievable(radius) {
        Some(cause) => Err(ShapeError::Number { what: "radius", cause }),
        None if radius < 0.0 => Err(ShapeError::NegativeRadius { radius }),
        None => Ok(()),
    }
}
