use crate::formula::Formula;

/// How the states `x_1 .. x_{s-1}` come about before an `s`-step row can run.
///
/// Start-up decides what order a run shows: a start of order below the row's leaves a transient that hides it.
#[derive(Clone, Debug)]
pub enum Starter<T> {
    /// Euler steps with the row's own feedback step `h`, as in eq. (9) of Wang and Guo (IEEE Access 8, 2020).
    /// Each leaves a residual of `sigma^2 / 2` times the second derivative.
    Paper,
    /// Explicit rows of at most 1, 2, 3, ... steps: entry `k` runs once `k + 1` states are known, the last one from
    /// there on. The first step is Euler's, so it leaves what [`Starter::Paper`] leaves. See
    /// [`FormulaTable::ramp`](crate::formula::FormulaTable::ramp).
    Ramp(Vec<Formula>),
    /// One classical Runge-Kutta step of order 4 per `sigma`.
    Rk4,
    /// One eleven-stage Runge-Kutta step of order 8 per `sigma`.
    Rk8,
    /// The states `x_1, x_2, ..., x_{s-1}` themselves, oldest first.
    Given(Vec<Vec<T>>),
}

impl<T> Starter<T> {
    /// The cheapest starter that does not hide a row of order `order`: [`Rk4`](Self::Rk4) up to 4, else [`Rk8`](Self::Rk8).
    pub fn sufficient_for(order: usize) -> Self {
        if order <= 4 { Self::Rk4 } else { Self::Rk8 }
    }

    /// The name used in scenario files and reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Ramp(_) => "ramp",
            Self::Rk4 => "rk4",
            Self::Rk8 => "rk8",
            Self::Given(_) => "given",
        }
    }

    /// The order of the start, where the starter fixes it (not for [`Given`](Self::Given)).
    pub fn order(&self) -> Option<usize> {
        match self {
            Self::Paper | Self::Ramp(_) => Some(1),
            Self::Rk4 => Some(4),
            Self::Rk8 => Some(8),
            Self::Given(_) => None,
        }
    }
}
