//! Versions of URDF.

/// The version of URDF that a file is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Version {
    V1_0,
    /// Adds `quat_xyzw`.
    V1_1,
    /// A limit that is not given is infinite.
    V1_2,
}
