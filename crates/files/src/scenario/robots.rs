//! Which robot a scenario means: one of the embedded ones, or a file.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};

use super::document::read_bounded;
use super::error::{ErrorKind, Place, ScenarioError, suggestion};
use super::files;
use kinstep::robot::{Diagnostic, MAX_BYTES, ReadError, Robot, Severity, UrdfOptions, embedded};

/// Where a robot comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RobotSource {
    /// Embedded in the library, by name.
    Embedded(String),
    /// A file: URDF, or a Denavit-Hartenberg table in TOML.
    File(PathBuf),
    /// The URDF itself, written into the scenario: a scenario made by a program is one file then.
    Text(String),
}

impl RobotSource {
    /// Returns what `reference` means: an embedded robot's name, a path that is tried from `folder` and then
    /// from the working directory, or URDF text, which begins with `<`.
    ///
    /// # Errors
    /// [`ScenarioError`] of kind [`ErrorKind::Scenario`] for a name (no path, no extension) that is neither, with
    /// the nearest names, of kind [`ErrorKind::File`] for a path to a file that is in neither place.
    pub fn find(reference: &str, folder: Option<&Path>) -> Result<Self, ScenarioError> {
        if reference.trim_start().starts_with('<') {
            return Ok(Self::Text(reference.to_owned()));
        }
        let names = embedded::names();
        if names.contains(&reference) {
            return Ok(Self::Embedded(reference.to_owned()));
        }
        if let Some(found) = files::find(reference, folder) {
            return Ok(Self::File(found));
        }
        if Path::new(reference).extension().is_some() || reference.contains(['/', '\\']) {
            return Err(files::missing(reference, folder));
        }
        let hint = suggestion(reference, names);
        let message = format!("\"{reference}\" is neither a built-in robot nor a file; {hint}");
        Err(ScenarioError::new(ErrorKind::Scenario, message))
    }

    /// Returns the name or the path, for messages.
    pub fn label(&self) -> String {
        match self {
            Self::Embedded(name) => name.clone(),
            Self::File(path) => path.display().to_string(),
            Self::Text(_) => "in the scenario".to_owned(),
        }
    }

    /// Returns the robot.
    ///
    /// # Errors
    /// [`ReadError`] where the file can not be read, or no robot can be made of it.
    pub fn read(&self, options: &UrdfOptions) -> Result<Robot, ReadError> {
        match self {
            Self::File(path) => Robot::from_file(path, options),
            Self::Embedded(name) => read_embedded(name, options),
            Self::Text(text) => Robot::from_urdf_with(text, options)
                .map_err(|error| ReadError::Urdf { path: self.label().into(), error }),
        }
    }

    /// Returns the place of a finding in the robot's text.
    pub fn place(&self, line: usize, column: usize) -> Place {
        Place::of_line(Some(self.label()), &self.text(), line, column)
    }

    /// Returns the robot's text as it stands; empty where it can not be read.
    fn text(&self) -> String {
        match self {
            Self::Embedded(name) => embedded::text(name).unwrap_or_default().to_owned(),
            Self::Text(text) => text.clone(),
            Self::File(path) => {
                let bytes = read_bounded(path, MAX_BYTES as u64).ok().flatten().unwrap_or_default();
                String::from_utf8(bytes).unwrap_or_default()
            }
        }
    }

    /// Returns the text where it is URDF.
    pub fn urdf(&self) -> Option<String> {
        let text = self.text();
        text.trim_start_matches('\u{feff}').trim_ascii_start().starts_with('<').then_some(text)
    }

    /// Returns the folder of the robot's file, if it is one.
    pub fn folder(&self) -> Option<PathBuf> {
        match self {
            Self::File(path) => path.parent().map(Path::to_owned),
            Self::Embedded(_) | Self::Text(_) => None,
        }
    }

    /// Returns the refusal that a failed [`RobotSource::read`] means, with its place in the file.
    pub fn refusal(&self, error: &ReadError) -> ScenarioError {
        if matches!(error, ReadError::File { .. }) {
            return ScenarioError::of_file(Path::new(&self.label()), error.to_string());
        }
        let is_error = |found: &&Diagnostic| found.severity == Severity::Error;
        let errors = error.diagnostics().iter().filter(is_error).count();
        let more =
            if errors > 1 { format!(" ({errors} errors; `robot check` lists them)") } else { String::new() };
        let Some(first) = error.diagnostics().iter().find(is_error) else {
            return ScenarioError::new(ErrorKind::Robot, error.to_string());
        };
        let place = self.place(first.line, first.column);
        ScenarioError::new(ErrorKind::Robot, format!("{}{more}", first.message)).or_placed(Some(place))
    }
}

/// Returns an embedded robot. Robots do not change, so each is read once: a sweep asks for one thousands of times.
fn read_embedded(name: &str, options: &UrdfOptions) -> Result<Robot, ReadError> {
    static READ: LazyLock<Mutex<HashMap<String, Robot>>> = LazyLock::new(Mutex::default);
    // Whoever panicked while holding the lock left a map that is whole.
    let known = || READ.lock().unwrap_or_else(PoisonError::into_inner);
    let is_default = *options == UrdfOptions::default();
    if let Some(robot) = known().get(name).filter(|_| is_default) {
        return Ok(robot.clone());
    }
    let text = embedded::text(name).unwrap_or_default();
    let robot =
        Robot::from_urdf_with(text, options).map_err(|error| ReadError::Urdf { path: name.into(), error })?;
    if is_default {
        known().insert(name.to_owned(), robot.clone());
    }
    Ok(robot)
}
