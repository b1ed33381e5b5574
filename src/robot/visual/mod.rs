//! What a robot looks like: the shapes of its links as its URDF has them, and the meshes that they name.
//!
//! Looks matter to nothing but pictures, so nothing here refuses a robot: a shape that can not be read or found is left out,
//! and a note says so.

mod collada;
mod find;
mod mesh;
mod obj;
mod read;
mod reduce;
mod stl;
mod visuals;

pub use find::find_mesh;
pub use mesh::{Mesh, MeshError, MeshPart, Triangle};
pub use visuals::{Colour, Shape, Visual, Visuals};
