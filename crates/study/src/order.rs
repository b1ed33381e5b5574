//! The study itself: a ladder, what is claimed, and runs of planners, formulas or anything else with samples.

use super::convergence::{Convergence, Criteria, Mark};
use super::ladder::{Ladder, Rung};
use super::measure::Measure;
use super::problem::Problem;
use super::reference::started;
use super::round_off::jitter;
use super::samples::{Errors, Samples};
use kinstep::formula::Formula;
use kinstep::integrate::{IntegrateError, Ode, Starter, Status};
use kinstep::planner::{ArmPlan, Plan, Planner};
use nalgebra::Vector6;
use std::fmt;

/// A jitter that still falls by this much at each of the last two pairs of rungs is signal, not round-off.
const STILL_FALLING: f64 = 0.6;

/// A grid with a sample at every time of every rung may have this many times the samples of the finest rung.
const MOST_COMMON: f64 = 16.0;

/// The orders that a study is to confirm; where none is claimed, it says what was seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Orders {
    /// Of the solution of an ODE.
    pub formula: Option<usize>,
    /// Of the task error of a plan.
    pub task: Option<usize>,
    /// Of the joint trajectory against the exact flow.
    pub joint: Option<usize>,
}

impl Orders {
    /// What a formula of order `p` promises at a fixed step `h`: task `p + 1`, joints and ODEs `p`.
    pub fn at_fixed_step(p: usize) -> Self {
        Self { formula: Some(p), task: Some(p + 1), joint: Some(p) }
    }

    /// What a formula of order `p` promises at a fixed gain `k`, where `h` shrinks with `sigma`: `p` throughout.
    pub fn at_fixed_gain(p: usize) -> Self {
        Self { formula: Some(p), task: Some(p), joint: Some(p) }
    }
}

/// The errors of the runs of a solution of an ODE, and what they are judged by.
pub(super) struct Judged {
    pub(super) errors: Vec<Errors>,
    /// The rungs that do not count, and why.
    pub(super) left_out: Vec<Option<Mark>>,
    /// Of the numbers that the runs are made of.
    pub(super) resolution: f64,
    /// Of the reference.
    pub(super) uncertainty: f64,
}

/// What a study found.
#[derive(Clone, Debug, PartialEq)]
pub struct OrderReport {
    /// The rungs, coarsest first.
    pub rungs: Vec<Rung>,
    /// The solution of an ODE, largest error over the whole run.
    pub formula: Option<Convergence>,
    /// The solution of an ODE, largest error over the second half of the run.
    pub formula_steady: Option<Convergence>,
    /// The solution of an ODE, error of the last sample.
    pub formula_end_point: Option<Convergence>,
    /// The solution of an ODE, root of the mean square over the run.
    pub formula_mean_square: Option<Convergence>,
    /// The task error, largest over the whole run and all arms, start-up included.
    pub task_transient: Option<Convergence>,
    /// The task error, largest over the second half of the run.
    pub task_steady: Option<Convergence>,
    /// The task error of the last sample.
    pub task_end_point: Option<Convergence>,
    /// The task error, root of the mean square over the run of the worst arm.
    pub task_mean_square: Option<Convergence>,
    /// The joint positions against a reference run on the same grid points, largest over the whole run.
    pub joint: Option<Convergence>,
    /// Runs that stopped, and why.
    pub notes: Vec<String>,
}

impl OrderReport {
    pub(super) fn empty(ladder: &Ladder) -> Self {
        Self {
            rungs: ladder.rungs().collect(),
            formula: None,
            formula_steady: None,
            formula_end_point: None,
            formula_mean_square: None,
            task_transient: None,
            task_steady: None,
            task_end_point: None,
            task_mean_square: None,
            joint: None,
            notes: Vec::new(),
        }
    }

    /// The sampling gaps \[s\], coarsest first.
    pub fn sigmas(&self) -> Vec<f64> {
        self.rungs.iter().map(|rung| rung.sigma).collect()
    }

    /// What was seen by a measure: of the task error of a plan, or of the solution of an ODE.
    pub fn measured(&self, measure: Measure) -> Option<&Convergence> {
        let (task, formula) = match measure {
            Measure::Maximum => (&self.task_transient, &self.formula),
            Measure::Steady => (&self.task_steady, &self.formula_steady),
            Measure::EndPoint => (&self.task_end_point, &self.formula_end_point),
            Measure::MeanSquare => (&self.task_mean_square, &self.formula_mean_square),
        };
        task.as_ref().or(formula.as_ref())
    }

    /// What was seen of the solution of an ODE, by every measure.
    pub(super) fn of_solution(&mut self) -> impl Iterator<Item = &mut Convergence> {
        let parts = [
            &mut self.formula,
            &mut self.formula_steady,
            &mut self.formula_end_point,
            &mut self.formula_mean_square,
        ];
        parts.into_iter().flatten()
    }

