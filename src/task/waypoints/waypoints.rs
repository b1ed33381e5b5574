use crate::kind::{Form, Parameter, Parameters, Value};
use crate::math::{number_text, rotation_vector};
use nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};
use std::f64::consts::PI;

/// The length of path \[m\] that a turn by one radian counts as, where parameters follow the chords.
const METRES_PER_RADIAN: f64 = 0.1;
/// How near \[rad\] to half a turn two neighbours may be: there the axis between them is lost in rounding.
const HALF_TURN_MARGIN: f64 = 1e-6;
/// How far from one the length of a quaternion may be: what rounding to four digits leaves.
const UNIT_MARGIN: f64 = 1e-3;

/// Poses that a path runs through, each at a parameter from 0 to 1.
///
/// ```
/// use kinstep::nalgebra::Vector3;
/// use kinstep::task::Waypoints;
///
/// let corner = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 1.0, 0.0]].map(Vector3::from);
/// let waypoints = Waypoints::new(corner.to_vec(), None, None)?;
/// assert_eq!(waypoints.knots(), [0.0, 0.75, 1.0]);
/// # Ok::<(), kinstep::task::WaypointProblem>(())
/// ```
#[derive(Clone, Debug)]
pub struct Waypoints {
    points: Vec<Vector3<f64>>,
    rotations: Option<Vec<Rotation3<f64>>>,
    knots: Vec<f64>,
    /// The lengths of the chords \[m\], turns counted in.
    chords: Vec<f64>,
}

/// What is wrong with a list of waypoints, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{list}[{index}] {problem}")]
pub struct WaypointProblem {
    /// Which list: `points`, `rpy`, `quaternions`, `times` or `knots`.
    pub list: &'static str,
    /// The place in the list, from 0.
    pub index: usize,
    /// What is wrong there, as the end of a sentence.
    pub problem: String,
}

fn wrong(list: &'static str, index: usize, problem: impl Into<String>) -> WaypointProblem {
    WaypointProblem { list, index, problem: problem.into() }
}

pub(in crate::task) const FILE: Parameter = Parameter::optional(
    "file",
    Form::Text,
    "",
    "A table of waypoints (CSV) in place of the lists, relative to the scenario's own file: columns x, y, z, and t, qx, qy, qz, qw or \
     roll, pitch, yaw or rx, ry, rz, by name.",
);
pub(in crate::task) const POINTS: Parameter = Parameter::optional(
    "points",
    Form::Vectors,
    "m",
    "Positions of the waypoints, in axes parallel to the world's.",
);
pub(in crate::task) const RPY: Parameter = Parameter::optional(
    "rpy",
    Form::Vectors,
    "rad",
    "Orientations of the waypoints: roll, pitch and yaw about fixed axes, as in URDF. Default: the orientation is held.",
);
pub(in crate::task) const QUATERNIONS: Parameter = Parameter::optional(
    "quaternions",
    Form::Quaternions,
    "",
    "Orientations of the waypoints as quaternions x, y, z, w, in place of rpy.",
);
pub(in crate::task) const TIMES: Parameter = Parameter::optional(
    "times",
    Form::Numbers,
    "s",
    "Times of the waypoints: unless a time law is named they are the time law, stretched to the duration.",
);
pub(in crate::task) const KNOTS: Parameter = Parameter::optional(
    "knots",
    Form::Numbers,
    "",
    "Increasing parameters of the waypoints, of any size. Default: the lengths of the chords, a radian counted as 0.1 m.",
);

/// What is wrong with the waypoints of a curve, unless they stand in a file that was not read yet.
pub(in crate::task) fn objection(given: &Parameters) -> Option<String> {
    let lists = ["points", "rpy", "quaternions", "times", "knots"];
    if given.get("file").is_none() {
        return Waypoints::of(given).err().map(|problem| problem.to_string());
    }
    let beside = lists.into_iter().find(|list| given.get(list).is_some())?;
    Some(format!("the waypoints stand in a `file` and in `{beside}`; give one of them"))
}

impl Waypoints {
    /// Returns the waypoints with these positions \[m\], orientations and parameters; without parameters they follow the
    /// lengths of the chords.
    ///
    /// # Errors
    /// [`WaypointProblem`] for fewer than two points, numbers that are not finite, lists of different lengths, parameters that
    /// do not increase, two poses in one place without parameters, and neighbours that are half a turn apart.
    pub fn new(
        points: Vec<Vector3<f64>>,
        rotations: Option<Vec<Rotation3<f64>>>,
        parameters: Option<Vec<f64>>,
    ) -> Result<Self, WaypointProblem> {
        Self::checked(points, rotations.map(|all| ("rotations", all)), parameters.map(|all| ("knots", all)))
    }

