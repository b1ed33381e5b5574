//! What a caller may ask of the reader.

/// How strictly a URDF is read.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct UrdfOptions {
    /// Take a revolute or prismatic joint without `<limit>` as unlimited (a warning) instead of as defective.
    pub assume_unlimited: bool,
    /// Take every attribute that URDF does not know as an error instead of a warning.
    pub strict: bool,
    /// The robot's name when the file gives none; `robot` when this is `None`.
    pub name: Option<String>,
}