    /// The kinds of error studied, by key.
    pub fn parts(&self) -> impl Iterator<Item = (&'static str, &Convergence)> {
        [
            ("formula", &self.formula),
            ("formula_steady", &self.formula_steady),
            ("formula_end_point", &self.formula_end_point),
            ("formula_mean_square", &self.formula_mean_square),
            ("task_transient", &self.task_transient),
            ("task_steady", &self.task_steady),
            ("task_end_point", &self.task_end_point),
            ("task_mean_square", &self.task_mean_square),
            ("joint", &self.joint),
        ]
        .into_iter()
        .filter_map(|(key, part)| Some((key, part.as_ref()?)))
    }
}

/// What a key of [`OrderReport::parts`] means, in words.
fn words(key: &str) -> &'static str {
    match key {
        "formula" => "solution, largest over the whole run",
        "formula_steady" => "solution, largest over the second half",
        "formula_end_point" => "solution, last sample",
        "formula_mean_square" => "solution, root mean square",
        "task_transient" => "task error, largest over the whole run",
        "task_steady" => "task error, largest over the second half",
        "task_end_point" => "task error, last sample",
        "task_mean_square" => "task error, root mean square",
        _ => "joint positions, largest over the whole run",
    }
}

impl fmt::Display for OrderReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (key, part) in self.parts() {
            writeln!(f, "{} (floor {:.1e}): {}", words(key), part.floor, part.verdict)?;
            if let Some(fit) = &part.fit {
                let (order, width, count) = (fit.order, fit.half_width, fit.to - fit.from);
                writeln!(f, "    fitted to {count} rungs: {order:.3} +- {width:.3} (95 %)")?;
            }
            for (i, rung) in self.rungs.iter().enumerate() {
                let slope = i.checked_sub(1).map(|pair| part.slopes[pair]).filter(|slope| slope.is_finite());
                let slope = slope.map_or_else(String::new, |slope| format!("{slope:.3}"));
                let (sigma, error, mark) = (rung.sigma, part.errors[i], part.marks[i].name());
                writeln!(f, "    sigma {sigma:<12.6e} error {error:<10.3e} slope {slope:<7} {mark}")?;
            }
        }
        self.notes.iter().try_for_each(|note| writeln!(f, "{note}"))
    }
}

/// A ladder of sampling gaps, the orders claimed, and how strictly to judge.
///
/// ```
/// use kinstep::formula::FormulaTable;
/// use kinstep_study::{Ladder, OrderStudy, Orders, Problem};
///
/// let formula = FormulaTable::builtin().get("la6-wang-guo")?;
/// let study = OrderStudy::new(Ladder::halvings(Problem::SWING.duration, 64, 6)?);
/// let report = study.claiming(Orders::at_fixed_step(3)).of_formula(formula, &Problem::SWING)?;
/// assert!(report.formula.is_some_and(|seen| seen.verdict.is_confirmed()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct OrderStudy {
    ladder: Ladder,
    orders: Orders,
    criteria: Criteria,
}

impl OrderStudy {
    /// A study over `ladder` that claims nothing and judges by the default [`Criteria`].
    pub fn new(ladder: Ladder) -> Self {
        Self { ladder, orders: Orders::default(), criteria: Criteria::default() }
    }

    /// The same with orders to confirm. They are not read from what runs: a wrong claim has to be possible.
    #[must_use]
    pub fn claiming(mut self, orders: Orders) -> Self {
        self.orders = orders;
        self
    }

    /// The same with criteria of your own.
    #[must_use]
    pub fn judged_by(mut self, criteria: Criteria) -> Self {
        self.criteria = criteria;
        self
    }

    /// Studies the task error of the plans that `planner(sigma)` makes.
    ///
    /// Hold `h` fixed in the closure to see order `p + 1`, or the gain to see `p`.
    ///
    /// # Errors
    /// What the closure returns.
    pub fn of_planner<E>(&self, planner: impl Fn(f64) -> Result<Planner, E>) -> Result<OrderReport, E> {
        let mut report = OrderReport::empty(&self.ladder);
        let mut errors = Vec::new();
        for rung in self.ladder.rungs() {
            let plan = run(&planner, rung, &mut report.notes)?;
            errors.push(plan.as_ref().map_or(Errors::NONE, task_errors));
        }
        self.judge_task(&mut report, &errors);
        Ok(report)
    }

