//! A table of rows `a, alpha, d, theta`, and the robot that it describes.

use std::collections::HashSet;

use nalgebra::{IsometryMatrix3, Rotation3, Translation3, Vector3};
use thiserror::Error;

use crate::robot::size::MAX_SIZE;
use crate::robot::{Diagnostic, Joint, JointKind, Limits, Link, MAX_JOINTS, Robot, diagnostic, names};

/// Most rows of a table: in the standard convention each makes two joints.
pub(super) const MAX_ROWS: usize = MAX_JOINTS / 2;

/// Which of the two Denavit-Hartenberg conventions the rows follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DhConvention {
    /// Denavit and Hartenberg (1955), Paul, Spong, Universal Robots: frame i at the far end of link i,
    /// `A_i = Rz(theta) Tz(d) Tx(a) Rx(alpha)`.
    Standard,
    /// Craig, Khalil and Kleinfinger, Franka: frame i at the near end of link i, on the axis of joint i,
    /// `A_i = Rx(alpha) Tx(a) Rz(theta) Tz(d)`. The row's `a` and `alpha` are those that Craig writes with index i-1.
    Modified,
}

/// One row of a Denavit-Hartenberg table: a joint and the link that it carries.
#[derive(Debug, Clone, PartialEq)]
pub struct DhRow {
    /// Name of the joint.
    pub joint: String,
    /// Name of the link that carries the row's frame.
    pub link: String,
    /// Revolute or continuous (`q` is added to `theta`), prismatic (`q` is added to `d`), or fixed (a flange, a tool).
    pub kind: JointKind,
    /// Distance along x \[m\].
    pub a: f64,
    /// Angle about x \[rad\].
    pub alpha: f64,
    /// Distance along z \[m\].
    pub d: f64,
    /// Angle about z \[rad\].
    pub theta: f64,
    /// Whether the joint counts against z: `-q` is added then.
    pub flip: bool,
    /// Limits of the joint position `q`; infinite where they are not known.
    pub limits: Limits,
}

/// A Denavit-Hartenberg table with the names that its links and joints shall have.
///
/// A file of it (`kinstep robot show my_arm.toml`), for example of a SCARA robot:
///
/// ```
/// use kinstep::robot::{DhTable, Robot};
/// let table = DhTable::from_toml(
///     r#"
///     convention = "standard"
///     joint = [
///         { a = 0.4, d = 0.3, limits = ["-3*pi/4", "3*pi/4"] },
///         { a = 0.3, alpha = "pi", limits = [-2.5, 2.5] },
///         { kind = "prismatic", limits = [0, 0.2], velocity = 1.0 },
///         { d = 0.05 },                              # continuous, as it has no limits
///     ]
///     "#,
/// )?;
/// let robot = Robot::from_dh(&table)?;
/// let chain = robot.chain("base", "tip")?;
/// let pose = chain.forward(&[0.0, 0.0, 0.1, 0.0], &mut chain.scratch()).pose();
/// assert!((pose.translation.x - 0.7).abs() < 1e-15 && (pose.translation.z - 0.15).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DhTable {
    /// The robot's name.
    pub name: String,
    /// Name of the link that the first row starts from.
    pub base: String,
    /// Which convention the rows follow.
    pub convention: DhConvention,
    /// The rows from the base outwards.
    pub rows: Vec<DhRow>,
}

/// Why a Denavit-Hartenberg table gives no robot.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum DhError {
    /// The text is no table: every finding, by place.
    #[error("{}", diagnostic::summary(.0))]
    Text(Vec<Diagnostic>),
    /// One row is impossible: its kind, its numbers, its limits or its names.
    #[error("row {row} of the table: {problem}")]
    Row {
        /// Number of the row, from 1.
        row: usize,
        /// What is wrong with the row.
        problem: String,
    },
    /// The name of the first link is none that a link can have.
    #[error("`base` of the table {problem}")]
    Base {
        /// What is wrong with the name.
        problem: String,
    },
    /// No row moves, or there are too many rows.
    #[error(
        "the table has {rows} rows, {moving} of which move; a robot needs one that moves and at most {MAX_ROWS} rows"
    )]
    Size {
        /// How many rows there are.
        rows: usize,
        /// How many of the rows move.
        moving: usize,
    },
}

impl DhError {
    /// Everything that was found in the text that the table was read from, by place; empty when it came from no text.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        if let Self::Text(found) = self { found } else { &[] }
    }
}

