use super::bundle::Sample;
use super::field::{Owner, SynchronousField};
use super::fleet::Description;
use super::shared::{self, SharedArms};
use super::{Arm, Noise, Planner, PlannerError};
use crate::formula::{Formula, FormulaTable};
use crate::integrate::{IntegrateError, Multistep, Starter};
use num_traits::ToPrimitive;
use std::collections::HashSet;

/// Samples may take this much memory \[GiB\] before a plan is refused.
const MEMORY_CAP: f64 = 4.0;
/// A path laid by its centre has to begin this near the tip [m or rad].
const PATH_START_TOLERANCE: f64 = 1e-6;

/// How strongly the task error is fed back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Feedback {
    /// The step `h = sigma k sum(gamma)`, held fixed whatever `sigma`: errors fall as `sigma^(p+1)`.
    Step(f64),
    /// The continuous gain `k` [1/s]: `h` shrinks with `sigma`, and errors fall as `sigma^p` only.
    Gain(f64),
}

/// How the run begins; see [`Starter`].
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Start {
    /// The cheapest start of sufficient order: `rk4` up to order 4, `rk8` above.
    #[default]
    Sufficient,
    /// Euler steps with the same `h`.
    Paper,
    /// Lower rows of the formula's family.
    Ramp,
    /// Runge-Kutta of order 4.
    Rk4,
    /// Runge-Kutta of order 8.
    Rk8,
    /// The joint positions `x_1 .. x_{s-1}` of all arms one after the other, oldest state first. Arms that share joints
    /// stand at the place of the first of them: its joints, then those of the next that are not there yet.
    Given(Vec<Vec<f64>>),
}

impl Start {
    /// The names a scenario may use.
    pub const NAMES: [&'static str; 4] = ["paper", "ramp", "rk4", "rk8"];

    /// The start of that name.
    pub fn by_name(name: &str) -> Option<Self> {
        match name {
            "paper" => Some(Self::Paper),
            "ramp" => Some(Self::Ramp),
            "rk4" => Some(Self::Rk4),
            "rk8" => Some(Self::Rk8),
            _ => None,
        }
    }

    fn starter(&self, formula: &Formula) -> Starter<f64> {
        match self {
            Self::Sufficient => Starter::sufficient_for(formula.order()),
            Self::Paper => Starter::Paper,
            Self::Ramp => {
                let table = FormulaTable::builtin();
                Starter::Rows(
                    (1..formula.steps()).map_while(|known| table.ramp(formula, known).cloned()).collect(),
                )
            }
            Self::Rk4 => Starter::Rk4,
            Self::Rk8 => Starter::Rk8,
            Self::Given(states) => Starter::Given(states.clone()),
        }
    }
}

/// Collects what a plan is made of; [`build`](Self::build) checks it.
#[derive(Debug, Default)]
pub struct PlannerBuilder {
    formula: Option<Formula>,
    sigma: f64,
    duration: f64,
    feedback: Option<Feedback>,
    start: Start,
    arms: Vec<Arm>,
    allow_unstable: bool,
    noise: Noise,
}

impl PlannerBuilder {
    /// The row that discretises time.
    #[must_use]
    pub fn formula(mut self, formula: &Formula) -> Self {
        self.formula = Some(formula.clone());
        self
    }

    /// The sampling gap \[s\].
    #[must_use]
    pub fn sigma(mut self, sigma: f64) -> Self {
        self.sigma = sigma;
        self
    }

    /// How long the motion takes \[s\].
    #[must_use]
    pub fn duration(mut self, duration: f64) -> Self {
        self.duration = duration;
        self
    }

    /// The feedback step `h`, held fixed whatever `sigma`.
    #[must_use]
    pub fn h(self, h: f64) -> Self {
        self.feedback(Feedback::Step(h))
    }

    /// The feedback gain `k` [1/s].
    #[must_use]
    pub fn gain(self, gain: f64) -> Self {
        self.feedback(Feedback::Gain(gain))
    }

    /// The feedback, as a step or as a gain. Without one the row's own best step `h_opt` is taken.
    #[must_use]
    pub fn feedback(mut self, feedback: Feedback) -> Self {
        self.feedback = Some(feedback);
        self
    }

    /// How the run begins.
    #[must_use]
    pub fn start(mut self, start: Start) -> Self {
        self.start = start;
        self
    }

    /// Adds an arm.
    #[must_use]
    pub fn arm(mut self, arm: Arm) -> Self {
        self.arms.push(arm);
        self
    }

    /// Adds arms.
    #[must_use]
    pub fn arms(mut self, arms: impl IntoIterator<Item = Arm>) -> Self {
        self.arms.extend(arms);
        self
    }

    /// Lets `h` lie outside the feedback range, to watch the loop diverge.
    #[must_use]
    pub fn allow_unstable(mut self, allow: bool) -> Self {
        self.allow_unstable = allow;
        self
    }

    /// The noise that the loop suffers; without this call there is none.
    #[must_use]
    pub fn noise(mut self, noise: Noise) -> Self {
        self.noise = noise;
        self
    }

