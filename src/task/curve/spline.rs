use super::super::waypoints::{
    Ends, FILE, KNOTS, POINTS, QUATERNIONS, QuinticSpline, RPY, RotationSpline, TIMES, Waypoints, objection,
};
use super::super::{Path, PathPoint};
use super::{CurveKind, Line, MakeCurve};
use crate::kind::{Form, Kind, Parameter, Parameters};
use nalgebra::{Rotation3, Vector3};

/// How far the ends of a periodic spline may lie apart [m, rad].
const GAP: f64 = 1e-9;

/// A smooth path through waypoints: the quintic spline through their positions, four times continuously differentiable, and
/// the curve through the logarithms of their turns, three times.
#[derive(Clone, Debug)]
pub struct Spline {
    position: QuinticSpline,
    rotation: Option<RotationSpline>,
    /// The inverse of the orientation at the beginning.
    undone: Rotation3<f64>,
}

impl Spline {
    /// Returns the spline through waypoints, or what is wrong with them for one that begins and ends so.
    ///
    /// # Errors
    /// A sentence where there are fewer than three, or a periodic path does not end where it begins.
    pub fn through(waypoints: &Waypoints, ends: Ends) -> Result<Self, String> {
        let (knots, points) = (waypoints.knots(), waypoints.points());
        let last = points.len() - 1;
        if last < 2 {
            return Err(
                "points[2] is missing: a spline has three waypoints or more; two make a line".to_owned()
            );
        }
        if ends == Ends::Periodic {
            let (gap, turn) = ((points[last] - points[0]).norm(), waypoints.turn(0, last).norm());
            if gap > GAP || turn > GAP {
                return Err(format!(
                    "points[{last}] is {gap:.3e} m and {turn:.3e} rad from points[0]: a periodic path ends where it begins"
                ));
            }
        }
        let rotations = waypoints.rotations();
        Ok(Self {
            position: QuinticSpline::new(knots, points, ends),
            rotation: rotations.map(|rotations| RotationSpline::new(knots, rotations, ends)),
            undone: rotations.map_or(Rotation3::identity(), |rotations| rotations[0].inverse()),
        })
    }
}

impl Path for Spline {
    fn point(&self, u: f64) -> PathPoint {
        let (position, tangent) = self.position.at(u);
        PathPoint { position, tangent }
    }

    fn turn(&self, u: f64) -> (Rotation3<f64>, Vector3<f64>) {
        let Some(rotation) = &self.rotation else { return (Rotation3::identity(), Vector3::zeros()) };
        let (rotation, spin) = rotation.at(u);
        (rotation * self.undone, spin)
    }

    fn initial_orientation(&self) -> Option<Rotation3<f64>> {
        self.rotation.as_ref().map(|_| self.undone.inverse())
    }

    fn smoothness(&self) -> Option<usize> {
        Some(if self.rotation.is_some() { 3 } else { 4 })
    }
}

/// Given times come from motions that begin and end at rest.
fn ends(given: &Parameters) -> Result<Ends, String> {
    let unless_said = if given.get("times").is_some() { Ends::Clamped } else { Ends::Natural };
    let Some(word) = given.text("ends") else { return Ok(unless_said) };
    Ends::ALL
        .into_iter()
        .find(|ends| ends.name() == word)
        .ok_or_else(|| format!("ends = \"{word}\" is not one of {}", Ends::ALL.map(Ends::name).join(", ")))
}

fn spline(given: &Parameters) -> Result<Spline, String> {
    let ends = ends(given)?;
    Waypoints::of(given).map_err(|problem| problem.to_string()).and_then(|all| Spline::through(&all, ends))
}

pub(super) const KIND: CurveKind = Kind::new(
    "spline",
    "A smooth path through waypoints: a quintic spline, and logarithms of the turns between them.",
    &[
        POINTS,
        RPY,
        QUATERNIONS,
        TIMES,
        KNOTS,
        FILE,
        Parameter::optional(
            "ends",
            Form::Text,
            "",
            "How it begins and ends: natural, clamped (without velocity and acceleration), or periodic. Default: natural; with times clamped.",
        ),
    ],
    MakeCurve::Centered(|given| match spline(given) {
        Ok(spline) => Box::new(spline),
        Err(_) => Box::new(Line { displacement: Vector3::zeros() }),
    }),
)
.with_objection(|given| match given.get("file") {
    Some(_) => ends(given).err().or_else(|| objection(given)),
    None => spline(given).err(),
})
.with_draw(|size, whole| {
    let mut inner = || [(); 3].map(|()| f64::from(whole(-10, 10)) / 10.0 * size);
    let points: Vec<[f64; 3]> = vec![[0.0; 3], inner(), inner(), inner(), [0.0; 3]];
    Parameters::new().with("points", points).with("knots", [0.0, 1.0, 2.0, 3.0, 4.0]).with("ends", "periodic")
});
