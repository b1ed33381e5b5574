//! Obstacles and self-collision: capsules about links, exact distances, and how these change with the joints.
//!
//! A [`Capsule`] stands for each part of a link. [`CollisionModel`] has those of a robot, fitted to its URDF or given, and the
//! pairs of links that are not checked. A [`Scene`] puts machines among obstacles ([`Shape`]); at a configuration it gives the
//! distances of all pairs that are near, and their rows of derivatives by the joints.

mod fit;
mod geometry;
mod model;
mod obstacle;
mod scene;

pub use geometry::{Capsule, Cuboid, HalfSpace, Separation, Shape, ShapeError};
pub use model::{CollisionError, CollisionModel, Fit, LinkCapsule, Missing};
pub use obstacle::{MakeObstacle, OBSTACLES, ObstacleKind};
pub use scene::{
    JointPlaces, Pairings, PlacedScene, Proximities, Proximity, Scene, SceneBuilder, SceneScratch,
};
