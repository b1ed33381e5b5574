//! A plan for people.

use std::io::{self, Write};

use super::{PlanFormat, Table, short, sparkline};
use kinstep::math::number_text;
use kinstep::planner::{
    ArmPlan, ClosestApproach, LimitKind, LostDirection, Noise, Plan, StackRank, TaskPlan,
};

/// Width of the curves of the task errors [characters].
const CURVE: usize = 64;

/// What was done, a row per arm, the course of the errors, limits crossed and warnings.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlanText;

impl PlanFormat for PlanText {
    fn write(&self, plan: &Plan, out: &mut dyn Write) -> io::Result<()> {
        let names: Vec<&str> = plan.arms.iter().map(|arm| arm.name.as_str()).collect();
        let arms = if names.len() == 1 { "arm" } else { "arms in synchrony" };
        writeln!(
            out,
            "{} {arms} ({}): {} steps of {} s",
            names.len(),
            names.join(", "),
            plan.steps,
            number_text(plan.sigma)
        )?;
        writeln!(out, "formula {}, h = {}, start {}", plan.formula, short(plan.h), plan.start)?;
        plan.noise.iter().try_for_each(|noise| writeln!(out, "{}", disturbed_by(noise)))?;
        for shared in &plan.shared {
            let (arms, joints) = (shared.arms.join(" and "), shared.joints.join(", "));
            writeln!(out, "{arms} share {joints}: solved as one system")?;
        }
        match &plan.reason {
            None => writeln!(out, "{}\n", plan.status.name())?,
            Some(reason) => writeln!(out, "stopped, {}: {reason}\n", plan.status.name())?,
        }
        write!(out, "{}", errors(plan))?;
        for task in &plan.tasks {
            writeln!(out, "\n{}", kept_together(task))?;
        }
        for stack in &plan.stacks {
            writeln!(out, "\n{}", rank_of(stack))?;
        }
        for arm in &plan.arms {
            arm.lost_directions.iter().try_for_each(|lost| writeln!(out, "\n{}", lost_by(arm, lost)))?;
        }
        if plan.noise.is_some() {
            writeln!(out, "\nroot mean square of the error in the second half: {}", mean_squares(plan))?;
        }
        plan.arms.iter().try_for_each(|arm| start(arm, out))?;
        approach_of(plan).iter().try_for_each(|sentence| writeln!(out, "\n{sentence}"))?;
        plan.distance.iter().try_for_each(|closest| {
            writeln!(out, "\n{}, at t = {} s", came_near(closest), short(closest.t))
        })?;
        writeln!(out, "\ntask error over time, logarithmic:")?;
        let width = names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
        for arm in &plan.arms {
            let norms: Vec<f64> = arm.errors.iter().map(nalgebra::Vector6::norm).collect();
            writeln!(out, "  {:width$}  {}", arm.name, sparkline(&norms, CURVE))?;
        }
        if !plan.is_within_limits() {
            write!(out, "\n{}", violations(&plan.arms))?;
            would_do(plan).iter().try_for_each(|sentence| writeln!(out, "\n{sentence}"))?;
        }
        plan.warnings.iter().try_for_each(|warning| writeln!(out, "\nwarning: {warning}"))
    }
}

/// Says how well a task over the tips of several arms was kept.
pub(super) fn kept_together(task: &TaskPlan) -> String {
    let errors = match (task.max_position_error(), task.max_orientation_error()) {
        (position, 0.0) => format!("{position:.2e} m"),
        (0.0, orientation) => format!("{orientation:.2e} rad"),
        (position, orientation) => format!("{position:.2e} m, {orientation:.2e} rad"),
    };
    format!("{} of {}: max error {errors}", task.name, task.arms.join(" and "))
}

/// Says how near bodies came to each other.
pub(super) fn came_near(closest: &ClosestApproach) -> String {
    let ClosestApproach { minimum, pair: [one, other], margin, .. } = closest;
    let verdict = if closest.is_kept() { "kept" } else { "not kept" };
    let margin = short(*margin);
    format!("least distance {minimum:.4} m, between {one} and {other} (margin {margin} m, {verdict})")
}

/// Says how much of a stack of tasks could be met.
pub(super) fn rank_of(stack: &StackRank) -> String {
    let StackRank { arms, rows, rank, t } = stack;
    let of = format!("the stack of tasks of {} has {rows} rows", arms.join(" and "));
    if rank == rows {
        return format!("{of}, and all could be met at all times");
    }
    format!("{of}, of which {rank} could be met beside those before them at t = {} s", number_text(*t))
}

