//! Shapes of links, and where they are.

use nalgebra::IsometryMatrix3;

/// Red, green, blue and opacity, each from 0 to 1.
pub type Colour = [f64; 4];

/// The shape of a visual, in its own axes.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A box about its middle.
    Box {
        /// Lengths of the box along its own x, y and z \[m\].
        sides: [f64; 3],
    },
    /// A cylinder along z, about its middle.
    Cylinder {
        /// Radius \[m\].
        radius: f64,
        /// Length \[m\].
        length: f64,
    },
    /// A cylinder along z with half spheres on its ends.
    Capsule {
        /// Radius \[m\].
        radius: f64,
        /// Length of the cylinder \[m\].
        length: f64,
    },
    /// A sphere about its middle.
    Sphere {
        /// Radius \[m\].
        radius: f64,
    },
    /// A mesh in a file.
    Mesh {
        /// How the URDF names the file ([`find_mesh`](super::find_mesh)).
        reference: String,
        /// Factors along the mesh's own x, y and z.
        scale: [f64; 3],
    },
}

/// One shape of a link.
#[derive(Clone, Debug, PartialEq)]
pub struct Visual {
    /// The link's name.
    pub link: String,
    /// Pose of the shape in the link.
    pub origin: IsometryMatrix3<f64>,
    /// The shape itself.
    pub shape: Shape,
    /// The shape's colour, where the URDF gives one.
    pub colour: Option<Colour>,
}

/// What the links of a robot look like.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Visuals {
    /// The shapes, in the order of the file.
    pub visuals: Vec<Visual>,
    /// The shapes that were left out, and why.
    pub notes: Vec<String>,
}
