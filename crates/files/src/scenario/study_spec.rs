//! Initial value problems, and how the order of a run is studied.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::error::{ErrorKind, ScenarioError};
use super::key_path::KeyPath;
use super::model::Scenario;
use kinstep::integrate::{Direction, EquationText, Equations};
use kinstep::kind::Real;

/// The most rungs of a ladder.
const MOST_RUNGS: usize = 64;
/// The most steps of a rung.
const MOST_STEPS: usize = 10_000_000;

/// An initial value problem x' = f(t, x) from t = 0, in place of arms. Lines are `name = expression`; expressions
/// have numbers, names, `t`, `pi`, + - * / ^, comparisons (1 where they hold, else 0), parentheses and sin, cos, tan, asin, acos,
/// atan, atan2, sinh, cosh, tanh, exp, ln, sqrt, abs, sign, min and max.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table [problem] with equations and initial")]
pub struct ProblemSpec {
    /// What it is and where it is from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// Whether explicit formulas need far shorter steps for stability than for accuracy.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stiff: bool,
    /// Names with a value.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub parameters: BTreeMap<String, Real>,
    /// Short names for parts of the equations, each using earlier ones only: "r3 = (x^2 + y^2)^1.5".
    #[serde(default, rename = "where", skip_serializing_if = "Vec::is_empty")]
    pub definitions: Vec<String>,
    /// The derivative of every unknown: "x' = u".
    pub equations: Vec<String>,
    /// The value of every unknown at t = 0: "x = 1".
    pub initial: Vec<String>,
    /// The solution as a function of t, where it is known: "x = cos(t)".
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub exact: Vec<String>,
    /// What may happen, where an expression crosses zero, for `kinstep ode`: "ground: y", or { event = "ground: y", direction =
    /// "falling", terminal = true }.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub events: Vec<EventSpec>,
    /// A state that is known from elsewhere, for `kinstep ode`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<ReferenceSpec>,
}

/// Something that happens where an expression crosses zero.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(
    untagged,
    expecting = "\"name: expression\", or a table with `event` and, where needed, `direction` and `terminal`"
)]
pub enum EventSpec {
    /// In either direction, without an end: "name: expression".
    Plain(String),
    /// With more to say.
    Table(EventTable),
}

/// An event with its direction, and whether it ends the solution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct EventTable {
    /// The name and the expression: "name: expression".
    pub event: String,
    /// In which direction the expression crosses zero. Default: any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<CrossingDirection>,
    /// Whether the solution ends there. Default: no.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub terminal: bool,
}

/// In which direction zero is crossed as time goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum CrossingDirection {
    /// In either.
    Any,
    /// From below.
    Rising,
    /// From above.
    Falling,
}

/// A state at a time, and where it is from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ReferenceSpec {
    /// The time.
    pub t: Real,
    /// The unknowns then, in the order of the equations.
    pub x: Vec<Real>,
    /// Where the numbers are from.
    pub source: String,
}

impl EventSpec {
    /// The name and the expression.
    pub fn text(&self) -> &str {
        match self {
            Self::Plain(text) => text,
            Self::Table(table) => &table.event,
        }
    }

    /// In which direction zero is crossed.
    pub fn direction(&self) -> Direction {
        match self {
            Self::Plain(_) => Direction::Any,
            Self::Table(table) => match table.direction {
                None | Some(CrossingDirection::Any) => Direction::Any,
                Some(CrossingDirection::Rising) => Direction::Rising,
                Some(CrossingDirection::Falling) => Direction::Falling,
            },
        }
    }

    /// Whether the solution ends there.
    pub fn is_terminal(&self) -> bool {
        matches!(self, Self::Table(EventTable { terminal: true, .. }))
    }
}

