//! What a tip shall do: paths, the time laws they are run through with, and the error against them.

mod added_task;
mod cooperative;
mod curve;
mod distance;
mod error;
mod free;
mod leaning;
mod mask;
mod masked;
mod motion;
mod object;
mod path;
mod relative;
#[expect(clippy::module_inception, reason = "the file is named after the trait that it holds")]
mod task;
mod time_law;
mod tracking;
mod waypoints;

pub use added_task::{AddedTaskKind, LayPath, MadeTask, MakeTask, TaskStart};
pub use cooperative::Cooperative;
pub use curve::{
    Astroid, CURVES, Circle, CurveKind, Fourier, Hold, Line, Lissajous, MakeCurve, PlanarCurve, Polyline,
    Rose, Spline, Tricuspid,
};
pub use distance::Distance;
pub use error::TaskKind;
pub use free::Free;
pub use leaning::Leaning;
pub use mask::{Axes, Mask};
pub use masked::Masked;
pub(crate) use motion::place_of_sample;
pub use motion::{Motion, Reference};
pub use object::{Carried, Held};
pub use path::{Path, PathPoint, Planar, Plane, Turning};
pub use relative::Relative;
pub use task::{Component, Task, TaskInstant, TaskRows, Tip};
pub use time_law::{
    Linear, MakeTimeLaw, Quintic, SCurve, Sin2, Sin2Sin2, TIME_LAWS, TimeLaw, TimeLawKind, Trapezoid,
};
pub use tracking::Tracking;
pub use waypoints::{Ends, QuinticSpline, RotationSpline, WaypointProblem, Waypoints};

pub(crate) use error::pose_error;

/// Every built-in task beside those of the arms.
pub const TASKS: &[AddedTaskKind] = &[relative::KIND, cooperative::KIND, object::KIND, distance::KIND];
