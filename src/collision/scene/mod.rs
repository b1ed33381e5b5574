//! Machines among obstacles.

mod builder;
mod joint_places;
mod pairings;
mod proximities;
#[expect(clippy::module_inception, reason = "the file is named after what it holds")]
mod scene;

pub use builder::SceneBuilder;
pub use joint_places::JointPlaces;
pub use pairings::Pairings;
pub use proximities::{Proximities, Proximity};
pub use scene::{PlacedScene, Scene, SceneScratch};
