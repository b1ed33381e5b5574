//! The order study of a scenario: its ladder, its rows, and what each row is held to.

use super::convergence::{Convergence, Criteria, Mark, Undecidable, Verdict};
use super::ladder::Ladder;
use super::measure::Measure;
use super::order::{OrderReport, OrderStudy, Orders};
use super::reference::Reference;
use super::soundness;
use kinstep::formula::{Duty, Formula, FormulaTable, NotRunnable};
use kinstep::integrate::{Elementary, Equations, IntegrateError, Starter};
use kinstep::math::DoubleDouble;
use kinstep::planner::Planner;
use kinstep_files::scenario::{
    ErrorKind, FormulaRows, KeyPath, MeasureKind, Precision, Real, Scenario, ScenarioError, StarterKind,
    StudySpec,
};
use num_traits::ToPrimitive;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// The most steps of a run.
const MOST_STEPS: f64 = 1e7;
/// Rungs of the ladder that is chosen where none is given: from 8 sigma to sigma / 8.
const RUNGS: usize = 13;
/// A chosen ladder begins where a fixed gain gives at most this fraction of the feedback range.
const OF_RANGE: f64 = 0.6;
/// From this order on, errors on arms meet the floor of doubles before slopes have settled.
const HIGH_ORDER: usize = 6;
/// The row that joint trajectories are compared with, and its feedback step.
const JOINT_REFERENCE: (&str, f64) = ("split-ab8", 1.0);
/// What is said where the stated solution would blame a row that the equations' own does not.
const NOT_AS_STATED: &str = "compared with the equations solved with 32 digits: against `problem.exact` the order was not reached, so that it is not the solution that they have from this start, or can not be judged by";
/// Tolerances of the extrapolation for runs in doubles and with 32 digits.
const TOLERANCES: (f64, f64) = (1e-26, 1e-30);

/// What a scenario holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Studied {
    /// Arms: task errors and joint trajectories.
    Arms,
    /// An initial value problem: errors of its solution.
    Problem,
}

/// What was seen of one row.
#[derive(Clone, Debug)]
pub struct RowStudy {
    /// The row.
    pub id: String,
    /// The row's own order.
    pub order: usize,
    /// The feedback step, where there is one and it is held fixed.
    pub h: Option<f64>,
    /// The start.
    pub start: &'static str,
    /// The order that is claimed of the measure of the study; nothing where the start decides.
    pub claimed: Option<usize>,
    /// What was seen.
    pub report: OrderReport,
    /// What the study's measure says.
    pub seen: Convergence,
}

impl RowStudy {
    /// Whether the finest run came to its end.
    pub fn is_finished(&self) -> bool {
        let ended = |(error, mark): (&f64, &Mark)| error.is_finite() || *mark == Mark::NoReference;
        self.seen.errors.iter().zip(&self.seen.marks).next_back().is_some_and(ended)
    }
}

/// The study that a scenario asks for.
#[derive(Debug)]
pub struct ScenarioStudy {
    scenario: Scenario,
    folder: Option<PathBuf>,
    table: FormulaTable,
    rows: Vec<Formula>,
    ladder: Ladder,
    measure: Measure,
    criteria: Criteria,
    problem: Option<(Equations, Reference)>,
    /// Whether the problem's own solution is what runs are compared with.
    is_stated: bool,
}

impl ScenarioStudy {
    /// Reads what is to be studied: the rows `ids` where some are given, else the scenario's own and those of its
    /// `[study]`. Robot files are looked for from `folder`.
    ///
    /// # Errors
    /// [`ScenarioError`] with the key at fault: an unknown, lying, unstable or implicit row, gaps that do not divide the
    /// duration.
    pub fn new(
        scenario: &Scenario,
        folder: Option<&Path>,
        rows: &FormulaRows,
        ids: &[String],
    ) -> Result<Self, ScenarioError> {
        scenario.check()?;
        refuse_noise(scenario)?;
        let spec = scenario.study.clone().unwrap_or_default();
        let rows_studied = chosen_rows(scenario, &spec, rows, ids)?;
        let ladder = ladder(scenario, &spec, &rows_studied)?;
        let default = Criteria::default();
        let criteria = Criteria {
            tolerance: spec.tolerance.as_ref().map_or(default.tolerance, Real::value),
            floor_margin: spec.floor_margin.as_ref().map_or(default.floor_margin, Real::value),
        };
        let table = rows.table_for("")?.clone();
        let mut is_stated = false;
        let problem = match scenario.equations()? {
            Some(equations) => {
                let off = soundness::check(&equations, ladder.duration())
                    .map_err(|fault| at_fault(scenario, &equations, fault))?;
                let reference = reference(&equations, &ladder, &spec, rows)?;
                is_stated =
                    matches!(spec.reference.as_deref(), None | Some("exact")) && equations.has_exact();
                Some((equations, if is_stated { reference.less_certain(off) } else { reference }))
            }
            None => None,
        };
        let measure = spec.measure.map_or(Measure::Maximum, measure);
        let (scenario, folder) = (scenario.clone(), folder.map(Path::to_owned));
        Ok(Self {
            scenario,
            folder,
            table,
            rows: rows_studied,
            ladder,
            measure,
            criteria,
            problem,
            is_stated,
        })
    }

