//! Robots: a URDF read strictly into flat arrays, and directed chains through it with pose and Jacobian.
//!
//! [`Robot::from_urdf`] gives a robot and its [`Diagnostic`]s; a defective joint spoils only the chains that
//! pass through it. [`Robot::from_dh`] makes one of a Denavit-Hartenberg table. [`Robot::with_calibration`],
//! [`Robot::with_locked`] and [`Robot::with_tool`] give changed copies, [`Robot::to_urdf`] writes any of them down.
//! [`Robot::chain`] gives the path between any two links, in either direction, and [`Chain::forward`] its kinematics.
//!
//! [`Robot`] itself knows none of these: each is a file with an `impl Robot` of its own.

mod calibration;
mod chain;
mod chain_error;
mod dh;
mod diagnostic;
mod displacement;
pub mod embedded;
mod export;
mod file;
mod fold;
mod follow;
mod kinematics;
mod link_kinematics;
mod lock;
mod lookup;
mod model;
pub mod names;
pub mod nearby;
mod path;
mod places;
mod poses;
mod positions;
mod read_error;
mod report;
mod segment;
mod side_by_side;
mod size;
mod toml_table;
mod tool;
mod tree;
mod units;
mod urdf;
mod visual;
mod with_limits;

pub use calibration::{Calibration, CalibrationError, JointCorrection};
pub use chain::{Chain, ChainJoint, LimitViolation};
pub use chain_error::ChainError;
pub use dh::{DhConvention, DhError, DhRow, DhTable};
pub use diagnostic::{Diagnostic, Severity};
pub use export::ExportError;
pub use kinematics::{ChainScratch, MovingAxis, Posed};
pub use link_kinematics::{JointSource, LinkKinematics, LinkScratch, PosedLinks};
pub use lock::LockError;
pub use model::{Defect, Joint, JointKind, Limits, Link, Mimic, Robot};
pub use positions::PositionsError;
pub use read_error::ReadError;
pub use size::unbelievable;
pub use tool::ToolError;
pub use tree::{TreeRow, TreeRows};
pub use units::{degrees_suspected, millimetres_suspected};
pub use urdf::{DisabledPair, MAX_BYTES, MAX_DEPTH, MAX_JOINTS, Srdf, UrdfError, UrdfOptions};
pub use visual::{Colour, Mesh, MeshError, MeshPart, Shape, Triangle, Visual, Visuals, find_mesh};
pub use with_limits::LimitsError;

pub(crate) use diagnostic::summary;
pub(crate) use report::Report;
pub(crate) use side_by_side::{SideBySide, SideBySideScratch};
pub(crate) use toml_table::{Entries, read_toml, wrong_type};
