//! Why a run near a singularity stopped: is the place it should go to within reach at all?

use super::field::ArmRuntime;
use crate::math::GramCholesky;
use crate::robot::{Chain, Posed};
use crate::task::{Reference, TaskKind};
use nalgebra::Vector6;

/// Configurations tried from which a reachable reference should be found.
const STARTS: usize = 24;
/// Damped least-squares steps from each.
const ITERATIONS: usize = 120;
/// A residual below this [m, rad] counts as reached.
const REACHED: f64 = 1e-6;

/// The smallest task error with which the tip gets to `reference` from `q` or from places around it, over a bounded,
/// deterministic search by the Levenberg-Marquardt method. Joint limits are left out: this asks about geometry.
pub(super) fn smallest_distance(runtime: &ArmRuntime, q: &[f64], reference: &Reference) -> f64 {
    let (chain, task) = (&runtime.arm.chain, runtime.arm.task);
    let mut best = f64::INFINITY;
    for start in 0..STARTS {
        let mut candidate = scattered(q, start);
        best = best.min(match task {
            TaskKind::PositionXy => descend::<2>(chain, task, reference, &mut candidate),
            TaskKind::Position => descend::<3>(chain, task, reference, &mut candidate),
            TaskKind::Pose => descend::<6>(chain, task, reference, &mut candidate),
        });
        if best < REACHED {
            break;
        }
    }
    best
}

/// Whether that distance means the reference can be reached.
pub(super) fn is_reached(distance: f64) -> bool {
    distance < REACHED
}

/// The `start`-th configuration around `q`: further away each time, in directions from additive recurrences.
fn scattered(q: &[f64], start: usize) -> Vec<f64> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let radius = std::f64::consts::PI * start as f64 / STARTS as f64;
    let offset = |i: usize| ((start * (i + 2)) as f64 * GOLDEN + (i as f64).sqrt()).fract() * 2.0 - 1.0;
    q.iter().enumerate().map(|(i, &q)| q + radius * offset(i)).collect()
}

fn descend<const M: usize>(chain: &Chain, task: TaskKind, reference: &Reference, q: &mut [f64]) -> f64 {
    let mut scratch = chain.scratch();
    let mut columns = vec![Vector6::zeros(); chain.dof()];
    let measure = |posed: &Posed<'_>| task.error(&posed.pose(), reference);
    let mut damping = 1e-3;
    let posed = chain.forward(q, &mut scratch);
    let mut error = measure(&posed);
    posed.geometric_jacobian(&mut columns);
    for _ in 0..ITERATIONS {
        if error.norm() < REACHED {
            break;
        }
        let Some(step) = damped_step::<M>(&columns, &error, damping) else { break };
        let candidate: Vec<f64> = q.iter().zip(&step).map(|(q, s)| q - s).collect();
        let posed = chain.forward(&candidate, &mut scratch);
        let next = measure(&posed);
        if next.norm() < error.norm() {
            posed.geometric_jacobian(&mut columns);
            q.copy_from_slice(&candidate);
            error = next;
            damping = (damping * 0.2).max(1e-12);
        } else {
            damping *= 5.0;
            if damping > 1e6 {
                break;
            }
        }
    }
    error.norm()
}

/// `J^T (J J^T + damping I)^-1 e`: the damping enters as extra columns of `J`.
fn damped_step<const M: usize>(
    columns: &[Vector6<f64>],
    error: &Vector6<f64>,
    damping: f64,
) -> Option<Vec<f64>> {
    let mut extended = columns.to_vec();
    extended.extend((0..M).map(|i| {
        let mut unit = Vector6::zeros();
        unit[i] = damping.sqrt();
        unit
    }));
    let y = GramCholesky::<M>::new(&extended)?.solve(&std::array::from_fn(|i| error[i]));
    Some(columns.iter().map(|column| (0..M).map(|i| column[i] * y[i]).sum()).collect())
}
