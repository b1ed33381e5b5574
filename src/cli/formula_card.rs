//! One formula as a card, many as a list.

use std::fmt::Write;

use num_traits::ToPrimitive;
use serde::Serialize;

use super::output::Show;
use crate::formula::{Analysis, CheckedRow, Coefficients, Formula, FormulaTable, Row};
use crate::math::{Rational, RootCondition};
use crate::report::{Table, short};

/// What a line of the list and a card have in common.
#[derive(Serialize)]
#[expect(clippy::struct_excessive_bools, reason = "they are keys of a document")]
struct Facts {
    id: String,
    name: Option<String>,
    family: Option<String>,
    steps: usize,
    order: Option<usize>,
    error_constant: Option<String>,
    explicit: bool,
    split: bool,
    zero_stable: bool,
    strictly_zero_stable: bool,
    h_max: HMax,
    declared_ok: bool,
    #[serde(skip)]
    constant: Option<f64>,
    #[serde(skip)]
    condition: RootCondition,
}

/// Everything that is known of one row.
#[derive(Serialize)]
pub(super) struct Card {
    #[serde(flatten)]
    facts: Facts,
    source: Option<String>,
    attribution: Option<String>,
    note: Option<String>,
    alpha: Vec<String>,
    beta: Vec<String>,
    gamma: Vec<String>,
    per_step_constant: Option<String>,
    root_moduli: Vec<f64>,
    h_opt: Option<f64>,
    r_opt: Option<f64>,
    noise_gain: Option<Noise>,
    problems: Vec<String>,
    remarks: Vec<String>,
    /// The finished row, where a draft is checked or a row is typed.
    #[serde(skip_serializing_if = "Option::is_none")]
    toml: Option<String>,
    #[serde(skip)]
    spelling: String,
}

/// The end of the feedback range: exact where it is a fraction, else by the polynomial that it is a root of.
#[derive(Clone, Default, Serialize)]
struct HMax {
    exact: Option<String>,
    polynomial: Option<String>,
    value: Option<f64>,
    unbounded: bool,
}

#[derive(Serialize)]
struct Noise {
    h: f64,
    residual: f64,
    feedforward_per_sigma: f64,
    state: f64,
}

impl HMax {
    /// Nothing is said of a row without a stable loop to begin with.
    fn of(analysis: &Analysis) -> Self {
        let Some(range) = analysis.feedback_range().filter(|_| analysis.is_zero_stable()) else {
            return Self::default();
        };
        Self {
            exact: range.exact().map(|exact| exact.to_string()),
            polynomial: range.polynomial(),
            value: Some(range.value()).filter(|value| value.is_finite()),
            unbounded: range.is_unbounded(),
        }
    }

    fn text(&self) -> String {
        match (&self.exact, self.value) {
            _ if self.unbounded => "unbounded".to_owned(),
            (Some(exact), _) if exact.len() <= 9 => exact.clone(),
            (_, Some(value)) => format!("{value:.6}"),
            _ => "-".to_owned(),
        }
    }
}

impl Card {
    pub(super) fn of_formula(formula: &Formula) -> Self {
        Self::new(formula.row(), formula.analysis(), Vec::new())
    }

    /// Returns the card of a row that may contradict itself; with `finished`, the row as it should be written.
    pub(super) fn of_row(checked: &CheckedRow, finished: bool) -> Self {
        let problems = checked.contradictions().iter().map(ToString::to_string).collect();
        let toml = finished.then(|| checked.to_toml());
        Self { toml, ..Self::new(checked.row(), checked.analysis(), problems) }
    }

    pub(super) fn with_remark(mut self, remark: &str) -> Self {
        self.remarks.push(remark.to_owned());
        self
    }

