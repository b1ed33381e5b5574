use super::coefficients::RowKind;
use crate::formula::NotRunnable;
use thiserror::Error;

/// Why a stepper could not be made.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum IntegrateError {
    /// The row may not run: it is implicit, or not zero-stable.
    #[error(transparent)]
    NotRunnable(#[from] NotRunnable),
    /// The sampling gap is zero, infinite or NaN.
    #[error("the sampling gap is {text}; it must be a number other than zero")]
    SamplingGap {
        /// What was given.
        text: String,
    },
    /// The initial state, or a given one, does not fit the field.
    #[error("{what} has {got} entries where the right-hand side has {expected}")]
    Dimension {
        /// Which vector.
        what: String,
        /// Its length.
        got: usize,
        /// The length it should have.
        expected: usize,
    },
    /// Too few or too many given starting states.
    #[error("formula `{id}` needs {expected} starting states besides the initial one, got {got}")]
    StartingStates {
        /// The row.
        id: String,
        /// How many were given.
        got: usize,
        /// How many it needs.
        expected: usize,
    },
    /// A row is asked to do what its kind can not.
    #[error("formula `{id}` is {kind} and can not be {role}; choose one that is {expected}")]
    Kind {
        /// The row.
        id: String,
        /// What it is.
        kind: RowKind,
        /// What it is asked to be.
        role: &'static str,
        /// What is needed.
        expected: RowKind,
    },
    /// An implicit-explicit row on a field without a second part.
    #[error(
        "formula `{id}` is implicit in the second part of the right-hand side, but the right-hand side has one part only; split it, or choose an implicit formula"
    )]
    OnePart {
        /// The row.
        id: String,
    },
    /// A pair of which one row has fixed coefficients and the other has not.
    #[error(
        "formulas `{predictor}` and `{corrector}` can not be a pair: one of them is for equal steps only, the other for varying ones"
    )]
    MixedPair {
        /// The row that predicts.
        predictor: String,
        /// The row that corrects.
        corrector: String,
    },
    /// A tolerance that is negative, infinite or NaN.
    #[error("{what} is {text}; it must be a finite number, zero or more")]
    Tolerance {
        /// Which one.
        what: &'static str,
        /// What was given.
        text: String,
    },
    /// Neither a relative nor an absolute tolerance.
    #[error(
        "the relative and an absolute tolerance are both zero, so that no error is allowed; give one of them"
    )]
    NoTolerance,
    /// A range of time without length.
    #[error(
        "the range of time goes from {start} to {end}; it must have an end other than its start, and both must be finite"
    )]
    Range {
        /// Where it starts.
        start: String,
        /// Where it ends.
        end: String,
    },
    /// A time at which the state is asked for, beyond the range.
    #[error("the state at t = {t} is asked for, beyond the range from {start} to {end}")]
    SampleTime {
        /// The time.
        t: String,
        /// Where the range starts.
        start: String,
        /// Where it ends.
        end: String,
    },
    /// An initial state that is not finite.
    #[error("entry {index} of the initial state is {text}; it must be a finite number")]
    InitialState {
        /// Which entry, from zero.
        index: usize,
        /// What was given.
        text: String,
    },
    /// A right-hand side of two parts where only one is taken.
    #[error(
        "`{id}` takes a right-hand side of one part only; add the two, or choose an implicit-explicit formula"
    )]
    TwoParts {
        /// The method.
        id: String,
    },
    /// A row without a step.
    #[error("formula `{id}` has no step: it needs at least one past state")]
    NoStep {
        /// The row.
        id: String,
    },
}

/// Refuses a vector that does not have as many entries as the state.
pub(super) fn check_length<T>(what: &str, vector: &[T], expected: usize) -> Result<(), IntegrateError> {
    if vector.len() == expected {
        return Ok(());
    }
    Err(IntegrateError::Dimension { what: what.to_owned(), got: vector.len(), expected })
}
