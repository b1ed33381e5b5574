//! When an arm counts as lost, and why a run stopped.

use super::plan::{PlanStatus, Stop};
use super::reachability;
use crate::law::{Conflict, Infeasible};
use crate::planner::system::{ArmRuntime, Bounds, Coupling, Deviation, System};
use crate::task::Reference;

/// The fraction that an arm of a stable loop is held to once it came near a singularity: whatever it loses there, no
/// feedback will bring back, and the velocities it would take grow with the error.
const NEAR_SINGULARITY: f64 = 0.2;
/// Below this fraction of those bounds an arm counts as back on its path after a singularity.
const RECOVERED: f64 = 0.05;

/// A run does not begin in a singular configuration: nothing could be promised about its first steps.
pub(in crate::planner) fn check_start(arms: &mut [ArmRuntime]) -> Option<Stop> {
    for runtime in &mut *arms {
        runtime.was_singular = runtime.is_singular();
    }
    let runtime = arms.iter().find(|runtime| runtime.was_singular)?;
    let of = match runtime.coupling {
        Coupling::None => format!("its {}-row task Jacobian", runtime.arm.task.rows()),
        Coupling::Joints => "the stacked task Jacobian of all arms that share its joints".to_owned(),
        Coupling::Tasks => {
            "the stacked task Jacobian of all arms that are resolved with it (where what one task asks for follows from the others, no q0 is regular)".to_owned()
        }
    };
    let reason = format!(
        "arm `{}` starts in a singular configuration: the smallest singular value of {of} at q0 is {:.3e}, below the threshold {:.3e}; choose another q0 (a bent arm) or a task with fewer components",
        runtime.arm.name, runtime.resolution.smallest_singular_value, runtime.threshold
    );
    Some(Stop { status: PlanStatus::Singular, reason })
}

/// Stops the run when one of its arms has lost its path, and finds out why.
///
/// A loop outside its range diverges unless rank is missing right now. Inside the range the loop is not to blame:
/// what counts is whether the arm met a singularity since it was last on its path, and whether the point it should
/// go to can be reached.
pub(in crate::planner) fn check_lost(arms: &mut [ArmRuntime], is_stable: bool, t: f64) -> Option<Stop> {
    for runtime in arms {
        let singular = if is_stable {
            runtime.stop_criteria().is_near_singular(&runtime.resolution)
        } else {
            runtime.is_singular()
        };
        let lost_rank = singular || runtime.was_singular;
        let fraction = if is_stable && lost_rank { NEAR_SINGULARITY } else { 1.0 };
        if !runtime.is_within(fraction) {
            return Some(diagnose(runtime, is_stable, lost_rank, t));
        }
        let remembers = is_stable && !runtime.is_within(RECOVERED);
        runtime.was_singular = singular || (remembers && runtime.was_singular);
    }
    None
}

fn diagnose(runtime: &ArmRuntime, is_stable: bool, lost_rank: bool, t: f64) -> Stop {
    if !lost_rank && !is_stable {
        return diverged(
            runtime,
            t,
            "the closed loop is not stable at this h: choose h inside the formula's range",
        );
    }
    let tracked = runtime.arm.task.tracking().map(|(kind, motion)| (kind, motion.at(t)));
    if let Some((kind, reference)) = &tracked {
        let distance = reachability::smallest_distance(runtime, *kind, reference);
        if !reachability::is_reached(distance) {
            return unreachable(runtime, t, reference, distance);
        }
    }
    if lost_rank {
        return singular(runtime, t, tracked.as_ref().map(|(_, reference)| reference));
    }
    diverged(runtime, t, "sigma is too coarse for this path: choose a smaller one, or a longer duration")
}

fn diverged(runtime: &ArmRuntime, t: f64, remedy: &str) -> Stop {
    let reason = format!(
        "arm `{}` diverged: at t = {t:.6} s its task error is {:.3e} although it is far from singular; {remedy}",
        runtime.arm.name,
        runtime.error.norm()
    );
    Stop { status: PlanStatus::Diverged, reason }
}

fn singular(runtime: &ArmRuntime, t: f64, reference: Option<&Reference>) -> Stop {
    // What a set of arms can reach at once is not known from what each of them can.
    let (of, reached) = match runtime.coupling {
        Coupling::None => ("its Jacobian", "from another q0 for instance"),
        Coupling::Joints => {
            ("the Jacobian of all arms that share its joints", "by this arm if it were alone")
        }
        Coupling::Tasks => {
            ("the Jacobian of all arms that are resolved with it", "by this arm if it were alone")
        }
    };
    let verdict = reference.map_or_else(
        || "whether its task can be met there is not known".to_owned(),
        |reference| format!("the path's point {} can be reached, {reached}", place(reference)),
    );
    // Above the threshold a bound decides.
    let least = if runtime.is_singular() { "" } else { "at least " };
    let reason = format!(
        "arm `{}` met a singularity and lost its path at t = {t:.6} s with a task error of {:.3e}: the smallest singular value of {of} is {least}{:.3e}, with a threshold of {:.3e}; {verdict}",
        runtime.arm.name,
        runtime.error.norm(),
        runtime.resolution.smallest_singular_value,
        runtime.threshold,
    );
    Stop { status: PlanStatus::Singular, reason }
}

