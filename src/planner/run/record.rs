use super::approach::{count_from, put_lead_before, put_wait_before};
use super::closest_approach::ClosestApproach;
use super::convergence::Convergence;
use super::distance_watch::DistanceWatch;
use super::lost_directions::lost_directions;
use super::plan::{ArmPlan, Plan, PlanStatus, SharedJoints, StackRank, Stop, TaskPlan};
use crate::planner::system::{ArmRuntime, ArmState, Coupling, Monitor, System};
use nalgebra::Vector6;

/// What a plan says of itself.
#[derive(Clone, Debug)]
pub(in crate::planner) struct Description {
    pub(in crate::planner) formula: String,
    pub(in crate::planner) sigma: f64,
    pub(in crate::planner) h: f64,
    /// Whether `h` lies in the formula's feedback range.
    pub(in crate::planner) is_stable: bool,
    pub(in crate::planner) start: &'static str,
    pub(in crate::planner) steps: usize,
    /// The largest rate [1/s] of null-space criteria that the row follows at this gap.
    pub(in crate::planner) largest_criterion_rate: f64,
    /// How many samples lead arms to their paths before the run.
    pub(in crate::planner) lead: usize,
    /// What is to be kept apart.
    pub(in crate::planner) watch: Option<DistanceWatch>,
    /// The factor by which the feedback shrinks errors per step, and the steps of the row.
    pub(in crate::planner) factor: (f64, usize),
    /// How many derivatives of the motions are continuous, if not all.
    pub(in crate::planner) smoothness: Option<usize>,
    pub(in crate::planner) warnings: Vec<String>,
}

/// What is recorded of a run sample after sample.
pub(in crate::planner) struct Record {
    arms: Vec<ArmPlan>,
    tasks: Vec<TaskPlan>,
}

impl Record {
    /// An empty record with room for a run of so many steps.
    pub(in crate::planner) fn new<'a>(
        arms: &[ArmRuntime],
        systems: impl Iterator<Item = &'a System>,
        steps: usize,
    ) -> Self {
        let tasks = systems.flat_map(|system| {
            system.added_tasks().map(|((state, rows), _)| TaskPlan {
                name: state.name.clone(),
                kind: state.task.name().to_owned(),
                arms: system.arms_of(state).map(str::to_owned).collect(),
                rows: rows.rows(),
                components: (0..rows.rows()).map(|row| state.task.component(row)).collect(),
                errors: Vec::with_capacity((steps + 1) * rows.rows()),
            })
        });
        Self { arms: arms.iter().map(|arm| empty_plan(arm, steps)).collect(), tasks: tasks.collect() }
    }

    /// Adds a sample of the arms.
    pub(in crate::planner) fn write_arms<'a>(&mut self, arms: impl Iterator<Item = ArmState<'a>>) {
        for (state, plan) in arms.zip(&mut self.arms) {
            plan.positions.extend_from_slice(state.positions);
            plan.velocities.extend_from_slice(state.velocities);
            plan.errors.push(state.error);
        }
    }

    /// Whether there are tasks beside those of the arms.
    pub(in crate::planner) fn has_tasks(&self) -> bool {
        !self.tasks.is_empty()
    }

    /// Adds a sample of the tasks beside those of the arms.
    pub(in crate::planner) fn write_tasks<'a>(&mut self, systems: impl Iterator<Item = &'a System>) {
        let added = systems.flat_map(System::added_tasks);
        for (((_, rows), _), plan) in added.zip(&mut self.tasks) {
            plan.errors.extend_from_slice(&rows.error);
        }
    }

    /// The plan that came of it.
    pub(in crate::planner) fn conclude<'a>(
        mut self,
        description: Description,
        stop: Option<Stop>,
        arms: &[ArmRuntime],
        systems: impl Iterator<Item = &'a System>,
    ) -> Plan {
        let Description {
            formula,
            sigma,
            h,
            start,
            steps,
            mut warnings,
            lead,
            watch,
            factor,
            smoothness,
            ..
        } = description;
        let largest_criterion_rate = description.largest_criterion_rate;
        for (plan, runtime) in self.arms.iter_mut().zip(arms) {
            take_figures(plan, &runtime.monitor);
            plan.worst_singular_value = worst_singular_value(plan, runtime, sigma);
            plan.lost_directions = lost_directions(plan, runtime, sigma);
            if let Some(tolerance) = runtime.arm.convergence {
                warnings.extend(converge(plan, tolerance, factor, sigma));
            }
            let chain = &runtime.arm.chain;
            plan.violations = runtime.monitor.violations(chain);
            let limits = || chain.joints().iter().map(|joint| &joint.limits);
            plan.time_scale = plan.scale_of_limits(limits(), sigma);
            if lead > 0 {
                put_lead_before(plan, &runtime.arm, lead, sigma);
            }
            plan.violations.extend(plan.crossed_by_differences(limits(), sigma));
            warnings.extend(return_warning(plan, runtime));
            warnings.extend(damping_warning(plan, runtime.threshold));
            warnings.extend(rate_warning(&plan.name, runtime.monitor.largest_rate, largest_criterion_rate));
        }
        let distance = watch.and_then(|watch| watch.closest(&self.arms, sigma));
        warnings.extend(distance.as_ref().and_then(distance_warning));
        self.tasks.iter_mut().for_each(|task| put_wait_before(task, lead));
        let steps = steps + lead;
        let (status, reason) = match stop {
            Some(stop) if lead > 0 => {
                let begins = lead as f64 * sigma;
                let reason =
                    format!("{} (times of the path, which begins at {begins} s of the plan)", stop.reason);
                (stop.status, Some(reason))
            }
            Some(stop) => (stop.status, Some(stop.reason)),
            None => (PlanStatus::Completed, None),
        };
        let systems: Vec<&System> = systems.collect();
        let begins = lead as f64 * sigma;
        let stacks = systems.iter().filter_map(|system| stack_rank(system, arms, begins)).collect();
        let shared = systems.iter().filter(|system| system.arms().count() > 1);
        let shared =
            shared.map(|system| SharedJoints { arms: system.arm_names(), joints: system.joints_in_common() });
        let (arms, tasks) = (self.arms, self.tasks);
        let shared = shared.filter(|shared| !shared.joints.is_empty()).collect();
        let noise = None;
        Plan {
            status,
            reason,
            formula,
            sigma,
            h,
            start,
            steps,
            lead,
            smoothness,
            noise,
            arms,
            tasks,
            stacks,
            shared,
            distance,
            warnings,
        }
    }
}