/// Says which direction an arm lost, and when.
pub(super) fn lost_by(arm: &ArmPlan, lost: &LostDirection) -> String {
    let entries: Vec<String> = lost.direction.iter().map(|entry| format!("{entry:.2}")).collect();
    format!(
        "{} lost a direction from {} to {} s: ({}), with a singular value of {:.2e} at worst",
        arm.name,
        number_text(lost.from),
        number_text(lost.to),
        entries.join(", "),
        lost.smallest_singular_value
    )
}

/// Says what noise a loop suffered.
pub(super) fn disturbed_by(noise: &Noise) -> String {
    let loud = noise.deviations().into_iter().filter(|deviation| deviation.3 > 0.0);
    let loud: Vec<_> = loud.map(|(_, of, unit, value)| format!("{} {unit} in {of}", short(value))).collect();
    format!("white noise of seed {}: {}", noise.seed, loud.join(", "))
}

/// The root mean squares of the errors of all arms, where they are steady.
pub(super) fn mean_squares(plan: &Plan) -> String {
    let figures = plan.arms.iter().map(|arm| format!("{} {:.2e}", arm.name, arm.rms_error_steady));
    figures.collect::<Vec<_>>().join(", ")
}

/// Says how the arms came to their paths.
pub(super) fn approach_of(plan: &Plan) -> Vec<String> {
    let mut said = Vec::new();
    if plan.lead > 0 {
        let time = short(plan.lead as f64 * plan.sigma);
        said.push(format!(
            "the joints are led to where the paths begin in the first {time} s ({} steps)",
            plan.lead
        ));
    }
    for arm in &plan.arms {
        let Some(convergence) = &arm.convergence else { continue };
        let came = match convergence.reached {
            Some(t) => format!(
                "within {:.1e} from t = {} s on; errors count from there",
                convergence.tolerance,
                short(t)
            ),
            None => format!("never to stay within {:.1e}", convergence.tolerance),
        };
        let predicted = if convergence.predicted.is_finite() {
            format!("{} s after the start", short(convergence.predicted))
        } else {
            "never".to_owned()
        };
        said.push(format!(
            "{} started {:.2e} off its path and came {came} (by r(h)^n with r(h) = {}: {predicted})",
            arm.name,
            convergence.initial_error,
            short(convergence.factor)
        ));
    }
    said
}

/// Where an arm begins, if that was solved for.
fn start(arm: &ArmPlan, out: &mut dyn Write) -> io::Result<()> {
    let Some(distance) = arm.start_distance else { return Ok(()) };
    let q0 = arm.position(0).iter().map(|q| format!("{q:.4}")).collect::<Vec<_>>().join(", ");
    writeln!(out, "\n{} starts at q0 = [{q0}], found for its start_pose to {distance:.1e}", arm.name)
}

fn errors(plan: &Plan) -> Table {
    let mut table = Table::new([
        "arm",
        "joints",
        "max error",
        "second half",
        "position [m]",
        "orientation [rad]",
        "limits",
    ]);
    for arm in &plan.arms {
        let limits = match arm.violations.len() {
            0 => "kept".to_owned(),
            count => format!("{count} crossed"),
        };
        let errors = [arm.max_error, arm.max_error_steady, arm.max_position_error, arm.max_orientation_error];
        let cells = [arm.name.clone(), arm.joints.len().to_string()];
        table.row(cells.into_iter().chain(errors.map(|e| format!("{e:.2e}"))).chain([limits]));
    }
    table
}

/// Says in which time the motion would be within the limits that depend on it, where it is not.
fn would_do(plan: &Plan) -> Option<String> {
    let duration = duration_within_limits(plan)?;
    Some(format!("a duration of {duration} s would do for velocities, accelerations and jerks"))
}

/// A duration, to three digits, in which limits of velocity, acceleration and jerk would be kept, where they are not.
pub(super) fn duration_within_limits(plan: &Plan) -> Option<String> {
    let depends = |arm: &ArmPlan| arm.violations.iter().any(|v| v.kind != LimitKind::Position);
    // What scaling does not see, such as feedback, gets half a percent.
    let least = 1.005 * plan.feasible_duration().filter(|_| plan.arms.iter().any(depends))?;
    let decimals = 2 - least.log10().floor() as i32;
    let unit = 10_f64.powi(-decimals);
    let rounded = (least.max(1.005 * plan.duration()) / unit).ceil() * unit;
    Some(number_text(format!("{rounded:.*}", decimals.max(0) as usize).parse().unwrap_or(rounded)))
}

fn violations(arms: &[ArmPlan]) -> Table {
    let mut table = Table::new(["limit crossed", "joint", "of", "at worst", "limit", "t [s]"]);
    for arm in arms {
        for v in &arm.violations {
            let figures = [v.value, v.limit, v.t].map(short);
            table.row(
                [arm.name.clone(), v.joint.clone(), v.kind.name().to_owned()].into_iter().chain(figures),
            );
        }
    }
    table
}