    /// The sampling gaps.
    pub fn ladder(&self) -> &Ladder {
        &self.ladder
    }

    /// The number that sums up the errors of a run and that the verdict is about.
    pub fn measure(&self) -> Measure {
        self.measure
    }

    /// What is asked of errors before they count.
    pub fn criteria(&self) -> Criteria {
        self.criteria
    }

    /// What the scenario holds.
    pub fn studied(&self) -> Studied {
        if self.problem.is_some() { Studied::Problem } else { Studied::Arms }
    }

    /// Runs all rows, in parallel; the result does not depend on how many threads there are.
    ///
    /// # Errors
    /// [`ScenarioError`] where a plan of the ladder is refused.
    pub fn run(&self) -> Result<Vec<RowStudy>, ScenarioError> {
        let studies: Vec<_> = self.rows.par_iter().map(|row| self.study_row(row)).collect();
        studies.into_iter().collect()
    }

    fn study_row(&self, row: &Formula) -> Result<RowStudy, ScenarioError> {
        let claims = self.claims(row);
        let study = OrderStudy::new(self.ladder.clone()).claiming(claims).judged_by(self.criteria);
        let extended =
            self.scenario.study.as_ref().and_then(|spec| spec.precision) == Some(Precision::Extended);
        let of_problem = |equations: &Equations, reference: &Reference| {
            if extended {
                self.of_problem::<DoubleDouble>(row, &study, equations, reference)
            } else {
                self.of_problem::<f64>(row, &study, equations, reference)
            }
        };
        let mut report = match &self.problem {
            Some((equations, reference)) => of_problem(equations, reference),
            None => self.of_arms(row, &study),
        }?;
        let measured = |report: &OrderReport| {
            report
                .measured(self.measure)
                .cloned()
                .expect("studies of arms and of problems fill every measure")
        };
        let mut seen = measured(&report);
        if let Some((equations, _)) =
            self.problem.as_ref().filter(|_| self.is_stated && seen.verdict.is_not_reached())
        {
            // Before a row is blamed, the solution that is stated has to be the one that the equations have from the start.
            let reference = Reference::extended(equations, &self.ladder, tolerance(extended));
            let second = of_problem(equations, &reference)?;
            let seen_again = measured(&second);
            if !seen_again.verdict.is_not_reached() {
                (report, seen) = (second, seen_again);
                report.notes.insert(0, NOT_AS_STATED.to_owned());
            }
        }
        let claimed = if self.problem.is_some() { claims.formula } else { claims.task };
        Ok(RowStudy {
            id: row.id().to_owned(),
            order: row.order(),
            h: if self.problem.is_some() { None } else { self.fixed_step(row).0 },
            start: self.start::<f64>(row).name(),
            claimed,
            report,
            seen,
        })
    }

    fn of_problem<T: Elementary>(
        &self,
        row: &Formula,
        study: &OrderStudy,
        equations: &Equations,
        reference: &Reference,
    ) -> Result<OrderReport, ScenarioError> {
        study.of_equations::<T>(row, &self.start(row), equations, reference).map_err(|e| refused(row, &e))
    }

