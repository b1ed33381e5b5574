//! Starts by rows of fewer steps, as many as the states that are known.

use super::paper;
use crate::formula::{Formula, FormulaTable};
use crate::integrate::coefficients::Weights;
use crate::math::Rational;
use crate::math::Scalar;

/// What a start by rows is made for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ramp<'a, T> {
    pub(super) sigma: T,
    /// Number of steps of the row that is started.
    pub(super) steps: usize,
    /// What its `gamma` sums to.
    pub(super) gamma_sum: &'a Rational,
    /// Whether the new state can be solved for.
    pub(super) takes_implicit: bool,
}

/// The explicit rows of the family of `formula` in the built-in table.
pub(super) fn builtin_ladder(formula: &Formula) -> Vec<Formula> {
    let table = FormulaTable::builtin();
    (1..formula.steps()).map_while(|known| table.ramp(formula, known).cloned()).collect()
}

impl<T: Scalar> Ramp<'_, T> {
    /// The rows of the steps of the start, the last one for all that are left: those of the ladder up to the first that does not
    /// fit, behind Euler's.
    pub(super) fn rows(self, ladder: &[Formula]) -> Vec<Weights<T>> {
        let fits = |(known, row): &(usize, &Formula)| {
            row.steps() <= known + 1 && (self.takes_implicit || row.is_explicit())
        };
        let usable = ladder.iter().take(self.steps - 1).enumerate().take_while(fits);
        let usable: Vec<_> =
            usable.map(|(_, row)| Weights::for_start(row, self.sigma, self.gamma_sum)).collect();
        if usable.first().is_some_and(Weights::is_implicit) {
            return usable;
        }
        let mut rows = paper::rows(self.sigma, self.gamma_sum);
        rows.extend(usable.into_iter().skip(1));
        rows
    }
}