    fn new(row: &Row, analysis: &Analysis, problems: Vec<String>) -> Self {
        let weights = |list: &[Rational]| list.iter().map(ToString::to_string).collect();
        let optimum = analysis.optimum();
        let noise = optimum.and_then(|optimum| analysis.noise_gain(optimum.h));
        Self {
            facts: Facts::new(row, analysis, problems.is_empty()),
            source: row.source.clone(),
            attribution: row.attribution.clone(),
            note: row.note.clone(),
            alpha: weights(analysis.alpha()),
            beta: weights(analysis.beta()),
            gamma: weights(analysis.gamma()),
            per_step_constant: analysis.per_step_constant().map(ToString::to_string),
            root_moduli: analysis.root_moduli().to_vec(),
            h_opt: optimum.map(|optimum| optimum.h),
            r_opt: optimum.map(|optimum| optimum.radius),
            noise_gain: noise.map(|noise| Noise {
                h: noise.h,
                residual: noise.residual,
                feedforward_per_sigma: noise.feedforward_per_sigma,
                state: noise.state,
            }),
            problems,
            remarks: Vec::new(),
            toml: None,
            spelling: spelling(row),
        }
    }

    fn stability(&self) -> &'static str {
        match self.facts.condition {
            RootCondition::StrictlyStable => "zero-stable, with only z = 1 on the unit circle",
            RootCondition::WeaklyStable => {
                "weakly stable: zero-stable, with further roots on the unit circle"
            }
            RootCondition::Unstable => "NOT zero-stable: for study only, no plan runs on it",
        }
    }

    fn text(&self) -> String {
        let mut text = String::new();
        let title = self.facts.name.as_ref().filter(|name| **name != self.facts.id);
        let _ =
            writeln!(text, "{}{}", self.facts.id, title.map_or_else(String::new, |name| format!(": {name}")));
        let mut line = |label: &str, value: &str| {
            // Writing to a String can not fail.
            let _ = writeln!(text, "  {label:<16}{value}");
        };
        line("formula", &self.spelling);
        let kind = [
            if self.facts.explicit { "explicit" } else { "implicit" },
            if self.facts.split { ", split feedback" } else { "" },
        ];
        line("kind", &format!("{} steps, {}", self.facts.steps, kind.concat()));
        match (self.facts.order, &self.facts.error_constant, &self.per_step_constant) {
            (Some(p), Some(c), Some(per_step)) => {
                line(
                    "order",
                    &format!("{p}: x' = formula - ({c}) sigma^{p} x^({}), {per_step} per step", p + 1),
                );
                line(
                    "in control",
                    &format!("task error O(sigma^{}) at fixed h, O(sigma^{p}) at fixed gain", p + 1),
                );
            }
            _ => line("order", "none: the row is inconsistent"),
        }
        line("stability", self.stability());
        line(
            "root moduli",
            &self.root_moduli.iter().map(|m| format!("{m:.6}")).collect::<Vec<_>>().join(", "),
        );
        self.closed_loop_lines(&mut line);
        for (label, value) in
            [("source", &self.source), ("attribution", &self.attribution), ("note", &self.note)]
        {
            if let Some(value) = value {
                line(label, value);
            }
        }
        self.problems.iter().for_each(|problem| line("PROBLEM", problem));
        self.remarks.iter().for_each(|remark| line("remark", remark));
        if let Some(toml) = &self.toml {
            let _ = write!(text, "\n{toml}");
        }
        text
    }

    fn closed_loop_lines(&self, line: &mut impl FnMut(&str, &str)) {
        let HMax { exact, polynomial, value, unbounded } = &self.facts.h_max;
        line(
            "feedback range",
            &match (exact.as_deref(), value) {
                _ if *unbounded => "every h > 0".to_owned(),
                (Some("0"), _) => "empty: no h gives a stable loop".to_owned(),
                (Some(exact), Some(value)) if exact.contains('/') => format!("0 < h < {exact} = {value:.6}"),
                (Some(exact), _) => format!("0 < h < {exact}"),
                (None, Some(value)) => {
                    format!(
                        "0 < h < {value:.12}, a root of {}",
                        polynomial.as_deref().unwrap_or("a polynomial")
                    )
                }
                _ => "none".to_owned(),
            },
        );
        if let (Some(h), Some(r)) = (self.h_opt, self.r_opt) {
            line("best h", &format!("{h:.6}, where errors decay by {r:.6} per step"));
        }
        if let Some(noise) = &self.noise_gain {
            line(
                "noise gains",
                &format!(
                    "residual {:.4}, feedforward {:.4} sigma, joint state {:.4} (at h = {:.4})",
                    noise.residual, noise.feedforward_per_sigma, noise.state, noise.h
                ),
            );
        }
    }
}

