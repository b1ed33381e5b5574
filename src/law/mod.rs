//! How redundancy is resolved: from task velocities to joint velocities.

mod criterion;
mod least_norm;
mod pseudoinverse;
mod stacked;

pub use criterion::Criterion;
pub use pseudoinverse::Pseudoinverse;

pub(crate) use least_norm::least_norm;
pub(crate) use stacked::StackedPseudoinverse;

use nalgebra::Vector6;

/// What a law is asked to resolve at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Demand<'a> {
    /// Number of task rows that count (2, 3 or 6): the leading ones of every 6-vector here.
    pub rows: usize,
    /// The columns of the geometric Jacobian at `q`.
    pub jacobian: &'a [Vector6<f64>],
    /// Joint positions [rad or m].
    pub q: &'a [f64],
    /// Desired task velocity `phi'`.
    pub feedforward: &'a Vector6<f64>,
    /// Corrective task velocity `-k e`.
    pub feedback: &'a Vector6<f64>,
}

/// How well conditioned the instant was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// The smallest singular value of the task Jacobian where it is near the threshold, else a lower bound of it.
    pub smallest_singular_value: f64,
    /// Whether the answer was damped because that value lay below the law's threshold.
    pub damped: bool,
}

/// A redundancy resolution, applied to the two parts of the motion apart.
///
/// The feedforward part is integrated with the row's `beta`, the feedback part with its `gamma`; both see the same
/// Jacobian. A law owns what scratch memory it needs, so each arm has its own.
pub trait Law: Send {
    /// Allocates what a Jacobian of `rows` rows and `joints` columns with lengths of order `length` \[m\] needs; called
    /// once, before the first [`resolve`](Law::resolve).
    fn prepare(&mut self, rows: usize, joints: usize, length: f64);

    /// Writes the joint velocities [rad/s or m/s] of the feedforward part and of the feedback part.
    fn resolve(&mut self, demand: &Demand<'_>, feedforward: &mut [f64], feedback: &mut [f64]) -> Resolution;

    /// The singular value below which this law calls a configuration singular.
    fn threshold(&self) -> f64;

    /// The threshold of a law that is the least-norm law and nothing else: while the smallest singular value is certain to
    /// lie above it, the planner resolves several arms at once, with the same answer to the last bit.
    fn least_norm_threshold(&self) -> Option<f64> {
        None
    }

    /// The rate [1/s] at which a null-space criterion of this law pulls the joints, if it has one. It is integrated
    /// explicitly, so the planner refuses a `sigma` at which the row could not follow it.
    fn criterion_rate(&self) -> Option<f64> {
        None
    }
}
