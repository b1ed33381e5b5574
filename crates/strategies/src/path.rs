//! Random smooth paths, closed and open ones, and the laws by which time runs along them.

use kinstep::kind::{Parameters, Value};
use kinstep::task::{
    CURVES, CurveKind, Leaning, Linear, MakeCurve, Path, Planar, Plane, Quintic, Sin2, Sin2Sin2, TimeLaw,
};
use nalgebra::{Unit, Vector3};
use proptest::prelude::*;
use proptest::sample::select;
use proptest::strategy::Union;
use std::f64::consts::TAU;

/// The form of a path.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// `sum_m (a_m (cos 2 pi m u - 1) + b_m sin 2 pi m u) / m^3` with the vectors `(a_m, b_m)` \[1/10\].
    Fourier(Vec<[[i8; 3]; 2]>),
    /// A planar curve of the registry, once around, and the numbers from which its parameters are drawn.
    Curve(&'static str, Vec<i32>),
    /// A straight line in that direction, open.
    Line([i8; 3]),
    /// That much of a circle \[degrees\], open.
    Arc(u16),
}

impl Shape {
    /// The curve's name in the registry, and its parameters in the size `scale` \[m\].
    pub fn parameters(&self, scale: f64) -> (&'static str, Parameters) {
        let given = Parameters::new();
        match self {
            Self::Fourier(modes) => {
                let vectors = |which: usize| -> Value {
                    let vector = |(k, mode): (usize, &[[i8; 3]; 2])| {
                        mode[which].map(|entry| f64::from(entry) / 10.0 * scale / ((k + 1) as f64).powi(3))
                    };
                    modes.iter().enumerate().map(vector).collect::<Vec<[f64; 3]>>().into()
                };
                ("fourier", given.with("cosines", vectors(0)).with("sines", vectors(1)))
            }
            Self::Curve(name, numbers) => {
                let mut numbers = numbers.iter();
                let mut whole = |low: i32, _| numbers.next().copied().unwrap_or(low);
                let draw = curve(name).and_then(|kind| kind.draw);
                (name, draw.map_or(given, |draw| draw(scale, &mut whole)))
            }
            Self::Line(direction) => {
                ("line", given.with("displacement", direction.map(|entry| f64::from(entry) * scale)))
            }
            Self::Arc(_) => ("circle", given.with("radius", scale)),
        }
    }

    /// The angle \[rad\] that curves by angle sweep.
    pub fn sweep(&self) -> f64 {
        match self {
            Self::Arc(degrees) => f64::from(*degrees).to_radians(),
            _ => TAU,
        }
    }
}

/// The built-in curve of that name.
fn curve(name: &str) -> Option<&'static CurveKind> {
    CURVES.iter().find(|kind| kind.name == name)
}

/// A path of a given extent, in space or in the plane of x and y.
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
    /// The axis about which tips lean, of any length.
    pub const LEAN_AXIS: [f64; 3] = [1.0, 2.0, 3.0];

    /// The path for an arm whose task Jacobian has that smallest singular value at the start.
    pub fn path(&self, smallest_singular_value: f64) -> Leaning<Box<dyn Path>> {
        let axis = Unit::new_normalize(Vector3::from(Self::LEAN_AXIS));
        let lean = self.lean_angle(smallest_singular_value);
        Leaning::new(self.scaled(self.scale(smallest_singular_value)), axis, lean)
    }

    /// How far the tip leans \[rad\], for an arm with that smallest singular value.
    pub fn lean_angle(&self, smallest_singular_value: f64) -> f64 {
        self.extent(smallest_singular_value) * f64::from(self.lean)
    }

    /// By what the path of unit size is multiplied, for an arm with that smallest singular value.
    pub fn scale(&self, smallest_singular_value: f64) -> f64 {
        let unit = self.scaled(1.0);
        let start = unit.point(0.0).position;
        let distance = |k: u32| (unit.point(f64::from(k) / 64.0).position - start).norm();
        let size = (1..=64).map(distance).fold(0.0, f64::max);
        self.extent(smallest_singular_value) / size
    }

    /// The largest distance from the start \[m\], for an arm with that smallest singular value.
    pub fn extent(&self, smallest_singular_value: f64) -> f64 {
        f64::from(self.extent) / 100.0 * smallest_singular_value
    }

    fn scaled(&self, scale: f64) -> Box<dyn Path> {
        let (name, given) = self.shape.parameters(scale);
        match curve(name).map(|kind| kind.make) {
            Some(MakeCurve::Planar(make)) => {
                let rotation = f64::from(self.rotation).to_radians();
                Box::new(Planar::new(make(&given), Plane::Xy, rotation, 0.0, self.shape.sweep()))
            }
            Some(MakeCurve::Centered(make)) => make(&given),
            Some(MakeCurve::FromTip(make)) => make(&given, &Vector3::zeros()),
            None => unreachable!("shapes are named after curves of the registry"),
        }
    }

    /// Whether the path moves in x and y: a planar arm would rest on any other.
    fn moves_in_plane(&self) -> bool {
        match &self.shape {
            Shape::Fourier(modes) => modes.iter().flatten().any(|v| v[0] != 0 || v[1] != 0),
            Shape::Line(direction) => direction[0] != 0 || direction[1] != 0,
            _ => true,
        }
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
    let planar = CURVES.iter().filter(|kind| matches!(kind.make, MakeCurve::Planar(_)));
    let shapes = planar.filter_map(|kind| Some((1, drawn(kind)?)));
    of_shape(Union::new_weighted(std::iter::once((2, fourier.boxed())).chain(shapes).collect()))
}