/// How much of its tasks a system could meet, if these have different priorities.
fn stack_rank(system: &System, arms: &[ArmRuntime], begins: f64) -> Option<StackRank> {
    let shape = system.shape();
    let first = shape.tasks.first()?;
    shape.tasks.iter().find(|task| task.priority != first.priority)?;
    let (missing, at) = arms[system.arms().next()?].monitor.most_missing_rows;
    let (rows, t) = (shape.rows(), at + begins);
    Some(StackRank { arms: system.arm_names(), rows, rank: rows - missing.min(rows), t })
}

/// Tells apart how the arm was brought onto its path. A sentence where it was not.
fn converge(plan: &mut ArmPlan, tolerance: f64, factor: (f64, usize), sigma: f64) -> Option<String> {
    let convergence = Convergence::of(&plan.errors, tolerance, factor, sigma);
    let (initial, reached) = (convergence.initial_error, convergence.reached);
    plan.convergence = Some(convergence);
    take_velocities_of_positions(plan, reached.map(|reached| (reached / sigma).round() as usize), sigma);
    if let Some(reached) = reached {
        count_from(plan, (reached / sigma).round() as usize);
        return None;
    }
    Some(format!(
        "arm `{}` started {initial:.3e} off its path and did not stay within {tolerance:.3e} of it",
        plan.name
    ))
}

/// While feedback brings an arm in, or all along where it does not, the feedforward is not what the joints do: their velocities are
/// then the slopes of their positions.
fn take_velocities_of_positions(plan: &mut ArmPlan, until: Option<usize>, sigma: f64) {
    let joints = plan.joints.len();
    let samples = plan.positions.len() / joints.max(1);
    let until = until.unwrap_or(samples).min(samples);
    if samples < 2 {
        return;
    }
    for n in 0..until {
        let [before, after] = [n.saturating_sub(1), (n + 1).min(samples - 1)];
        let gap = (after - before) as f64 * sigma;
        for joint in 0..joints {
            let [from, to] = [before, after].map(|n| plan.positions[n * joints + joint]);
            plan.velocities[n * joints + joint] = (to - from) / gap;
        }
    }
}

