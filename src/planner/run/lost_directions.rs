//! Which directions of its task an arm lost near singularities, where and how long.

use super::plan::{ArmPlan, LostDirection};
use crate::planner::system::{ArmRuntime, Coupling};

/// The directions that an arm lost in a run of its own: one for each stretch of samples. Costs nothing where no sample was damped.
/// Of arms that are resolved together it is not known which of them lost what.
pub(super) fn lost_directions(plan: &ArmPlan, runtime: &ArmRuntime, sigma: f64) -> Vec<LostDirection> {
    let mut lost: Vec<LostDirection> = Vec::new();
    if plan.damped_samples == 0 || runtime.coupling != Coupling::None {
        return lost;
    }
    let mut is_open = false;
    for n in 0..plan.errors.len() {
        let t = n as f64 * sigma;
        let (smallest_singular_value, direction) = runtime.arm.weakest_direction(t, plan.position(n));
        let is_lost = smallest_singular_value < runtime.threshold;
        let here = LostDirection { from: t, to: t, direction, smallest_singular_value };
        match lost.last_mut().filter(|_| is_lost && is_open) {
            Some(last) if smallest_singular_value < last.smallest_singular_value => {
                *last = LostDirection { from: last.from, ..here };
            }
            Some(last) => last.to = t,
            None if is_lost => lost.push(here),
            None => {}
        }
        is_open = is_lost;
    }
    lost
}
