use super::kind::RowKind;
use super::ratio::RatioCoefficients;
use crate::formula::Formula;
use std::sync::Arc;

/// The coefficients of a multistep row: fixed ones for equal steps, or functions of the ratios of the last steps.
///
/// ```
/// use kinstep::formula::FormulaTable;
/// use kinstep::integrate::{Coefficients, RowKind};
/// let row = Coefficients::<f64>::from(FormulaTable::builtin().get("am2")?);
/// assert_eq!((row.id(), row.steps(), row.order(), row.kind()), ("am2", 2, 3, RowKind::Implicit));
/// # Ok::<(), kinstep::formula::UnknownFormula>(())
/// ```
#[derive(Clone, Debug)]
pub enum Coefficients<T> {
    /// The row of a table; every step has the same length.
    Fixed(Box<Formula>),
    /// Coefficients computed anew for every step; its length may change from step to step.
    Ratio(Arc<dyn RatioCoefficients<T>>),
}

impl<T> Coefficients<T> {
    /// Returns the id of the row.
    pub fn id(&self) -> &str {
        match self {
            Self::Fixed(formula) => formula.id(),
            Self::Ratio(row) => row.id(),
        }
    }

    /// Returns the number of steps: how many past states are needed.
    pub fn steps(&self) -> usize {
        match self {
            Self::Fixed(formula) => formula.steps(),
            Self::Ratio(row) => row.steps(),
        }
    }

    /// Returns the order p: a step errs by a multiple of `sigma^(p+1)`.
    pub fn order(&self) -> usize {
        match self {
            Self::Fixed(formula) => formula.order(),
            Self::Ratio(row) => row.order(),
        }
    }

    /// Returns what the row needs at the new state.
    pub fn kind(&self) -> RowKind {
        match self {
            Self::Fixed(formula) => RowKind::of(formula),
            Self::Ratio(row) => row.kind(),
        }
    }

    /// Returns whether steps may vary.
    pub fn may_vary(&self) -> bool {
        matches!(self, Self::Ratio(_))
    }
}

impl<T> From<&Formula> for Coefficients<T> {
    fn from(formula: &Formula) -> Self {
        Self::Fixed(Box::new(formula.clone()))
    }
}

impl<T, R: RatioCoefficients<T> + 'static> From<Arc<R>> for Coefficients<T> {
    fn from(row: Arc<R>) -> Self {
        Self::Ratio(row)
    }
}
