//! Which row to take where nothing else decides: a measure, and the rows that are least in it.

use crate::math::rational_to_f64;

use super::formula::Formula;
use super::table::FormulaTable;

/// What a row costs in control at its own best feedback step, in numbers without units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Merit {
    /// |C|/h_opt: the steady residual in units of sigma^(p+1) |J q^(p+1)|.
    pub steady: f64,
    /// Steps until a disturbance has fallen to a thousandth: ln 1000 / -ln r_opt, and never below the row's number of steps.
    pub recovery: f64,
    /// Gain from noise in the feedforward velocity to the residual, per unit of sigma.
    pub noise: f64,
    /// Gain from noise in the measured residual to the residual.
    pub residual_noise: f64,
    /// The best feedback step h_opt.
    pub h: f64,
}

impl Merit {
    /// Returns steady residual x recovery x noise gain: rows are compared by this product, in which units and
    /// weights cancel. Less is better.
    pub fn cost(&self) -> f64 {
        self.steady * self.recovery * self.noise
    }
}

/// Returns the merit of a row, `None` for one that no controller may run or that has no best feedback step.
pub fn merit(formula: &Formula) -> Option<Merit> {
    formula.runnable_with_feedback().ok()?;
    let optimum = formula.optimum()?;
    let noise = formula.noise_gain(optimum.h)?;
    let decay = 1000_f64.ln() / -optimum.radius.ln();
    Some(Merit {
        steady: rational_to_f64(formula.per_step_constant()).abs() / optimum.h,
        recovery: decay.max(formula.steps() as f64),
        noise: noise.feedforward_per_sigma,
        residual_noise: noise.residual,
        h: optimum.h,
    })
}

/// The row to use for a number of steps and an order.
#[derive(Debug, Clone)]
pub struct Recommendation<'t> {
    /// The number of steps.
    pub steps: usize,
    /// The order.
    pub order: usize,
    /// The row to use.
    pub formula: &'t Formula,
    /// The merit of that row.
    pub merit: Merit,
    /// How many rows of these steps and this order were compared.
    pub compared: usize,
    /// The reason, from the figures of all rows compared.
    pub why: String,
}

/// A motion by which orders can be compared: the residual of a row depends on how fast the path turns and how noisy
/// its samples are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Duty {
    /// Angular frequency of the path times sigma [rad per step].
    pub turn: f64,
    /// Standard deviation of the noise in residual and feedforward velocity, relative to the path's amplitude.
    pub noise: f64,
    /// Most steps in which a disturbance has to fall to a thousandth.
    pub recovery: f64,
}

impl Default for Duty {
    /// Returns 63 steps per turn of the path, noise of a millionth, and recovery within 10 steps.
    fn default() -> Self {
        Self { turn: 0.1, noise: 1e-6, recovery: 10.0 }
    }
}

impl Duty {
    /// Returns the residual to be expected of a row of this order and merit, relative to the path's amplitude:
    /// sqrt((C/h turn^(p+1))^2 + noise^2 (residual^2 + (feedforward turn)^2)).
    pub fn residual(&self, order: usize, merit: &Merit) -> f64 {
        let truncation = merit.steady * self.turn.powf(order as f64 + 1.0);
        let noise = self.noise * merit.residual_noise.hypot(merit.noise * self.turn);
        truncation.hypot(noise)
    }
}

impl FormulaTable {
    /// Returns the row to use for each number of steps and order that the table has a runnable row for, steps first.
    ///
    /// The row of least [`Merit::cost`]; of equal ones the first in the table.
    pub fn recommended(&self) -> Vec<Recommendation<'_>> {
        let rows: Vec<(&Formula, Merit)> =
            self.iter().filter_map(|formula| merit(formula).map(|merit| (formula, merit))).collect();
        let mut kinds: Vec<(usize, usize)> = rows.iter().map(|(f, _)| (f.steps(), f.order())).collect();
        kinds.sort_unstable();
        kinds.dedup();
        kinds.into_iter().filter_map(|kind| recommendation(kind, &rows)).collect()
    }

    /// Returns the row that is least in the residual of a duty among those that recover in time, with its merit;
    /// `None` where no row does.
    pub fn best_for(&self, duty: &Duty) -> Option<(&Formula, Merit)> {
        self.iter()
            .filter_map(|formula| merit(formula).map(|merit| (formula, merit)))
            .filter(|(_, merit)| merit.recovery <= duty.recovery)
            .min_by(|(f, a), (g, b)| duty.residual(f.order(), a).total_cmp(&duty.residual(g.order(), b)))
    }
}

