//! The one rule for inverses near a singularity.

use super::{Resolution, SystemShape, TaskShape};
use crate::math::RowRotations;

/// The default threshold, as a fraction of the length by which a task is judged.
const RELATIVE_THRESHOLD: f64 = 1e-3;

/// The threshold that was given, or else the largest of those of all tasks: of a task that is judged by a length \[m\] a fraction
/// of it, of at most one metre where angles are asked for too.
pub(super) fn threshold(given: Option<f64>, shape: &SystemShape) -> f64 {
    let of_task = |task: &TaskShape| {
        RELATIVE_THRESHOLD * if task.has_angles() { task.length.min(1.0) } else { task.length }
    };
    given.unwrap_or_else(|| shape.tasks.iter().map(of_task).fold(0.0, f64::max))
}

/// Whether an undamped inverse may be used: its singular values are certain to lie above the threshold, and it means
/// something at all.
pub(crate) fn is_regular(bound: f64, smallest_pivot: f64, threshold: f64) -> bool {
    smallest_pivot > 0.0 && bound > threshold
}

/// The inverse of a decomposed matrix, damped below a threshold `epsilon`: `sum v_i s_i / (s_i^2 + lambda^2) u_i`, with
/// `lambda^2 = epsilon^2 (1 - (s_min / epsilon)^2)`, which sets in continuously (Nakamura and Hanafusa 1986,
/// Chiaverini 1997).
pub(super) struct DampedInverse<'a> {
    rotations: &'a RowRotations,
    threshold: f64,
    smallest: f64,
    damping: f64,
}

impl<'a> DampedInverse<'a> {
    pub(super) fn new(rotations: &'a RowRotations, threshold: f64) -> Self {
        let smallest = rotations.smallest();
        let damping = (threshold * threshold - smallest * smallest).max(0.0);
        Self { rotations, threshold, smallest, damping }
    }

    /// Writes the damped inverse applied to `v`.
    pub(super) fn apply(&self, v: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        self.rotations.apply(v, |s| s / (s * s + self.damping), out);
    }

    /// Adds the inverse applied to `v`, never damped: it drops the directions below the threshold.
    pub(super) fn add_undamped(&self, v: &[f64], out: &mut [f64]) {
        self.rotations.apply(v, |s| if s < self.threshold { 0.0 } else { s.recip() }, out);
    }

    pub(super) fn resolution(&self) -> Resolution {
        Resolution {
            smallest_singular_value: self.smallest,
            damped: self.damping > 0.0,
            ..Resolution::default()
        }
    }
}
