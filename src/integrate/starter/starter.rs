use super::kind::StarterKind;
use crate::formula::Formula;

/// How the states `x_1 .. x_{s-1}` come about before an `s`-step row can run.
///
/// Start-up decides what order a run shows: a start of order below the row's leaves a transient that hides it.
///
/// ```
/// use kinstep::integrate::{Starter, StarterKind};
/// let starter = Starter::<f64>::sufficient_for(6);
/// assert_eq!((starter.name(), starter.order()), ("rk8", Some(8)));
/// assert_eq!(Starter::<f64>::from(StarterKind::Paper).name(), "paper");
/// ```
#[derive(Clone, Debug, Default)]
pub enum Starter<T> {
    /// The cheapest Runge-Kutta start that does not hide the row; see [`sufficient_for`](Self::sufficient_for).
    #[default]
    Sufficient,
    /// Euler steps with the row's own feedback step `h`, as in eq. (9) of Wang and Guo (IEEE Access 8, 2020).
    /// Each leaves a residual of `sigma^2 / 2` times the second derivative.
    Paper,
    /// Explicit rows of the same family in the built-in table, of rising order; the first step is Euler's, so it leaves what
    /// [`Starter::Paper`] leaves. See [`FormulaTable::ramp`](crate::formula::FormulaTable::ramp).
    Ramp,
    /// The same with rows of your own, of at most 1, 2, 3, ... steps: entry `k` runs once `k + 1` states are known, the last
    /// one from there on. The first step is Euler's unless the first row is implicit. Implicit rows, such as the lower backward
    /// differentiation formulas, can start only methods that solve for the new state.
    Rows(Vec<Formula>),
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
        StarterKind::sufficient_for(order).into()
    }

    /// The kind, where it has one: not for [`Sufficient`](Self::Sufficient), which depends on the row, nor for
    /// [`Given`](Self::Given).
    pub fn kind(&self) -> Option<StarterKind> {
        match self {
            Self::Paper => Some(StarterKind::Paper),
            Self::Ramp | Self::Rows(_) => Some(StarterKind::Ramp),
            Self::Rk4 => Some(StarterKind::Rk4),
            Self::Rk8 => Some(StarterKind::Rk8),
            Self::Sufficient | Self::Given(_) => None,
        }
    }

    /// The name used in scenario files and reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Sufficient => "sufficient",
            Self::Given(_) => "given",
            named => named.kind().map_or("", StarterKind::name),
        }
    }

    /// The order of the start, where the starter alone decides it: not for [`Sufficient`](Self::Sufficient) and
    /// [`Given`](Self::Given).
    pub fn order(&self) -> Option<usize> {
        self.kind().map(StarterKind::order)
    }
}

impl<T> From<StarterKind> for Starter<T> {
    fn from(kind: StarterKind) -> Self {
        match kind {
            StarterKind::Paper => Self::Paper,
            StarterKind::Ramp => Self::Ramp,
            StarterKind::Rk4 => Self::Rk4,
            StarterKind::Rk8 => Self::Rk8,
        }
    }
}
