//! Why a run near a singularity stopped: is the place it should go to within reach at all?

use crate::inverse::{Search, Target};
use crate::planner::system::ArmRuntime;
use crate::task::{Reference, TaskKind};

/// Configurations tried from which a reachable reference should be found.
const STARTS: usize = 24;
/// A residual below this [m, rad] counts as reached.
const REACHED: f64 = 1e-6;

/// The smallest task error with which the tip gets to `reference` from where it is or from places around it, over a bounded,
/// deterministic search. Joint limits are left out: this asks about geometry.
pub(in crate::planner) fn smallest_distance(
    runtime: &ArmRuntime,
    task: TaskKind,
    reference: &Reference,
) -> f64 {
    let target = Target::of_task(task, reference);
    let search = Search::new().starts(STARTS).solutions(1).near(&runtime.positions).beyond_limits();
    search.solve(&runtime.arm.chain, &target).map_or(f64::INFINITY, |solution| solution.distance())
}

/// Whether that distance means the reference can be reached.
pub(in crate::planner) fn is_reached(distance: f64) -> bool {
    distance < REACHED
}
