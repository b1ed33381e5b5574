//! One formula as a card.

use std::collections::BTreeMap;
use std::fmt::Write;

use num_traits::{ToPrimitive, Zero};
use serde::Serialize;

use super::output::Show;
use kinstep::formula::{Analysis, CheckedRow, Coefficients, Formula, NoiseGain, Row, recursion};
use kinstep::math::{AlgebraicNumber, Rational, RootCondition};

/// What a line of the list and a card have in common.
#[derive(Serialize)]
#[expect(clippy::struct_excessive_bools, reason = "they are keys of a document")]
pub(super) struct Facts {
    pub(super) id: String,
    name: Option<String>,
    pub(super) family: Option<String>,
    pub(super) steps: usize,
    pub(super) order: Option<usize>,
    pub(super) error_constant: Option<String>,
    explicit: bool,
    split: bool,
    pub(super) zero_stable: bool,
    strictly_zero_stable: bool,
    pub(super) h_max: HMax,
    pub(super) h_opt: Option<f64>,
    pub(super) r_opt: Option<f64>,
    pub(super) noise_gain: Option<Noise>,
    pub(super) declared_ok: bool,
    #[serde(skip)]
    pub(super) constant: Option<f64>,
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
    /// z of each root of rho: real and imaginary part, largest modulus first.
    roots: Vec<[f64; 2]>,
    recursion: String,
    h_opt_exact: Option<Exact>,
    r_opt_squared_exact: Option<Exact>,
    /// What makes h_opt the best.
    optimum_cause: Option<&'static str>,
    /// Proved: no h of the range has a radius below this.
    r_bound: Option<f64>,
    ssp_coefficient: Option<String>,
    problems: Vec<String>,
    remarks: Vec<String>,
    /// The finished row, where a draft is checked or a row is typed.
    #[serde(skip_serializing_if = "Option::is_none")]
    toml: Option<String>,
    /// The row in other languages, as asked for.
    #[serde(flatten)]
    snippets: BTreeMap<&'static str, String>,
    #[serde(skip)]
    spelling: String,
    #[serde(skip)]
    has_root_at_one: bool,
}

/// The most rows that are offered in place of an inconsistent one.
const MOST_HINTS: usize = 3;
/// Moduli above this lie outside the unit circle: those of repeated roots on it are right to the last digits of a double.
const OUTSIDE: f64 = 1.0 + 1e-9;

/// The end of the feedback range: exact where it is a fraction, else by the polynomial that it is a root of.
#[derive(Clone, Default, Serialize)]
pub(super) struct HMax {
    exact: Option<String>,
    /// An irrational end of degree two.
    closed_form: Option<String>,
    polynomial: Option<String>,
    /// Whether the polynomial is proved irreducible.
    irreducible: Option<bool>,
    /// Two fractions with an irrational end between them.
    certified_interval: Option<[String; 2]>,
    pub(super) value: Option<f64>,
    pub(super) unbounded: bool,
}

#[derive(Serialize)]
pub(super) struct Noise {
    h: f64,
    pub(super) residual: f64,
    pub(super) feedforward_per_sigma: f64,
    state: f64,
}

impl Noise {
    fn of(gain: NoiseGain) -> Self {
        let NoiseGain { h, residual, feedforward_per_sigma, state } = gain;
        Self { h, residual, feedforward_per_sigma, state }
    }
}

/// An algebraic number: in closed form, or by a polynomial and an interval.
#[derive(Serialize)]
struct Exact {
    closed_form: Option<String>,
    polynomial: Option<String>,
    interval: Option<[String; 2]>,
    value: f64,
}

impl Exact {
    fn of(number: &AlgebraicNumber, variable: &str) -> Self {
        let root = match number {
            AlgebraicNumber::Root(root) => Some(root),
            _ => None,
        };
        Self {
            closed_form: number.closed_form(),
            polynomial: root.map(|root| root.polynomial().normalised().to_text(variable)),
            interval: root.map(|root| interval(root.interval())),
            value: number.to_f64(),
        }
    }

    /// `closed form`, or `a root of ...`; a polynomial too long to read is told by its degree.
    fn text(&self) -> String {
        const READABLE: usize = 100;
        match (&self.closed_form, &self.polynomial) {
            (Some(closed), _) => closed.clone(),
            (None, Some(polynomial)) if polynomial.len() <= READABLE => format!("a root of {polynomial}"),
            _ => "algebraic of high degree (--json has the polynomial)".to_owned(),
        }
    }
}

fn interval((low, high): (&Rational, &Rational)) -> [String; 2] {
    [low.to_string(), high.to_string()]
}

impl HMax {
    /// Nothing is said of a row without a stable loop to begin with.
    fn of(analysis: &Analysis) -> Self {
        let Some(range) = analysis.feedback_range().filter(|_| analysis.is_zero_stable()) else {
            return Self::default();
        };
        let irrational = range.irrational();
        Self {
            exact: range.exact().map(|exact| exact.to_string()),
            closed_form: irrational.as_ref().and_then(AlgebraicNumber::closed_form),
            polynomial: irrational.as_ref().map(|number| number.polynomial().to_text("h")),
            irreducible: irrational.as_ref().map(AlgebraicNumber::is_minimal),
            certified_interval: range.certified_interval().map(interval),
            value: Some(range.value()).filter(|value| value.is_finite()),
            unbounded: range.is_unbounded(),
        }
    }