    fn of_arms(&self, row: &Formula, study: &OrderStudy) -> Result<OrderReport, ScenarioError> {
        let (step, note) = self.fixed_step(row);
        let planner = |sigma: f64| {
            let mut scenario = self.at(sigma, row.id());
            if step.is_some() {
                scenario.law.h = step.map(Real::from);
            }
            self.plan(&scenario)
        };
        let exact = |sigma: f64| {
            let mut scenario = self.at(sigma, JOINT_REFERENCE.0);
            scenario.law.h = Some(JOINT_REFERENCE.1.into());
            scenario.law.gain = None;
            scenario.start = Some(StarterKind::Rk8);
            self.plan(&scenario)
        };
        let finest = self.ladder.sigmas().last().copied().unwrap_or(self.ladder.duration());
        let mut less_smooth = None;
        let mut report = match exact(finest) {
            Ok(reference) => {
                less_smooth = reference.smoothness().filter(|&smooth| smooth < row.order());
                study.of_planner_against(planner, exact)?
            }
            Err(refusal) => {
                let mut report = study.of_planner(planner)?;
                report.notes.push(format!("the joints are not studied: {refusal}"));
                report
            }
        };
        report.notes.splice(0..0, note.into_iter().chain(self.without_effect()));
        report.notes.extend(limit_of_doubles(row, &report));
        report.notes.extend(less_smooth.map(|smooth| {
            format!(
                "the motion of the arms has {smooth} continuous derivatives only: errors fall like sigma^{} at best, which is not the row's doing",
                smooth + 1
            )
        }));
        Ok(report)
    }

    /// Keys of the study that say nothing about arms.
    fn without_effect(&self) -> Vec<String> {
        let Some(spec) = &self.scenario.study else { return Vec::new() };
        let precision = (spec.precision == Some(Precision::Extended)).then_some(
            "study.precision = \"extended\" has no effect: arms are run in doubles; it acts on problems",
        );
        let reference = spec.reference.is_some().then_some(
            "study.reference has no effect: the task error of arms is measured itself, and their joints are compared with a run of high order; it acts on problems",
        );
        precision.into_iter().chain(reference).map(str::to_owned).collect()
    }

    fn at(&self, sigma: f64, id: &str) -> Scenario {
        let mut scenario = self.scenario.clone();
        scenario.sigma = sigma.into();
        scenario.formula = Some(id.to_owned());
        scenario
    }

    fn plan(&self, scenario: &Scenario) -> Result<Planner, ScenarioError> {
        scenario.planner(&self.table, self.folder.as_deref())
    }

    /// The feedback step that is held for a row, unless the gain is: the scenario's own where the row's range has it,
    /// else the row's best one, with a sentence that says so.
    fn fixed_step(&self, row: &Formula) -> (Option<f64>, Option<String>) {
        let best = row.optimum().map(|optimum| optimum.h);
        let own = self.scenario.formula.as_deref() == Some(row.id());
        match (&self.scenario.law.h, &self.scenario.law.gain) {
            (None, Some(_)) => (None, None),
            (None, None) => (best, None),
            (Some(h), _) if own || row.feedback_range().contains(h.value()) => (Some(h.value()), None),
            (Some(h), _) => {
                let instead = best.map_or_else(|| "none".to_owned(), |best| format!("{best:.4}"));
                let note = format!(
                    "h = {h} lies outside the feedback range {} of {}: its best step, {instead}, was taken instead",
                    row.feedback_range(),
                    row.id()
                );
                (best, Some(note))
            }
        }
    }

    fn start<T: Elementary>(&self, row: &Formula) -> Starter<T> {
        match self.scenario.start {
            None => Starter::sufficient_for(row.order()),
            Some(StarterKind::Ramp) => {
                let rows = (1..row.steps()).map_while(|known| self.table.ramp(row, known).cloned());
                Starter::Rows(rows.collect())
            }
            Some(kind) => kind.into(),
        }
    }

    /// What a row promises here. A start of low order leaves a transient of its own, unless the motion begins at rest: then
    /// nothing is claimed of the whole run.
    fn claims(&self, row: &Formula) -> Orders {
        let p = row.order();
        let start = self.start::<f64>(row).order().unwrap_or(p);
        let sufficient = start >= p || row.steps() == 1;
        let claimed = self.scenario.study.as_ref().and_then(|spec| spec.order);
        let step = self.fixed_step(row).0;
        let task = match step {
            Some(h) if h > 0.0 => p + 1,
            _ => p,
        };
        let whole = |order| (sufficient || self.measure == Measure::Steady).then_some(order);
        Orders {
            formula: claimed.or(Some(if sufficient { p } else { p.min(start + 1) })),
            task: claimed.or(whole(task)),
            joint: sufficient.then_some(p),
        }
    }
}

