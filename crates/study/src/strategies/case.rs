//! Whole order studies of random formulas on random arms and paths.

use super::{
    ArmCase, FormulaCase, PathCase, TimeLawCase, arms, feedback_steps, formulas, overshooting_steps,
    path_spec, paths, time_laws,
};
use crate::{Ladder, OrderReport, OrderStudy, Orders, Rung};
use kinstep::formula::{Formula, FormulaTable};
use kinstep::integrate::Starter;
use kinstep::planner::{Arm, Feedback, Plan, Planner, PlannerError};
use kinstep::robot::Chain;
use kinstep::task::Motion;
use kinstep_files::scenario::{self, Scenario, StudySpec};
use num_traits::ToPrimitive;
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::fmt;

/// How long every path takes \[s\].
const DURATION: f64 = 4.0;
/// Errors decay at least this fast at every rung.
const RADIUS: f64 = 0.95;
/// And grow at least this fast where the run is to diverge.
const GROWTH: f64 = 1.02;
/// Growth over a run that is to diverge: enough to lift round-off to the size of the arm.
const TOTAL_GROWTH: f64 = 1e18;
/// The error of the coarsest run is at most this fraction of the path's extent.
const RESOLVED: f64 = 0.05;
/// At how many samples of a run it is looked at, about.
const SAMPLES: usize = 128;
/// The condition number of the Jacobian stays below this along the path.
const CONDITION: f64 = 100.0;

/// A formula, an arm, a path and a ladder; what is claimed of them stands apart, so that a lie can be told.
#[derive(Clone)]
pub struct OrderCase {
    /// The row that runs.
    pub formula: FormulaCase,
    /// The arm.
    pub arm: ArmCase,
    /// The path.
    pub path: PathCase,
    /// The time law.
    pub time_law: TimeLawCase,
    /// The feedback, by step or by gain.
    pub feedback: Feedback,
    /// The start.
    pub start: Starter<f64>,
    /// The sampling gaps.
    pub ladder: Ladder,
    /// The orders claimed.
    pub orders: Orders,
    chain: Chain,
    smallest_singular_value: f64,
}

impl OrderCase {
    /// The arm on its path.
    fn planner_arm(&self) -> Arm {
        let q0 = self.arm.q0();
        let start = self.chain.forward(&q0, &mut self.chain.scratch()).pose();
        let path = self.path.path(self.smallest_singular_value);
        let motion = Motion::from_pose(path, self.time_law.law(), DURATION, &start);
        Arm::new("arm", self.chain.clone(), q0, self.arm.task, motion)
    }

    /// The planner at a sampling gap \[s\].
    ///
    /// # Errors
    /// What the builder refuses.
    pub fn planner(&self, sigma: f64) -> Result<Planner, PlannerError> {
        self.planner_with(self.formula.formula(), self.feedback, self.start.clone(), sigma)
    }

    fn planner_with(
        &self,
        formula: &Formula,
        feedback: Feedback,
        start: Starter<f64>,
        sigma: f64,
    ) -> Result<Planner, PlannerError> {
        let builder = Planner::builder().formula(formula).sigma(sigma).duration(DURATION).feedback(feedback);
        builder.start(start).arm(self.planner_arm()).build()
    }

    /// Studies the task error.
    ///
    /// # Errors
    /// What the planner's builder refuses.
    pub fn study(&self) -> Result<OrderReport, PlannerError> {
        self.order_study().of_planner(|sigma| self.planner(sigma))
    }

    /// Studies the task error, and the joint positions against runs of `reference` at its step `h`.
    ///
    /// # Errors
    /// What the planner's builder refuses.
    pub fn study_against(&self, reference: &Formula, h: f64) -> Result<OrderReport, PlannerError> {
        self.order_study().of_planner_against(
            |sigma| self.planner(sigma),
            |sigma| self.planner_with(reference, Feedback::Step(h), Starter::Sufficient, sigma),
        )
    }

    fn order_study(&self) -> OrderStudy {
        OrderStudy::new(self.ladder.clone()).claiming(self.orders)
    }

    /// Whether the coarsest run follows its path at all: an error of the path's own size says nothing about orders.
    fn resolves_its_path(&self) -> bool {
        let extent = self.path.extent(self.smallest_singular_value);
        let plan =
            self.ladder.rungs().next().and_then(|rung| self.planner(rung.sigma).ok()).map(Planner::run);
        plan.is_some_and(|plan| plan.is_completed() && plan.arms[0].max_error <= RESOLVED * extent)
    }

    /// The largest condition number of the task Jacobian along the coarsest and the finest run; infinite where one stops.
    pub fn worst_condition(&self) -> f64 {
        let mut rungs = self.ladder.rungs();
        let ends = [rungs.next(), rungs.last()];
        ends.into_iter().flatten().map(|rung| self.condition_along(rung)).fold(0.0, f64::max)
    }

