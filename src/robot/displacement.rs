//! Where a joint's motion takes its child.

use nalgebra::{IsometryMatrix3, Rotation3, Translation3, Vector3};

use super::JointKind;

/// Returns the motion of a joint at a position: a shift along its axis, or a turn about it; none where it has no single
/// position.
pub(super) fn displacement(kind: JointKind, axis: Vector3<f64>, position: f64) -> IsometryMatrix3<f64> {
    match kind {
        _ if position == 0.0 => IsometryMatrix3::identity(),
        JointKind::Prismatic => IsometryMatrix3::from_parts((axis * position).into(), Rotation3::identity()),
        JointKind::Revolute | JointKind::Continuous => {
            IsometryMatrix3::from_parts(Translation3::identity(), Rotation3::new(axis * position))
        }
        _ => IsometryMatrix3::identity(),
    }
}
