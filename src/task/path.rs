use super::PlanarCurve;
use nalgebra::{Rotation3, Unit, Vector3};
use serde::{Deserialize, Serialize};

/// A point of a path with its derivative by the progress `u`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// Position \[m\].
    pub position: Vector3<f64>,
    /// `d position / du` \[m\].
    pub tangent: Vector3<f64>,
}

/// A geometric path, drawn by a progress `u` from 0 to 1.
///
/// One method is required; closures `|u| -> PathPoint` are paths too:
///
/// ```
/// use kinstep::nalgebra::Vector3;
/// use kinstep::task::{Path, PathPoint};
///
/// let helix = |u: f64| PathPoint {
///     position: Vector3::new((6.0 * u).cos(), (6.0 * u).sin(), 0.2 * u) * 0.1,
///     tangent: Vector3::new(-6.0 * (6.0 * u).sin(), 6.0 * (6.0 * u).cos(), 0.2) * 0.1,
/// };
/// assert_eq!(helix.point(0.0).position.x, 0.1);
/// ```
pub trait Path: Send + Sync {
    /// The position at progress `u` and its exact derivative, in axes parallel to the world's.
    fn point(&self, u: f64) -> PathPoint;

    /// The rotation from the initial orientation at progress `u`, in world axes, and `d angle / du` as a rotation rate
    /// \[rad\]. Unless overridden the orientation stays the initial one.
    fn turn(&self, _u: f64) -> (Rotation3<f64>, Vector3<f64>) {
        (Rotation3::identity(), Vector3::zeros())
    }

    /// The orientation with which it begins in its own axes, if it has orientations and not only turns. A path that is laid to
    /// where a tip stands turns the tip's own orientation.
    fn initial_orientation(&self) -> Option<Rotation3<f64>> {
        None
    }

    /// How many derivatives by `u` are continuous from beginning to end; `None` where all are, as unless overridden.
    ///
    /// With `k` of them the errors of a run fall like `sigma^(k+1)` at best, whatever the order of its formula.
    fn smoothness(&self) -> Option<usize> {
        None
    }
}

impl<F: Fn(f64) -> PathPoint + Send + Sync> Path for F {
    fn point(&self, u: f64) -> PathPoint {
        self(u)
    }
}

impl Path for Box<dyn Path> {
    fn point(&self, u: f64) -> PathPoint {
        (**self).point(u)
    }

    fn turn(&self, u: f64) -> (Rotation3<f64>, Vector3<f64>) {
        (**self).turn(u)
    }

    fn initial_orientation(&self) -> Option<Rotation3<f64>> {
        (**self).initial_orientation()
    }

    fn smoothness(&self) -> Option<usize> {
        (**self).smoothness()
    }
}

/// The plane in which a planar curve is drawn, in world axes; the first letter is the direction of the curve's own x.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Plane {
    /// Curve x along world x, curve y along world y.
    #[default]
    Xy,
    /// Curve x along world y, curve y along world z.
    Yz,
    /// Curve x along world z, curve y along world x.
    Zx,
    /// The mirror image of xy: curve x along world y, curve y along world x.
    Yx,
    /// The mirror image of yz: curve x along world z, curve y along world y.
    Zy,
    /// The mirror image of zx: curve x along world x, curve y along world z.
    Xz,
}

impl Plane {
    /// The directions of the curve's x and y.
    fn directions(self) -> (Vector3<f64>, Vector3<f64>) {
        match self {
            Self::Xy => (Vector3::x(), Vector3::y()),
            Self::Yz => (Vector3::y(), Vector3::z()),
            Self::Zx => (Vector3::z(), Vector3::x()),
            Self::Yx => (Vector3::y(), Vector3::x()),
            Self::Zy => (Vector3::z(), Vector3::y()),
            Self::Xz => (Vector3::x(), Vector3::z()),
        }
    }
}

/// A planar curve laid into space: its angle runs from `from` over `sweep` \[rad\] while `u` runs from 0 to 1.
#[derive(Clone, Debug)]
pub struct Planar<C> {
    curve: C,
    x: Vector3<f64>,
    y: Vector3<f64>,
    from: f64,
    sweep: f64,
}

impl<C: PlanarCurve> Planar<C> {
    /// Returns the curve in `plane`, turned there by `rotation` \[rad\], over the angles `from` to `from + sweep`
    /// \[rad\].
    pub fn new(curve: C, plane: Plane, rotation: f64, from: f64, sweep: f64) -> Self {
        let (x, y) = plane.directions();
        let (sine, cosine) = rotation.sin_cos();
        Self { curve, x: x * cosine + y * sine, y: y * cosine - x * sine, from, sweep }
    }

    /// Returns the whole curve, once around, in the plane of world x and y.
    pub fn whole(curve: C) -> Self {
        Self::new(curve, Plane::Xy, 0.0, 0.0, std::f64::consts::TAU)
    }
}

impl<C: PlanarCurve> Path for Planar<C> {
    fn point(&self, u: f64) -> PathPoint {
        let ([x, y], [dx, dy]) = self.curve.point(self.from + self.sweep * u);
        PathPoint { position: self.x * x + self.y * y, tangent: (self.x * dx + self.y * dy) * self.sweep }
    }
}

/// A path whose orientation turns evenly about a fixed axis while the position follows another path.
#[derive(Clone, Debug)]
pub struct Turning<P> {
    path: P,
    axis: Unit<Vector3<f64>>,
    angle: f64,
}

impl<P: Path> Turning<P> {
    /// Returns `path` with its orientation turning by `angle` \[rad\] about the world direction `axis` from beginning
    /// to end.
    pub fn new(path: P, axis: Unit<Vector3<f64>>, angle: f64) -> Self {
        Self { path, axis, angle }
    }
}

impl<P: Path> Path for Turning<P> {
    fn point(&self, u: f64) -> PathPoint {
        self.path.point(u)
    }

    fn turn(&self, u: f64) -> (Rotation3<f64>, Vector3<f64>) {
        (Rotation3::from_axis_angle(&self.axis, self.angle * u), self.axis.into_inner() * self.angle)
    }

    fn smoothness(&self) -> Option<usize> {
        self.path.smoothness()
    }
}
