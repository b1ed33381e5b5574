use super::super::waypoints::{FILE, KNOTS, POINTS, QUATERNIONS, RPY, TIMES, Waypoints, interval, objection};
use super::super::{Path, PathPoint};
use super::{CurveKind, Line, MakeCurve};
use crate::kind::{Form, Kind, Parameter, Parameters};
use crate::math::number_text;
use nalgebra::{Rotation3, Vector3};

/// Straight ways between waypoints, with the shortest turns on them.
///
/// With a blend the path leaves each corner out: from a distance `blend` before it to as far behind it goes over from one
/// straight way to the next, `p = corner + v_1 s + (v_2 - v_1) w b(s / w)` with `b'` the smooth step of degree seven. So the path
/// is four times continuously differentiable; it passes a corner by a turn `a` at a distance of `0.273 blend sin(a / 2)`.
/// Without one it goes to each corner and stops there: the smooth step takes each way from rest to rest, with three
/// continuous derivatives.
#[derive(Clone, Debug)]
pub struct Polyline {
    knots: Vec<f64>,
    /// The orientations at the corners, if there are any.
    rotations: Option<Vec<Rotation3<f64>>>,
    points: Vec<Vector3<f64>>,
    ways: Vec<(Vector3<f64>, Vector3<f64>)>,
    /// Half the length of the blend at each knot, in parameters; nothing at the ends.
    blends: Option<Vec<f64>>,
}

impl Polyline {
    /// Returns the polyline with blends that begin `blend` \[m\] before each corner, or what keeps it from having them.
    ///
    /// # Errors
    /// A sentence where two blends do not fit between their corners.
    pub fn through(waypoints: &Waypoints, blend: f64) -> Result<Self, String> {
        let (knots, points) = (waypoints.knots().to_vec(), waypoints.points().to_vec());
        let last = knots.len() - 1;
        let way = |i: usize| (points[i + 1] - points[i], waypoints.turn(i, i + 1));
        let ways = (0..last).map(way).collect();
        let blends = (blend > 0.0).then(|| blends(waypoints, blend)).transpose()?;
        let rotations = waypoints.rotations().map(<[_]>::to_vec);
        Ok(Self { knots, rotations, points, ways, blends })
    }

    /// How much of way `i` lies behind at `s`, and the derivative of that.
    fn share(&self, i: usize, s: f64) -> (f64, f64) {
        let h = self.knots[i + 1] - self.knots[i];
        let Some(blends) = &self.blends else {
            let (_, step, rate) = smooth_step((s - self.knots[i]) / h);
            return (step, rate / h);
        };
        let is_last = i + 2 == self.knots.len();
        let [begun, ended] = [i, i + 1].map(|knot| bend(s - self.knots[knot], blends[knot]));
        // The first way has begun before the path, the last does not end.
        let begun = if i == 0 { (s - self.knots[0], 1.0) } else { begun };
        let ended = if is_last { (0.0, 0.0) } else { ended };
        ((begun.0 - ended.0) / h, (begun.1 - ended.1) / h)
    }

    /// The ways that are travelled at `s`: a blend is part of two.
    fn travelled(&self, s: f64) -> std::ops::Range<usize> {
        let i = interval(&self.knots, s);
        i.saturating_sub(1)..(i + 2).min(self.ways.len())
    }
}

/// Half the length of the blend at each knot, in parameters.
fn blends(waypoints: &Waypoints, blend: f64) -> Result<Vec<f64>, String> {
    let (knots, chords) = (waypoints.knots(), waypoints.chords());
    let last = chords.len();
    let speed = |i: usize| chords[i] / (knots[i + 1] - knots[i]);
    let at = |knot: usize| match knot {
        0 => 0.0,
        _ if knot == last => 0.0,
        _ => blend / speed(knot - 1).max(speed(knot)),
    };
    let blends: Vec<f64> = (0..=last).map(at).collect();
    for i in 0..last {
        let (room, needed) = (knots[i + 1] - knots[i], blends[i] + blends[i + 1]);
        if !(needed <= room * (1.0 + 1e-12)) {
            let most = number_text(((blend * room / needed) * 1e6).floor() / 1e6);
            return Err(format!(
                "blend = {} m does not fit between points[{i}] and points[{}]; at most {most} m does",
                number_text(blend),
                i + 1
            ));
        }
    }
    Ok(blends)
}