/// A curve of that kind with the numbers that its parameters are drawn from, if it says how to draw them.
fn drawn(kind: &'static CurveKind) -> Option<BoxedStrategy<Shape>> {
    let mut ranges = Vec::new();
    (kind.draw?)(1.0, &mut |low, high| {
        ranges.push(low..=high);
        low
    });
    Some(ranges.prop_map(|numbers| Shape::Curve(kind.name, numbers)).boxed())
}

/// Lines and arcs that move in x and y at least, of the same extent as [`paths`]: they end away from where they begin.
pub fn open_paths() -> impl Strategy<Value = PathCase> + Clone {
    let line = prop::array::uniform3(-10_i8..=10).prop_map(Shape::Line);
    of_shape(prop_oneof![line, (30_u16..=270).prop_map(Shape::Arc)])
}

fn of_shape(shape: impl Strategy<Value = Shape> + Clone) -> impl Strategy<Value = PathCase> + Clone {
    (shape, -9_i16..=9, 0_u8..=1, 10_u8..=60)
        .prop_map(|(shape, turns, lean, extent)| PathCase { shape, rotation: 20 * turns, lean, extent })
        .prop_filter("moves in x and y", PathCase::moves_in_plane)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinstep::math::rotation_vector;

    /// What holds for all paths.
    fn check(case: &PathCase, u: f64) -> Result<(), TestCaseError> {
        let path = case.path(0.5);
        let at = |u: f64| path.point(u).position;
        let extent = (0..=64).map(|k| (at(f64::from(k) / 64.0) - at(0.0)).norm()).fold(0.0, f64::max);
        prop_assert!((extent - 0.005 * f64::from(case.extent)).abs() < 1e-12);
        let step = 1e-5;
        let difference = (at(u + step) - at(u - step)) / (2.0 * step);
        prop_assert!((difference - path.point(u).tangent).norm() < 1e-7);
        let turn = path.turn(u + step).0 * path.turn(u - step).0.inverse();
        prop_assert!((rotation_vector(&turn) / (2.0 * step) - path.turn(u).1).norm() < 1e-7);
        Ok(())
    }

    /// How far the end is from the beginning.
    fn gap(case: &PathCase) -> f64 {
        let path = case.path(0.5);
        (path.point(1.0).position - path.point(0.0).position).norm()
    }

    proptest! {
        #[test]
        fn paths_close_keep_their_extent_and_know_their_derivative(case in paths(), u in 0.0..1.0_f64) {
            prop_assert!(gap(&case) < 1e-12);
            check(&case, u)?;
        }

        #[test]
        fn open_paths_stay_open_keep_their_extent_and_know_their_derivative(case in open_paths(), u in 0.0..1.0_f64) {
            prop_assert!(gap(&case) > 0.002 * f64::from(case.extent));
            check(&case, u)?;
        }
    }
}