fn recommendation<'t>(
    (steps, order): (usize, usize),
    rows: &[(&'t Formula, Merit)],
) -> Option<Recommendation<'t>> {
    let alike: Vec<(&Formula, Merit)> =
        rows.iter().filter(|(f, _)| f.steps() == steps && f.order() == order).copied().collect();
    let (formula, merit) = alike.iter().min_by(|(_, a), (_, b)| a.cost().total_cmp(&b.cost())).copied()?;
    let why = reason(formula, &merit, &alike);
    Some(Recommendation { steps, order, formula, merit, compared: alike.len(), why })
}

/// A figure of the merit.
type Column = fn(&Merit) -> f64;

/// Which columns the row leads, and who leads the others.
fn reason(formula: &Formula, merit: &Merit, alike: &[(&Formula, Merit)]) -> String {
    if alike.len() == 1 {
        return "the only row of its kind".to_owned();
    }
    let columns: [(&str, Column); 3] =
        [("steady error", |m| m.steady), ("recovery time", |m| m.recovery), ("noise", |m| m.noise)];
    let mut leads = Vec::new();
    let mut behind = Vec::new();
    for (name, value) in columns {
        let Some(best) = alike.iter().min_by(|(_, a), (_, b)| value(a).total_cmp(&value(b))) else {
            continue;
        };
        let more = value(merit) / value(&best.1) - 1.0;
        if best.0.id() == formula.id() || !(more > 5e-3) {
            leads.push(name);
        } else {
            behind.push(format!(
                "{} has {:.0} % less {name}",
                best.0.id(),
                100.0 * (1.0 - 1.0 / (1.0 + more))
            ));
        }
    }
    let product = format!("least product of {}", alike.len());
    match (leads.is_empty(), behind.is_empty()) {
        (_, true) => format!("best of {} in every column", alike.len()),
        (true, false) => format!("{product}; {}", behind.join(", ")),
        (false, false) => format!("{product}, leads in {}; {}", leads.join(" and "), behind.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_runnable_row_has_one_recommendation() {
        let table = FormulaTable::builtin();
        let recommended = table.recommended();
        for formula in table.iter().filter(|formula| merit(formula).is_some()) {
            let kind = (formula.steps(), formula.order());
            assert_eq!(recommended.iter().filter(|r| (r.steps, r.order) == kind).count(), 1, "{kind:?}");
        }
        assert!(recommended.iter().all(|r| r.formula.runnable_with_feedback().is_ok() && !r.why.is_empty()));
    }

    #[test]
    fn the_recommended_row_costs_least_of_its_kind() {
        let table = FormulaTable::builtin();
        for r in table.recommended() {
            for other in table.iter().filter(|f| (f.steps(), f.order()) == (r.steps, r.order)) {
                assert!(merit(other).is_none_or(|m| m.cost() >= r.merit.cost()), "{}", other.id());
            }
        }
    }

    #[test]
    fn rough_paths_and_noise_ask_for_other_rows() {
        let table = FormulaTable::builtin();
        let of =
            |turn, noise| table.best_for(&Duty { turn, noise, recovery: 100.0 }).expect("there is one").0;
        let (smooth, noisy) = (of(0.02, 1e-12), of(0.02, 1e-2));
        assert!(smooth.order() > noisy.order(), "{} {}", smooth.id(), noisy.id());
        assert!(table.best_for(&Duty { recovery: 0.0, ..Duty::default() }).is_none());
    }

    #[test]
    fn unstable_and_implicit_rows_have_no_merit() {
        for id in ["am3", "bdf3", "la3-leapfrog"] {
            assert!(FormulaTable::builtin().get(id).is_ok_and(|row| merit(row).is_none()), "{id}");
        }
    }
}
