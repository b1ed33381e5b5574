//! Generic multistep integration and synchronous kinematic control of robot arms.
//!
//! Three things that are usually welded together are separate values here: a *formula* (a row of exact
//! rationals, checked for order, error constant and zero-stability before anything runs on it), a *robot*
//! (read from URDF) and a *law* (how redundancy is resolved). A plan is formula x robot x task x law.

pub mod collision;
pub mod formula;
pub mod integrate;
pub mod inverse;
pub mod kind;
pub mod law;
pub mod math;
pub mod planner;
pub mod robot;
pub mod scheme;
pub mod task;

/// The linear algebra of the public interface: poses are [`nalgebra::IsometryMatrix3`], twists [`nalgebra::Vector6`].
pub use nalgebra;
