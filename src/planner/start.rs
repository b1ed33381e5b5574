use crate::formula::{Formula, FormulaTable};
use crate::integrate::Starter;

/// How the run begins; see [`Starter`].
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Start {
    /// The cheapest start of sufficient order: `rk4` up to order 4, `rk8` above.
    #[default]
    Sufficient,
    /// Euler steps with the same `h`.
    Paper,
    /// Lower rows of the formula's family.
    Ramp,
    /// Runge-Kutta of order 4.
    Rk4,
    /// Runge-Kutta of order 8.
    Rk8,
    /// The joint positions `x_1 .. x_{s-1}` of all arms one after the other, oldest state first. Arms that share joints
    /// stand at the place of the first of them: its joints, then those of the next that are not there yet.
    Given(Vec<Vec<f64>>),
}

impl Start {
    /// The names a scenario may use.
    pub const NAMES: [&'static str; 4] = ["paper", "ramp", "rk4", "rk8"];

    /// The start of that name.
    pub fn by_name(name: &str) -> Option<Self> {
        match name {
            "paper" => Some(Self::Paper),
            "ramp" => Some(Self::Ramp),
            "rk4" => Some(Self::Rk4),
            "rk8" => Some(Self::Rk8),
            _ => None,
        }
    }

    /// The starter for a row.
    pub(super) fn starter(&self, formula: &Formula) -> Starter<f64> {
        match self {
            Self::Sufficient => Starter::sufficient_for(formula.order()),
            Self::Paper => Starter::Paper,
            Self::Ramp => {
                let table = FormulaTable::builtin();
                Starter::Ramp(
                    (1..formula.steps()).map_while(|known| table.ramp(formula, known).cloned()).collect(),
                )
            }
            Self::Rk4 => Starter::Rk4,
            Self::Rk8 => Starter::Rk8,
            Self::Given(states) => Starter::Given(states.clone()),
        }
    }
}