impl DhTable {
    /// Returns an arm in the plane: joints `j1`, `j2`, ... about parallel z axes, links of these lengths \[m\] along x, from
    /// the link `base` to the link `tip`.
    ///
    /// ```
    /// use kinstep::robot::{DhTable, Robot};
    /// let robot = Robot::from_dh(&DhTable::planar("arm", &[1.0, 0.8]))?;
    /// assert_eq!(robot.chain("base", "tip")?.reach(), 1.8);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn planar(name: impl Into<String>, lengths: &[f64]) -> DhTable {
        let row = |a: f64, joint: String, link: String, kind: JointKind| DhRow {
            joint,
            link,
            kind,
            a,
            alpha: 0.0,
            d: 0.0,
            theta: 0.0,
            flip: false,
            limits: Limits::UNLIMITED,
        };
        let before = std::iter::once(0.0).chain(lengths.iter().copied());
        let mut rows: Vec<DhRow> = before
            .zip(1..=lengths.len())
            .map(|(a, i)| row(a, format!("j{i}"), format!("link{i}"), JointKind::Continuous))
            .collect();
        let last = lengths.last().copied().unwrap_or(0.0);
        rows.push(row(last, "to_tip".to_owned(), "tip".to_owned(), JointKind::Fixed));
        DhTable { name: name.into(), base: "base".to_owned(), convention: DhConvention::Modified, rows }
    }
}

impl DhRow {
    /// Says what can not be meant in this row, and under which key.
    pub(super) fn problem(&self) -> Option<(&'static str, String)> {
        let numbers = [("a", self.a), ("alpha", self.alpha), ("d", self.d), ("theta", self.theta)];
        if let Some((key, value)) = numbers.into_iter().find(|(_, value)| !(value.abs() <= MAX_SIZE)) {
            return Some((key, format!("`{key}` is {value}, which is not finite or beyond any arm")));
        }
        match self.kind {
            JointKind::Fixed => None,
            kind if !kind.is_supported() => {
                let cause =
                    format!("a row can not be {kind}; rows are revolute, continuous, prismatic or fixed");
                Some(("kind", cause))
            }
            kind => self.limits_problem(kind),
        }
    }

    fn limits_problem(&self, kind: JointKind) -> Option<(&'static str, String)> {
        let Limits { lower, upper, velocity, acceleration, jerk } = self.limits;
        let of_range = if lower > upper {
            Some(format!("its lower limit {lower} is greater than its upper limit {upper}"))
        } else if !(lower < f64::INFINITY && upper > f64::NEG_INFINITY) {
            Some(format!("no position lies between its limits {lower} and {upper}"))
        } else if kind == JointKind::Continuous && (lower.is_finite() || upper.is_finite()) {
            Some("a continuous joint has no limits; make it revolute, or leave them out".to_owned())
        } else {
            None
        };
        let mut magnitudes =
            [("velocity", velocity), ("acceleration", acceleration), ("jerk", jerk)].into_iter();
        let held = magnitudes.find(|(_, limit)| !(*limit > 0.0));
        let of_motion = held.map(|(key, limit)| {
            (key, format!("its {key} limit {limit} lets it never move; give a positive one"))
        });
        of_range.map(|cause| ("limits", cause)).or(of_motion)
    }

    /// The constant transforms before and after the motion about (or along) z.
    fn constants(&self, convention: DhConvention) -> (IsometryMatrix3<f64>, IsometryMatrix3<f64>) {
        let about_x =
            placed(Vector3::new(self.a, 0.0, 0.0), Rotation3::from_euler_angles(self.alpha, 0.0, 0.0));
        let about_z =
            placed(Vector3::new(0.0, 0.0, self.d), Rotation3::from_euler_angles(0.0, 0.0, self.theta));
        match convention {
            // The motion about z commutes with everything about z.
            DhConvention::Modified => (about_x * about_z, IsometryMatrix3::identity()),
            DhConvention::Standard => (about_z, about_x),
        }
    }

    /// Roll, pitch and yaw of the constant before the motion, where they are exactly that.
    fn angles(&self, convention: DhConvention) -> Option<[f64; 3]> {
        match convention {
            DhConvention::Standard => Some([0.0, 0.0, self.theta]),
            DhConvention::Modified if self.theta == 0.0 => Some([self.alpha, 0.0, 0.0]),
            DhConvention::Modified => None,
        }
    }
}

fn placed(xyz: Vector3<f64>, turn: Rotation3<f64>) -> IsometryMatrix3<f64> {
    IsometryMatrix3::from_parts(Translation3::from(xyz), turn)
}