    /// The same, and the joint positions against plans of `reference(sigma)`: a formula of higher order, say. It is run with a
    /// sample at every time at which some rung has one, and once more with twice as many; what the
    /// two differ by is the floor of the joint errors.
    ///
    /// # Errors
    /// What the closures return.
    pub fn of_planner_against<E>(
        &self,
        planner: impl Fn(f64) -> Result<Planner, E>,
        reference: impl Fn(f64) -> Result<Planner, E>,
    ) -> Result<OrderReport, E> {
        let mut report = OrderReport::empty(&self.ladder);
        let common =
            self.ladder.common().filter(|common| common.steps as f64 <= MOST_COMMON * self.longest());
        let (mut coarse, mut fine) = (None, None);
        if let Some(common) = common {
            coarse = run(&reference, common, &mut report.notes)?;
            fine = run(&reference, self.ladder.rung(2 * common.steps), &mut report.notes)?;
        } else {
            report.notes.push("the joints are not studied: the gaps of the ladder have no common grid of moderate size; choose gaps in simple ratios".to_owned());
        }
        let (mut errors, mut joint) = (Vec::new(), Vec::new());
        for rung in self.ladder.rungs() {
            let plan = run(&planner, rung, &mut report.notes)?;
            errors.push(plan.as_ref().map_or(Errors::NONE, task_errors));
            let both = plan.as_ref().zip(fine.as_ref());
            joint.push(both.map_or(f64::NAN, |(plan, reference)| joint_error(plan, reference)));
        }
        self.judge_task(&mut report, &errors);
        // Without a reference nothing can be said, whatever the floor.
        let between = coarse.zip(fine).map_or(f64::INFINITY, |(coarse, fine)| joint_error(&coarse, &fine));
        let scale = errors.iter().map(|errors| errors.scale).fold(1.0, f64::max);
        let floor = between.max(f64::EPSILON * scale * self.longest().sqrt());
        report.joint = Some(self.judge(&joint, floor, self.orders.joint));
        Ok(report)
    }

    /// Studies a formula on an ODE, started sufficiently well ([`Starter::sufficient_for`]).
    ///
    /// # Errors
    /// [`IntegrateError`] for a row that may not run.
    pub fn of_formula(&self, formula: &Formula, problem: &Problem) -> Result<OrderReport, IntegrateError> {
        let starter = Starter::sufficient_for(formula.order());
        self.of_samples(problem.exact, |rung| integrate(formula, &starter, problem, rung))
    }

    /// Studies any integrator: `run(rung)` returns its samples at `0, sigma, ..., T`, and `exact(t, state)` writes the solution.
    ///
    /// Fewer samples than the rung has steps count as a run that stopped.
    ///
    /// # Errors
    /// What the closure returns.
    pub fn of_samples<E>(
        &self,
        exact: impl Fn(f64, &mut [f64]),
        run: impl Fn(Rung) -> Result<Samples, E>,
    ) -> Result<OrderReport, E> {
        let mut report = OrderReport::empty(&self.ladder);
        let mut errors = Vec::new();
        for rung in self.ladder.rungs() {
            let samples = run(rung)?;
            errors.push(if samples.steps() == rung.steps {
                Errors::against(&samples, rung.sigma, &exact)
            } else {
                report.notes.push(format!(
                    "the run at sigma = {} s gave {} of {} steps",
                    rung.sigma,
                    samples.steps(),
                    rung.steps
                ));
                Errors::NONE
            });
        }
        let left_out = vec![None; errors.len()];
        self.judge_formula(
            &mut report,
            &Judged { errors, left_out, resolution: f64::EPSILON, uncertainty: 0.0 },
        );
        Ok(report)
    }

    pub(super) fn ladder(&self) -> &Ladder {
        &self.ladder
    }

    fn judge_task(&self, report: &mut OrderReport, errors: &[Errors]) {
        let floor = floor(errors, f64::EPSILON);
        let part = |measure| Some(self.judge_measured(errors, measure, floor, self.orders.task));
        report.task_transient = part(Measure::Maximum);
        report.task_steady = part(Measure::Steady);
        report.task_end_point = part(Measure::EndPoint);
        report.task_mean_square = part(Measure::MeanSquare);
    }

    /// Judges the errors of solutions of an ODE.
    pub(super) fn judge_formula(&self, report: &mut OrderReport, judged: &Judged) {
        // Rounding errors of single steps add up like a random walk.
        let rounding = floor(&judged.errors, judged.resolution) * self.longest().sqrt();
        let floor = rounding.max(judged.uncertainty);
        let part = |measure| {
            let picked: Vec<f64> = judged.errors.iter().map(|errors| errors.measured(measure)).collect();
            let sigmas = self.ladder.sigmas();
            let claimed = self.orders.formula;
            Some(Convergence::judge_without(
                &sigmas,
                &picked,
                floor,
                claimed,
                &self.criteria,
                &judged.left_out,
            ))
        };
        report.formula = part(Measure::Maximum);
        report.formula_steady = part(Measure::Steady);
        report.formula_end_point = part(Measure::EndPoint);
        report.formula_mean_square = part(Measure::MeanSquare);
    }

