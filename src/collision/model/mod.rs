//! What of a robot may collide.

mod error;
mod file;
mod fit;
mod from_urdf;
#[expect(clippy::module_inception, reason = "the file is named after the idea")]
mod model;

pub use error::CollisionError;
pub use fit::Fit;
pub use model::{CollisionModel, LinkCapsule, Missing};
