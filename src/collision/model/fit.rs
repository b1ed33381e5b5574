//! What a capsule was fitted to.

/// A capsule that was fitted to a shape of a robot's file.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Name of the link.
    pub link: String,
    /// What the shape is: `box`, `cylinder`, `capsule`, `sphere` or `mesh`.
    pub shape: &'static str,
    /// Radius of the capsule \[m\].
    pub radius: f64,
    /// Length of the capsule's segment \[m\].
    pub length: f64,
    /// Volume of the capsule over that of the shape, 1 where it is exact; `None` for meshes that enclose no volume.
    pub volume_ratio: Option<f64>,
}