    /// The range as a line of the card.
    fn sentence(&self) -> String {
        let Self { exact, closed_form, polynomial, irreducible, value, unbounded, .. } = self;
        match (exact.as_deref(), value) {
            _ if *unbounded => "every h > 0".to_owned(),
            (Some("0"), _) => "empty: no small h > 0 gives a stable loop".to_owned(),
            (Some(exact), Some(value)) if exact.contains('/') => format!("0 < h < {exact} = {value:.6}"),
            (Some(exact), _) => format!("0 < h < {exact}"),
            (None, Some(value)) => {
                let closed = closed_form.as_ref().map_or_else(String::new, |closed| format!("{closed} = "));
                let polynomial = polynomial.as_deref().unwrap_or("a polynomial");
                let minimal = if *irreducible == Some(true) { ", irreducible" } else { "" };
                format!("0 < h < {closed}{value:.12}, a root of {polynomial}{minimal}")
            }
            _ => "none: the weights of the feedback cancel".to_owned(),
        }
    }

    pub(super) fn text(&self) -> String {
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
        let remarks = checked.row().hints().iter().take(MOST_HINTS).map(ToString::to_string).collect();
        Self { remarks, toml, ..Self::new(checked.row(), checked.analysis(), problems) }
    }

    pub(super) fn with_remark(mut self, remark: &str) -> Self {
        self.remarks.push(remark.to_owned());
        self
    }

    fn new(row: &Row, analysis: &Analysis, problems: Vec<String>) -> Self {
        let weights = |list: &[Rational]| list.iter().map(ToString::to_string).collect();
        let closed_form = analysis.closed_form();
        let squared = closed_form.as_ref().and_then(|form| form.radius_squared.as_ref());
        Self {
            facts: Facts::new(row, analysis, problems.is_empty()),
            source: row.source().map(str::to_owned),
            attribution: row.attribution().map(str::to_owned),
            note: row.note().map(str::to_owned),
            alpha: weights(analysis.alpha()),
            beta: weights(analysis.beta()),
            gamma: weights(analysis.gamma()),
            per_step_constant: analysis.per_step_constant().map(ToString::to_string),
            root_moduli: analysis.root_moduli().to_vec(),
            roots: analysis.roots().iter().map(|z| [z.re, z.im]).collect(),
            recursion: recursion(analysis),
            h_opt_exact: closed_form.as_ref().map(|form| Exact::of(&form.h, "h")),
            r_opt_squared_exact: squared.map(|squared| Exact::of(squared, "R")),
            optimum_cause: closed_form.as_ref().map(|form| form.cause.words()),
            r_bound: analysis.radius_bound(),
            ssp_coefficient: analysis.ssp_coefficient().map(|c| c.to_string()),
            snippets: BTreeMap::new(),
            problems,
            remarks: Vec::new(),
            toml: None,
            spelling: spelling(row),
            has_root_at_one: analysis.order_defect(0).is_zero(),
        }
    }

    /// Adds the row in another language; then that is what is printed.
    pub(super) fn with_snippet(mut self, language: &'static str, text: String) -> Self {
        self.snippets.insert(language, text);
        self
    }

