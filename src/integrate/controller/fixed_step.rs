use super::step_controller::{Attempt, Decision, StepController};

/// The built-in controller of equal steps: accepts every step and keeps its length.
///
/// ```
/// use kinstep::integrate::{Attempt, Decision, FixedStep, StepController};
/// let attempt = Attempt { time: 0.0, step: 0.1, from: &[1.0], to: &[0.9], error: None, order: 1 };
/// assert_eq!(FixedStep.judge(&attempt), Decision::Accept { next: 0.1 });
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FixedStep;

impl<T: Copy> StepController<T> for FixedStep {
    #[inline]
    fn judge(&mut self, attempt: &Attempt<'_, T>) -> Decision<T> {
        Decision::Accept { next: attempt.step }
    }
}
