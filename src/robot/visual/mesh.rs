//! Meshes: triangles, by colour.

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use super::Colour;

/// Most triangles that are read.
pub(super) const MOST_TRIANGLES: usize = 4_000_000;

/// The corners of a triangle \[m\], counter-clockwise as seen from outside.
pub type Triangle = [[f32; 3]; 3];

/// Triangles of one colour.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshPart {
    /// Colour of the triangles, where the file gives one.
    pub colour: Option<Colour>,
    /// The triangles of this colour.
    pub triangles: Vec<Triangle>,
}

/// The surface of a body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// The parts of the mesh, none of them empty.
    pub parts: Vec<MeshPart>,
}

/// Why there is no mesh.
#[derive(Debug, Error)]
pub enum MeshError {
    /// The file can not be read.
    #[error("{} can not be read: {source}", .path.display())]
    File {
        /// Path of the file.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
    /// The file holds no mesh that is understood.
    #[error("{} is no mesh: {reason}", .path.display())]
    Content {
        /// Path of the file.
        path: PathBuf,
        /// Why the file gives no mesh.
        reason: String,
    },
}

impl Mesh {
    /// Returns the number of triangles of all parts.
    pub fn triangles(&self) -> usize {
        self.parts.iter().map(|part| part.triangles.len()).sum()
    }
}

/// Splits a polygon, given by its corners, into triangles about its first.
pub(super) fn fan(corners: &[[f32; 3]]) -> impl Iterator<Item = Triangle> {
    corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]])
}
