//! Robots: a URDF read strictly into flat arrays, and directed chains through it with pose and Jacobian.
//!
//! [`Robot::from_urdf`] gives a robot and its [`Diagnostic`]s; a defective joint spoils only the chains that
//! pass through it. [`Robot::chain`] gives the path between any two links, in either direction, and
//! [`Chain::forward`] its kinematics.

mod chain;
mod diagnostic;
pub mod embedded;
mod fold;
mod kinematics;
mod model;
mod names;
mod path;
mod tree;
mod urdf;

pub use chain::{Chain, ChainJoint, LimitViolation};
pub use diagnostic::{Diagnostic, Severity};
pub use kinematics::{ChainScratch, Posed};
pub use model::{Defect, Joint, JointKind, Limits, Link, Mimic, Robot};
pub use path::ChainError;
pub use tree::{TreeRow, TreeRows};
pub use urdf::{MAX_BYTES, MAX_DEPTH, MAX_JOINTS, ReadError, UrdfError, UrdfOptions};
