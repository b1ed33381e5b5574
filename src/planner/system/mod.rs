//! Arms and the systems that they form: which joints are resolved together, by which law, for which tasks, within which limits.

mod arm;
mod arm_runtime;
mod arm_state;
mod bounds;
mod dependent_tasks;
mod derivative_errors;
mod disturbance;
mod joint_index;
mod joint_sets;
mod joint_system;
mod lead;
mod limits;
mod monitor;
mod nearby;
mod resolved;
mod surroundings;

pub use arm::Arm;
pub use arm_state::ArmState;
pub use derivative_errors::{DerivativeErrors, derivative_errors, rows_at_start};
pub use joint_sets::joint_sets;
pub use joint_system::JointSystem;
pub use monitor::Violation;
pub use surroundings::Surroundings;

pub(super) use arm_runtime::{ArmRuntime, Coupling};
pub(super) use bounds::{Bounds, Deviation};
pub(super) use dependent_tasks::Dependence;
pub(super) use disturbance::Disturbance;
pub(super) use joint_index::JointIndex;
pub(super) use joint_sets::check_common_starts;
pub(super) use joint_system::AddedTask;
pub(super) use limits::{JointLimits, excess};
pub(super) use monitor::Monitor;
pub(super) use resolved::{Moment, System};
