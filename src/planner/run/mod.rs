//! Runs that advance together by one stepper: what is recorded of them, what disturbs them, and what stops them.

mod approach;
mod convergence;
mod differences;
mod ensemble;
mod field;
mod noise;
mod plan;
mod reachability;
mod record;
mod stop_criteria;
mod time_scale;

pub use convergence::Convergence;
pub use differences::Peak;
pub use noise::Noise;
pub use plan::{ArmPlan, Plan, PlanStatus, SharedJoints, Stop, TaskPlan};

pub(super) use ensemble::Ensemble;
pub(super) use field::{Evaluated, SynchronousField};
pub(super) use record::Description;
