//! What is done to a robot after it is read and before chains are laid through it: calibration, locks, a tool.

use std::path::Path;

use super::document::read_text;
use super::error::{ErrorKind, Place, ScenarioError};
use super::files;
use super::key_path::KeyPath;
use super::model::ArmSpec;
use kinstep::kind::Real;
use kinstep::robot::{Calibration, CalibrationError, Robot};

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

fn refusal(error: &CalibrationError, file: &Path, text: &str) -> ScenarioError {
    let name = file.display().to_string();
    let first = match error {
        CalibrationError::Text(found) => {
            found.iter().find(|found| found.severity == kinstep::robot::Severity::Error)
        }
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

impl ArmSpec {
    /// Returns the arm's robot, calibrated and with its locked joints held.
    pub(super) fn changed(
        &self,
        at: &KeyPath,
        robot: Robot,
        folder: Option<&Path>,
    ) -> Result<Robot, ScenarioError> {
        let mut robot = robot;
        if let Some(reference) = &self.calibration {
            let at = at.key("calibration");
            let file = files::find(reference, folder).ok_or_else(|| files::missing(reference, folder));
            let done = file.and_then(|file| calibrated(&robot, &file));
            robot = done.map_err(|e| {
                let path = Some(at.clone()).filter(|_| e.place.is_none());
                ScenarioError { message: format!("{at}: {}", e.message), path, ..e }
            })?;
        }
        for (joint, held) in &self.lock {
            let numbers: Vec<f64> = held.numbers().iter().map(Real::value).collect();
            robot = robot
                .with_locked(joint, &numbers)
                .map_err(|e| ScenarioError::at(ErrorKind::Robot, &at.key("lock").key(joint), e))?;
        }
        Ok(robot)
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
