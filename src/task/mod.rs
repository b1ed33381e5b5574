//! What a tip shall do: paths, the time laws they are run through with, and the error against them.

mod curve;
mod error;
mod fourier;
mod motion;
mod path;
#[expect(clippy::module_inception, reason = "the file is named after the trait that it holds")]
mod task;
mod time_law;
mod tracking;

pub use curve::{Astroid, Circle, Line, Lissajous, PlanarCurve, Rose, Tricuspid};
pub use error::TaskKind;
pub use fourier::{Fourier, Leaning};
pub(crate) use motion::place_of_sample;
pub use motion::{Motion, Reference};
pub use path::{Path, PathPoint, Planar, Plane, Turning};
pub use task::{Component, Task, TaskInstant, TaskRows, Tip};
pub use time_law::{Linear, Quintic, Sin2, Sin2Sin2, TimeLaw};
pub use tracking::Tracking;

pub(crate) use error::pose_error;
