use crate::integrate::status::Status;

/// A step that was attempted, as its controller sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attempt<'a, T> {
    /// The time from which the step goes.
    pub time: T,
    /// Its length.
    pub step: T,
    /// The state from which it goes.
    pub from: &'a [T],
    /// The state to which it would lead.
    pub to: &'a [T],
    /// The estimate of the step's own error, component by component, where the method has one.
    pub error: Option<&'a [T]>,
    /// The order p: the error falls like `step^(p+1)`.
    pub order: usize,
}

/// What a controller says to an attempt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Decision<T> {
    /// The step is made; the next one is to be of this length.
    Accept {
        /// The length of the next step.
        next: T,
    },
    /// The step is not made; another of this length is attempted from the same state.
    Reject {
        /// The length of the next attempt.
        retry: T,
    },
}

/// Judges the steps of a run; see [`Multistep::step_under`](crate::integrate::stepper::Multistep::step_under).
///
/// It is asked from the first step of the recursion itself on, not while the starter is at work. Rows of
/// [fixed coefficients](crate::integrate::coefficients::Coefficients::Fixed) keep their step whatever it proposes, so a rejection
/// ends their run.
///
/// ```
/// use kinstep::integrate::{Attempt, Decision, StepController};
///
/// /// Keeps the largest error estimate of a step near a tolerance.
/// struct Elementary {
///     tolerance: f64,
/// }
///
/// impl StepController<f64> for Elementary {
///     fn judge(&mut self, attempt: &Attempt<'_, f64>) -> Decision<f64> {
///         let errors = attempt.error.unwrap_or_default().iter();
///         let error = errors.fold(1e-6 * self.tolerance, |most, error| error.abs().max(most));
///         let factor = (self.tolerance / error).powf(1.0 / (attempt.order as f64 + 1.0));
///         let length = attempt.step * (0.9 * factor).clamp(0.5, 1.5);
///         if error <= self.tolerance { Decision::Accept { next: length } } else { Decision::Reject { retry: length } }
///     }
/// }
/// ```
pub trait StepController<T> {
    /// Says whether the step is made, and the length of the next one.
    fn judge(&mut self, attempt: &Attempt<'_, T>) -> Decision<T>;

    /// Says with which length to try again after a step of length `step` came to nothing, as `status` says; `None`, unless
    /// overridden, ends the run with that status.
    fn after_failure(&mut self, _step: T, _status: Status) -> Option<T> {
        None
    }
}
