use super::PlannerError;
use super::feedback::{Feedback, feedback_step};
use super::grid::grid;
use super::planner::Planner;
use super::resolve::resolved;
use super::run::{Description, DistanceWatch, Evaluated, Noise, SynchronousField};
use super::system::{Arm, ArmRuntime, Dependence, JointIndex, JointSystem, Surroundings, System};
use crate::formula::Formula;
use crate::integrate::{IntegrateError, Multistep, Starter};
use crate::law::LinearityKind;
use num_traits::ToPrimitive;
use std::collections::HashSet;

/// A path laid by its centre has to begin this near the tip [m or rad].
const PATH_START_TOLERANCE: f64 = 1e-6;

/// Collects what a plan is made of; [`build`](Self::build) checks it.
#[derive(Debug, Default)]
pub struct PlannerBuilder {
    formula: Option<Formula>,
    sigma: f64,
    duration: f64,
    feedback: Option<Feedback>,
    start: Starter<f64>,
    arms: Vec<Arm>,
    systems: Vec<JointSystem>,
    allow_unstable: bool,
    noise: Noise,
    surroundings: Option<Surroundings>,
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

    /// How the run begins; by the cheapest start of sufficient order unless set.
    ///
    /// States that are given hold the joint positions of all arms one after the other. Arms that share joints stand at the
    /// place of the first of them: its joints, then those of the next that are not there yet.
    #[must_use]
    pub fn start(mut self, start: Starter<f64>) -> Self {
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

    /// The noise that is injected into the loop; without this call there is none.
    #[must_use]
    pub fn noise(mut self, noise: Noise) -> Self {
        self.noise = noise;
        self
    }

    /// Has arms resolved as one system, with tasks over several of their tips or a law that sees all their joints.
    #[must_use]
    pub fn system(mut self, system: JointSystem) -> Self {
        self.systems.push(system);
        self
    }

    /// What stands around the arms: with it the plan says how near bodies came to each other, and laws that keep distances see
    /// what is near.
    #[must_use]
    pub fn surroundings(mut self, surroundings: Surroundings) -> Self {
        self.surroundings = Some(surroundings);
        self
    }

    /// Checks everything and allocates all that a step needs.
    ///
    /// # Errors
    /// Anything that keeps the plan from being run as it was meant; see [`PlannerError`].
    pub fn build(self) -> Result<Planner, PlannerError> {
        let formula = self.formula.as_ref().ok_or(PlannerError::NoFormula)?;
        check_arms(&self.arms)?;
        self.noise.check()?;
        let mut warnings = Vec::new();
        let (sigma, steps) = grid(self.sigma, self.duration, &self.arms, &mut warnings)?;
        let starter = named(self.start, formula);
        let noise = Some(self.noise).filter(|noise| !noise.is_silent());
        let watch = self.surroundings.as_ref().map(|around| watched(around, &self.arms, &mut warnings));
        let watch = watch.transpose()?;
        let warnings_of_arms: Vec<String> = self.arms.iter().filter_map(too_few_joints).collect();

        let (arms, systems) = resolved(self.arms, self.systems, sigma, self.surroundings.as_ref())?;
        let kinds: Vec<LinearityKind> = systems.iter().map(|system| system.law().kind()).collect();
        let asked = (sigma, self.allow_unstable);
        let feedback = feedback_step(formula, self.feedback, &kinds, asked, &mut warnings)?;
        warn_about_start(formula, &starter, steps, &mut warnings);
        let smoothness = smoothness(formula, &arms, &mut warnings);
        warnings.extend(warnings_of_arms);
        let largest_criterion_rate = check_criteria(formula, &systems, sigma)?;
        warnings.extend(systems.iter().filter_map(too_few_in_system));
        let mut field = match noise {
            None => {
                let moving: Vec<usize> = (0..systems.len()).collect();
                SynchronousField::new(arms, systems, &moving, feedback.gain)
            }
            Some(_) => SynchronousField::one_by_one(arms, systems, feedback.gain),
        };
        let starter = laid_out(starter, &field)?;
        let initial = field.state(|JointIndex { arm, joint }| field.arms[arm].arm.q0[joint]);
        let mut stepper = Multistep::new(formula, &starter, &field, 0.0, sigma, &initial)?;
        Evaluated::at_sample(&mut stepper, &mut field).scatter_to_arms();
        check_path_starts(&field)?;
        check_independence(&mut field)?;
        let lead = lead_steps(&field, sigma);
        let converges = field.arms.iter().any(|runtime| runtime.arm.convergence.is_some());
        let factor = if converges { formula.spectral_radius(feedback.h) } else { 0.0 };
        let description = Description {
            formula: formula.id().to_owned(),
            sigma,
            h: feedback.h,
            is_stable: feedback.is_stable,
            start: starter.name(),
            steps,
            largest_criterion_rate,
            lead,
            watch,
            factor: (factor, formula.steps()),
            smoothness,
            warnings,
        };
        Ok(Planner::begin(description, stepper, field, noise))
    }
}

impl Planner {
    /// An empty builder.
    pub fn builder() -> PlannerBuilder {
        PlannerBuilder::default()
    }
}

fn check_arms(arms: &[Arm]) -> Result<(), PlannerError> {
    if arms.is_empty() {
        return Err(PlannerError::NoArms);
    }
    let mut names = HashSet::new();
    for arm in arms {
        if !names.insert(arm.name.as_str()) {
            return Err(PlannerError::DuplicateArm { name: arm.name.clone() });
        }
        check_initial(arm)?;
    }
    Ok(())
}

/// The watch over the distances of a plan whose arms start far enough from everything.
fn watched(
    surroundings: &Surroundings,
    arms: &[Arm],
    warnings: &mut Vec<String>,
) -> Result<DistanceWatch, PlannerError> {
    surroundings.check(arms)?;
    let watch = DistanceWatch::new(surroundings, arms)?;
    watch.check_start(arms)?;
    warnings.extend(surroundings.missing());
    if watch.is_idle() {
        warnings.push("there is no pair of bodies whose distance could be checked".to_owned());
    }
    Ok(watch)
}

/// The start that is meant, by its name.
fn named(start: Starter<f64>, formula: &Formula) -> Starter<f64> {
    match start {
        Starter::Sufficient => Starter::sufficient_for(formula.order()),
        named => named,
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
        let place = |index: JointIndex| joints.iter().position(|joint| joint.contains(&index));
        Ok(field.state(|index| place(index).map_or(0.0, |place| state[place])))
    };
    Ok(Starter::Given(states.into_iter().enumerate().map(lay_out).collect::<Result<_, _>>()?))
}

/// The joints of all arms one after the other, each with all that it is called: one that is shared belongs to several arms.
/// Arms of one system stand at the place of the first of them.
fn joints_in_order(field: &SynchronousField) -> Vec<Vec<JointIndex>> {
    let mut systems: Vec<&System> = field.systems.iter().collect();
    systems.sort_by_key(|system| system.arms().min());
    systems.into_iter().flat_map(System::joints).collect()
}

fn check_initial(arm: &Arm) -> Result<(), PlannerError> {
    let name = || arm.name.clone();
    if arm.chain.dof() == 0 {
        let (base, tip) = (arm.chain.base().to_owned(), arm.chain.tip().to_owned());
        return Err(PlannerError::NoJoints { arm: name(), base, tip });
    }
    let is_brought_back = arm.law.as_ref().is_some_and(|law| law.keeps_limits());
    let checked = if is_brought_back {
        arm.chain.check_positions(&arm.q0)
    } else {
        arm.chain.check_within_limits(&arm.q0)
    };
    checked.map_err(|problem| PlannerError::Initial { arm: name(), problem })
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

/// How many derivatives of the motions of all arms are continuous, if not all. A formula of a higher order does not show it.
fn smoothness(formula: &Formula, arms: &[ArmRuntime], warnings: &mut Vec<String>) -> Option<usize> {
    let smoothness = |runtime: &ArmRuntime| {
        let (_, motion) = runtime.arm.task.tracking()?;
        Some((motion.smoothness()?, runtime.arm.name.clone()))
    };
    let (least, arm) = arms.iter().filter_map(smoothness).min()?;
    if least < formula.order() {
        let (id, p, power) = (formula.id(), formula.order(), least + 1);
        warnings.push(format!(
            "the motion of arm `{arm}` has {least} continuous derivative{}: errors fall like O(sigma^{power}) at best, whatever the order {p} of formula `{id}`",
            if least == 1 { "" } else { "s" }
        ));
    }
    Some(least)
}

fn too_few_joints(arm: &Arm) -> Option<String> {
    let (joints, rows) = (arm.chain.dof(), arm.task.rows());
    (joints < rows).then(|| {
        let (name, task) = (&arm.name, arm.task.name());
        format!("arm `{name}` has {joints} joints for the {rows} components of a `{task}` task: most paths are out of its reach")
    })
}

fn too_few_in_system(system: &System) -> Option<String> {
    let (joints, rows) = (system.shape().joints.len(), system.shape().rows());
    (joints < rows && system.arms().count() > 1).then(|| {
        let arms = system.arm_names().join("`, `");
        format!("the arms `{arms}` together have {joints} joints for the {rows} components of their tasks: most paths are out of their reach")
    })
}

/// A criterion is integrated by `(alpha, beta)`: `sigma * rate * beta(1)` has to lie in that pair's own range. Returns the
/// largest rate [1/s] that does.
fn check_criteria(formula: &Formula, systems: &[System], sigma: f64) -> Result<f64, PlannerError> {
    // The plain law has no criterion, and the exact range of a pair takes longer than many a run.
    if systems.iter().all(|system| system.law().fast_path().is_some()) {
        return Ok(f64::INFINITY);
    }
    let pair = formula.without_split();
    let beta_sum = pair.gamma_sum().to_f64().unwrap_or(f64::NAN);
    let range = pair.feedback_range();
    let limit = range.map_or(0.0, |range| range.value() / (sigma * beta_sum));
    for system in systems {
        let Some(rate) = system.law().criterion_rate() else { continue };
        if !range.is_some_and(|range| range.contains(sigma * rate * beta_sum)) {
            let (arm, formula) = (system.arm_names().join("`, `"), formula.id().to_owned());
            return Err(PlannerError::CriterionTooFast { arm, rate, sigma, formula, limit });
        }
    }
    Ok(limit)
}

/// Where several tasks begin in a singular configuration: checks that they have any other.
fn check_independence(field: &mut SynchronousField) -> Result<(), PlannerError> {
    for system in &mut field.systems {
        let is_singular = system.arms().any(|arm| field.arms[arm].is_singular());
        if system.added_tasks().next().is_none() || !is_singular {
            continue;
        }
        let found = system.dependence(&mut field.arms);
        let said = |task: usize| match system.task_name(task) {
            (name, Some(arm)) => format!("the task `{name}` of arm `{arm}`"),
            (name, None) => format!("task `{name}`"),
        };
        match found {
            None => {}
            Some(Dependence::Tasks { others, .. }) if others.is_empty() => {}
            Some(Dependence::Tasks { task, others }) => {
                let others = others.into_iter().map(said).collect::<Vec<_>>().join(" with ");
                let (name, arm) = system.task_name(task);
                return Err(PlannerError::DependentTasks { task: said(task), others, arm, name });
            }
            Some(Dependence::Still { task, rows }) => {
                let rows: Vec<&str> =
                    rows.into_iter().map(|row| system.component(task, row).name()).collect();
                let (name, arm) = system.task_name(task);
                return Err(PlannerError::StillRows { task: said(task), rows: rows.join(", "), arm, name });
            }
        }
    }
    Ok(())
}

/// How many samples the longest lead of an arm takes.
fn lead_steps(field: &SynchronousField, sigma: f64) -> usize {
    let longest = field.arms.iter().map(|runtime| runtime.arm.lead_duration()).fold(0.0, f64::max);
    // A lead of a whole number of gaps takes that many.
    (longest / sigma * (1.0 - 1e-9)).ceil() as usize
}

fn check_path_starts(field: &SynchronousField) -> Result<(), PlannerError> {
    for runtime in &field.arms {
        let distance = runtime.error.norm();
        let arm = runtime.arm.name.clone();
        if distance > PATH_START_TOLERANCE && runtime.arm.convergence.is_none() {
            return Err(PlannerError::PathStart { arm, distance });
        }
        if !runtime.is_within(1.0) {
            return Err(PlannerError::TooFar { arm, distance });
        }
    }
    for system in &field.systems {
        for ((state, rows), _) in system.added_tasks() {
            let distance = rows.error_by_component(&*state.task).norm();
            if distance > PATH_START_TOLERANCE {
                return Err(PlannerError::TaskStart { task: state.name.clone(), distance });
            }
        }
    }
    Ok(())
}
