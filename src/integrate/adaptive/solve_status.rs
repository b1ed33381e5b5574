use std::fmt;

/// How a solution ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SolveStatus {
    /// At the end that was asked for.
    Completed,
    /// At a terminal event.
    Event,
    /// Where the right-hand side is infinite or NaN, however short the step.
    NonFinite,
    /// Where no step is short enough for the tolerances.
    StepTooSmall,
    /// After as many steps as were allowed.
    TooManySteps,
    /// Where an implicit equation could not be solved, however short the step.
    NoConvergence,
}

impl SolveStatus {
    /// Returns the name, as in `"step_too_small"`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Completed => "completed",
            Self::Event => "event",
            Self::NonFinite => "non_finite",
            Self::StepTooSmall => "step_too_small",
            Self::TooManySteps => "too_many_steps",
            Self::NoConvergence => "no_convergence",
        }
    }

    /// Whether it went as it was asked to: to the end, or to a terminal event.
    pub fn is_success(self) -> bool {
        matches!(self, Self::Completed | Self::Event)
    }
}

impl fmt::Display for SolveStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
