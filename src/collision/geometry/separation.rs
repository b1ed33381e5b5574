//! How far two shapes are apart, where and in which direction.

use nalgebra::{IsometryMatrix3, Vector3};

/// The signed distance between two shapes `a` and `b`, and where it is attained.
///
/// `points[0] - points[1] = distance * normal`, whether the shapes are apart or overlap; moving `a` by `-distance` along the
/// normal makes them touch. With `v_a` and `v_b` the velocities of the bodies at the two points,
/// `d(distance)/dt = normal . (v_a - v_b)` wherever the distance has a derivative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// The distance \[m\]; negative where the shapes overlap, by the least shift that would part them.
    pub distance: f64,
    /// The unit vector from `b` towards `a`.
    pub normal: Vector3<f64>,
    /// The witness points on the surfaces of `a` and of `b` \[m\].
    pub points: [Vector3<f64>; 2],
}

impl Separation {
    /// The separation of what grows around `a` and `b` by these radii.
    pub(super) fn inflated(self, radius_a: f64, radius_b: f64) -> Separation {
        let Separation { distance, normal, points: [a, b] } = self;
        Separation {
            distance: distance - radius_a - radius_b,
            normal,
            points: [a - normal * radius_a, b + normal * radius_b],
        }
    }

    /// The separation in the axes in which `pose` stands.
    pub(super) fn moved(self, pose: &IsometryMatrix3<f64>) -> Separation {
        let point = |point: Vector3<f64>| pose.rotation * point + pose.translation.vector;
        Separation { normal: pose.rotation * self.normal, points: self.points.map(point), ..self }
    }
}