    fn condition_along(&self, rung: Rung) -> f64 {
        let Some(plan) = self.planner(rung.sigma).ok().map(Planner::run).filter(Plan::is_completed) else {
            return f64::INFINITY;
        };
        let condition = |n: usize| {
            let (smallest, largest) = self.arm.singular_values(&self.chain, plan.arms[0].position(n));
            largest / smallest
        };
        (0..=plan.steps).step_by((plan.steps / SAMPLES).max(1)).map(condition).fold(0.0, f64::max)
    }

    fn assemble(
        (formula, arm, path, time_law): (FormulaCase, ArmCase, PathCase, TimeLawCase),
        feedback: Feedback,
        ladder: Ladder,
        orders: Orders,
    ) -> Option<Self> {
        let chain = arm.chain()?;
        let (smallest_singular_value, _) = arm.singular_values(&chain, &arm.q0());
        let start = Starter::Sufficient;
        let case = Self {
            formula,
            arm,
            path,
            time_law,
            feedback,
            start,
            ladder,
            orders,
            chain,
            smallest_singular_value,
        };
        (case.resolves_its_path() && case.worst_condition() < CONDITION).then_some(case)
    }
}

impl OrderCase {
    /// The case as a scenario, with its robot and its row inside: `kinstep order` runs what the study runs.
    pub fn scenario(&self) -> Scenario {
        let row = self.formula.to_string();
        let id = self.formula.formula().id().to_owned();
        let is_builtin = FormulaTable::builtin().get(&id).is_ok();
        let (h, gain) = match self.feedback {
            Feedback::Step(h) => (Some(h.into()), None),
            Feedback::Gain(gain) => (None, Some(gain.into())),
        };
        let start = self.start.kind();
        let steps: Vec<usize> = self.ladder.rungs().map(|rung| rung.steps).collect();
        let arm = scenario::ArmSpec {
            name: "arm".to_owned(),
            robot: self.arm.urdf(),
            base: "base".to_owned(),
            tip: "tip".to_owned(),
            task: self.arm.task.into(),
            q0: self.arm.q0().into_iter().map(Into::into).collect(),
            start_pose: None,
            mount: scenario::Mount::default(),
            tool: scenario::Mount::default(),
            approach: None,
            approach_tolerance: None,
            calibration: None,
            limits: None,
            lock: BTreeMap::new(),
            independent: false,
            assume_unlimited: false,
            path: Some(path_spec(&self.path, self.smallest_singular_value, self.arm.task, self.time_law)),
        };
        Scenario {
            sigma: (DURATION / steps.first().copied().unwrap_or(1) as f64).into(),
            duration: DURATION.into(),
            formula: Some(id),
            start,
            formulas: if is_builtin { Vec::new() } else { vec![row] },
            allow_unstable: false,
            law: scenario::LawSpec { h, gain, ..scenario::LawSpec::default() },
            noise: None,
            study: Some(StudySpec { steps: Some(steps), order: self.orders.task, ..StudySpec::default() }),
            problem: None,
            arm: vec![arm],
            relation: Vec::new(),
            collision: None,
            obstacle: Vec::new(),
        }
    }
}

/// A scenario file that does again what the case did.
impl fmt::Display for OrderCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "# Save this as case.toml; `kinstep order case.toml` runs it again.")?;
        f.write_str(&self.scenario().to_toml())
    }
}

impl fmt::Debug for OrderCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\n{self}")
    }
}

fn parts() -> impl Strategy<Value = (FormulaCase, ArmCase, PathCase, TimeLawCase)> {
    (formulas(), arms(), paths(), time_laws())
}

/// Studies at a fixed step `h` with `r(h) <= 0.95` and a condition number below 100 along the path; claimed is the task order `p + 1`.
pub fn order_at_fixed_step() -> impl Strategy<Value = OrderCase> {
    (parts(), any::<prop::sample::Index>()).prop_filter_map(
        "a usable step, and well conditioned along the path",
        |(parts, pick)| {
            let steps = feedback_steps(parts.0.formula(), RADIUS);
            let h = *steps.get(pick.index(steps.len().max(1)))?;
            let orders = Orders::at_fixed_step(parts.0.formula().order());
            let ladder = ladder_for(orders.task?)?;
            OrderCase::assemble(parts, Feedback::Step(h), ladder, orders)
        },
    )
}

