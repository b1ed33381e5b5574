//! Brings formula, robots, tasks and laws together: [`Planner`] steps N arms in synchrony, [`Plan`] is what came of it.

mod arm;
mod batch;
mod board;
mod builder;
mod bundle;
mod diagnosis;
mod error;
mod field;
mod fleet;
mod glance;
mod lost;
mod monitor;
mod noise;
mod plan;
mod run;
mod runtime;
mod shared;

pub use arm::Arm;
pub use batch::{Batch, run_together};
pub use builder::{Feedback, PlannerBuilder, Start};
pub use error::PlannerError;
pub use monitor::{LimitKind, Violation};
pub use noise::Noise;
pub use plan::{ArmPlan, Plan, PlanStatus, SharedJoints};
pub use run::{ArmState, Planner, Stop};