    fn judge_measured(
        &self,
        errors: &[Errors],
        measure: Measure,
        floor: f64,
        claimed: Option<usize>,
    ) -> Convergence {
        let picked: Vec<f64> = errors.iter().map(|errors| errors.measured(measure)).collect();
        self.judge(&picked, floor, claimed)
    }

    fn judge(&self, errors: &[f64], floor: f64, claimed: Option<usize>) -> Convergence {
        Convergence::judge(&self.ladder.sigmas(), errors, floor, claimed, &self.criteria)
    }

    /// Steps of the finest run.
    fn longest(&self) -> f64 {
        self.ladder.rungs().map(|rung| rung.steps).max().unwrap_or(1) as f64
    }
}

/// Runs the planner of a rung; `None` and a note for a plan that stopped or that is not on the rung's grid.
fn run<E>(
    planner: &impl Fn(f64) -> Result<Planner, E>,
    rung: Rung,
    notes: &mut Vec<String>,
) -> Result<Option<Plan>, E> {
    let plan = planner(rung.sigma)?.run();
    if plan.steps != rung.steps {
        let (sigma, steps, planned) = (rung.sigma, rung.steps, plan.steps);
        notes.push(format!("at sigma = {sigma} s the plan has {planned} steps where the ladder has {steps}: give both one duration"));
        return Ok(None);
    }
    if !plan.is_completed() {
        let reason = plan.reason.as_deref().unwrap_or("no reason given");
        notes.push(format!("the run at sigma = {} s ended `{}`: {reason}", rung.sigma, plan.status.name()));
        return Ok(None);
    }
    Ok(Some(plan))
}

fn task_errors(plan: &Plan) -> Errors {
    let most = |pick: fn(&ArmPlan) -> f64| plan.arms.iter().map(pick).fold(0.0, f64::max);
    let rough = |arm: &ArmPlan| {
        let steady = &arm.errors[arm.errors.len() / 2..];
        let series = |row: usize| steady.iter().map(|error| error[row]).collect::<Vec<_>>();
        (0..6).filter_map(|row| jitter(&series(row))).fold(0.0, f64::max)
    };
    let mean_square = |arm: &ArmPlan| {
        let sum: f64 = arm.errors.iter().map(Vector6::norm_squared).sum();
        (sum / arm.errors.len().max(1) as f64).sqrt()
    };
    Errors {
        transient: most(|arm| arm.max_error),
        steady: most(|arm| arm.max_error_steady),
        end_point: most(|arm| arm.errors.last().map_or(f64::NAN, Vector6::norm)),
        mean_square: most(mean_square),
        jitter: most(rough),
        scale: most(|arm| arm.positions.iter().fold(1.0, |most: f64, q| most.max(q.abs()))),
    }
}

/// The largest difference of joint positions between a plan and a reference with a multiple of its samples.
fn joint_error(plan: &Plan, reference: &Plan) -> f64 {
    let stride = reference.steps / plan.steps;
    let mut most = 0.0_f64;
    for (arm, truth) in plan.arms.iter().zip(&reference.arms) {
        for n in 0..=plan.steps {
            let pairs = arm.position(n).iter().zip(truth.position(n * stride));
            most = pairs.fold(most, |most, (q, truth)| most.max((q - truth).abs()));
        }
    }
    most
}

/// The round-off that the finest run shows, or that its numbers can not go below.
///
/// Rough errors can be signal too, of parasitic roots for instance. That falls from rung to rung, which round-off does not.
fn floor(errors: &[Errors], resolution: f64) -> f64 {
    let run: Vec<&Errors> = errors.iter().filter(|errors| errors.transient.is_finite()).collect();
    let least = run.iter().map(|errors| errors.scale).fold(0.0, f64::max) * 2.0 * resolution;
    let last = &run[run.len().saturating_sub(3)..];
    let falls = last.windows(2).all(|pair| pair[1].jitter < STILL_FALLING * pair[0].jitter);
    match last.last() {
        Some(finest) if !falls => finest.jitter.max(least),
        _ => least,
    }
}

fn integrate(
    formula: &Formula,
    starter: &Starter<f64>,
    problem: &Problem,
    rung: Rung,
) -> Result<Samples, IntegrateError> {
    let mut field = Ode::new(problem.dimension, problem.derivative);
    let mut stepper = started(formula, starter, &field, rung.sigma, &problem.initial())?;
    let mut states = stepper.state().to_vec();
    for _ in 0..rung.steps {
        if stepper.step(&mut field) != Status::Running {
            break;
        }
        states.extend_from_slice(stepper.state());
    }
    Ok(Samples { dimension: problem.dimension, states })
}