    fn checked(
        points: Vec<Vector3<f64>>,
        rotations: Option<(&'static str, Vec<Rotation3<f64>>)>,
        parameters: Option<(&'static str, Vec<f64>)>,
    ) -> Result<Self, WaypointProblem> {
        let count = points.len();
        if count < 2 {
            return Err(wrong("points", count, "is missing: a path has two waypoints or more"));
        }
        let unlike = |list, length: usize| {
            let problem = format!("ends a list of {length} beside {count} points; it takes one for each");
            (length != count).then(|| wrong(list, length.saturating_sub(1), problem))
        };
        let lengths = [
            rotations.as_ref().and_then(|(list, all)| unlike(list, all.len())),
            parameters.as_ref().and_then(|(list, all)| unlike(list, all.len())),
        ];
        lengths.into_iter().flatten().next().map_or(Ok(()), Err)?;
        let is_finite = |point: &Vector3<f64>| point.iter().all(|entry| entry.is_finite());
        if let Some(index) = points.iter().position(|point| !is_finite(point)) {
            return Err(wrong("points", index, "is not finite"));
        }
        let turns = match &rotations {
            Some((list, all)) => turns(list, all)?,
            None => vec![0.0; count - 1],
        };
        let chord = |i: usize| (points[i + 1] - points[i]).norm().hypot(METRES_PER_RADIAN * turns[i]);
        let chords: Vec<f64> = (0..count - 1).map(chord).collect();
        let knots = match parameters {
            Some((list, given)) => increasing(list, &given)?,
            None => of_chords(&chords)?,
        };
        Ok(Self { points, rotations: rotations.map(|(_, all)| all), knots, chords })
    }

    /// The waypoints that the parameters of a curve say: `points`, `rpy` or `quaternions`, `times` or `knots`.
    ///
    /// # Errors
    /// As [`Waypoints::new`], and for two lists of orientations or of parameters and quaternions that are not of length one.
    pub fn of(given: &Parameters) -> Result<Self, WaypointProblem> {
        let points = given.vectors("points").unwrap_or_default().into_iter().map(Vector3::from).collect();
        for [one, other] in [["rpy", "quaternions"], ["times", "knots"]] {
            if given.get(one).is_some() && given.get(other).is_some() {
                let list = if one == "rpy" { "quaternions" } else { "knots" };
                return Err(wrong(list, 0, format!("says again what `{one}` says; give one of the two")));
            }
        }
        let rpy = |[roll, pitch, yaw]: [f64; 3]| Rotation3::from_euler_angles(roll, pitch, yaw);
        let rotations = match (given.vectors("rpy"), given.get("quaternions").and_then(Value::list)) {
            (Some(all), _) => Some(("rpy", all.into_iter().map(rpy).collect())),
            (None, Some(all)) => Some(("quaternions", quaternions(all)?)),
            (None, None) => None,
        };
        let parameters = ["times", "knots"].into_iter().find_map(|list| Some((list, given.numbers(list)?)));
        Self::checked(points, rotations, parameters)
    }

    /// The positions \[m\].
    pub fn points(&self) -> &[Vector3<f64>] {
        &self.points
    }

    /// The orientations, if they have any.
    pub fn rotations(&self) -> Option<&[Rotation3<f64>]> {
        self.rotations.as_deref()
    }

    /// Their parameters, from 0 to 1.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The lengths of the ways between neighbours \[m\], a turn by a radian counted as 0.1 m.
    pub fn chords(&self) -> &[f64] {
        &self.chords
    }

    /// The rotation from one waypoint to another about the axes of the first \[rad\].
    pub(in crate::task) fn turn(&self, from: usize, to: usize) -> Vector3<f64> {
        self.rotations
            .as_ref()
            .map_or(Vector3::zeros(), |all| rotation_vector(&(all[from].inverse() * all[to])))
    }
}

/// The angles \[rad\] between neighbours.
fn turns(list: &'static str, rotations: &[Rotation3<f64>]) -> Result<Vec<f64>, WaypointProblem> {
    let turn = |(i, pair): (usize, &[Rotation3<f64>])| {
        let angle = rotation_vector(&(pair[0].inverse() * pair[1])).norm();
        if !angle.is_finite() {
            return Err(wrong(list, i + 1, "is not finite"));
        }
        if angle > PI - HALF_TURN_MARGIN {
            let problem = "is half a turn (pi) from the one before it, which two ways lead to; put an orientation between them";
            return Err(wrong(list, i + 1, problem));
        }
        Ok(angle)
    };
    rotations.windows(2).enumerate().map(turn).collect()
}

fn quaternions(values: &[Value]) -> Result<Vec<Rotation3<f64>>, WaypointProblem> {
    let rotation = |(i, value): (usize, &Value)| {
        let numbers: Vec<f64> = value.list().unwrap_or_default().iter().filter_map(Value::number).collect();
        let &[x, y, z, w] = numbers.as_slice() else {
            return Err(wrong("quaternions", i, "is not made of four numbers x, y, z, w"));
        };
        let quaternion = Quaternion::new(w, x, y, z);
        let length = quaternion.norm();
        if !((length - 1.0).abs() <= UNIT_MARGIN) {
            let length = number_text((length * 1e6).round() / 1e6);
            let problem = format!("has the length {length}; a quaternion of a rotation has length 1");
            return Err(wrong("quaternions", i, problem));
        }
        Ok(UnitQuaternion::from_quaternion(quaternion).to_rotation_matrix())
    };
    values.iter().enumerate().map(rotation).collect()
}

/// Parameters from 0 to 1 in the given proportions.
fn increasing(list: &'static str, given: &[f64]) -> Result<Vec<f64>, WaypointProblem> {
    if let Some(index) = given.iter().position(|number| !number.is_finite()) {
        return Err(wrong(list, index, "is not finite"));
    }
    if let Some(i) = given.windows(2).position(|pair| pair[0] >= pair[1]) {
        let [before, here] = [given[i], given[i + 1]].map(number_text);
        return Err(wrong(
            list,
            i + 1,
            format!("is {here} after {before}; they increase from waypoint to waypoint"),
        ));
    }
    let (first, last) = (given[0], given[given.len() - 1]);
    Ok(normalised(given.iter().map(|number| (number - first) / (last - first)).collect()))
}

fn of_chords(chords: &[f64]) -> Result<Vec<f64>, WaypointProblem> {
    if let Some(i) = chords.iter().position(|&chord| chord <= 0.0) {
        let problem = "is where the one before it is; take one of them away, or give `knots` or `times`";
        return Err(wrong("points", i + 1, problem));
    }
    let total: f64 = chords.iter().sum();
    let along = chords.iter().scan(0.0, |sum, chord| {
        *sum += chord;
        Some(*sum / total)
    });
    let knots: Vec<f64> = std::iter::once(0.0).chain(along).collect();
    if let Some(i) = knots.windows(2).position(|pair| pair[0] >= pair[1]) {
        return Err(wrong(
            "points",
            i + 1,
            "is as good as where the one before it is, for the length of the path",
        ));
    }
    Ok(normalised(knots))
}

/// The last parameter is 1, whatever rounding made of it.
fn normalised(mut knots: Vec<f64>) -> Vec<f64> {
    if let Some(last) = knots.last_mut() {
        *last = 1.0;
    }
    knots
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner() -> Parameters {
        Parameters::new().with("points", vec![[0.0, 0.0, 0.0], [0.3, 0.0, 0.0], [0.3, 0.4, 0.0]])
    }

    fn problem(given: &Parameters) -> String {
        objection(given).unwrap()
    }

    #[test]
    fn what_is_wrong_is_told_with_its_list_and_place() {
        assert_eq!(objection(&corner()), None);
        let again = Parameters::new().with("points", vec![[0.1, 0.0, 0.0], [0.1, 0.0, 0.0]]);
        assert!(problem(&again).starts_with("points[1] is where the one before it is"));
        assert_eq!(objection(&again.clone().with("times", [0.0, 1.0])), None, "a pause");
        let one = Parameters::new().with("points", vec![[0.1, 0.0, 0.0]]);
        assert!(problem(&one).starts_with("points[1] is missing"));
        let times = |times: [f64; 3]| problem(&corner().with("times", times));
        assert!(times([0.0, 0.5, 0.5]).starts_with("times[2] is 0.5 after 0.5"));
        assert!(times([0.0, f64::NAN, 1.0]).starts_with("times[1] is not finite"));
        assert!(
            problem(&corner().with("knots", [0.0, 1.0])).starts_with("knots[1] ends a list of 2 beside 3")
        );
        assert!(problem(&corner().with("file", "w.csv")).contains("`file` and in `points`"));
        assert_eq!(objection(&Parameters::new().with("file", "w.csv")), None);
        let both = corner().with("times", [0.0, 1.0, 2.0]).with("knots", [0.0, 1.0, 2.0]);
        assert!(problem(&both).starts_with("knots[0] says again what `times` says"));
    }

    #[test]
    fn orientations_are_rotations_and_never_half_a_turn_apart() {
        let half = corner().with("rpy", vec![[0.0; 3], [0.0, 0.0, 0.1], [PI, 0.0, 0.1]]);
        assert!(problem(&half).starts_with("rpy[2] is half a turn (pi) from the one before it"));
        let with = |last: [f64; 4]| {
            corner().with("quaternions", vec![[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0], last])
        };
        assert!(problem(&with([0.0; 4])).starts_with("quaternions[2] has the length 0;"));
        assert!(problem(&with([0.0, 0.0, 1.0, 1.0])).starts_with("quaternions[2] has the length 1.414214;"));
        assert!(problem(&with([1.0, 0.0, 0.0, 0.0])).contains("half a turn"));
        // The other quaternion of a rotation is no other rotation.
        let waypoints = Waypoints::of(&with([0.0, 0.0, -0.6, -0.8])).unwrap();
        assert!((waypoints.turn(1, 2) - Vector3::z() * (2.0 * 0.6_f64.asin())).norm() < 1e-15);
    }

    #[test]
    fn a_turn_in_one_place_has_a_length_of_its_own() {
        let points = vec![Vector3::zeros(), Vector3::x(), Vector3::x()];
        let rotations = [0.0, 0.0, 2.5].map(|angle| Rotation3::new(Vector3::z() * angle));
        let waypoints = Waypoints::new(points, Some(rotations.to_vec()), None).unwrap();
        assert_eq!(waypoints.knots(), [0.0, 0.8, 1.0]);
    }
}
