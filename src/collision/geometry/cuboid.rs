//! Boxes.

use nalgebra::{IsometryMatrix3, Vector3};

use super::ShapeError;
use super::shape_error::believable;

/// A box: its middle and its axes are those of a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cuboid {
    pose: IsometryMatrix3<f64>,
    half: Vector3<f64>,
}

impl Cuboid {
    /// Returns the box with its middle at the origin of `pose` and sides of these lengths \[m\] along the pose's axes.
    ///
    /// # Errors
    /// [`ShapeError`]: a number that is not finite or beyond 1e6, a side that is not positive.
    pub fn new(pose: IsometryMatrix3<f64>, sides: Vector3<f64>) -> Result<Cuboid, ShapeError> {
        believable("center", &pose.translation.vector)?;
        for column in pose.rotation.matrix().column_iter() {
            believable("orientation", &column.into_owned())?;
        }
        believable("size", &sides)?;
        match sides.iter().find(|side| !(**side > 0.0)) {
            Some(&side) => Err(ShapeError::NoSide { side }),
            None => Ok(Cuboid { pose, half: sides / 2.0 }),
        }
    }

    /// Returns the pose of the middle.
    pub fn pose(&self) -> &IsometryMatrix3<f64> {
        &self.pose
    }

    /// Returns half the lengths of the sides \[m\].
    pub fn half_sides(&self) -> Vector3<f64> {
        self.half
    }

    /// Returns the box in the axes in which `pose` stands.
    #[must_use]
    pub fn placed(&self, pose: &IsometryMatrix3<f64>) -> Cuboid {
        Cuboid { pose: pose * self.pose, half: self.half }
    }
}
