//! The page about all formulas, written by the code that checks them.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::figure::{FrontPoint, pareto_figure, portrait};
use super::short;
use kinstep::formula::derive::{BarrierProof, barrier};
use kinstep::formula::{Coefficients, DerivativeRule, Duty, Formula, FormulaTable};
use kinstep::math::rational_to_f64;

/// A page in Markdown and the pictures that it shows.
///
/// ```no_run
/// use kinstep::formula::FormulaTable;
/// use kinstep_report::FormulaPage;
/// let page = FormulaPage::of(FormulaTable::builtin());
/// assert!(page.markdown.contains("la6-wang-guo"));
/// ```
#[derive(Debug, Clone)]
pub struct FormulaPage {
    /// The page.
    pub markdown: String,
    /// The pictures by file name; the page looks for them in the folder `pictures` beside it.
    pub pictures: Vec<(String, String)>,
}

/// The row that is shown in pictures.
const PORTRAYED: &str = "la6-wang-guo";
/// The kinds of rows whose fronts are drawn: steps and order.
const DRAWN: [(usize, usize); 4] = [(5, 3), (7, 4), (8, 4), (9, 5)];
/// The barrier is listed up to so many steps.
const BARRIER_STEPS: usize = 16;

impl FormulaPage {
    /// Returns the page of a table.
    pub fn of(table: &FormulaTable) -> Self {
        let mut page = Self { markdown: String::new(), pictures: Vec::new() };
        page.markdown.push_str(HEAD);
        page.recommended(table);
        page.leaders(table);
        page.fronts(table);
        page.barrier();
        page.portrait(table);
        page.whole_table(table);
        page.derivative_rules();
        page
    }

    fn recommended(&mut self, table: &FormulaTable) {
        let text = &mut self.markdown;
        text.push_str(RECOMMENDED);
        text.push_str("| steps | order | row | h_opt | r_opt | steady error | recovery | noise | why |\n|--:|--:|---|--:|--:|--:|--:|--:|---|\n");
        for r in table.recommended() {
            let m = &r.merit;
            let radius = r.formula.optimum().map_or_else(String::new, |optimum| short(optimum.radius));
            let figures =
                [short(m.h), radius, short(m.steady), format!("{:.0}", m.recovery.ceil()), short(m.noise)];
            let _ = writeln!(
                text,
                "| {} | {} | `{}` | {} | {} |",
                r.steps,
                r.order,
                r.formula.id(),
                figures.join(" | "),
                r.why
            );
        }
        let duty = Duty::default();
        if let Some((formula, merit)) = table.best_for(&duty) {
            let _ = writeln!(
                text,
                "\nA plan that names no formula runs on **`{}`**: of all rows that recover within {:.0} steps it has the \
                 least residual, {:.1e} of the path's amplitude, on a path that turns by {} rad per step, with noise of \
                 {:.0e} of the amplitude in residual and feedforward velocity.",
                formula.id(),
                duty.recovery,
                duty.residual(formula.order(), &merit),
                duty.turn,
                duty.noise
            );
        }
    }

    fn leaders(&mut self, table: &FormulaTable) {
        self.markdown.push_str(LEADERS);
        let mut by_order: BTreeMap<usize, Vec<&Formula>> = BTreeMap::new();
        for formula in table.iter().filter(|formula| has_loop(formula) && formula.is_explicit()) {
            by_order.entry(formula.order()).or_default().push(formula);
        }
        for (order, rows) in by_order {
            let leader = |value: &dyn Fn(&Formula) -> Option<f64>| {
                let best = rows
                    .iter()
                    .filter_map(|row| value(row).filter(|v| v.is_finite()).map(|v| (v, row.id())))
                    .min_by(|a, b| a.0.total_cmp(&b.0));
                best.map_or_else(|| "-".to_owned(), |(v, id)| format!("`{id}` {}", short(v.abs())))
            };
            let cells = [
                leader(&|row| Some(-row.feedback_range().value())),
                leader(&|row| row.optimum().map(|optimum| optimum.radius)),
                leader(&|row| Some(constant(row))),
                leader(&|row| row.optimum().map(|optimum| constant(row) / optimum.h)),
                leader(&|row| Some(row.noise_gain(row.optimum()?.h)?.feedforward_per_sigma)),
            ];
            let _ = writeln!(self.markdown, "| {order} | {} | {} |", rows.len(), cells.join(" | "));
        }
    }

