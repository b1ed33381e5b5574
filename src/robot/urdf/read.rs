//! URDF from a text or from bytes: sizes and encoding first, then the document.

use super::{MAX_BYTES, UrdfError, UrdfOptions, document, encoding};
use crate::robot::Robot;
use crate::robot::report::Report;

impl Robot {
    /// Returns the robot that a URDF text describes, with everything found wrong in it as
    /// [`diagnostics`](Robot::diagnostics). A defective joint spoils only the chains through it.
    ///
    /// # Errors
    /// [`UrdfError`] when no robot can be made at all: the text is not XML, not URDF (SDF, MJCF, xacro), holds
    /// a DTD, has no link, or exceeds the size caps. The error carries every finding with its place.
    ///
    /// ```
    /// use kinstep::robot::Robot;
    /// let robot = Robot::from_urdf(
    ///     r#"<robot name="pendulum">
    ///          <link name="base"/> <link name="bob"/>
    ///          <joint name="pivot" type="continuous">
    ///            <parent link="base"/> <child link="bob"/> <axis xyz="0 1 0"/>
    ///          </joint>
    ///        </robot>"#,
    /// )?;
    /// assert_eq!(robot.joints()[0].name, "pivot");
    /// # Ok::<(), kinstep::robot::UrdfError>(())
    /// ```
    pub fn from_urdf(text: &str) -> Result<Robot, UrdfError> {
        read_text(text, &UrdfOptions::default())
    }

    /// Returns the robot that a URDF text describes, as [`Robot::from_urdf`] does, read as the options say.
    ///
    /// # Errors
    /// As [`Robot::from_urdf`].
    pub fn from_urdf_with(text: &str, options: &UrdfOptions) -> Result<Robot, UrdfError> {
        read_text(text, options)
    }

    /// Returns the robot that a URDF describes, as [`Robot::from_urdf_with`] does, from bytes whose encoding is checked
    /// first: UTF-8, with or without a byte order mark.
    ///
    /// # Errors
    /// As [`Robot::from_urdf`]; also when the bytes are not UTF-8 (the message names the encoding).
    pub fn from_urdf_bytes(bytes: &[u8], options: &UrdfOptions) -> Result<Robot, UrdfError> {
        read_bytes(bytes, options)
    }
}

/// Reads a robot from text.
fn read_text(text: &str, options: &UrdfOptions) -> Result<Robot, UrdfError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.len() > MAX_BYTES {
        return Err(UrdfError::whole_file(format!(
            "the text has {} bytes, more than the {MAX_BYTES} (64 MiB) that are read",
            text.len()
        )));
    }
    let mut report = Report::new(text);
    match document::read(text, options, &mut report) {
        Some(mut robot) => {
            robot.diagnostics = report.finish();
            Ok(robot)
        }
        None => Err(UrdfError::new(report.finish())),
    }
}

/// Reads a robot from bytes.
fn read_bytes(bytes: &[u8], options: &UrdfOptions) -> Result<Robot, UrdfError> {
    if bytes.len() > MAX_BYTES {
        return Err(UrdfError::whole_file(format!(
            "the file has {} bytes, more than the {MAX_BYTES} (64 MiB) that are read",
            bytes.len()
        )));
    }
    read_text(encoding::decode(bytes)?, options)
}