/// Studies at a fixed gain `k` with `r(h) <= 0.95` at the step `h` of every rung and a condition number below 100 along the path;
/// claimed is the task order `p`.
pub fn order_at_fixed_gain() -> impl Strategy<Value = OrderCase> {
    parts().prop_filter_map("usable steps at every rung, and well conditioned along the path", |parts| {
        let formula = parts.0.formula();
        let orders = Orders::at_fixed_gain(formula.order());
        let (h, ladder) = gain_ladder(formula)?;
        let sigma = ladder.rungs().next()?.sigma;
        let gain = h / (sigma * formula.gamma_sum().to_f64()?);
        OrderCase::assemble(parts, Feedback::Gain(gain), ladder, orders)
    })
}

/// A ladder on which errors of that order pass from coarse to the round-off floor.
fn ladder_for(order: usize) -> Option<Ladder> {
    match order {
        0..=3 => Ladder::halvings(DURATION, 256, 5),
        4 => Ladder::halvings(DURATION, 128, 7),
        // Where the loop forgets slowly, the order comes out late: these go on until round-off ends them.
        5 => Ladder::half_octaves(DURATION, 128, 12),
        _ => Ladder::half_octaves(DURATION, 96, 13),
    }
    .ok()
}

/// The step of the coarsest rung and a ladder on which the steps that a fixed gain gives stay within the decay asked for.
fn gain_ladder(formula: &Formula) -> Option<(f64, Ladder)> {
    const RUNGS: usize = 9;
    let steps = feedback_steps(formula, RADIUS);
    // Small steps give clean slopes: begin in the lower half of what there is.
    let h = steps[..steps.len().div_ceil(2)].last().copied()?;
    // The ladder is short, because the step shrinks with sigma: it has to begin where paths are well resolved.
    let coarsest = if formula.order() <= 4 { 512 } else { 256 };
    let rungs = Ladder::half_octaves(DURATION, coarsest, RUNGS).ok()?;
    let usable = rungs.rungs().take_while(|rung| {
        let here = h * coarsest as f64 / rung.steps as f64;
        formula.feedback_range().contains(here) && formula.spectral_radius(here) <= RADIUS
    });
    let usable = usable.count();
    (usable >= 4)
        .then(|| Ladder::half_octaves(DURATION, coarsest, usize::min(usable, RUNGS)).ok())
        .flatten()
        .map(|ladder| (h, ladder))
}

/// A run whose step lies beyond the range, long enough to show it.
#[derive(Clone)]
pub struct UnstableCase {
    /// The parts; its ladder and claims have no meaning here.
    pub case: OrderCase,
    /// The step.
    pub h: f64,
    /// The spectral radius there.
    pub radius: f64,
    /// Steps of the run.
    pub steps: usize,
}

impl UnstableCase {
    /// The planner, with permission to be unstable.
    ///
    /// # Errors
    /// What the builder refuses.
    pub fn planner(&self) -> Result<Planner, PlannerError> {
        let sigma = DURATION / self.steps as f64;
        let formula = self.case.formula.formula();
        let builder = Planner::builder().formula(formula).sigma(sigma).duration(DURATION).h(self.h);
        builder.allow_unstable(true).arm(self.case.planner_arm()).build()
    }
}

impl fmt::Debug for UnstableCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\nh = {}, r(h) = {:.4}, {} steps\n{}", self.h, self.radius, self.steps, self.case)
    }
}

/// Runs at a step with `r(h) >= 1.02`, long enough that even round-off grows to the size of the arm.
pub fn diverging() -> impl Strategy<Value = UnstableCase> {
    (order_at_fixed_step(), any::<prop::sample::Index>()).prop_filter_map(
        "a step beyond the range",
        |(case, pick)| {
            let formula = case.formula.formula();
            let steps = overshooting_steps(formula, GROWTH);
            let h = *steps.get(pick.index(steps.len().max(1)))?;
            let radius = formula.spectral_radius(h);
            let steps = (TOTAL_GROWTH.ln() / radius.ln()).ceil().max(128.0) as usize;
            Some(UnstableCase { case, h, radius, steps })
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ScenarioStudy;
    use kinstep_files::scenario::ScenarioText;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]

        #[test]
        fn what_is_printed_runs_again_and_shows_the_same(case in order_at_fixed_step()) {
            let text = ScenarioText::parse(&case.to_string()).unwrap();
            let scenario = text.scenario().unwrap();
            let rows = scenario.formula_rows(None).unwrap();
            let again = ScenarioStudy::new(&scenario, None, &rows, &[]).unwrap().run().unwrap().remove(0);
            let first = case.study().unwrap().task_transient.unwrap();
            prop_assert_eq!(again.seen.verdict.name(), first.verdict.name());
            // Lengths are rounded once more on the way through the file.
            for (one, other) in again.seen.errors.iter().zip(&first.errors) {
                prop_assert!((one / other - 1.0).abs() < 1e-3 || (one - other).abs() < 1e-13, "{} {}", one, other);
            }
        }
    }
}
