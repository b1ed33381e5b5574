//! Brings formula, robots, tasks and laws together: [`Planner`] steps N arms in synchrony, [`Plan`] is what came of it.
//!
//! Three folders below it, each of which sees those before it: `system` (arms, which joints are resolved together, limits),
//! `lanes` (the fast path for plain arms that are alike: nothing else needs to know it) and `run` (runs that advance
//! together, and what stops them).

mod batch;
mod builder;
mod error;
mod feedback;
mod grid;
mod lanes;
#[expect(clippy::module_inception, reason = "the file is named after the type that it holds")]
mod planner;
mod resolve;
mod run;
mod system;

pub use crate::law::LimitKind;
pub use batch::{Batch, run_together};
pub use builder::PlannerBuilder;
pub use error::PlannerError;
pub use feedback::Feedback;
pub use grid::{MAX_SAMPLE_BYTES, sample_bytes};
pub use planner::Planner;
pub use run::{
    ArmPlan, ClosestApproach, Convergence, LostDirection, Noise, Peak, Plan, PlanStatus, SharedJoints,
    StackRank, Stop, TaskPlan,
};
pub use system::{
    Arm, ArmState, DerivativeErrors, JointSystem, Surroundings, Violation, derivative_errors, joint_sets,
    rows_at_start,
};
