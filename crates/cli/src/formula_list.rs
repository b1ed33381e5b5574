//! The formulas as a list: all or some of them, in their own order or the best first.

use serde::Serialize;

use super::arguments::{FormulaList as Wanted, SortKey};
use super::failure::Failure;
use super::formula_card::Facts;
use super::output::Show;
use kinstep::formula::{DerivativeRule, Duty, FormulaTable, Row};
use kinstep_report::{Table, short};

/// One line per formula.
#[derive(Serialize)]
pub(super) struct FormulaList {
    formulas: Vec<Facts>,
    #[serde(skip)]
    is_narrow: bool,
}

/// Below this many columns of text, the figures at h_opt are left out.
const WIDE: usize = 110;

impl FormulaList {
    /// Returns the lines of the formulas wanted.
    pub(super) fn new(table: &FormulaTable, own_rows: Vec<Row>, wanted: &Wanted) -> Result<Self, Failure> {
        check_families(table, &own_rows, &wanted.family)?;
        let is_wanted = |row: &Row, steps: usize, order: Option<usize>, zero_stable: bool| {
            let family = row.family().unwrap_or_default();
            (wanted.family.is_empty() || wanted.family.iter().any(|name| name == family))
                && wanted.steps.is_none_or(|(low, high)| (low..=high).contains(&steps))
                && wanted.order.is_none_or(|(low, high)| order.is_some_and(|p| (low..=high).contains(&p)))
                && (zero_stable || !wanted.zero_stable)
        };
        let builtin = table
            .iter()
            .filter(|f| is_wanted(f.row(), f.steps(), Some(f.order()), f.is_zero_stable()))
            .map(|formula| Facts::new(formula.row(), formula.analysis(), true));
        let own = own_rows.into_iter().map(Row::check).filter_map(|checked| {
            let analysis = checked.analysis();
            let wanted =
                is_wanted(checked.row(), analysis.steps(), analysis.order(), analysis.is_zero_stable());
            wanted.then(|| Facts::new(checked.row(), analysis, checked.contradictions().is_empty()))
        });
        let mut formulas: Vec<Facts> = builtin.chain(own).collect();
        if let Some(key) = wanted.sort {
            sort(&mut formulas, key);
        }
        let columns = std::env::var("COLUMNS").ok().and_then(|columns| columns.parse::<usize>().ok());
        Ok(Self { formulas, is_narrow: columns.is_some_and(|columns| columns < WIDE) })
    }

    pub(super) fn is_sound(&self) -> bool {
        self.formulas.iter().all(|line| line.declared_ok)
    }
}

fn check_families(table: &FormulaTable, own_rows: &[Row], wanted: &[String]) -> Result<(), Failure> {
    let mut known: Vec<&str> = Vec::new();
    let own = own_rows.iter().filter_map(|row| row.family());
    for family in table.iter().map(kinstep::formula::Formula::family).chain(own) {
        if !known.contains(&family) {
            known.push(family);
        }
    }
    match wanted.iter().find(|name| !known.contains(&name.as_str())) {
        Some(name) => Err(Failure::usage(format!(
            "there is no family \"{name}\"; the families are {}",
            known.join(", ")
        ))),
        None => Ok(()),
    }
}

/// Puts the best first; lines without the figure keep their order at the end.
fn sort(lines: &mut [Facts], key: SortKey) {
    if key == SortKey::Id {
        return lines.sort_by(|a, b| a.id.cmp(&b.id));
    }
    let rank = |line: &Facts| {
        let rank = match key {
            SortKey::Order => line.order.map(|order| -(order as f64)),
            SortKey::Range if line.h_max.unbounded => Some(f64::NEG_INFINITY),
            SortKey::Range => line.h_max.value.filter(|h| *h > 0.0).map(|h| -h),
            SortKey::ErrorConstant => line.constant.map(f64::abs),
            SortKey::Decay => line.r_opt,
            SortKey::Noise => line.noise_gain.as_ref().map(|noise| noise.feedforward_per_sigma),
            SortKey::Id => None,
        };
        rank.unwrap_or(f64::INFINITY)
    };
    lines.sort_by(|a, b| rank(a).total_cmp(&rank(b)));
}