    /// Checks everything and allocates all that a step needs.
    ///
    /// # Errors
    /// Anything that keeps the plan from being run as it was meant; see [`PlannerError`].
    pub fn build(self) -> Result<Planner, PlannerError> {
        let formula = self.formula.as_ref().ok_or(PlannerError::NoFormula)?;
        self.check_arms()?;
        self.noise.check()?;
        let mut warnings = Vec::new();
        let (sigma, steps) = self.grid(&mut warnings)?;
        let gamma_sum = formula.gamma_sum().to_f64().unwrap_or(f64::NAN);
        let h = self.feedback_step(formula, sigma, gamma_sum, &mut warnings)?;
        let starter = self.start.starter(formula);
        warn_about_start(formula, &starter, steps, &mut warnings);
        warnings.extend(self.arms.iter().filter_map(too_few_joints));

        let gain = h / (sigma * gamma_sum);
        let noise = Some(self.noise).filter(|noise| !noise.is_silent());
        let mut field = match noise {
            None => SynchronousField::new(self.arms, gain, sigma),
            Some(_) => SynchronousField::one_by_one(self.arms, gain, sigma),
        };
        check_criteria(formula, &field, sigma)?;
        warnings.extend(field.shared.iter().filter_map(|shared| too_few_shared(shared, &field)));
        let starter = laid_out(starter, &field)?;
        let initial = field.state(|(arm, joint)| field.arms[arm].arm.q0[joint]);
        let mut stepper = Multistep::new(formula, &starter, &field, 0.0, sigma, &initial)?;
        stepper.evaluate(&mut field);
        let (state, velocities) = (stepper.state(), stepper.derivative());
        field.tell(&Sample { positions: state, previous: state, velocities });
        check_path_starts(&field)?;
        let description = Description {
            formula: formula.id().to_owned(),
            sigma,
            h,
            is_stable: formula.feedback_range().contains(h),
            start: starter.name(),
            steps,
            warnings,
        };
        Ok(Planner::begin(description, stepper, field, noise))
    }

    fn check_arms(&self) -> Result<(), PlannerError> {
        if self.arms.is_empty() {
            return Err(PlannerError::NoArms);
        }
        let mut names = HashSet::new();
        for arm in &self.arms {
            if !names.insert(arm.name.as_str()) {
                return Err(PlannerError::DuplicateArm { name: arm.name.clone() });
            }
            check_initial(arm)?;
        }
        shared::sets(&self.arms).iter().try_for_each(|set| shared::check(&self.arms, set))
    }

    /// The gap and the number of steps: `sigma` as asked where it divides the duration, else `T / N` just below it.
    fn grid(&self, warnings: &mut Vec<String>) -> Result<(f64, usize), PlannerError> {
        let (sigma, duration) = (self.sigma, self.duration);
        if !(duration > 0.0 && duration.is_finite()) {
            return Err(PlannerError::Duration { value: duration });
        }
        if !(sigma > 0.0 && sigma <= duration) {
            return Err(PlannerError::Sigma { value: sigma, duration });
        }
        let exact = duration / sigma;
        let whole = exact.round();
        let divides = (exact - whole).abs() <= 1e-9 * whole;
        let steps = if divides { whole } else { exact.ceil() };
        self.check_memory(steps)?;
        if divides {
            return Ok((sigma, steps as usize));
        }
        let adjusted = duration / steps;
        warnings.push(format!(
            "sigma = {sigma} s does not divide the duration {duration} s; it was adjusted to {duration}/{steps} = {adjusted} s"
        ));
        Ok((adjusted, steps as usize))
    }

    fn check_memory(&self, steps: f64) -> Result<(), PlannerError> {
        let joints: usize = self.arms.iter().map(|arm| arm.q0.len()).sum();
        let bytes_per_sample = 8.0 * (2 * joints + 6 * self.arms.len()) as f64;
        let gibibytes = steps * bytes_per_sample / f64::from(1 << 30);
        if gibibytes <= MEMORY_CAP {
            return Ok(());
        }
        // A pose step of a 7-joint arm takes well under a microsecond on current machines.
        let seconds = steps * 1e-6 * self.arms.len() as f64;
        Err(PlannerError::TooManySteps { sigma: self.sigma, steps, gibibytes, seconds })
    }

