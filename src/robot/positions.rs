//! Joint positions held against the chain that they are for.

use super::names::{printable, quote};
use super::{Chain, LimitViolation};
use crate::math::number_text;
use thiserror::Error;

/// Why joint positions do not fit a chain.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PositionsError {
    /// There are too few or too many.
    #[error("expected {expected} positions ({}), got {got}", printable(.joints))]
    Length {
        /// Positions given.
        got: usize,
        /// Positions needed.
        expected: usize,
        /// The joints' names, in order.
        joints: String,
    },
    /// One is infinite or NaN.
    #[error("the position of joint {} is {value}, which is not a finite number", quote(.joint))]
    NonFinite {
        /// Index of the joint in [`Chain::joints`].
        index: usize,
        /// The joint's name.
        joint: String,
        /// What was given.
        value: f64,
    },
    /// One lies outside the joint's limits.
    #[error("joint {} would be at {}, outside its limits [{}, {}]", quote(&.0.joint), number_text(.0.value), number_text(.0.lower), number_text(.0.upper))]
    OutsideLimits(LimitViolation),
}

impl PositionsError {
    /// The index of the joint at fault, where it is one.
    pub fn index(&self) -> Option<usize> {
        match self {
            Self::Length { .. } => None,
            Self::NonFinite { index, .. } => Some(*index),
            Self::OutsideLimits(violation) => Some(violation.index),
        }
    }
}

impl Chain {
    /// Checks that `q` has a finite position for every joint.
    ///
    /// # Errors
    /// [`PositionsError::Length`] or [`PositionsError::NonFinite`].
    pub fn check_positions(&self, q: &[f64]) -> Result<(), PositionsError> {
        let joints = self.joints();
        if q.len() != joints.len() {
            let names: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
            return Err(PositionsError::Length {
                got: q.len(),
                expected: joints.len(),
                joints: names.join(", "),
            });
        }
        match q.iter().position(|value| !value.is_finite()) {
            Some(index) => {
                Err(PositionsError::NonFinite { index, joint: joints[index].name.clone(), value: q[index] })
            }
            None => Ok(()),
        }
    }

    /// Checks that `q` has a finite position within the limits for every joint.
    ///
    /// # Errors
    /// The first [`PositionsError`] in the order of the joints.
    pub fn check_within_limits(&self, q: &[f64]) -> Result<(), PositionsError> {
        self.check_positions(q)?;
        self.limit_violations(q).next().map_or(Ok(()), |found| Err(PositionsError::OutsideLimits(found)))
    }
}
