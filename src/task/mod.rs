//! What a tip shall do: paths, the time laws they are run through with, and the error against them.

mod added_task;
mod curve;
mod distance;
mod error;
mod leaning;
mod motion;
mod path;
#[expect(clippy::module_inception, reason = "the file is named after the trait that it holds")]
mod task;
mod time_law;
mod tracking;
mod waypoints;

pub use added_task::{AddedTaskKind, MadeTask, MakeTask, TaskStart};
pub use curve::{
    Astroid, CURVES, Circle, CurveKind, Fourier, Line, Lissajous, MakeCurve, PlanarCurve, Polyline, Rose,
    Spline, Tricuspid,
};
pub use distance::Distance;
pub use error::TaskKind;
pub use leaning::Leaning;
pub(crate) use motion::place_of_sample;
pub use motion::{Motion, Reference};
pub use path::{Path, PathPoint, Planar, Plane, Turning};
pub use task::{Component, Task, TaskInstant, TaskRows, Tip};
pub use time_law::{
    Linear, MakeTimeLaw, Quintic, SCurve, Sin2, Sin2Sin2, TIME_LAWS, TimeLaw, TimeLawKind, Trapezoid,
};
pub use tracking::Tracking;
pub use waypoints::{Ends, QuinticSpline, RotationSpline, WaypointProblem, Waypoints};

pub(crate) use error::pose_error;

/// Every built-in task beside those of the arms.
pub const TASKS: &[AddedTaskKind] = &[distance::KIND];