    fn feedback_step(
        &self,
        formula: &Formula,
        sigma: f64,
        gamma_sum: f64,
        warnings: &mut Vec<String>,
    ) -> Result<f64, PlannerError> {
        let h = match self.feedback {
            Some(Feedback::Step(h)) => h,
            Some(Feedback::Gain(gain)) => {
                check_feedback("gain", gain)?;
                sigma * gain * gamma_sum
            }
            None => formula.optimum().map_or(0.0, |optimum| optimum.h),
        };
        check_feedback("step h", h)?;
        if h == 0.0 {
            warnings.push("h = 0: without feedback the task error is never corrected and drifts".to_owned());
            return Ok(h);
        }
        let range = formula.feedback_range();
        if range.contains(h) {
            return Ok(h);
        }
        let (id, range) = (formula.id().to_owned(), range.to_string());
        if !self.allow_unstable {
            return Err(PlannerError::StepSizeOutsideRange { h, formula: id, range });
        }
        warnings
            .push(format!("h = {h} lies outside the feedback range {range} of formula `{id}`, as allowed"));
        Ok(h)
    }
}

/// A start with given states, in the order of the field's components.
fn laid_out(starter: Starter<f64>, field: &SynchronousField) -> Result<Starter<f64>, IntegrateError> {
    let Starter::Given(states) = starter else { return Ok(starter) };
    let joints = joints_in_order(field);
    let lay_out = |(k, state): (usize, Vec<f64>)| {
        if state.len() != joints.len() {
            let (what, expected) = (format!("starting state {}", k + 1), joints.len());
            return Err(IntegrateError::Dimension { what, got: state.len(), expected });
        }
        let place = |owner: Owner| joints.iter().position(|joint| joint.contains(&owner));
        Ok(field.state(|owner| place(owner).map_or(0.0, |place| state[place])))
    };
    Ok(Starter::Given(states.into_iter().enumerate().map(lay_out).collect::<Result<_, _>>()?))
}

/// The joints of all arms one after the other, each with all that it is called: one that is shared belongs to several arms.
fn joints_in_order(field: &SynchronousField) -> Vec<Vec<Owner>> {
    let mut in_order: Vec<Vec<Owner>> = Vec::new();
    let mut listed = vec![false; field.arms.len()];
    for arm in 0..field.arms.len() {
        if std::mem::replace(&mut listed[arm], true) {
            continue;
        }
        match field.shared.iter().find(|shared| shared.arms().any(|member| member == arm)) {
            None => in_order.extend((0..field.arms[arm].positions.len()).map(|joint| vec![(arm, joint)])),
            Some(shared) => {
                in_order.extend(shared.owners());
                shared.arms().for_each(|arm| listed[arm] = true);
            }
        }
    }
    in_order
}

fn check_feedback(what: &'static str, value: f64) -> Result<(), PlannerError> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(PlannerError::Feedback { what, value })
}

fn check_initial(arm: &Arm) -> Result<(), PlannerError> {
    let name = || arm.name.clone();
    if arm.chain.dof() == 0 {
        let (base, tip) = (arm.chain.base().to_owned(), arm.chain.tip().to_owned());
        return Err(PlannerError::NoJoints { arm: name(), base, tip });
    }
    arm.chain.check_within_limits(&arm.q0).map_err(|problem| PlannerError::Initial { arm: name(), problem })
}

fn warn_about_start(formula: &Formula, starter: &Starter<f64>, steps: usize, warnings: &mut Vec<String>) {
    let (id, p) = (formula.id(), formula.order());
    if formula.steps() > 1
        && let Some(order) = starter.order().filter(|&order| order < p)
    {
        warnings.push(format!(
            "the start `{}` has order {order}, below the {p} of formula `{id}`: unless the path begins at rest to second order, its transient of O(sigma^{}) hides the formula's O(sigma^{}) in the maximum over the whole run",
            starter.name(),
            order + 1,
            p + 1
        ));
    }
    if steps < formula.steps() {
        warnings.push(format!(
            "the plan has {steps} steps, all of them part of the start: formula `{id}` takes over after {}",
            formula.steps() - 1
        ));
    }
}

fn too_few_joints(arm: &Arm) -> Option<String> {
    let (joints, rows) = (arm.chain.dof(), arm.task.rows());
    (joints < rows).then(|| {
        let (name, task) = (&arm.name, arm.task.name());
        format!("arm `{name}` has {joints} joints for the {rows} components of a `{task}` task: most paths are out of its reach")
    })
}

fn too_few_shared(shared: &SharedArms, field: &SynchronousField) -> Option<String> {
    let (joints, rows) = shared.size();
    (joints < rows).then(|| {
        let arms = shared.report(&field.arms).arms.join("`, `");
        format!("the arms `{arms}` together have {joints} joints for the {rows} components of their tasks: most paths are out of their reach")
    })
}

/// A criterion is integrated by `(alpha, beta)`: `sigma * rate * beta(1)` has to lie in that pair's own range.
fn check_criteria(formula: &Formula, field: &SynchronousField, sigma: f64) -> Result<(), PlannerError> {
    for runtime in &field.arms {
        let Some(rate) = runtime.arm.law.criterion_rate() else { continue };
        let pair = formula.without_split();
        let beta_sum = pair.gamma_sum().to_f64().unwrap_or(f64::NAN);
        let range = pair.feedback_range();
        if !range.is_some_and(|range| range.contains(sigma * rate * beta_sum)) {
            return Err(PlannerError::CriterionTooFast {
                arm: runtime.arm.name.clone(),
                rate,
                sigma,
                formula: formula.id().to_owned(),
                limit: range.map_or(0.0, |range| range.value() / (sigma * beta_sum)),
            });
        }
    }
    Ok(())
}

fn check_path_starts(field: &SynchronousField) -> Result<(), PlannerError> {
    for runtime in &field.arms {
        let distance = runtime.error.norm();
        if distance > PATH_START_TOLERANCE {
            return Err(PlannerError::PathStart { arm: runtime.arm.name.clone(), distance });
        }
    }
    Ok(())
}
