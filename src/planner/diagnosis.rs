//! Why a run near a singularity stopped: is the place it should go to within reach at all?

use super::runtime::ArmRuntime;
use crate::inverse::{Search, Target};
use crate::task::Reference;

/// Configurations tried from which a reachable reference should be found.
const STARTS: usize = 24;
/// A residual below this [m, rad] counts as reached.
const REACHED: f64 = 1e-6;

/// The smallest task error with which the tip gets to `reference` from `q` or from places around it, over a bounded,
/// deterministic search. Joint limits are left out: this asks about geometry.
pub(super) fn smallest_distance(runtime: &ArmRuntime, q: &[f64], reference: &Reference) -> f64 {
    let target = Target::of_task(runtime.arm.task, reference);
    let search = Search::new().starts(STARTS).solutions(1).near(q).beyond_limits();
    search.solve(&runtime.arm.chain, &target).map_or(f64::INFINITY, |solution| solution.distance())
}

/// Whether that distance means the reference can be reached.
pub(super) fn is_reached(distance: f64) -> bool {
    distance < REACHED
}