/// The coefficients as they were written.
fn spelling(row: &Row) -> String {
    let list = |weights: &[Rational]| weights.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    match row.coefficients() {
        Coefficients::Difference { numerators, denominator } => {
            format!("x'(t_n) = ({}) / {denominator} / sigma, from x_n+1 back", list(numerators))
        }
        Coefficients::General { alpha, beta, gamma } => {
            let gamma = gamma.as_ref().map_or_else(String::new, |gamma| format!("; gamma ({})", list(gamma)));
            format!("alpha ({}); beta ({}){gamma}; newest first", list(alpha), list(beta))
        }
    }
}

/// Cards one after the other.
#[derive(Serialize)]
pub(super) struct Cards {
    formulas: Vec<Card>,
}

impl Cards {
    pub(super) fn new(formulas: Vec<Card>) -> Self {
        Self { formulas }
    }

    pub(super) fn is_sound(&self) -> bool {
        self.formulas.iter().all(|card| card.facts.declared_ok)
    }
}

impl Show for Cards {
    fn text(&self) -> String {
        let cards: Vec<String> = self.formulas.iter().map(Card::text).collect();
        cards.join("\n")
    }
}

/// One line per formula.
#[derive(Serialize)]
pub(super) struct FormulaList {
    formulas: Vec<Facts>,
}

impl FormulaList {
    pub(super) fn new(table: &FormulaTable, own_rows: Vec<Row>) -> Self {
        let builtin = table.iter().map(|formula| Facts::new(formula.row(), formula.analysis(), true));
        let own = own_rows.into_iter().map(|row| {
            let checked = row.check();
            Facts::new(checked.row(), checked.analysis(), checked.contradictions().is_empty())
        });
        Self { formulas: builtin.chain(own).collect() }
    }

    pub(super) fn is_sound(&self) -> bool {
        self.formulas.iter().all(|line| line.declared_ok)
    }
}

impl Facts {
    fn new(row: &Row, analysis: &Analysis, declared_ok: bool) -> Self {
        let constant = analysis.error_constant();
        Self {
            id: row.id().to_owned(),
            name: row.name.clone(),
            family: row.family.clone(),
            steps: analysis.steps(),
            order: analysis.order(),
            constant: constant.as_ref().and_then(Rational::to_f64),
            error_constant: constant.map(|c| c.to_string()),
            explicit: analysis.is_explicit(),
            split: analysis.is_split(),
            zero_stable: analysis.is_zero_stable(),
            strictly_zero_stable: analysis.is_strictly_zero_stable(),
            h_max: HMax::of(analysis),
            declared_ok,
            condition: analysis.root_condition(),
        }
    }

    fn remark(&self) -> &'static str {
        match (self.declared_ok, self.zero_stable, self.strictly_zero_stable, self.explicit) {
            (false, ..) => "declares what is not so",
            (_, false, ..) => "unstable specimen",
            (_, _, false, _) => "weakly stable",
            (.., false) => "implicit, not run yet",
            _ => "",
        }
    }
}

impl Show for FormulaList {
    fn text(&self) -> String {
        let mut table = Table::new(["id", "family", "steps", "order", "c", "h_max", ""]);
        for line in &self.formulas {
            let constant = match &line.error_constant {
                Some(exact) if exact.len() <= 9 => exact.clone(),
                _ => line.constant.map_or_else(|| "-".to_owned(), short),
            };
            let order = line.order.map_or_else(|| "-".to_owned(), |order| order.to_string());
            let cells =
                [line.steps.to_string(), order, constant, line.h_max.text(), line.remark().to_owned()];
            let family = line.family.clone().unwrap_or_default();
            table.row([line.id.clone(), family].into_iter().chain(cells));
        }
        format!(
            "{table}\n{} formulas; c: error constant; 0 < h < h_max: feedback steps with a stable loop.\n\
             `kinstep formula show ID` shows one in full.\n",
            self.formulas.len()
        )
    }
}
