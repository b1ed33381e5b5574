//! Obstacles and self-collision: capsules about links, exact distances, and how these change with the joints.

mod geometry;

pub use geometry::{Capsule, Cuboid, HalfSpace, Separation, Shape, ShapeError};