    fn fronts(&mut self, table: &FormulaTable) {
        self.markdown.push_str(FRONTS);
        let runs = |row: &&Formula| has_loop(row) && row.is_explicit();
        let mut kinds: Vec<(usize, usize)> =
            table.iter().filter(runs).map(|row| (row.steps(), row.order())).collect();
        kinds.sort_unstable();
        kinds.dedup();
        let mut drawn = String::new();
        for kind in kinds {
            let rows: Vec<&Formula> =
                table.iter().filter(runs).filter(|row| (row.steps(), row.order()) == kind).collect();
            if rows.len() < 2 {
                continue;
            }
            let front = pareto_front(&rows);
            let names: Vec<String> = front.iter().map(|row| format!("`{}`", row.id())).collect();
            let (steps, order) = kind;
            let _ = writeln!(self.markdown, "| {steps} | {order} | {} | {} |", rows.len(), names.join(", "));
            if DRAWN.contains(&kind) {
                let is_beaten = |row: &&&Formula| front.iter().all(|leader| leader.id() != row.id());
                let leaders: Vec<FrontPoint> = front.iter().map(|row| FrontPoint::of(row)).collect();
                let beaten: Vec<FrontPoint> =
                    rows.iter().filter(is_beaten).map(|row| FrontPoint::of(row)).collect();
                let figure = pareto_figure(kind, &leaders, &beaten, "beaten by another");
                let _ = writeln!(drawn, "\n![{}](pictures/{}.svg)", figure.title, figure.name);
                self.pictures.push((format!("{}.svg", figure.name), figure.to_svg()));
            }
        }
        self.markdown.push_str(&drawn);
    }

    fn barrier(&mut self) {
        self.markdown.push_str(BARRIER);
        for found in (1..=BARRIER_STEPS).filter_map(barrier) {
            let beyond = match &found.beyond {
                BarrierProof::Sign { index, value } => format!("r_{index} = {value} is fixed, not positive"),
                BarrierProof::TooFewSteps => "too few steps".to_owned(),
                BarrierProof::Witness(_) | BarrierProof::Open => "undecided".to_owned(),
            };
            let witness = match found.witness.coefficients() {
                Coefficients::Difference { numerators, denominator } if found.steps <= 7 => {
                    let list: Vec<String> = numerators.iter().map(ToString::to_string).collect();
                    format!("({})/{denominator}", list.join(", "))
                }
                _ => "long; `--json` has it".to_owned(),
            };
            let _ = writeln!(self.markdown, "| {} | {} | {beyond} | {witness} |", found.steps, found.order);
        }
    }

    fn portrait(&mut self, table: &FormulaTable) {
        let Ok(formula) = table.get(PORTRAYED) else { return };
        let _ = writeln!(
            self.markdown,
            "\n## A row in pictures\n\n`kinstep formula show ID --plot FOLDER` draws these of any row, with their \
             numbers as CSV; here is `{PORTRAYED}`.\n"
        );
        for figure in portrait(PORTRAYED, formula.analysis()) {
            let _ = writeln!(self.markdown, "![{}](pictures/{}.svg)\n", figure.title, figure.name);
            self.pictures.push((format!("{}.svg", figure.name), figure.to_svg()));
        }
    }

