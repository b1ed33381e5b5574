use crate::math::Scalar;

/// Whether a stepper can go on; where it can not, the last good state is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Status {
    /// All is well.
    Running,
    /// The step from the current state gave an infinite or NaN component.
    NonFinite,
    /// The equation of an implicit step could not be solved.
    NotSolved,
    /// The controller rejected a step whose length can not change, because the coefficients are fixed.
    Rejected,
    /// The controller asked for a step that does not change the time, or that goes backwards or is not finite.
    StepTooSmall,
}

impl Status {
    /// Running if all components of a new state are finite.
    pub(super) fn of_finite<T: Scalar>(state: &[T]) -> Self {
        if state.iter().all(|entry| entry.is_finite()) { Self::Running } else { Self::NonFinite }
    }
}