impl Show for FormulaList {
    fn text(&self) -> String {
        let wide = ["h_opt", "r_opt", "noise"];
        let figures = if self.is_narrow { &wide[..0] } else { &wide[..] };
        let head = ["id", "family", "steps", "order", "c", "h_max"];
        let mut table = Table::new(head.iter().chain(figures).chain(&[""]).copied());
        for line in &self.formulas {
            let dash = || "-".to_owned();
            let constant = match &line.error_constant {
                Some(exact) if exact.len() <= 9 => exact.clone(),
                _ => line.constant.map_or_else(dash, short),
            };
            let order = line.order.map_or_else(dash, |order| order.to_string());
            let noise = line.noise_gain.as_ref().map(|noise| noise.feedforward_per_sigma);
            let figures = [line.h_opt, line.r_opt, noise].map(|figure| figure.map_or_else(dash, short));
            let figures = figures.into_iter().take(if self.is_narrow { 0 } else { 3 });
            let family = line.family.clone().unwrap_or_default();
            let facts = [line.id.clone(), family, line.steps.to_string(), order, constant, line.h_max.text()];
            table.row(facts.into_iter().chain(figures).chain([line.remark().to_owned()]));
        }
        if self.formulas.is_empty() {
            return "No formula is like that.\n".to_owned();
        }
        let figures = if self.is_narrow {
            ""
        } else {
            "h_opt, r_opt: best feedback step and its decay per step; noise: gain from the feedforward velocity there, per sigma.\n"
        };
        format!(
            "{table}\n{} formulas; c: error constant; 0 < h < h_max: feedback steps with a stable loop.\n{figures}\
             `kinstep formula show ID` shows one in full.\n",
            self.formulas.len()
        )
    }
}

/// The row to use for each kind, and the one for plans that name none.
#[derive(Serialize)]
pub(super) struct Recommended {
    default: Option<String>,
    recommended: Vec<RecommendedLine>,
}

#[derive(Serialize)]
struct RecommendedLine {
    steps: usize,
    order: usize,
    id: String,
    h_opt: f64,
    steady_error: f64,
    recovery_steps: f64,
    noise: f64,
    compared: usize,
    why: String,
}

impl Recommended {
    /// Returns the recommendations of a table among the formulas wanted.
    pub(super) fn new(table: &FormulaTable, wanted: &Wanted) -> Result<Self, Failure> {
        check_families(table, &[], &wanted.family)?;
        let inside =
            |span: Option<(usize, usize)>, n| span.is_none_or(|(low, high)| (low..=high).contains(&n));
        let of_family = table.of_families(&wanted.family);
        let lines = of_family.recommended();
        let recommended = lines
            .iter()
            .filter(|r| inside(wanted.steps, r.steps) && inside(wanted.order, r.order))
            .map(|r| RecommendedLine {
                steps: r.steps,
                order: r.order,
                id: r.formula.id().to_owned(),
                h_opt: r.merit.h,
                steady_error: r.merit.steady,
                recovery_steps: r.merit.recovery,
                noise: r.merit.noise,
                compared: r.compared,
                why: r.why.clone(),
            })
            .collect();
        let default = table.best_for(&Duty::default()).map(|(formula, _)| formula.id().to_owned());
        Ok(Self { default, recommended })
    }
}

impl Show for Recommended {
    fn text(&self) -> String {
        let mut table = Table::new(["steps", "order", "use", "h_opt", "|C|/h", "recovery", "noise", "why"]);
        for line in &self.recommended {
            let numbers = [short(line.h_opt), short(line.steady_error)];
            let last = [format!("{:.0}", line.recovery_steps.ceil()), short(line.noise), line.why.clone()];
            let kind = [line.steps.to_string(), line.order.to_string(), line.id.clone()];
            table.row(kind.into_iter().chain(numbers).chain(last));
        }
        let default = self.default.as_ref().map_or_else(String::new, |id| {
            format!("A plan that names no formula runs on {id}: the least residual in the standard duty (docs/formulas.md).\n")
        });
        format!(
            "{table}\nOf its kind, each has the least product of steady error |C|/h, recovery (steps until a disturbance is\n\
             a thousandth) and gain from feedforward noise, at its own h_opt.\n{default}"
        )
    }
}

/// The rules for derivatives.
#[derive(Serialize)]
pub(super) struct RuleList {
    derivative_rules: Vec<RuleLine>,
}

#[derive(Serialize)]
struct RuleLine {
    id: String,
    name: String,
    order: usize,
    error_constant: String,
    noise_gain: f64,
    weights: Vec<String>,
    source: String,
}

impl RuleList {
    pub(super) fn new(order: Option<(usize, usize)>) -> Self {
        let line = |rule: &DerivativeRule| RuleLine {
            id: rule.id().to_owned(),
            name: rule.name().to_owned(),
            order: rule.order(),
            error_constant: rule.error_constant().to_string(),
            noise_gain: rule.noise_gain(),
            weights: rule.weights().iter().map(ToString::to_string).collect(),
            source: rule.source().to_owned(),
        };
        let wanted =
            |rule: &&DerivativeRule| order.is_none_or(|(low, high)| (low..=high).contains(&rule.order()));
        Self { derivative_rules: DerivativeRule::builtin().iter().filter(wanted).map(line).collect() }
    }
}

impl Show for RuleList {
    fn text(&self) -> String {
        let mut table = Table::new(["id", "order", "c", "noise", "weights of x_n, x_n-1, ..."]);
        for rule in &self.derivative_rules {
            let cells = [rule.id.clone(), rule.order.to_string(), rule.error_constant.clone()];
            table.row(cells.into_iter().chain([format!("{:.4}", rule.noise_gain), rule.weights.join(" ")]));
        }
        format!("{table}\nrule = x' + c sigma^order x^(order+1); noise: gain from the samples, over sigma.\n")
    }
}
