//! Random smooth closed paths and the laws by which time runs along them.

use crate::task::{
    Astroid, Circle, Linear, Lissajous, Path, PathPoint, Planar, PlanarCurve, Plane, Quintic, Rose, Sin2,
    Sin2Sin2, TimeLaw, Tricuspid,
};
use nalgebra::{Rotation3, Unit, Vector3};
use proptest::prelude::*;
use proptest::sample::select;
use std::f64::consts::TAU;
use std::fmt;

/// The form of a closed path.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// `sum_m (a_m (cos 2 pi m u - 1) + b_m sin 2 pi m u) / m^3` with the vectors `(a_m, b_m)` \[1/10\].
    Fourier(Vec<[[i8; 3]; 2]>),
    /// A circle.
    Circle,
    /// A tricuspid from one of its cusps.
    Tricuspid,
    /// An astroid from one of its cusps.
    Astroid,
    /// A Lissajous figure of these frequencies.
    Lissajous(u8, u8),
    /// A rose of that many petals.
    Rose(u8),
}

/// A closed path of a given extent, in space or in the plane of x and y.
#[derive(Clone, Debug, PartialEq)]
pub struct PathCase {
    /// Its form.
    pub shape: Shape,
    /// By how much the curves by angle are turned in their plane \[degrees\].
    pub rotation: i16,
    /// How far the tip leans about the path's axis and back \[rad\], as a multiple of the extent.
    pub lean: u8,
    /// The largest distance from the start \[m\], as a fraction (in hundredths) of the arm's smallest singular value at the
    /// start: about the joint motion that the path asks for \[1/100 rad\].
    pub extent: u8,
}

impl PathCase {
    /// The path for an arm whose task Jacobian has that smallest singular value at the start.
    pub fn path(&self, smallest_singular_value: f64) -> LeaningPath {
        let unit = self.unit_path();
        let start = unit.point(0.0).position;
        let distance = |k: u32| (unit.point(f64::from(k) / 64.0).position - start).norm();
        let size = (1..64).map(distance).fold(0.0, f64::max);
        let extent = self.extent(smallest_singular_value);
        LeaningPath { unit, scale: extent / size, lean: extent * f64::from(self.lean) }
    }

    /// The largest distance from the start \[m\], for an arm with that smallest singular value.
    pub fn extent(&self, smallest_singular_value: f64) -> f64 {
        f64::from(self.extent) / 100.0 * smallest_singular_value
    }

    fn unit_path(&self) -> Box<dyn Path> {
        let planar = |curve: Box<dyn PlanarCurve>| {
            let rotation = f64::from(self.rotation).to_radians();
            Box::new(Planar::new(curve, Plane::Xy, rotation, 0.0, TAU)) as Box<dyn Path>
        };
        match &self.shape {
            Shape::Fourier(modes) => Box::new(Fourier { modes: modes.clone() }),
            Shape::Circle => planar(Box::new(Circle { radius: 1.0 })),
            Shape::Tricuspid => planar(Box::new(Tricuspid { radius: 1.0 })),
            Shape::Astroid => planar(Box::new(Astroid { radius: 1.0 })),
            Shape::Lissajous(x, y) => {
                let frequencies = [f64::from(*x), f64::from(*y)];
                planar(Box::new(Lissajous { amplitudes: [1.0, 1.0], frequencies, phase: 0.5 }))
            }
            Shape::Rose(petals) => planar(Box::new(Rose { radius: 1.0, petals: f64::from(*petals) })),
        }
    }

    /// Whether the path moves in x and y: a planar arm would rest on any other.
    fn moves_in_plane(&self) -> bool {
        match &self.shape {
            Shape::Fourier(modes) => modes.iter().flatten().any(|v| v[0] != 0 || v[1] != 0),
            _ => true,
        }
    }
}

/// A path scaled to an arm, leaning over and back about (1, 2, 3) where orientation is asked for.
pub struct LeaningPath {
    unit: Box<dyn Path>,
    scale: f64,
    lean: f64,
}

impl fmt::Debug for LeaningPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LeaningPath")
            .field("scale", &self.scale)
            .field("lean", &self.lean)
            .finish_non_exhaustive()
    }
}

impl Path for LeaningPath {
    fn point(&self, u: f64) -> PathPoint {
        let PathPoint { position, tangent } = self.unit.point(u);
        PathPoint { position: position * self.scale, tangent: tangent * self.scale }
    }

