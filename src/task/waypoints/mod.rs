//! Paths through given poses: what a list of them says, and the curves through it.

mod quintic_spline;
mod rotation_spline;
#[expect(clippy::module_inception, reason = "the file is named after the type that it holds")]
mod waypoints;

pub use quintic_spline::{Ends, QuinticSpline};
pub use rotation_spline::RotationSpline;
pub use waypoints::{WaypointProblem, Waypoints};

pub(super) use quintic_spline::interval;
pub(super) use waypoints::{FILE, KNOTS, POINTS, QUATERNIONS, RPY, TIMES, objection};
