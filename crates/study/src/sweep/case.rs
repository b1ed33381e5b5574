//! The cases of a sweep, by their numbers, and what came of each.

use super::axis::Axis;
use kinstep::math::random::mix;
use kinstep::planner::{Plan, Planner, run_together};
use kinstep_files::scenario::{FormulaRows, ScenarioError, ScenarioText};

/// Scenarios, what varies in them, and how often distributions are drawn.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// The scenarios with their names.
    pub scenarios: Vec<(String, ScenarioText)>,
    /// What varies; the last axis varies fastest.
    pub axes: Vec<Axis>,
    /// How often the distributions are drawn for every combination of the lists. The draws are the same for all
    /// combinations, so that these can be compared.
    pub samples: usize,
    /// What the draws depend on.
    pub seed: u64,
}

/// One run of a sweep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Case {
    /// Its number.
    pub index: usize,
    /// Which scenario.
    pub scenario: usize,
    /// The value of every axis.
    pub values: Vec<String>,
}

/// What came of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// The case.
    pub case: Case,
    /// How the run ended, or `refused`.
    pub status: &'static str,
    /// Why it ended early or was refused.
    pub reason: Option<String>,
    /// What was run; nothing where it was refused.
    pub figures: Option<Figures>,
}

/// The figures of a run, the worst over its arms.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    pub(super) formula: String,
    pub(super) start: &'static str,
    pub(super) steps: usize,
    /// In the order of [`Figures::NAMES`].
    pub(super) numbers: [f64; 10],
}

impl Figures {
    pub(super) const NAMES: [&'static str; 10] = [
        "sigma",
        "h",
        "max_error",
        "max_error_component",
        "max_error_steady",
        "rms_error_steady",
        "max_position_error",
        "max_orientation_error",
        "smallest_singular_value",
        "limit_violations",
    ];

    fn of(plan: &Plan) -> Self {
        let worst =
            |pick: fn(&kinstep::planner::ArmPlan) -> f64| plan.arms.iter().map(pick).fold(0.0, f64::max);
        Self {
            formula: plan.formula.clone(),
            start: plan.start,
            steps: plan.steps,
            numbers: [
                plan.sigma,
                plan.h,
                worst(|arm| arm.max_error),
                worst(|arm| arm.max_error_component),
                worst(|arm| arm.max_error_steady),
                worst(|arm| arm.rms_error_steady),
                worst(|arm| arm.max_position_error),
                worst(|arm| arm.max_orientation_error),
                plan.arms.iter().map(|arm| arm.smallest_singular_value.0).fold(f64::INFINITY, f64::min),
                plan.arms.iter().map(|arm| arm.violations.len()).sum::<usize>() as f64,
            ],
        }
    }
}

impl Sweep {
    /// The number of cases; nothing where there are more than numbers.
    pub fn len(&self) -> Option<usize> {
        let lists = self.axes.iter().try_fold(self.scenarios.len(), |all, axis| all.checked_mul(axis.len()));
        lists?.checked_mul(self.draws())
    }

    /// Whether there is nothing to run.
    pub fn is_empty(&self) -> bool {
        self.len() == Some(0)
    }

    fn draws(&self) -> usize {
        if self.axes.iter().any(Axis::is_random) { self.samples } else { 1 }
    }

    /// The case of that number.
    pub fn case(&self, index: usize) -> Case {
        let (mut rest, draw) = (index / self.draws(), index % self.draws());
        let mut places = vec![0; self.axes.len()];
        for (place, axis) in places.iter_mut().zip(&self.axes).rev() {
            *place = rest % axis.len();
            rest /= axis.len();
        }
        let values = self.axes.iter().zip(&places).enumerate().map(|(k, (axis, &place))| {
            axis.value(place, mix(mix(self.seed ^ mix(draw as u64)).wrapping_add(k as u64)))
        });
        Case { index, scenario: rest, values: values.collect() }
    }

    /// The scenario of a case, with its values laid over it.
    ///
    /// # Errors
    /// [`ScenarioError`] for a key or a value that no scenario has.
    pub fn text(&self, case: &Case) -> Result<ScenarioText, ScenarioError> {
        let mut text = self.scenarios[case.scenario].1.clone();
        for (axis, value) in self.axes.iter().zip(&case.values) {
            text.set(&format!("{}={value}", axis.key()))?;
        }
        Ok(text)
    }

    /// Runs a case.
    pub fn run(&self, index: usize, rows: &FormulaRows) -> Record {
        self.run_all(&[index], rows).remove(0)
    }

    /// Runs cases, those alike [together](run_together); the records are the same as one by one.
    pub fn run_all(&self, indices: &[usize], rows: &FormulaRows) -> Vec<Record> {
        let (mut planners, mut records) = (Vec::new(), Vec::with_capacity(indices.len()));
        for &index in indices {
            let case = self.case(index);
            match self.planner(&case, rows) {
                Ok(planner) => {
                    planners.push(planner);
                    records.push(Record { case, status: "", reason: None, figures: None });
                }
                Err(refusal) => {
                    let reason = Some(refusal.message);
                    records.push(Record { case, status: "refused", reason, figures: None });
                }
            }
        }
        let started = records.iter_mut().filter(|record| record.reason.is_none());
        for (record, plan) in started.zip(run_together(planners)) {
            record.status = plan.status.name();
            record.figures = Some(Figures::of(&plan));
            record.reason = plan.reason;
        }
        records
    }

    fn planner(&self, case: &Case, rows: &FormulaRows) -> Result<Planner, ScenarioError> {
        let text = self.text(case)?;
        let scenario = text.scenario()?;
        let table = rows.table_for(scenario.formula.as_deref().unwrap_or_default())?;
        scenario.planner(table, text.folder())
    }
}
