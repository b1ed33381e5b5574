//! Capsules: all points within a radius of a segment. A sphere is one whose segment is a point.

use std::f64::consts::PI;

use nalgebra::{IsometryMatrix3, Vector3};

use super::ShapeError;
use super::shape_error::{believable, radius as check_radius};

/// All points within a radius of the segment between two points; a sphere where these are one point.
///
/// ```
/// use kinstep::collision::Capsule;
/// use kinstep::nalgebra::Vector3;
/// let finger = Capsule::new(Vector3::zeros(), Vector3::new(0.0, 0.0, 0.1), 0.01)?;
/// let ball = Capsule::sphere(Vector3::new(0.0, 0.05, 0.05), 0.02)?;
/// let separation = finger.separation(&ball);
/// assert!((separation.distance - 0.02).abs() < 1e-15);
/// assert!((separation.normal - Vector3::new(0.0, -1.0, 0.0)).norm() < 1e-15);
/// # Ok::<(), kinstep::collision::ShapeError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capsule {
    from: Vector3<f64>,
    to: Vector3<f64>,
    radius: f64,
}

impl Capsule {
    /// Returns the capsule of that radius \[m\] about the segment between two points \[m\].
    ///
    /// # Errors
    /// [`ShapeError`]: a number that is not finite or beyond 1e6, a negative radius.
    pub fn new(from: Vector3<f64>, to: Vector3<f64>, radius: f64) -> Result<Capsule, ShapeError> {
        believable("from", &from)?;
        believable("to", &to)?;
        check_radius(radius)?;
        Ok(Capsule { from, to, radius })
    }

    /// Returns the sphere of that radius \[m\] about a point \[m\].
    ///
    /// # Errors
    /// [`ShapeError`]: a number that is not finite or beyond 1e6, a negative radius.
    pub fn sphere(center: Vector3<f64>, radius: f64) -> Result<Capsule, ShapeError> {
        believable("center", &center)?;
        check_radius(radius)?;
        Ok(Capsule { from: center, to: center, radius })
    }

    /// Returns where the segment begins \[m\].
    pub fn from(&self) -> Vector3<f64> {
        self.from
    }

    /// Returns where the segment ends \[m\].
    pub fn to(&self) -> Vector3<f64> {
        self.to
    }

    /// Returns the radius \[m\].
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns whether the segment is a point.
    pub fn is_sphere(&self) -> bool {
        self.from == self.to
    }

    /// Returns the volume \[m^3\].
    pub fn volume(&self) -> f64 {
        let length = (self.to - self.from).norm();
        PI * self.radius * self.radius * (length + 4.0 / 3.0 * self.radius)
    }

    /// Returns the distance \[m\] of a point from the surface; negative inside.
    pub fn distance_to(&self, point: &Vector3<f64>) -> f64 {
        (point - self.nearest(point)).norm() - self.radius
    }

    /// The point of the segment that is nearest to a point.
    pub(super) fn nearest(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let along = self.to - self.from;
        let length = along.norm_squared();
        if !(length > 0.0) {
            return self.from;
        }
        // From the nearer end, so that the other end is hit exactly.
        match ((point - self.from).dot(&along) / length).clamp(0.0, 1.0) {
            part if part < 0.5 => self.from + along * part,
            part => self.to - along * (1.0 - part),
        }
    }

    /// Returns the capsule in the axes in which `pose` stands.
    #[must_use]
    pub fn placed(&self, pose: &IsometryMatrix3<f64>) -> Capsule {
        let place = |point: Vector3<f64>| pose.rotation * point + pose.translation.vector;
        Capsule { from: place(self.from), to: place(self.to), radius: self.radius }
    }

    /// Returns the middle and the radius \[m\] of the smallest sphere around the capsule.
    pub fn bounding_sphere(&self) -> (Vector3<f64>, f64) {
        (self.middle(), (self.to - self.from).norm() / 2.0 + self.radius)
    }

    /// Returns the spheres at both ends; the one that it is, where it is a sphere.
    pub(in crate::collision) fn ends(&self) -> impl Iterator<Item = Capsule> + use<> {
        let ends = [self.from, self.to].map(|end| Capsule { from: end, to: end, radius: self.radius });
        ends.into_iter().take(if self.is_sphere() { 1 } else { 2 })
    }

    pub(super) fn middle(&self) -> Vector3<f64> {
        (self.from + self.to) / 2.0
    }
}
