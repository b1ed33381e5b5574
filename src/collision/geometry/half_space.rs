//! Half-spaces: floors, walls, ceilings.

use nalgebra::{IsometryMatrix3, Vector3};

use super::ShapeError;
use super::shape_error::believable;

/// Everything on one side of a plane: the solid lies against the normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfSpace {
    normal: Vector3<f64>,
    offset: f64,
}

impl HalfSpace {
    /// Returns the half-space below the plane through `point` \[m\]; `normal`, of any length, points out of the solid.
    ///
    /// # Errors
    /// [`ShapeError`]: a number that is not finite or beyond 1e6, a normal of length zero.
    pub fn new(point: Vector3<f64>, normal: Vector3<f64>) -> Result<HalfSpace, ShapeError> {
        believable("point", &point)?;
        believable("normal", &normal)?;
        let largest = normal.amax();
        if !(largest > 0.0) {
            return Err(ShapeError::ZeroNormal);
        }
        // Scaled first: the square of a tiny number is zero.
        let normal = (normal / largest).normalize();
        Ok(HalfSpace { normal, offset: normal.dot(&point) })
    }

    /// Returns the unit vector that points out of the solid.
    pub fn normal(&self) -> Vector3<f64> {
        self.normal
    }

    /// Returns the height \[m\] of a point above the plane; negative in the solid.
    pub fn height_of(&self, point: &Vector3<f64>) -> f64 {
        self.normal.dot(point) - self.offset
    }

    /// Returns the half-space in the axes in which `pose` stands.
    #[must_use]
    pub fn placed(&self, pose: &IsometryMatrix3<f64>) -> HalfSpace {
        let normal = pose.rotation * self.normal;
        HalfSpace { normal, offset: self.offset + normal.dot(&pose.translation.vector) }
    }
}