    /// What the exact verdict, and whether z = 1 is a root at all, say together.
    fn stability(&self) -> &'static str {
        match (self.facts.condition, self.has_root_at_one) {
            (RootCondition::StrictlyStable, true) => "zero-stable, with only z = 1 on the unit circle",
            (RootCondition::StrictlyStable, false) => {
                "all roots inside the unit circle; z = 1, a root of every consistent row, is none of them"
            }
            (RootCondition::WeaklyStable, true) => {
                "weakly stable: zero-stable, with further roots on the unit circle"
            }
            (RootCondition::WeaklyStable, false) => {
                "weakly stable: roots on the unit circle; z = 1, a root of every consistent row, is none of them"
            }
            (RootCondition::Unstable, _) if self.root_moduli.first().is_some_and(|most| *most > OUTSIDE) => {
                "NOT zero-stable, a root outside the unit circle: for study only, no plan runs on it"
            }
            (RootCondition::Unstable, _) => {
                "NOT zero-stable, a repeated root on the unit circle: for study only, no plan runs on it"
            }
        }
    }

    /// What is promised of arms, where there is a stable loop to begin with.
    fn in_control(&self, p: usize) -> Option<String> {
        let has_range = self.facts.h_max.unbounded || self.facts.h_max.value.is_some_and(|end| end > 0.0);
        let runs = self.facts.explicit && self.facts.strictly_zero_stable && has_range;
        runs.then(|| format!("task error O(sigma^{}) at fixed h, O(sigma^{p}) at fixed gain", p + 1))
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
        line("recursion", &self.recursion);
        let kind = [
            if self.facts.explicit { "explicit" } else { "implicit" },
            if self.facts.split { ", split feedback" } else { "" },
        ];
        let steps = if self.facts.steps == 1 { "step" } else { "steps" };
        line("kind", &format!("{} {steps}, {}", self.facts.steps, kind.concat()));
        match (&self.facts.order, &self.facts.error_constant, &self.per_step_constant) {
            (Some(p), Some(c), Some(per_step)) => {
                line(
                    "order",
                    &format!("{p}: x' = formula - ({c}) sigma^{p} x^({}), {per_step} per step", p + 1),
                );
                if let Some(promise) = self.in_control(*p) {
                    line("in control", &promise);
                }
            }
            _ => line("order", "none: the row is inconsistent"),
        }
        line("stability", self.stability());
        line("roots", &roots_text(&self.roots));
        line(
            "root moduli",
            &self.root_moduli.iter().map(|m| format!("{m:.6}")).collect::<Vec<_>>().join(", "),
        );
        if let Some(c) = self.ssp_coefficient.as_ref().filter(|_| self.facts.order.is_some()) {
            line("SSP", &format!("{c}: keeps what Euler's method keeps, up to {c} times its step"));
        }
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
        let range = match (self.facts.order, self.facts.zero_stable) {
            (None, _) => "none: the row is inconsistent".to_owned(),
            (_, false) => "none: the row is not zero-stable".to_owned(),
            _ => self.facts.h_max.sentence(),
        };
        line("feedback range", &range);
        self.optimum_lines(line);
        if let Some(noise) = &self.facts.noise_gain {
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

impl Card {
    fn optimum_lines(&self, line: &mut impl FnMut(&str, &str)) {
        let (Some(h), Some(r)) = (self.facts.h_opt, self.facts.r_opt) else { return };
        line("best h", &format!("{h:.6}, where errors decay by {r:.6} per step"));
        let Some(exact) = &self.h_opt_exact else {
            line("  exactly", "out of reach for a row of this length; the figures are numeric");
            self.bound_line(line);
            return;
        };
        let cause = self.optimum_cause.map_or_else(String::new, |cause| format!("; {cause}"));
        line("  h exactly", &format!("{}{cause}", exact.text()));
        match &self.r_opt_squared_exact {
            Some(squared) if squared.value == 0.0 => {}
            Some(squared) => line("  r^2 exactly", &squared.text()),
            None => line("  r^2 exactly", "not found; the figure is numeric"),
        }
        self.bound_line(line);
    }

    fn bound_line(&self, line: &mut impl FnMut(&str, &str)) {
        if let Some(bound) = self.r_bound.filter(|bound| *bound > 0.0) {
            line("  proved", &format!("no h of the range has a radius below {bound:.12}"));
        }
    }

    /// What is printed: the card, or the languages that were asked for.
    fn printed(&self) -> String {
        if self.snippets.is_empty() {
            self.text()
        } else {
            self.snippets.values().cloned().collect::<Vec<_>>().join("\n")
        }
    }
}

/// Roots as people write them, a pair once.
fn roots_text(roots: &[[f64; 2]]) -> String {
    let part = |x: f64| if x.abs() < 5e-7 { 0.0 } else { x };
    let upper = roots.iter().filter(|z| part(z[1]) >= 0.0);
    let text = upper.map(|&[re, im]| match (part(re), part(im)) {
        (re, 0.0) => format!("{re:.6}"),
        (re, im) => format!("{re:.6} +- {im:.6} i"),
    });
    text.collect::<Vec<_>>().join(", ")
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
        let cards: Vec<String> = self.formulas.iter().map(Card::printed).collect();
        cards.join("\n")
    }
}

impl Facts {
    pub(super) fn new(row: &Row, analysis: &Analysis, declared_ok: bool) -> Self {
        let constant = analysis.error_constant();
        let optimum = analysis.optimum();
        let noise = optimum.and_then(|optimum| analysis.noise_gain(optimum.h));
        Self {
            id: row.id().to_owned(),
            name: row.name().map(str::to_owned),
            family: row.family().map(str::to_owned),
            steps: analysis.steps(),
            order: analysis.order(),
            constant: constant.as_ref().and_then(Rational::to_f64),
            error_constant: constant.map(|c| c.to_string()),
            explicit: analysis.is_explicit(),
            split: analysis.is_split(),
            zero_stable: analysis.is_zero_stable(),
            strictly_zero_stable: analysis.is_strictly_zero_stable(),
            h_max: HMax::of(analysis),
            h_opt: optimum.map(|optimum| optimum.h),
            r_opt: optimum.map(|optimum| optimum.radius),
            noise_gain: noise.map(Noise::of),
            declared_ok,
            condition: analysis.root_condition(),
        }
    }

    pub(super) fn remark(&self) -> &'static str {
        match (self.declared_ok, self.zero_stable, self.strictly_zero_stable, self.explicit) {
            (false, ..) => "declares what is not so",
            (_, false, ..) => "unstable specimen",
            (_, _, false, _) => "weakly stable",
            (.., false) => "implicit, not run yet",
            _ => "",
        }
    }
}