    fn whole_table(&mut self, table: &FormulaTable) {
        let _ = write!(self.markdown, "## The whole table\n\n{} rows.\n", table.len());
        let mut families: Vec<&str> = Vec::new();
        for formula in table {
            if !families.contains(&formula.family()) {
                families.push(formula.family());
            }
        }
        for family in families {
            let _ = writeln!(self.markdown, "\n### {family}\n\n{TABLE_HEAD}");
            table.iter().filter(|row| row.family() == family).for_each(|row| self.table_line(row));
        }
    }

    fn table_line(&mut self, row: &Formula) {
        let range = row.feedback_range();
        let end = match range.exact() {
            _ if range.is_unbounded() => "unbounded".to_owned(),
            Some(exact) if exact.to_string().len() <= 12 => exact.to_string(),
            _ => format!("{:.6}", range.value()),
        };
        let stable = match (row.is_zero_stable(), row.is_strictly_zero_stable()) {
            (false, _) => "no",
            (true, false) => "weakly",
            (true, true) => "yes",
        };
        let optimum = row.optimum();
        let noise = optimum.and_then(|optimum| row.noise_gain(optimum.h));
        let dash = || "-".to_owned();
        let exact = |value: &kinstep::math::Rational| {
            let text = value.to_string();
            if text.len() <= 14 { text } else { short(rational_to_f64(value)) }
        };
        let cells = [
            format!("`{}`", row.id()),
            row.steps().to_string(),
            row.order().to_string(),
            exact(row.error_constant()),
            exact(row.per_step_constant()),
            stable.to_owned(),
            if row.is_zero_stable() { end } else { dash() },
            optimum.map_or_else(dash, |optimum| format!("{:.4}", optimum.h)),
            optimum.map_or_else(dash, |optimum| format!("{:.4}", optimum.radius)),
            noise.map_or_else(dash, |noise| short(noise.residual)),
            noise.map_or_else(dash, |noise| short(noise.feedforward_per_sigma)),
            row.analysis().ssp_coefficient().map_or_else(dash, |c| exact(&c)),
            row.source().to_owned(),
        ];
        let _ = writeln!(self.markdown, "| {} |", cells.join(" | "));
    }

    fn derivative_rules(&mut self) {
        self.markdown.push_str(RULES);
        for rule in DerivativeRule::builtin() {
            let weights: Vec<String> = rule.weights().iter().map(ToString::to_string).collect();
            let _ = writeln!(
                self.markdown,
                "| `{}` | {} | {} | {:.4} | {} |",
                rule.id(),
                rule.order(),
                rule.error_constant(),
                rule.noise_gain(),
                weights.join(", ")
            );
        }
    }
}

fn has_loop(formula: &Formula) -> bool {
    formula.is_zero_stable() && !formula.feedback_range().is_empty()
}

fn constant(formula: &Formula) -> f64 {
    rational_to_f64(formula.per_step_constant()).abs()
}

/// Returns the rows that no other of them beats: at least as good in h_max, |C| and r_opt, and better in one.
///
/// A row without an optimum counts as having the radius 1.
pub fn pareto_front<'t>(rows: &[&'t Formula]) -> Vec<&'t Formula> {
    let figures: Vec<[f64; 3]> = rows
        .iter()
        .map(|row| {
            let radius = row.optimum().map_or(1.0, |optimum| optimum.radius);
            [-row.feedback_range().value(), constant(row), radius]
        })
        .collect();
    // Radii come from a search in doubles: closer ones are equal.
    let not_above = |a: f64, b: f64| a <= b + 1e-12;
    let beats = |a: &[f64; 3], b: &[f64; 3]| {
        a.iter().zip(b).all(|(x, y)| not_above(*x, *y)) && a.iter().zip(b).any(|(x, y)| *x < y - 1e-12)
    };
    let is_beaten = |i: usize| figures.iter().any(|other| beats(other, &figures[i]));
    (0..rows.len()).filter(|&i| !is_beaten(i)).map(|i| rows[i]).collect()
}

const HEAD: &str = "\
# The formulas

*Written by `kinstep formula docs`; a test holds it against the table. Do not edit it by hand.*

