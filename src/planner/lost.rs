//! When an arm counts as lost, and why a run stopped.

use super::runtime::ArmRuntime;
use super::{PlanStatus, Stop, diagnosis};
use crate::task::Reference;
use nalgebra::Vector6;

/// The task error at which a run is stopped, as a fraction of the chain's reach.
const LOST_FRACTION_OF_REACH: f64 = 0.1;
/// The orientation error at which a run is stopped \[rad\].
const LOST_ORIENTATION: f64 = 1.0;
/// The fraction of those bounds that an arm with fewer joints than task components is held to: the error of a path that it
/// can not follow does not grow, it just stays.
const WITH_TOO_FEW_JOINTS: f64 = 0.01;
/// The fraction that an arm of a stable loop is held to once it came near a singularity: whatever it loses there, no
/// feedback will bring back, and the velocities it would take grow with the error.
const NEAR_SINGULARITY: f64 = 0.2;
/// Within this many thresholds a configuration counts as near a singularity.
pub(super) const NEAR: f64 = 10.0;
/// Below this fraction of those bounds an arm counts as back on its path after a singularity.
const RECOVERED: f64 = 0.05;

/// The squared lengths of a task error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deviation {
    /// \[m^2\]
    pub(super) position: f64,
    /// \[rad^2\]
    pub(super) orientation: f64,
}

impl Deviation {
    pub(super) fn of(e: &Vector6<f64>) -> Self {
        Self {
            position: e[0] * e[0] + e[1] * e[1] + e[2] * e[2],
            orientation: e[3] * e[3] + e[4] * e[4] + e[5] * e[5],
        }
    }
}

/// What an arm's task error is measured by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// The chain's reach, or a metre where that is infinite.
    pub(super) length: f64,
    /// Whether there are fewer joints than task components, its own or those of all arms that it shares joints with.
    pub(super) has_too_few_joints: bool,
}

impl Bounds {
    /// The largest deviation that lies within this fraction of the bounds.
    pub(super) fn largest(&self, fraction: f64) -> Deviation {
        let fraction = if self.has_too_few_joints { WITH_TOO_FEW_JOINTS * fraction } else { fraction };
        Deviation {
            position: (fraction * (LOST_FRACTION_OF_REACH * self.length)).powi(2),
            orientation: (fraction * LOST_ORIENTATION).powi(2),
        }
    }
}

/// Whether the task error lies within this fraction of the bounds at which a run is stopped; false for NaN.
fn is_within(runtime: &ArmRuntime, fraction: f64) -> bool {
    let (deviation, largest) = (Deviation::of(&runtime.error), runtime.bounds.largest(fraction));
    deviation.position <= largest.position && deviation.orientation <= largest.orientation
}

/// Whether the smallest singular value lies below that many of the law's thresholds.
fn is_singular(runtime: &ArmRuntime, thresholds: f64) -> bool {
    runtime.resolution.smallest_singular_value < thresholds * runtime.arm.law.threshold()
}

/// A run does not begin in a singular configuration: nothing could be promised about its first steps.
pub(super) fn check_start(arms: &mut [ArmRuntime]) -> Option<Stop> {
    for runtime in &mut *arms {
        runtime.was_singular = is_singular(runtime, 1.0);
    }
    let runtime = arms.iter().find(|runtime| runtime.was_singular)?;
    let of = if runtime.is_shared {
        "the stacked task Jacobian of all arms that share its joints".to_owned()
    } else {
        format!("its {}-row task Jacobian", runtime.arm.task.rows())
    };
    let reason = format!(
        "arm `{}` starts in a singular configuration: the smallest singular value of {of} at q0 is {:.3e}, below the threshold {:.3e}; choose another q0 (a bent arm) or a task with fewer components",
        runtime.arm.name,
        runtime.resolution.smallest_singular_value,
        runtime.arm.law.threshold()
    );
    Some(Stop { status: PlanStatus::Singular, reason })
}

/// Stops the run when one of its arms has lost its path, and finds out why.
///
/// A loop outside its range diverges unless rank is missing right now. Inside the range the loop is not to blame:
/// what counts is whether the arm met a singularity since it was last on its path, and whether the point it should
/// go to can be reached.
pub(super) fn check_lost(arms: &mut [ArmRuntime], is_stable: bool, t: f64) -> Option<Stop> {
    for runtime in arms {
        let singular = is_singular(runtime, if is_stable { NEAR } else { 1.0 });
        let lost_rank = singular || runtime.was_singular;
        let fraction = if is_stable && lost_rank { NEAR_SINGULARITY } else { 1.0 };
        if !is_within(runtime, fraction) {
            return Some(diagnose(runtime, is_stable, lost_rank, t));
        }
        let remembers = is_stable && !is_within(runtime, RECOVERED);
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
    let reference = runtime.arm.motion.at(t);
    let distance = diagnosis::smallest_distance(runtime, &runtime.positions, &reference);
    if !diagnosis::is_reached(distance) {
        return unreachable(runtime, t, &reference, distance);
    }
    if lost_rank {
        return singular(runtime, t, &reference);
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

fn singular(runtime: &ArmRuntime, t: f64, reference: &Reference) -> Stop {
    // What a set of arms can reach at once is not known from what each of them can.
    let (of, reached) = if runtime.is_shared {
        ("the Jacobian of all arms that share its joints", "by this arm if it were alone")
    } else {
        ("its Jacobian", "from another q0 for instance")
    };
    let reason = format!(
        "arm `{}` met a singularity and lost its path at t = {t:.6} s with a task error of {:.3e}: the smallest singular value of {of} is {:.3e}, with a threshold of {:.3e}; the path's point {} can be reached, {reached}",
        runtime.arm.name,
        runtime.error.norm(),
        runtime.resolution.smallest_singular_value,
        runtime.arm.law.threshold(),
        place(reference)
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
