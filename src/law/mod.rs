//! How redundancy is resolved: from the rows of tasks to joint velocities.
//!
//! A [`Law`] answers for a *system*: joints that are resolved together (of one arm, of arms with joints in common, of arms
//! that a task ties together). It is prepared once for the system's [`SystemShape`] and then resolves [`Instant`] after
//! instant; what it can not meet it says by [`Infeasible`].

mod criteria_sum;
mod criterion;
mod damped;
mod damping;
mod distance_rows;
mod fixed_rows;
mod infeasible;
mod instant;
mod joint_ranges;
#[expect(clippy::module_inception, reason = "the file is named after the trait that it holds")]
mod law;
mod law_kind;
mod least_norm;
mod limited;
mod network;
mod prioritized;
mod pseudoinverse;
mod quadratic_program;
mod saturated;
mod shape;
mod stacked;
mod task_stack;
#[cfg(test)]
mod trial;
mod weighted;

pub use criterion::{
    CRITERIA, Clearance, Criterion, CriterionKind, JointLimits, MakeCriterion, Manipulability, Posture,
};
pub use damped::{Damped, Damping};
pub use infeasible::{Conflict, Infeasible, LimitKind};
pub use instant::{Avoidance, Instant, JointVelocity, NextState};
pub use law::{Law, LinearityKind, Resolution};
pub use law_kind::{Criteria, LawKind, MakeLaw};
pub use limited::{Limited, RangeMethod};
pub use network::{Network, NetworkKind, RecurrentNetwork};
pub use prioritized::Prioritized;
pub use pseudoinverse::Pseudoinverse;
pub use quadratic_program::{ActiveSetMethod, QuadraticProgram};
pub use saturated::{NullSpaceSaturation, Saturated};
pub use shape::{SystemShape, TaskShape};
pub use weighted::Weighted;

/// Every built-in law; the first is the one that is taken unless another is named.
pub const LAWS: &[LawKind] = &[
    pseudoinverse::KIND,
    damped::KIND,
    weighted::KIND,
    prioritized::KIND,
    quadratic_program::KIND,
    saturated::KIND,
    network::KIND,
];

pub(crate) use damping::is_regular;
pub(crate) use least_norm::least_norm;
