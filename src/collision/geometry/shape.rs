//! What an obstacle may be, and its distance from a capsule.

use nalgebra::{IsometryMatrix3, Vector3};

use super::{Capsule, Cuboid, HalfSpace, Separation, segment_box, segment_plane, segments};

/// What an obstacle may be.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Shape {
    /// A capsule, or a sphere.
    Capsule(Capsule),
    /// A box.
    Box(Cuboid),
    /// Everything on one side of a plane.
    HalfSpace(HalfSpace),
}

impl Shape {
    /// Returns the shape in the axes in which `pose` stands.
    #[must_use]
    pub fn placed(&self, pose: &IsometryMatrix3<f64>) -> Shape {
        match self {
            Shape::Capsule(capsule) => Shape::Capsule(capsule.placed(pose)),
            Shape::Box(cuboid) => Shape::Box(cuboid.placed(pose)),
            Shape::HalfSpace(solid) => Shape::HalfSpace(solid.placed(pose)),
        }
    }

    /// Returns a lower bound of the distance \[m\] from a sphere, for a fraction of what the distance costs.
    pub(in crate::collision) fn least_distance(&self, center: &Vector3<f64>, radius: f64) -> f64 {
        match self {
            Shape::Capsule(capsule) => {
                let (middle, own) = capsule.bounding_sphere();
                (center - middle).norm() - own - radius
            }
            Shape::Box(cuboid) => {
                (center - cuboid.pose().translation.vector).norm() - cuboid.half_sides().norm() - radius
            }
            Shape::HalfSpace(solid) => solid.height_of(center) - radius,
        }
    }
}

impl From<Capsule> for Shape {
    fn from(capsule: Capsule) -> Shape {
        Shape::Capsule(capsule)
    }
}

impl From<Cuboid> for Shape {
    fn from(cuboid: Cuboid) -> Shape {
        Shape::Box(cuboid)
    }
}

impl From<HalfSpace> for Shape {
    fn from(solid: HalfSpace) -> Shape {
        Shape::HalfSpace(solid)
    }
}

impl Capsule {
    /// Returns the exact separation of two capsules (or spheres) given in the same axes; the normal points from `other` to this
    /// one. Allocates nothing, and is never NaN for finite capsules.
    pub fn separation(&self, other: &Capsule) -> Separation {
        segments::separation(self, other)
    }

    /// Returns the exact separation of the capsule from a shape given in the same axes; the normal points from the shape to the
    /// capsule. Allocates nothing, and is never NaN for finite shapes.
    ///
    /// ```
    /// use kinstep::collision::{Capsule, HalfSpace};
    /// use kinstep::nalgebra::Vector3;
    /// let floor = HalfSpace::new(Vector3::zeros(), Vector3::z())?;
    /// let ball = Capsule::sphere(Vector3::new(1.0, 2.0, 0.05), 0.1)?;
    /// let separation = ball.separation_from(&floor.into());
    /// assert!((separation.distance + 0.05).abs() < 1e-15, "it sinks in by 5 cm");
    /// # Ok::<(), kinstep::collision::ShapeError>(())
    /// ```
    pub fn separation_from(&self, shape: &Shape) -> Separation {
        match shape {
            Shape::Capsule(other) => segments::separation(self, other),
            Shape::Box(cuboid) => segment_box::separation(self, cuboid),
            Shape::HalfSpace(solid) => segment_plane::separation(self, solid),
        }
    }
}
