//! Corrections of single joints, as a calibration of one particular arm finds them.

use std::collections::BTreeMap;

use nalgebra::{IsometryMatrix3, Rotation3, Translation3, Vector3};
use thiserror::Error;

use super::displacement::displacement;
use super::report::Report;
use super::size::MAX_SIZE;
use super::toml_table::{Entries, read_toml, wrong_type};
use super::{Defect, Diagnostic, JointKind, Robot, diagnostic, names};

/// The keys of one joint's corrections.
const KEYS: [&str; 4] = ["xyz", "rpy", "zero", "reversed"];

/// How one joint of a real arm differs from the model.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointCorrection {
    /// Added to the position of the joint's origin, in the parent link's axes \[m\].
    pub xyz: [f64; 3],
    /// Turns the joint's frame about its origin: roll, pitch and yaw about the parent link's axes \[rad\].
    pub rpy: [f64; 3],
    /// Position of the model at which the arm reads zero \[rad\] or \[m\].
    pub zero: f64,
    /// Whether the arm's reading falls as the model's position grows: the arm counts against the model's axis.
    pub reversed: bool,
}

/// Corrections by joint, for [`Robot::with_calibration`].
///
/// As TOML:
///
/// ```
/// use kinstep::robot::{Calibration, embedded};
/// let calibration = Calibration::from_toml(
///     r#"
///     [joint.panda_joint2]
///     xyz = [0.0002, 0, -0.0001]     # added to the origin, in the parent link's axes [m]
///     rpy = [0, 0.0004, 0]           # turns the joint's frame about its origin [rad]
///     zero = "pi/1800"               # the model's position where the arm reads zero
///     reversed = false               # whether the arm counts against the model's axis
///     "#,
/// )?;
/// let robot = embedded::get("panda")?.with_calibration(&calibration)?;
/// # assert_ne!(robot.joint("panda_joint2"), embedded::get("panda")?.joint("panda_joint2"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Calibration {
    corrections: BTreeMap<String, JointCorrection>,
    /// The line of each joint in the text that it was read from.
    lines: BTreeMap<String, usize>,
}

/// Why a calibration can not be read, or does not fit a robot.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// The text is no calibration: every finding, by place.
    #[error("{}", diagnostic::summary(.0))]
    Text(Vec<Diagnostic>),
    /// A joint that the robot does not have.
    #[error("{}the robot has no joint {} to correct{}", at_line(*.line), names::quote(.name),
            known_joints(.nearest, .known))]
    UnknownJoint {
        /// The name in the calibration.
        name: String,
        /// Line of the joint's entry in the calibration, from 1; `None` where it was not read from a text.
        line: Option<usize>,
        /// The joints whose names look like it, nearest first.
        nearest: Vec<String>,
        /// The names of all joints of the robot.
        known: Vec<String>,
    },
    /// `zero` or `reversed` of a joint that has no single position.
    #[error("{}joint {} is {kind}: it has no position that `zero` or `reversed` could correct", at_line(*.line), names::quote(.joint))]
    NoPosition {
        /// Name of the joint.
        joint: String,
        /// Line of the joint's entry in the calibration, from 1; `None` where it was not read from a text.
        line: Option<usize>,
        /// Type of the joint.
        kind: JointKind,
    },
    /// A joint whose own values could not be read.
    #[error("{}joint {} can not be corrected, because it is defective: {}", at_line(*.line), names::quote(.joint), .defect.reason)]
    Defective {
        /// Name of the joint.
        joint: String,
        /// Line of the joint's entry in the calibration, from 1; `None` where it was not read from a text.
        line: Option<usize>,
        /// What is wrong with the joint.
        defect: Defect,
    },
    /// A number that is not finite, or beyond any arm.
    #[error("{}the correction {value} of joint {} is not finite, or beyond any arm", at_line(*.line), names::quote(.joint))]
    Size {
        /// Name of the joint.
        joint: String,
        /// Line of the joint's entry in the calibration, from 1; `None` where it was not read from a text.
        line: Option<usize>,
        /// The number that was refused.
        value: f64,
    },
}

impl CalibrationError {
    /// Returns the line of the calibration's text that the error is about, from 1, where it is known.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::Text(found) => diagnostic::first_error(found).map(|first| first.line),
            Self::UnknownJoint { line, .. }
            | Self::NoPosition { line, .. }
            | Self::Defective { line, .. }
            | Self::Size { line, .. } => *line,
        }
    }
}

fn at_line(line: Option<usize>) -> String {
    line.map_or_else(String::new, |line| format!("line {line}: "))
}

fn known_joints(nearest: &[String], known: &[String]) -> String {
    if nearest.is_empty() {
        format!("; its joints are {}", names::short_list(known, "and"))
    } else {
        names::suggestion(nearest)
    }
}

impl Calibration {
    /// Returns the corrections that a TOML text lists: a table `[joint.NAME]` per joint, with the fields of
    /// [`JointCorrection`]. Numbers may be expressions in pi.
    ///
    /// # Errors
    /// [`CalibrationError::Text`] with everything that is wrong, by place.
    pub fn from_toml(text: &str) -> Result<Calibration, CalibrationError> {
        let (calibration, found) = read_toml(text, read);
        calibration.ok_or(CalibrationError::Text(found))
    }