/// The line of a problem that is at fault.
fn at_fault(scenario: &Scenario, equations: &Equations, fault: soundness::Fault) -> ScenarioError {
    let spec = scenario.problem.as_ref();
    let lines = spec.map(|spec| match fault.list {
        "exact" => &spec.exact,
        "initial" => &spec.initial,
        _ => &spec.equations,
    });
    let name = &equations.unknowns()[fault.unknown];
    let is_of = |line: &String| {
        line.split('=').next().is_some_and(|before| before.trim().trim_end_matches('\'').trim_end() == name)
    };
    let list = KeyPath::dotted("problem").key(fault.list);
    let at = lines
        .and_then(|lines| lines.iter().position(is_of))
        .map_or_else(|| list.clone(), |line| list.index(line));
    ScenarioError::at(ErrorKind::Scenario, &at, fault.message)
}

fn measure(kind: MeasureKind) -> Measure {
    match kind {
        MeasureKind::Maximum => Measure::Maximum,
        MeasureKind::Steady => Measure::Steady,
        MeasureKind::EndPoint => Measure::EndPoint,
        MeasureKind::MeanSquare => Measure::MeanSquare,
    }
}

fn refused(row: &Formula, error: &IntegrateError) -> ScenarioError {
    let kind = if matches!(error, IntegrateError::NotRunnable(_)) {
        ErrorKind::Formula
    } else {
        ErrorKind::Scenario
    };
    ScenarioError::new(kind, format!("{}: {error}", row.id()))
}

/// The rows to be studied, each once, all of them runnable.
fn chosen_rows(
    scenario: &Scenario,
    spec: &StudySpec,
    rows: &FormulaRows,
    ids: &[String],
) -> Result<Vec<Formula>, ScenarioError> {
    let own = scenario.formula.clone().or_else(|| {
        let best = FormulaTable::builtin().best_for(&Duty::default());
        best.map(|(formula, _)| formula.id().to_owned())
    });
    let listed = own.into_iter().chain(spec.formulas.iter().cloned());
    let wanted: Vec<String> = if ids.is_empty() { listed.collect() } else { ids.to_vec() };
    let mut chosen: Vec<Formula> = Vec::new();
    for id in wanted {
        if chosen.iter().any(|row| row.id() == id) {
            continue;
        }
        let at = match spec.formulas.iter().position(|listed| *listed == id) {
            Some(index) => KeyPath::dotted("study.formulas").index(index),
            None => KeyPath::dotted("formula"),
        };
        // What was asked for on the command line is not the scenario's fault.
        let refuse = |kind, problem: String| {
            if ids.is_empty() {
                ScenarioError::at(kind, &at, problem)
            } else {
                ScenarioError::new(kind, format!("--formula {id}: {problem}"))
            }
        };
        let table =
            rows.table_for(&id).map_err(|e| if ids.is_empty() { e } else { refuse(e.kind, e.message) })?;
        let row = table.get(&id).map_err(|e| refuse(ErrorKind::Scenario, e.to_string()))?;
        runs(row, scenario).map_err(|e| refuse(ErrorKind::Formula, e))?;
        chosen.push(row.clone());
    }
    Ok(chosen)
}

/// Says whether a row can run: on arms explicit ones with a feedback range, on a problem also those that are solved.
fn runs(row: &Formula, scenario: &Scenario) -> Result<(), String> {
    let is_problem = scenario.problem.is_some();
    let runnable =
        if is_problem || scenario.allow_unstable { row.runnable() } else { row.runnable_with_feedback() };
    match runnable {
        Err(NotRunnable::Implicit { .. }) if is_problem => Ok(()),
        other => other.map_err(|e| e.to_string()),
    }
}

/// Arms are run in doubles. Where these do not reach far enough to decide, the same row shows its order with more digits.
fn limit_of_doubles(row: &Formula, report: &OrderReport) -> Option<String> {
    let task = [&report.task_transient, &report.task_steady].into_iter().flatten();
    let ends_at_floor = |seen: &Convergence| {
        matches!(
            seen.verdict,
            Verdict::Undecidable(Undecidable::AtFloor { .. } | Undecidable::TooFewRungs { .. })
        )
    };
    (row.order() >= HIGH_ORDER && task.into_iter().any(ends_at_floor)).then(|| {
        format!(
            "arms are run in doubles, where rounding hides errors of so high an order; with 32 digits it shows in `kinstep order kepler --formula {} --set study.precision=extended`",
            row.id()
        )
    })
}

/// Noise does not fall with the gap: it would hide every order.
fn refuse_noise(scenario: &Scenario) -> Result<(), ScenarioError> {
    if scenario.noise.as_ref().is_none_or(|spec| spec.noise().is_silent()) {
        return Ok(());
    }
    let problem = "no order can be seen through noise; take the table [noise] away, or set its numbers to 0";
    Err(ScenarioError::at(ErrorKind::Scenario, &KeyPath::dotted("noise"), problem))
}