A row is sum_j alpha_j x_(n+1-j) = sigma sum_j beta_j f_(n+1-j) + sigma sum_j gamma_j g_(n+1-j). In control, f is the
feedforward velocity, g the feedback, h = sigma k gamma(1) the feedback step, and residuals follow the roots of
rho(z) + h gamma(z)/gamma(1).

- **c**: error constant, x' = formula - c sigma^p x^(p+1); **C** = c beta(1): error of one step.
- **h_max**: the loop is stable for 0 < h < h_max, exact where it is a fraction.
- **h_opt**, **r_opt**: the h of least spectral radius, and that radius: errors shrink by r_opt per step.
- **noise**: l2 norms at h_opt, from the measured residual and from the feedforward velocity (per sigma).
- **SSP**: coefficient of strong stability preservation, where there is one.
";

const RECOMMENDED: &str = "
## Which row to take

For each number of steps and order, the row of least product of three figures at its own h_opt, in which units cancel:
*steady error* |C|/h_opt (the residual on a smooth path, over sigma^(p+1) |J q^(p+1)|), *recovery* (steps until a
disturbance is a thousandth of itself) and *noise* (gain from the feedforward velocity, per sigma). What another row does better
is said beside it. The column *why* is computed, like all others.

";

const LEADERS: &str = "
## Leaders

Among explicit zero-stable rows with a feedback range: the best row of each order in each column, with its figure.

| order | rows | widest range h_max | fastest decay r_opt | least \\|C\\| | least \\|C\\|/h_opt | least feedforward noise |
|--:|--:|---|---|---|---|---|
";

const FRONTS: &str = "
## Pareto fronts

Explicit rows of one kind that no other row of the table beats in h_max, |C| and r_opt together. How far a search came beyond
them is in [search.md](search.md).

| steps | order | rows | on the front |
|--:|--:|--:|---|
";

const BARRIER: &str = "
## Which orders there are

The highest order that look-ahead formulas of s steps can have with only z = 1 on the unit circle, recomputed when this page is
written. With zeta = (z - 1)/(z + 1) the other roots are inside the circle exactly when R(zeta) = sum_i r_i zeta^i has all its roots
in the left half-plane, for which every r_i must be positive; order p fixes r_0, ..., r_(p-1). The third column is the
coefficient that forbids the next order, the last a formula of the highest one, checked exactly. `kinstep formula barrier` prints this table.

| steps | highest order | why no higher one | a formula |
|--:|--:|---|---|
";

const TABLE_HEAD: &str = "\
| row | s | p | c | C | zero-stable | h_max | h_opt | r_opt | residual noise | feedforward noise | SSP | source |
|---|--:|--:|--:|--:|---|--:|--:|--:|--:|--:|--:|---|";

const RULES: &str = "
## Derivative rules

For references that are known by their samples: x'(t_n) from the present sample and past ones, x_n first. A rule of order q
adds about sigma^(q+1) |phi^(q+1)| beta(1) c/h to the residual; noise of unit strength in the samples becomes *noise*/sigma in the
velocity.

| rule | order | c | noise | weights |
|---|--:|--:|--:|---|
";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_beaten_row_is_not_on_the_front() {
        let table = FormulaTable::builtin();
        let rows: Vec<&Formula> =
            table.iter().filter(|row| has_loop(row) && (row.steps(), row.order()) == DRAWN[0]).collect();
        let front = pareto_front(&rows);
        assert!(front.len() >= 2 && front.len() < rows.len());
        // The paper's row is beaten in every column by la6-twelve.
        assert!(front.iter().all(|row| row.id() != "la6-wang-guo"));
        for row in &rows {
            let beaten = !front.iter().any(|leader| leader.id() == row.id());
            let twice: Vec<&Formula> = front.iter().copied().chain([*row]).collect();
            assert_eq!(
                beaten,
                pareto_front(&twice).iter().all(|leader| leader.id() != row.id()),
                "{}",
                row.id()
            );
        }
    }
}
