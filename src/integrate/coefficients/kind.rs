use crate::formula::Formula;
use num_traits::Zero;
use std::fmt;

/// Which parts of the right-hand side a row needs at the new state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowKind {
    /// None: `beta_0 = gamma_0 = 0`.
    Explicit,
    /// The first part, or both: `beta_0` is not zero.
    Implicit,
    /// The second part alone, `beta_0 = 0` and `gamma_0` not zero: `f` is explicit, `g` implicit.
    Imex,
}

impl RowKind {
    /// Returns the kind of a formula.
    ///
    /// ```
    /// use kinstep::formula::FormulaTable;
    /// use kinstep::integrate::RowKind;
    /// assert_eq!(RowKind::of(FormulaTable::builtin().get("bdf2")?), RowKind::Implicit);
    /// # Ok::<(), kinstep::formula::UnknownFormula>(())
    /// ```
    pub fn of(formula: &Formula) -> Self {
        match (formula.beta()[0].is_zero(), formula.gamma()[0].is_zero()) {
            (true, true) => Self::Explicit,
            (true, false) => Self::Imex,
            (false, _) => Self::Implicit,
        }
    }
}

impl fmt::Display for RowKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Explicit => "explicit",
            Self::Implicit => "implicit",
            Self::Imex => "implicit-explicit",
        })
    }
}
