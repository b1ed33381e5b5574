//! Scenarios: what to plan, as a TOML file that people write and programs generate.
//!
//! [`ScenarioText`] is the text of a file with the positions of its keys and the values laid over it from
//! outside; [`Scenario`] is what it says. Every refusal is a [`ScenarioError`] that names the key and its place.

mod approach;
mod arm_task;
mod build;
mod check;
mod collision_spec;
mod criterion_spec;
mod document;
mod error;
mod exactly;
mod fastest;
mod files;
mod formulas;
mod key_path;
mod kind_reader;
#[cfg(feature = "schema")]
mod kind_schema;
mod kinds;
mod law_spec;
mod lock_position;
mod model;
mod noise_spec;
mod overrides;
mod path_spec;
mod relation_spec;
mod robot_edits;
mod robots;
mod staging;
mod start_pose;
mod study_spec;
pub mod suite;
#[cfg(test)]
mod tests;
mod time_law_spec;
mod waypoint_file;

pub use approach::Approach;
pub use arm_task::{ArmTask, NoTask, RowsSpec};
pub use collision_spec::{CollisionSpec, ObstacleSpec};
pub use criterion_spec::CriterionSpec;
pub use document::{ScenarioText, read_text};
pub use error::{ErrorKind, Place, ScenarioError, suggestion};
pub use fastest::Fastest;
pub use formulas::{FormulaRows, row_refusals};
pub use key_path::{KeyPath, Step};
pub use kinds::Kinds;
pub use kinstep::integrate::StarterKind;
pub use kinstep::kind::Real;
pub use kinstep::math::{ExpressionError, evaluate};
pub use kinstep::task::{Plane, TaskKind};
pub use law_spec::LawSpec;
pub use lock_position::LockPosition;
pub use model::{ArmSpec, Mount, Scenario};
pub use noise_spec::NoiseSpec;
pub use path_spec::{PathSpec, TurnSpec};
pub use relation_spec::RelationSpec;
pub use robot_edits::{calibrated, limited, tool_name};
pub use robots::RobotSource;
pub use start_pose::{OnPath, StartPose, TipPose};
pub use study_spec::{
    CrossingDirection, EventSpec, EventTable, MeasureKind, Precision, ProblemSpec, ReferenceSpec, StudySpec,
};
pub use time_law_spec::TimeLawSpec;
