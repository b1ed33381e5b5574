//! Which directions of its task an arm lost near singularities, where and how long.

use super::plan::ArmPlan;
use crate::planner::system::{ArmRuntime, Coupling};
use nalgebra::Vector6;

/// A direction of its task that an arm could move in too slowly to be asked for in full: its singular value lay below the law's
/// threshold, where inverses are damped.
#[derive(Clone, Debug, PartialEq)]
pub struct LostDirection {
    /// From when \[s\].
    pub from: f64,
    /// Until when \[s\]: the last sample at which it was lost.
    pub to: f64,
    /// The unit vector (linear; angular) in the axes of the task, where it was worst; its sign means nothing.
    pub direction: Vector6<f64>,
    /// The smallest singular value then.
    pub smallest_singular_value: f64,
}

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
