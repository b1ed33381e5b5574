//! What is done to a robot after it is read and before chains are laid through it: calibration, locks, a tool.

use std::path::Path;

use super::build::read_robot;
use super::document::read_text;
use super::error::{ErrorKind, Place, ScenarioError};
use super::files;
use super::key_path::KeyPath;
use super::law_spec::LawSpec;
use super::model::{ArmSpec, Scenario};
use crate::trajectory::LimitsFile;
use kinstep::kind::Real;
use kinstep::robot::{Calibration, CalibrationError, Diagnostic, Robot, Severity};

/// Returns the robot with the corrections that a calibration file lists.
///
/// # Errors
/// [`ScenarioError`] of kind [`ErrorKind::File`] where the file can not be read, of kind [`ErrorKind::Robot`], with the
/// place in the file, where it is no calibration or does not fit the robot.
pub fn calibrated(robot: &Robot, file: &Path) -> Result<Robot, ScenarioError> {
    let text = read_text(file)?;
    let calibration = Calibration::from_toml(&text);
    calibration
        .and_then(|calibration| robot.with_calibration(&calibration))
        .map_err(|e| refusal(&e, file, &text))
}

/// Returns the robot with the limits of a file over its own, and what has to be said of that, by place in the file.
///
/// # Errors
/// [`ScenarioError`] of kind [`ErrorKind::File`] where the file can not be read, of kind [`ErrorKind::Robot`], with the place
/// in the file, where it holds no limits or does not fit the robot.
pub fn limited(robot: &Robot, file: &Path) -> Result<(Robot, Vec<Diagnostic>), ScenarioError> {
    let text = read_text(file)?;
    LimitsFile::from_yaml(&text).and_then(|limits| limits.over(robot)).map_err(|found| {
        let first = first_error(&found);
        let more = found.iter().filter(|found| found.severity == Severity::Error).count().saturating_sub(1);
        let more = if more > 0 { format!(" (and {more} more)") } else { String::new() };
        let (line, column, message) =
            first.map_or((1, 1, ""), |first| (first.line, first.column, &first.message));
        let place = Place::of_line(Some(file.display().to_string()), &text, line, column);
        ScenarioError::new(ErrorKind::Robot, format!("{message}{more}")).or_placed(Some(place))
    })
}

fn first_error(found: &[Diagnostic]) -> Option<&Diagnostic> {
    found.iter().find(|found| found.severity == Severity::Error)
}

fn refusal(error: &CalibrationError, file: &Path, text: &str) -> ScenarioError {
    let name = file.display().to_string();
    let first = match error {
        CalibrationError::Text(found) => first_error(found),
        _ => None,
    };
    let (message, line, column) = if let Some(first) = first {
        (first.message.clone(), first.line, first.column)
    } else {
        let message = error.to_string();
        let line = error.line().unwrap_or(1);
        let bare = message.strip_prefix(&format!("line {line}: ")).unwrap_or(&message).to_owned();
        (bare, line, 1)
    };
    let place = Place::of_line(Some(name), text, line, column);
    ScenarioError::new(ErrorKind::Robot, message).or_placed(Some(place))
}

/// Returns a name for the frame of a tool on the link `tip`: the link's own with `_tool`, and as many underscores as it takes to
/// be no name of a link or joint of the robot.
pub fn tool_name(robot: &Robot, tip: &str) -> String {
    let mut name = format!("{tip}_tool");
    while robot.link(&name).is_some() || robot.joint(&name).is_some() {
        name.push('_');
    }
    name
}

/// Changes a robot by the file that a key names.
fn by_file(
    at: &KeyPath,
    reference: &str,
    folder: Option<&Path>,
    edit: impl FnOnce(&Path) -> Result<Robot, ScenarioError>,
) -> Result<Robot, ScenarioError> {
    let file = files::find(reference, folder).ok_or_else(|| files::missing(reference, folder));
    file.and_then(|file| edit(&file)).map_err(|e| {
        let path = Some(at.clone()).filter(|_| e.place.is_none());
        ScenarioError { message: format!("{at}: {}", e.message), path, ..e }
    })
}

impl ArmSpec {
    /// Returns the arm's robot, calibrated, with its locked joints held and within all limits that the scenario has.
    pub(super) fn changed(
        &self,
        at: &KeyPath,
        robot: Robot,
        law: &LawSpec,
        folder: Option<&Path>,
    ) -> Result<Robot, ScenarioError> {
        let mut robot = robot;
        if let Some(reference) = &self.calibration {
            robot = by_file(&at.key("calibration"), reference, folder, |file| calibrated(&robot, file))?;
        }
        if let Some(reference) = &self.limits {
            let edit = |file: &Path| limited(&robot, file).map(|(robot, _)| robot);
            robot = by_file(&at.key("limits"), reference, folder, edit)?;
        }
        for (joint, held) in &self.lock {
            let numbers: Vec<f64> = held.numbers().iter().map(Real::value).collect();
            robot = robot
                .with_locked(joint, &numbers)
                .map_err(|e| ScenarioError::at(ErrorKind::Robot, &at.key("lock").key(joint), e))?;
        }
        law.limited(robot)
    }

    /// Returns the robot with the arm's tool put on, and the link at which the chain then ends.
    pub(super) fn tooled(&self, at: &KeyPath, robot: Robot) -> Result<(Robot, String), ScenarioError> {
        if self.tool.is_identity() || robot.link(&self.tip).is_none() {
            return Ok((robot, self.tip.clone()));
        }
        let name = tool_name(&robot, &self.tip);
        let tooled = robot.with_tool(&self.tip, &name, &self.tool.pose());
        let refuse = |e| ScenarioError::at(ErrorKind::Robot, &at.key("tool"), e);
        Ok((tooled.map_err(refuse)?, name))
    }
}

impl Scenario {
    /// Returns what has to be said of the robots of the arms as their files give them, file by file: `FILE:line:column: ...`.
    /// Nothing of a file that can not be read: that is refused elsewhere.
    pub fn robot_findings(&self, folder: Option<&Path>) -> Vec<String> {
        let mut said = Vec::new();
        for arm in &self.arm {
            let Ok((source, robot)) = read_robot(&KeyPath::dotted("arm").key(&arm.name), arm, folder) else {
                continue;
            };
            let found = robot.diagnostics().iter().map(|found| format!("{}:{found}", source.label()));
            said.extend(found);
        }
        each_once(said)
    }

    /// Returns what has to be said of the arms' files of limits: limits that are wider than the robots' own, and what the files
    /// hold and is not applied.
    pub fn limit_findings(&self, folder: Option<&Path>) -> Vec<String> {
        let mut said = Vec::new();
        for arm in &self.arm {
            let read = read_robot(&KeyPath::dotted("arm").key(&arm.name), arm, folder).ok();
            let file = arm.limits.as_deref().and_then(|reference| files::find(reference, folder));
            let Some(((_, robot), file)) = read.zip(file) else { continue };
            let notes = limited(&robot, &file).map(|(_, notes)| notes).unwrap_or_default();
            said.extend(notes.iter().map(|note| format!("{}:{note}", file.display())));
        }
        each_once(said)
    }
}

/// Arms of one robot have the same to say.
fn each_once(said: Vec<String>) -> Vec<String> {
    let mut once: Vec<String> = Vec::new();
    for sentence in said {
        if !once.contains(&sentence) {
            once.push(sentence);
        }
    }
    once
}