/// What is integrated to go over from a rate of 0 to one of 1 around 0, from `-half` to `half`: the value and the rate.
fn bend(s: f64, half: f64) -> (f64, f64) {
    if s <= -half {
        return (0.0, 0.0);
    }
    if s >= half {
        return (s, 1.0);
    }
    let (area, step, _) = smooth_step(0.5 * (s / half + 1.0));
    (2.0 * half * area, step)
}

/// `S(x) = 35 x^4 - 84 x^5 + 70 x^6 - 20 x^7`, the step from 0 to 1 whose first three derivatives vanish at both ends: its
/// integral, itself and its derivative; before 0 and after 1 it is constant.
fn smooth_step(x: f64) -> (f64, f64, f64) {
    let x = x.clamp(0.0, 1.0);
    let cube = x * x * x;
    let step = cube * x * (35.0 + x * (-84.0 + x * (70.0 - 20.0 * x)));
    let area = cube * x * x * (7.0 + x * (-14.0 + x * (10.0 - 2.5 * x)));
    let rest = 1.0 - x;
    (area, step, 140.0 * cube * rest * rest * rest)
}

impl Path for Polyline {
    fn point(&self, u: f64) -> PathPoint {
        let travelled = self.travelled(u);
        let mut point = PathPoint { position: self.points[travelled.start], tangent: Vector3::zeros() };
        for i in travelled {
            let (share, rate) = self.share(i, u);
            point.position += self.ways[i].0 * share;
            point.tangent += self.ways[i].0 * rate;
        }
        point
    }

    fn turn(&self, u: f64) -> (Rotation3<f64>, Vector3<f64>) {
        let Some(rotations) = &self.rotations else { return (Rotation3::identity(), Vector3::zeros()) };
        let travelled = self.travelled(u);
        let (mut rotation, mut spin) = (rotations[travelled.start], Vector3::zeros());
        for i in travelled {
            let (share, rate) = self.share(i, u);
            let turn = self.ways[i].1;
            spin += rotation * turn * rate;
            rotation *= Rotation3::new(turn * share);
        }
        (rotation * rotations[0].inverse(), spin)
    }

    fn initial_orientation(&self) -> Option<Rotation3<f64>> {
        self.rotations.as_ref().map(|rotations| rotations[0])
    }

    fn smoothness(&self) -> Option<usize> {
        (self.knots.len() > 2).then(|| if self.blends.is_some() { 4 } else { 3 })
    }
}

fn polyline(given: &Parameters) -> Result<Polyline, String> {
    let waypoints = Waypoints::of(given).map_err(|problem| problem.to_string())?;
    Polyline::through(&waypoints, blend(given)?)
}

fn blend(given: &Parameters) -> Result<f64, String> {
    let blend = given.number("blend").unwrap_or(0.0);
    if blend >= 0.0 {
        Ok(blend)
    } else {
        Err(format!("blend = {blend} m is not a distance; it is not negative"))
    }
}

pub(super) const KIND: CurveKind = Kind::new(
    "polyline",
    "Straight ways between waypoints, with the shortest turns on them, and blends at the corners.",
    &[
        POINTS,
        RPY,
        QUATERNIONS,
        TIMES,
        KNOTS,
        FILE,
        Parameter::optional(
            "blend",
            Form::Number,
            "m",
            "Distance before and behind each corner in which the path is rounded, a radian counted as 0.1 m. Default: 0, it stops in the corners.",
        ),
    ],
    MakeCurve::Centered(|given| match polyline(given) {
        Ok(polyline) => Box::new(polyline),
        Err(_) => Box::new(Line { displacement: Vector3::zeros() }),
    }),
)
.with_objection(|given| match given.get("file") {
    Some(_) => blend(given).err().or_else(|| objection(given)),
    None => polyline(given).err(),
})
.with_draw(|size, whole| {
    let mut inner = |place: i32| {
        let mut number = || f64::from(whole(-10, 10)) / 10.0 * size;
        [number(), number(), size * f64::from(place)]
    };
    let points: Vec<[f64; 3]> = vec![[0.0; 3], inner(1), inner(2), [0.0; 3]];
    Parameters::new().with("points", points).with("blend", 0.3 * size)
});