    fn turn(&self, u: f64) -> (Rotation3<f64>, Vector3<f64>) {
        let axis = Unit::new_normalize(Vector3::new(1.0, 2.0, 3.0));
        let (sine, cosine) = (TAU * u).sin_cos();
        let angle = 0.5 * self.lean * (1.0 - cosine);
        (Rotation3::from_axis_angle(&axis, angle), axis.into_inner() * (0.5 * self.lean * TAU * sine))
    }
}

struct Fourier {
    modes: Vec<[[i8; 3]; 2]>,
}

impl Path for Fourier {
    fn point(&self, u: f64) -> PathPoint {
        let mut point = PathPoint { position: Vector3::zeros(), tangent: Vector3::zeros() };
        for (k, modes) in self.modes.iter().enumerate() {
            let m = (k + 1) as f64;
            let [a, b] = modes.map(|v| Vector3::from(v.map(|entry| f64::from(entry) / 10.0)) / m.powi(3));
            let (sine, cosine) = (TAU * m * u).sin_cos();
            point.position += a * (cosine - 1.0) + b * sine;
            point.tangent += (b * cosine - a * sine) * (TAU * m);
        }
        point
    }
}

/// The time laws drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeLawCase {
    /// At rest at both ends, accelerating at once.
    Sin2,
    /// Three derivatives vanish at both ends.
    Sin2Sin2,
    /// Velocity and acceleration vanish at both ends.
    Quintic,
    /// Constant speed.
    Linear,
}

impl TimeLawCase {
    /// The law.
    pub fn law(self) -> Box<dyn TimeLaw> {
        match self {
            Self::Sin2 => Box::new(Sin2),
            Self::Sin2Sin2 => Box::new(Sin2Sin2),
            Self::Quintic => Box::new(Quintic),
            Self::Linear => Box::new(Linear),
        }
    }
}

/// Any of the time laws.
pub fn time_laws() -> impl Strategy<Value = TimeLawCase> + Clone {
    select(vec![TimeLawCase::Linear, TimeLawCase::Sin2, TimeLawCase::Quintic, TimeLawCase::Sin2Sin2])
}

/// Closed paths that move in x and y at least, of an extent that asks for 0.1 to 0.6 rad of joint motion.
pub fn paths() -> impl Strategy<Value = PathCase> + Clone {
    let vector = || prop::array::uniform3(-10_i8..=10);
    let fourier =
        prop::collection::vec((vector(), vector()).prop_map(|(a, b)| [a, b]), 1..=3).prop_map(Shape::Fourier);
    let shape = prop_oneof![
        2 => fourier,
        1 => Just(Shape::Circle),
        1 => Just(Shape::Tricuspid),
        1 => Just(Shape::Astroid),
        1 => (1_u8..=2, 1_u8..=3).prop_map(|(x, y)| Shape::Lissajous(x, y)),
        1 => (2_u8..=3).prop_map(Shape::Rose),
    ];
    (shape, -9_i16..=9, 0_u8..=1, 10_u8..=60)
        .prop_map(|(shape, turns, lean, extent)| PathCase { shape, rotation: 20 * turns, lean, extent })
        .prop_filter("moves in x and y", PathCase::moves_in_plane)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rotation_vector;

    proptest! {
        #[test]
        fn paths_close_keep_their_extent_and_know_their_derivative(case in paths(), u in 0.0..1.0_f64) {
            let path = case.path(0.5);
            let at = |u: f64| path.point(u).position;
            prop_assert!((at(1.0) - at(0.0)).norm() < 1e-12);
            let extent = (0..=64).map(|k| (at(f64::from(k) / 64.0) - at(0.0)).norm()).fold(0.0, f64::max);
            prop_assert!((extent - 0.005 * f64::from(case.extent)).abs() < 1e-12);
            let step = 1e-5;
            let difference = (at(u + step) - at(u - step)) / (2.0 * step);
            prop_assert!((difference - path.point(u).tangent).norm() < 1e-7);
            let turn = path.turn(u + step).0 * path.turn(u - step).0.inverse();
            prop_assert!((rotation_vector(&turn) / (2.0 * step) - path.turn(u).1).norm() < 1e-7);
        }
    }
}