impl Robot {
    /// Returns the robot that a Denavit-Hartenberg table describes.
    ///
    /// Each row's frame is a link of the row's name. In the standard convention, where that frame is at the far end of
    /// the
    /// body, the body's frame at its joint is a link too, named after it with `_axis`.
    ///
    /// # Errors
    /// [`DhError`]: no row that moves, too many rows, a name used twice or that URDF can not hold, or an impossible
    /// row.
    pub fn from_dh(table: &DhTable) -> Result<Robot, DhError> {
        let moving = table.rows.iter().filter(|row| row.kind.is_movable()).count();
        if moving == 0 || table.rows.len() > MAX_ROWS {
            return Err(DhError::Size { rows: table.rows.len(), moving });
        }
        let mut names = Names::new(&table.base).map_err(|problem| DhError::Base { problem })?;
        let mut serial = Serial::new(&table.base);
        for (row, number) in table.rows.iter().zip(1..) {
            let refuse = |problem| DhError::Row { row: number, problem };
            row.problem().map_or(Ok(()), |(_, problem)| Err(refuse(problem)))?;
            names.take(row, table.convention).map_err(refuse)?;
            serial.row(row, table.convention);
        }
        Ok(Robot::assembled(table.name.clone(), serial.links, serial.joints))
    }
}

/// The names that the rows so far have given.
pub(super) struct Names {
    links: HashSet<String>,
    joints: HashSet<String>,
}

impl Names {
    /// Returns the names of a table without rows, or what is wrong with that of its first link.
    pub(super) fn new(base: &str) -> Result<Names, String> {
        let problem = names::problem(base);
        problem.map_or_else(
            || Ok(Names { links: HashSet::from([base.to_owned()]), joints: HashSet::new() }),
            Err,
        )
    }

    /// Refuses names that no robot can have, or that are there already.
    pub(super) fn take(&mut self, row: &DhRow, convention: DhConvention) -> Result<(), String> {
        let (joints, links) = names_of(row, convention);
        for (what, given, taken) in [("joint", joints, &mut self.joints), ("link", links, &mut self.links)] {
            for name in given {
                if let Some(problem) = names::problem(&name) {
                    return Err(format!("the name of its {what} {problem}"));
                }
                if !taken.insert(name.clone()) {
                    let name = names::quote(&name);
                    return Err(format!("{what} {name} is there already; every {what} needs its own name"));
                }
            }
        }
        Ok(())
    }
}

/// The names of the joints and of the links that a row makes.
fn names_of(row: &DhRow, convention: DhConvention) -> (Vec<String>, Vec<String>) {
    let (joint, link) = (row.joint.clone(), row.link.clone());
    if has_two_frames(row, convention) {
        (vec![joint, format!("{link}_frame")], vec![format!("{link}_axis"), link])
    } else {
        (vec![joint], vec![link])
    }
}

/// Whether the body of a row has a frame at its joint, beside the row's own at its far end.
fn has_two_frames(row: &DhRow, convention: DhConvention) -> bool {
    convention == DhConvention::Standard && row.kind.is_movable()
}

/// Links and joints one after the other.
struct Serial {
    links: Vec<Link>,
    joints: Vec<Joint>,
}

impl Serial {
    fn new(base: &str) -> Serial {
        let links = vec![Link { name: base.to_owned(), parent_joint: None, defect: None }];
        Serial { links, joints: Vec::new() }
    }

    fn row(&mut self, row: &DhRow, convention: DhConvention) {
        let (before, after) = row.constants(convention);
        let (joints, links) = names_of(row, convention);
        if has_two_frames(row, convention) {
            self.joint(row, [&joints[0], &links[0]], before, row.angles(convention));
            let flange = DhRow { kind: JointKind::Fixed, ..row.clone() };
            return self.joint(&flange, [&joints[1], &links[1]], after, Some([row.alpha, 0.0, 0.0]));
        }
        let is_standard = convention == DhConvention::Standard;
        let angles = if is_standard { Some([row.alpha, 0.0, row.theta]) } else { row.angles(convention) };
        self.joint(row, [&joints[0], &links[0]], before * after, angles);
    }

    fn joint(
        &mut self,
        row: &DhRow,
        [name, link]: [&str; 2],
        origin: IsometryMatrix3<f64>,
        angles: Option<[f64; 3]>,
    ) {
        let child = self.links.len();
        self.links.push(Link { name: link.to_owned(), parent_joint: Some(self.joints.len()), defect: None });
        let limits = if row.kind.is_movable() { row.limits } else { Limits::UNLIMITED };
        // Bits of the matrix are those that the angles give, so that what is written down reads back the same.
        let origin = angles.map_or(origin, |[roll, pitch, yaw]| {
            placed(origin.translation.vector, Rotation3::from_euler_angles(roll, pitch, yaw))
        });
        self.joints.push(Joint {
            name: name.to_owned(),
            kind: row.kind,
            parent: child - 1,
            child,
            origin,
            axis: match row.kind {
                JointKind::Fixed => Vector3::x(),
                _ if row.flip => -Vector3::z(),
                _ => Vector3::z(),
            },
            limits,
            mimic: None,
            follows: None,
            defect: None,
            angles,
        });
    }
}
