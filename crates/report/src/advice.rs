//! What would make a plan better.

use super::plan_text::duration_within_limits;
use kinstep::formula::{Formula, FormulaTable};
use kinstep::math::number_text;
use kinstep::planner::{Plan, PlanStatus};
use kinstep_files::scenario::Scenario;

/// Something to try next.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Suggestion {
    /// Arguments of `kinstep plan` beside the scenario.
    pub arguments: String,
    /// What that is good for.
    pub reason: String,
}

impl Suggestion {
    /// Returns a suggestion of these arguments for that reason.
    pub fn new(arguments: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { arguments: arguments.into(), reason: reason.into() }
    }
}

/// Returns what to try next after this plan of `scenario`, whose formula stands in `table`.
pub fn suggestions(plan: &Plan, table: &FormulaTable, scenario: &Scenario) -> Vec<Suggestion> {
    let mut next = Vec::new();
    let Ok(formula) = table.get(&plan.formula) else { return next };
    let best = formula.optimum().map(|optimum| format!("{:.3}", optimum.h));
    if plan.status == PlanStatus::Diverged && !formula.feedback_range().contains(plan.h) {
        next.extend(
            best.map(|h| Suggestion::new(format!("--set law.h={h}"), "the formula's best feedback step")),
        );
    }
    if !plan.is_completed() {
        return next;
    }
    if let Some(longer) = duration_within_limits(plan) {
        let reason = "slow enough for what limits the joints' motion";
        next.push(Suggestion::new(format!("--set duration={longer}"), reason));
    }
    if errors_follow_the_order(plan, formula) {
        let halvings = formula.order() + usize::from(scenario.law.gain.is_none());
        let held = if scenario.law.gain.is_some() { "gain" } else { "h" };
        let (power, because) = match plan.smoothness.map(|smooth| smooth + 1) {
            Some(power) if power < halvings => (power, "as smooth as the path is".to_owned()),
            _ => (halvings, format!("order {} at the same {held}", formula.order())),
        };
        let why = format!("errors about {} times smaller: {because}", 1_u64 << power.min(60));
        next.push(Suggestion::new(format!("--set sigma={}", number_text(plan.sigma / 2.0)), why));
    }
    if plan.formula != "split-ab6" {
        let arguments = "--set formula=split-ab6 --set law.h=1 --set start=rk8";
        next.push(Suggestion::new(arguments, "a deadbeat loop of order 6"));
    }
    next
}

/// Whether a smaller gap may be promised to make the errors smaller: they stand above the round-off and are not those of
/// noise, and the loop is fast enough to settle within the run.
fn errors_follow_the_order(plan: &Plan, formula: &Formula) -> bool {
    const ROUND_OFF: f64 = 1e-13;
    const SETTLED: f64 = 1e-3;
    let worst = plan.arms.iter().map(|arm| arm.max_error).fold(0.0, f64::max);
    let left_over = formula.spectral_radius(plan.h).powf(plan.steps as f64 / 2.0);
    worst > ROUND_OFF && left_over < SETTLED && plan.noise.is_none()
}