/// The smallest singular value where its bound was least: in a step a bound is all that is worth its time.
fn worst_singular_value(plan: &ArmPlan, runtime: &ArmRuntime, sigma: f64) -> Option<f64> {
    let (bound, at) = plan.smallest_singular_value;
    let n = (at / sigma).round() as usize;
    let is_alone = runtime.coupling == Coupling::None;
    let is_recorded = bound.is_finite() && n < plan.errors.len();
    (is_alone && is_recorded).then(|| runtime.arm.smallest_singular_value(at, plan.position(n)))
}

/// Takes over what was watched on every sample.
fn take_figures(plan: &mut ArmPlan, monitor: &Monitor) {
    plan.max_error = monitor.max_error();
    plan.max_error_component = monitor.max_error_component;
    plan.max_error_steady = steady_maximum(&plan.errors);
    plan.rms_error_steady = steady_mean_square(&plan.errors).sqrt();
    plan.max_position_error = monitor.max_position_error();
    plan.max_orientation_error = monitor.max_orientation_error();
    plan.smallest_singular_value = (monitor.smallest_singular_value, monitor.smallest_at);
    plan.damped_samples = monitor.damped_samples;
}

/// The largest norm over the second half of the samples.
fn steady_maximum(errors: &[Vector6<f64>]) -> f64 {
    errors[errors.len() / 2..].iter().map(Vector6::norm).fold(0.0, f64::max)
}

/// The mean square of the norm over the second half of the samples.
fn steady_mean_square(errors: &[Vector6<f64>]) -> f64 {
    let half = &errors[errors.len() / 2..];
    half.iter().map(Vector6::norm_squared).sum::<f64>() / half.len() as f64
}

/// What became of joints that started outside their position limits.
fn return_warning(plan: &ArmPlan, runtime: &ArmRuntime) -> Option<String> {
    let outside: Vec<&str> =
        runtime.monitor.stayed_outside().iter().map(|&joint| plan.joints[joint].as_str()).collect();
    if !outside.is_empty() {
        let (arm, joints) = (&plan.name, outside.join("`, `"));
        return Some(format!(
            "arm `{arm}` started with `{joints}` outside the position limits and never came back"
        ));
    }
    let returned = runtime.monitor.returned?;
    Some(format!(
        "arm `{}` started outside its position limits and was within them from t = {returned:.6} s on",
        plan.name
    ))
}

fn damping_warning(plan: &ArmPlan, threshold: f64) -> Option<String> {
    let (smallest, at) = plan.smallest_singular_value;
    (plan.damped_samples > 1).then(|| {
        format!(
            "arm `{}` came near a singularity: damped least squares acted on {} samples; the smallest singular value was {smallest:.3e} at t = {at:.6} s (threshold {threshold:.3e})",
            plan.name, plan.damped_samples
        )
    })
}

fn distance_warning(closest: &ClosestApproach) -> Option<String> {
    let ClosestApproach { minimum, pair: [one, other], t, margin, .. } = closest;
    let came = if *minimum < 0.0 {
        format!("`{one}` and `{other}` overlap by {:.6} m", -minimum)
    } else {
        format!("`{one}` and `{other}` came within {minimum:.6} m of each other")
    };
    (!closest.is_kept()).then(|| format!("{came} at t = {t:.6} s, and the margin is {margin} m"))
}

/// A criterion whose rate depends on the configuration can only be watched.
fn rate_warning(arm: &str, (rate, at): (f64, f64), limit: f64) -> Option<String> {
    (!(rate <= limit)).then(|| {
        format!(
            "arm `{arm}`: the null-space criteria reached a rate of {rate:.6} 1/s at t = {at:.6} s, and at this sigma the formula follows rates below {limit:.6} 1/s only; lower their rates or sigma"
        )
    })
}

fn empty_plan(runtime: &ArmRuntime, steps: usize) -> ArmPlan {
    let joints = runtime.arm.joint_names();
    let entries = (steps + 1) * joints.len();
    ArmPlan {
        name: runtime.arm.name.clone(),
        joints,
        positions: Vec::with_capacity(entries),
        velocities: Vec::with_capacity(entries),
        errors: Vec::with_capacity(steps + 1),
        smallest_singular_value: (f64::INFINITY, 0.0),
        start_distance: runtime.arm.start_distance,
        ..ArmPlan::default()
    }
}