    /// Adds the correction of a joint, in place of any that it has.
    pub fn insert(&mut self, joint: impl Into<String>, correction: JointCorrection) {
        self.corrections.insert(joint.into(), correction);
    }

    /// Returns the corrections by joint name, in alphabetical order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &JointCorrection)> {
        self.corrections.iter().map(|(joint, correction)| (joint.as_str(), correction))
    }
}

fn read(file: &Entries<'_, '_>, report: &mut Report<'_>) -> Option<Calibration> {
    file.check_keys("a calibration", &["joint"], report);
    let Some(value) = file.value("joint") else {
        report.error(0, "the calibration corrects nothing; write a table `[joint.NAME]` for each joint");
        return None;
    };
    let Some(joints) = value.get_ref().as_table() else {
        wrong_type("joint", "tables `[joint.NAME]`", value, report);
        return None;
    };
    let mut calibration = Calibration::default();
    for (name, value) in joints {
        let (name, offset) = (name.get_ref().to_string(), name.span().start);
        let Some(table) = value.get_ref().as_table() else {
            wrong_type(&format!("joint.{name}"), "a table", value, report);
            continue;
        };
        let table = Entries { table, offset };
        table.check_keys("a correction", &KEYS, report);
        let correction = JointCorrection {
            xyz: table.vector("xyz", report),
            rpy: table.vector("rpy", report),
            zero: table.number("zero", report),
            reversed: table.flag("reversed", report).unwrap_or(false),
        };
        calibration.lines.insert(name.clone(), report.line(offset));
        calibration.corrections.insert(name, correction);
    }
    Some(calibration)
}

impl Robot {
    /// Returns the robot with the corrections of a calibration in its joints.
    ///
    /// With `p` and `R` of the joint's origin, the corrected one has `p + xyz` and `R(rpy) R`. An arm that reads `q`
    /// stands at the model's position `q + zero`, or `-q + zero` where it is `reversed`; limits stay where they are on
    /// the arm, and joints that follow stay where they are: their ratios and offsets refer to readings from then on.
    ///
    /// # Errors
    /// [`CalibrationError`]: a joint that the robot does not have (with the nearest names), one that is defective, or
    /// `zero` or `reversed` of a joint without a single position.
    pub fn with_calibration(&self, calibration: &Calibration) -> Result<Robot, CalibrationError> {
        let mut robot = self.clone();
        for (name, correction) in calibration.iter() {
            let line = calibration.lines.get(name).copied();
            let index = robot.joint_index(name).ok_or_else(|| self.no_joint_to_correct(name, line))?;
            self.check_correction(index, correction, line)?;
            robot.correct(index, correction);
        }
        robot.fold_followers();
        Ok(robot)
    }

    fn no_joint_to_correct(&self, name: &str, line: Option<usize>) -> CalibrationError {
        CalibrationError::UnknownJoint {
            name: name.to_owned(),
            line,
            nearest: self.joints_like(name),
            known: self.joints.iter().map(|joint| joint.name.clone()).collect(),
        }
    }

    fn check_correction(
        &self,
        index: usize,
        correction: &JointCorrection,
        line: Option<usize>,
    ) -> Result<(), CalibrationError> {
        let joint = &self.joints[index];
        let name = joint.name.clone();
        if let Some(defect) = joint.defect.clone() {
            return Err(CalibrationError::Defective { joint: name, line, defect });
        }
        let mut numbers = correction.xyz.into_iter().chain(correction.rpy).chain([correction.zero]);
        if let Some(value) = numbers.find(|value| !(value.abs() <= MAX_SIZE)) {
            return Err(CalibrationError::Size { joint: name, line, value });
        }
        let shifts = correction.zero != 0.0 || correction.reversed;
        if shifts && !joint.kind.is_movable() {
            return Err(CalibrationError::NoPosition { joint: name, line, kind: joint.kind });
        }
        Ok(())
    }

    fn correct(&mut self, index: usize, correction: &JointCorrection) {
        let JointCorrection { xyz, rpy: [roll, pitch, yaw], zero, reversed } = *correction;
        let sign = if reversed { -1.0 } else { 1.0 };
        let joint = &mut self.joints[index];
        let mut origin = joint.origin;
        origin.translation.vector += Vector3::from(xyz);
        if correction.rpy != [0.0; 3] {
            let turn = Rotation3::from_euler_angles(roll, pitch, yaw);
            origin = IsometryMatrix3::from_parts(
                Translation3::from(origin.translation.vector),
                turn * origin.rotation,
            );
        }
        joint.place(origin * displacement(joint.kind, joint.axis, zero));
        joint.axis *= sign;
        let ends = [joint.limits.lower, joint.limits.upper].map(|end| sign * (end - zero));
        (joint.limits.lower, joint.limits.upper) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        for follows in self.joints.iter_mut().filter_map(|joint| joint.follows.as_mut()) {
            if follows.driver == index {
                follows.offset += follows.multiplier * zero;
                follows.multiplier *= sign;
            }
        }
    }
}
