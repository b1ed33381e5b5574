//! Shapes and the exact distances between them.

mod capsule;
mod cuboid;
mod half_space;
mod segment_box;
mod segment_plane;
mod segments;
mod separation;
mod shape;
mod shape_error;

pub use capsule::Capsule;
pub use cuboid::Cuboid;
pub use half_space::HalfSpace;
pub use separation::Separation;
pub use shape::Shape;
pub use shape_error::ShapeError;