fn ladder(scenario: &Scenario, spec: &StudySpec, rows: &[Formula]) -> Result<Ladder, ScenarioError> {
    let duration = scenario.duration.value();
    let refuse =
        |key: &str, problem: String| ScenarioError::at(ErrorKind::Scenario, &KeyPath::dotted(key), problem);
    if let Some(steps) = &spec.steps {
        return Ladder::from_steps(duration, steps.iter().copied())
            .map_err(|e| refuse("study.steps", e.to_string()));
    }
    if let Some(sigmas) = &spec.sigmas {
        let sigmas: Vec<f64> = sigmas.iter().map(Real::value).collect();
        if let Some(fine) = sigmas.iter().find(|&&sigma| duration / sigma > MOST_STEPS) {
            return Err(refuse("study.sigmas", too_fine(*fine, duration)));
        }
        return Ladder::from_sigmas(duration, &sigmas).map_err(|e| refuse("study.sigmas", e.to_string()));
    }
    let sigma = coarsest(scenario, rows).unwrap_or(8.0 * scenario.sigma.value());
    let finest = sigma / f64::from(1 << (RUNGS / 2));
    if duration / finest > MOST_STEPS {
        return Err(refuse("sigma", too_fine(finest, duration)));
    }
    let history = rows.iter().map(Formula::steps).max().unwrap_or(1);
    let coarsest = even_share(scenario).filter(|_| scenario.law.gain.is_none());
    let coarsest = coarsest.unwrap_or((duration / sigma).ceil() as usize).max(3 * history).max(8);
    Ladder::half_octaves(duration, coarsest, RUNGS).map_err(|e| refuse("duration", e.to_string()))
}

/// The steps of a rung some halvings coarser than the scenario's own, such that its own gap is among the rungs.
fn even_share(scenario: &Scenario) -> Option<usize> {
    let own = (scenario.duration.value() / scenario.sigma.value()).round() as usize;
    [8, 4, 2, 1].into_iter().find(|halvings| own.is_multiple_of(2 * halvings)).map(|halvings| own / halvings)
}

fn too_fine(sigma: f64, duration: f64) -> String {
    let steps = duration / sigma;
    format!("a gap of {sigma:e} s makes {steps:.1e} steps; a study takes at most {MOST_STEPS:.0e} a run")
}

/// The coarsest gap that keeps a fixed gain well inside the feedback ranges; nothing where h is fixed.
fn coarsest(scenario: &Scenario, rows: &[Formula]) -> Option<f64> {
    let gain = scenario.law.gain.as_ref()?.value();
    let of_row = |row: &Formula| {
        OF_RANGE * row.feedback_range().value() / (gain * row.gamma_sum().to_f64().unwrap_or(f64::NAN))
    };
    let most = rows.iter().map(of_row).fold(f64::INFINITY, f64::min);
    Some(most.min(8.0 * scenario.sigma.value()))
}

/// The tolerance of a reference for runs in doubles, or with 32 digits.
fn tolerance(extended: bool) -> f64 {
    if extended { TOLERANCES.1 } else { TOLERANCES.0 }
}

fn reference(
    equations: &Equations,
    ladder: &Ladder,
    spec: &StudySpec,
    rows: &FormulaRows,
) -> Result<Reference, ScenarioError> {
    let at = KeyPath::dotted("study.reference");
    let extended = spec.precision == Some(Precision::Extended);
    let tolerance = tolerance(extended);
    match spec.reference.as_deref() {
        None => Ok(Reference::exact(equations, ladder)
            .unwrap_or_else(|| Reference::extended(equations, ladder, tolerance))),
        Some("extended") => Ok(Reference::extended(equations, ladder, tolerance)),
        Some("exact") => Reference::exact(equations, ladder).ok_or_else(|| {
            let problem = "the problem states no exact solution; give `problem.exact`, or \"extended\" here";
            ScenarioError::at(ErrorKind::Scenario, &at, problem)
        }),
        Some(id) => {
            let row = rows.table_for(id)?.get(id).map_err(|e| {
                let problem = format!("neither \"exact\" nor \"extended\" nor a formula: {e}");
                ScenarioError::at(ErrorKind::Scenario, &at, problem)
            })?;
            let run = if extended {
                Reference::by_formula::<DoubleDouble>(row, equations, ladder)
            } else {
                Reference::by_formula::<f64>(row, equations, ladder)
            };
            run.map_err(|e| ScenarioError::at(ErrorKind::Formula, &at, e))
        }
    }
}
