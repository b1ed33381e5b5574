use super::{Path, PathPoint};
use nalgebra::{Rotation3, Unit, Vector3};
use std::f64::consts::TAU;

/// A path whose orientation leans over about a fixed axis and back while the position follows another path: by the angle
/// `(angle / 2) (1 - cos 2 pi u)`.
#[derive(Clone, Debug)]
pub struct Leaning<P> {
    path: P,
    axis: Unit<Vector3<f64>>,
    angle: f64,
}

impl<P: Path> Leaning<P> {
    /// Returns `path` with its orientation leaning by `angle` \[rad\] about the world direction `axis` half-way
    /// through.
    pub fn new(path: P, axis: Unit<Vector3<f64>>, angle: f64) -> Self {
        Self { path, axis, angle }
    }
}

impl<P: Path> Path for Leaning<P> {
    fn point(&self, u: f64) -> PathPoint {
        self.path.point(u)
    }

    fn turn(&self, u: f64) -> (Rotation3<f64>, Vector3<f64>) {
        let (sine, cosine) = (TAU * u).sin_cos();
        let angle = 0.5 * self.angle * (1.0 - cosine);
        let rate = 0.5 * self.angle * TAU * sine;
        (Rotation3::from_axis_angle(&self.axis, angle), self.axis.into_inner() * rate)
    }

    fn smoothness(&self) -> Option<usize> {
        self.path.smoothness()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rotation_vector;
    use crate::task::Line;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_spin_is_the_derivative_and_the_tip_comes_back(angle in -1.0..1.0_f64, u in 0.0..1.0_f64) {
            let path = Leaning::new(Line { displacement: Vector3::x() }, Vector3::z_axis(), angle);
            let step = 1e-6;
            let turn = path.turn(u + step).0 * path.turn(u - step).0.inverse();
            prop_assert!((rotation_vector(&turn) / (2.0 * step) - path.turn(u).1).norm() < 1e-6);
            prop_assert!((path.turn(0.0).0.inverse() * path.turn(1.0).0).angle() < 1e-12);
            prop_assert_eq!(path.point(u), Line { displacement: Vector3::x() }.point(u));
        }
    }
}