/// How `kinstep order` studies the scenario: the gaps, the rows, what runs are compared with, and how strictly.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table [study]")]
pub struct StudySpec {
    /// The sampling gaps in s, coarsest first; each must divide the duration. Default: from 8 times `sigma` to an
    /// eighth of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigmas: Option<Vec<Real>>,
    /// The numbers of steps, fewest first, in place of `sigmas`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub steps: Option<Vec<usize>>,
    /// Ids of the formula rows to study besides the scenario's own.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub formulas: Vec<String>,
    /// The number that sums up the errors of a run and that the verdict is about. Default: maximum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measure: Option<MeasureKind>,
    /// What the runs of a problem are compared with: "exact" (its own solution), "extended" (an extrapolation with 32
    /// digits), or the id of a formula row, run on a finer grid. Default: exact where it is stated, else extended.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<String>,
    /// The numbers in which a problem is run. Default: double.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub precision: Option<Precision>,
    /// The order that is claimed. Default: what formula, start and feedback promise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub order: Option<usize>,
    /// How far the slope of the finest pair may be from the order. Default: 0.2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<Real>,
    /// How many times the round-off floor an error has to be to count. Default: 100.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub floor_margin: Option<Real>,
}

/// The numbers that sum up the errors of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum MeasureKind {
    /// The largest over the whole run, start-up included.
    Maximum,
    /// The largest over the second half of the run.
    Steady,
    /// The error of the last sample.
    EndPoint,
    /// The root of the mean square.
    MeanSquare,
}

/// Kinds of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// 16 digits.
    Double,
    /// 32 digits.
    Extended,
}

impl Scenario {
    /// Returns the scenario's problem, read; nothing for a scenario of arms.
    ///
    /// # Errors
    /// [`ScenarioError`] with the line at fault.
    pub fn equations(&self) -> Result<Option<Equations>, ScenarioError> {
        self.problem.as_ref().map(ProblemSpec::equations).transpose()
    }
}

impl ProblemSpec {
    fn equations(&self) -> Result<Equations, ScenarioError> {
        let text = EquationText {
            parameters: self.parameters.iter().map(|(name, value)| (name.clone(), value.value())).collect(),
            definitions: self.definitions.clone(),
            equations: self.equations.clone(),
            initial: self.initial.clone(),
            exact: self.exact.clone(),
            events: self.events.iter().map(|event| event.text().to_owned()).collect(),
        };
        Equations::parse(&text).map_err(|error| {
            let list = KeyPath::dotted("problem").key(error.list);
            let at = error.line.map_or_else(|| list.clone(), |line| list.index(line));
            let column = error.column.and_then(|column| u32::try_from(column).ok()?.try_into().ok());
            ScenarioError { column, ..ScenarioError::at(ErrorKind::Scenario, &at, error.message) }
        })
    }
}

impl StudySpec {
    /// Checks what can be checked by itself.
    pub(super) fn check(&self) -> Result<(), ScenarioError> {
        let at = |key: &str| KeyPath::dotted("study").key(key);
        let refuse =
            |key: &str, problem: String| Err(ScenarioError::at(ErrorKind::Scenario, &at(key), problem));
        if self.sigmas.is_some() && self.steps.is_some() {
            return refuse(
                "steps",
                "`sigmas` and `steps` say the same thing twice; give one of them".to_owned(),
            );
        }
        let rungs = self.sigmas.as_ref().map(Vec::len).or(self.steps.as_ref().map(Vec::len));
        if let Some(rungs) = rungs.filter(|rungs| !(1..=MOST_RUNGS).contains(rungs)) {
            let key = if self.sigmas.is_some() { "sigmas" } else { "steps" };
            return refuse(key, format!("{rungs} runs make no ladder; give 3 to {MOST_RUNGS}"));
        }
        if let Some(steps) = self.steps.iter().flatten().find(|&&steps| steps > MOST_STEPS) {
            return refuse("steps", format!("{steps} steps are too many; at most {MOST_STEPS}"));
        }
        if let Some(order) = self.order.filter(|order| !(1..=64).contains(order)) {
            return refuse("order", format!("{order} is not an order that a run could show"));
        }
        if let Some(tolerance) = self.tolerance.as_ref().filter(|t| !(t.value() > 0.0 && t.value() < 0.5)) {
            return refuse(
                "tolerance",
                format!("{tolerance} is not a tolerance of slopes; it lies between 0 and 0.5"),
            );
        }
        if let Some(margin) = self.floor_margin.as_ref().filter(|m| !(m.value() >= 1.0)) {
            return refuse("floor_margin", format!("{margin} is not a margin; it is 1 or more"));
        }
        Ok(())
    }
}