fn unreachable(runtime: &ArmRuntime, t: f64, reference: &Reference, distance: f64) -> Stop {
    let reason = format!(
        "arm `{}` can not reach its path at t = {t:.6} s: the nearest it gets to {} is a task error of {distance:.3e} (the run stopped at {:.3e}); move the path nearer or make it smaller",
        runtime.arm.name,
        place(reference),
        runtime.error.norm()
    );
    Stop { status: PlanStatus::Unreachable, reason }
}

fn place(reference: &Reference) -> String {
    let p = reference.position;
    format!("({:.4}, {:.4}, {:.4}) m", p.x, p.y, p.z)
}

/// Stops the run when a task beside those of the arms is lost.
pub(in crate::planner) fn check_added_tasks(system: &System, arms: &[ArmRuntime], t: f64) -> Option<Stop> {
    let first = &arms[system.arms().next()?];
    let first_priority = system.shape().tasks.iter().map(|task| task.priority).min();
    for ((state, rows), shape) in system.added_tasks() {
        // What comes later in a stack may be missed.
        if Some(shape.priority) > first_priority {
            continue;
        }
        let error = rows.error_by_component(&*state.task);
        let has_too_few_joints = first.bounds.has_too_few_joints;
        let bounds = Bounds { length: shape.length, has_too_few_joints };
        if Deviation::of(&error).is_within(&bounds.largest(1.0)) {
            continue;
        }
        let (status, why) = if first.stop_criteria().is_near_singular(&first.resolution) {
            (PlanStatus::Singular, "their Jacobian is near a singularity")
        } else {
            (
                PlanStatus::Diverged,
                "their Jacobian is far from singular: either it can not be met together with the arms' own tasks, or sigma is too coarse",
            )
        };
        let names = system.arms_of(state).collect::<Vec<_>>().join("`, `");
        let reason = format!(
            "task `{}` of `{names}` was lost at t = {t:.6} s with an error of {:.3e}; {why}",
            state.name,
            error.norm()
        );
        return Some(Stop { status, reason });
    }
    None
}

/// Says which rows of a system can not all be met.
pub(in crate::planner) fn infeasible(system: &System, infeasible: &Infeasible, t: f64) -> Stop {
    let rows = names_of_rows(system, &infeasible.conflicts);
    let rows = match &rows[..] {
        [] => "which of its rows are in conflict is not known".to_owned(),
        [only] => format!("{only} can not be met"),
        [rest @ .., last] => format!("{} and {last} can not all be met", rest.join(", ")),
    };
    let names = system.arm_names().join("`, `");
    let reason = format!(
        "no joint velocity of `{names}` at t = {t:.6} s meets all that is asked for within what is allowed: {rows}; let the motion take longer, ask for less, or take a row of lower order (rows with large weights of both signs pass limits sooner)"
    );
    Stop { status: PlanStatus::Limit, reason }
}

/// What the rows in conflict are called: limits first, then tasks, with the rows of them that count unless all do.
fn names_of_rows(system: &System, conflicts: &[Conflict]) -> Vec<String> {
    let shape = system.shape();
    let limit = |conflict: &Conflict| match *conflict {
        Conflict::Limit { joint, kind } => {
            let name = shape.joints.get(joint).map_or("?", String::as_str);
            Some(format!("the {} limit of joint `{name}`", kind.name()))
        }
        Conflict::Distance { pair } => {
            let [one, other] = system.pair_names(pair)?;
            Some(format!("the margin between `{one}` and `{other}`"))
        }
        Conflict::Task { .. } => None,
    };
    let mut names: Vec<String> = conflicts.iter().filter_map(limit).collect();
    for (task, shape) in shape.tasks.iter().enumerate() {
        let is_meant = |row: &usize| conflicts.contains(&Conflict::Task { task, row: *row });
        let rows: Vec<String> = (0..shape.rows()).filter(is_meant).map(|row| (row + 1).to_string()).collect();
        if rows.len() == shape.rows() {
            names.push(format!("task `{}`", shape.name));
        } else if let [only] = &rows[..] {
            names.push(format!("row {only} of task `{}`", shape.name));
        } else if !rows.is_empty() {
            names.push(format!("rows {} of task `{}`", rows.join(", "), shape.name));
        }
    }
    names
}
