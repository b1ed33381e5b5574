//! Runs that advance together by one stepper: what is recorded of them, what disturbs them, and what stops them.

mod approach;
mod closest_approach;
mod convergence;
mod differences;
mod distance_watch;
mod ensemble;
mod field;
mod lost_directions;
mod noise;
mod plan;
mod reachability;
mod record;
mod stop_criteria;
mod time_scale;

pub use closest_approach::ClosestApproach;
pub use convergence::Convergence;
pub use differences::Peak;
pub use noise::Noise;
pub use plan::{ArmPlan, LostDirection, Plan, PlanStatus, SharedJoints, StackRank, Stop, TaskPlan};

pub(super) use distance_watch::DistanceWatch;
pub(super) use ensemble::Ensemble;
pub(super) use field::{Evaluated, SynchronousField};
pub(super) use record::Description;
