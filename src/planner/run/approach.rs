//! How an arm comes to its path: brought in by the feedback, or led there before the run.

use super::plan::{ArmPlan, TaskPlan};
use crate::planner::system::{Arm, Deviation};
use nalgebra::Vector6;

/// Has the errors of an arm count from where it came onto its path.
pub(super) fn count_from(plan: &mut ArmPlan, first: usize) {
    let Some(errors) = plan.errors.get(first..).filter(|errors| !errors.is_empty()) else { return };
    let largest = |value: fn(&Vector6<f64>) -> f64| errors.iter().map(value).fold(0.0, f64::max);
    plan.max_error = largest(Vector6::norm);
    plan.max_error_component = largest(Vector6::amax);
    plan.max_position_error = largest(|error| Deviation::of(error).position.sqrt());
    plan.max_orientation_error = largest(|error| Deviation::of(error).orientation.sqrt());
}

/// Puts so many samples of the way to the path before those of the run. Arms that are on theirs wait.
pub(super) fn put_lead_before(plan: &mut ArmPlan, arm: &Arm, steps: usize, sigma: f64) {
    let time = steps as f64 * sigma;
    let mut scratch = arm.chain.scratch();
    let (mut positions, mut velocities, mut errors) = (Vec::new(), Vec::new(), Vec::new());
    for n in 0..steps {
        let (q, v) = match &arm.lead {
            Some(lead) => lead.at(n as f64 / steps as f64, &arm.q0, time),
            None => (arm.q0.clone(), vec![0.0; arm.q0.len()]),
        };
        errors.push(arm.task_error(0.0, &q, &mut scratch));
        positions.extend(q);
        velocities.extend(v);
    }
    plan.positions.splice(0..0, positions);
    plan.velocities.splice(0..0, velocities);
    plan.errors.splice(0..0, errors);
    plan.violations.iter_mut().for_each(|violation| violation.t += time);
    plan.smallest_singular_value.1 += time;
    for lost in &mut plan.lost_directions {
        (lost.from, lost.to) = (lost.from + time, lost.to + time);
    }
    if let Some(reached) = plan.convergence.as_mut().and_then(|convergence| convergence.reached.as_mut()) {
        *reached += time;
    }
}

/// A task over several tips is held at what it was at the start.
pub(super) fn put_wait_before(task: &mut TaskPlan, steps: usize) {
    let first: Vec<f64> = task.errors.iter().take(task.rows).copied().collect();
    task.errors.splice(0..0, first.repeat(steps));
}
