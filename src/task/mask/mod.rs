//! Any rows of a pose, in axes of choice.

mod axes;
#[expect(clippy::module_inception, reason = "the file is named after the type that it holds")]
mod mask;
mod path_axes;
mod pose_rows;

pub use axes::Axes;
pub use mask::Mask;

pub(super) use mask::Row;
pub(super) use pose_rows::PoseRows;
