use super::{Path, PathPoint};
use nalgebra::{Rotation3, Unit, Vector3};
use std::f64::consts::TAU;

/// A closed path in space by its Fourier coefficients \[m\]:
/// `p(u) = sum_m a_m (cos 2 pi m u - 1) + b_m sin 2 pi m u`, m = 1, 2, ...; it begins and ends in its origin.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fourier {
    /// The coefficients `a_1, a_2, ...` of the cosines \[m\].
    pub cosines: Vec<Vector3<f64>>,
    /// The coefficients `b_1, b_2, ...` of the sines \[m\].
    pub sines: Vec<Vector3<f64>>,
}

impl Path for Fourier {
    fn point(&self, u: f64) -> PathPoint {
        let mut point = PathPoint { position: Vector3::zeros(), tangent: Vector3::zeros() };
        let zero = Vector3::zeros();
        for k in 0..self.cosines.len().max(self.sines.len()) {
            let (a, b) = (self.cosines.get(k).unwrap_or(&zero), self.sines.get(k).unwrap_or(&zero));
            let rate = TAU * (k + 1) as f64;
            let (sine, cosine) = (rate * u).sin_cos();
            point.position += a * (cosine - 1.0) + b * sine;
            point.tangent += (b * cosine - a * sine) * rate;
        }
        point
    }
}

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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rotation_vector;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_tangent_and_the_spin_are_derivatives_and_the_path_closes(
            entries in prop::collection::vec(-1.0..1.0_f64, 12),
            u in 0.0..1.0_f64,
        ) {
            let vector = |k: usize| Vector3::new(entries[3 * k], entries[3 * k + 1], entries[3 * k + 2]);
            let fourier = Fourier { cosines: vec![vector(0), vector(1)], sines: vec![vector(2), vector(3)] };
            let path = Leaning::new(fourier, Vector3::z_axis(), entries[0]);
            prop_assert!((path.point(1.0).position - path.point(0.0).position).norm() < 1e-12);
            let step = 1e-6;
            let difference = (path.point(u + step).position - path.point(u - step).position) / (2.0 * step);
            prop_assert!((difference - path.point(u).tangent).norm() < 1e-6);
            let turn = path.turn(u + step).0 * path.turn(u - step).0.inverse();
            prop_assert!((rotation_vector(&turn) / (2.0 * step) - path.turn(u).1).norm() < 1e-6);
        }
    }
}
