//! Why no robot could be read from a file.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use super::diagnostic::{first_error, more};
use super::names::shown;
use super::{DhError, Diagnostic, UrdfError, nearby};

/// Why no robot could be read from a file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file can not be read.
    #[error("can not read {}: {}{}", shown(.path), plain(.source), hint(.path, .directory.as_deref(), .source))]
    File {
        /// Path of the file.
        path: PathBuf,
        /// The working directory from which a relative path was looked up.
        directory: Option<PathBuf>,
        /// What the operating system says.
        source: io::Error,
    },
    /// The file is read, but no robot can be made of it.
    #[error("{}", placed(.path, .error.diagnostics(), .error))]
    Urdf {
        /// Path of the file.
        path: PathBuf,
        /// Why no robot can be made of the file.
        error: UrdfError,
    },
    /// The file is read, but its Denavit-Hartenberg table makes no robot.
    #[error("{}", placed(.path, .error.diagnostics(), .error))]
    Dh {
        /// Path of the file.
        path: PathBuf,
        /// Why no robot can be made of the file.
        error: DhError,
    },
}

impl ReadError {
    pub(super) fn file(path: &Path, source: io::Error) -> ReadError {
        let directory = path.is_relative().then(|| std::env::current_dir().ok()).flatten();
        ReadError::File { path: path.to_owned(), directory, source }
    }

    /// Returns everything that was found in the file, by place; nothing where the file could not be read at all.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        match self {
            ReadError::File { .. } => &[],
            ReadError::Urdf { error, .. } => error.diagnostics(),
            ReadError::Dh { error, .. } => error.diagnostics(),
        }
    }
}

/// Writes `file:line:column: message`.
fn placed(path: &Path, found: &[Diagnostic], error: &impl std::fmt::Display) -> String {
    let path = shown(path);
    match first_error(found) {
        Some(first) => {
            let more = more(found);
            format!("{path}:{}:{}: {}{more}", first.line, first.column, first.message)
        }
        None => format!("{path}: {error}"),
    }
}

fn plain(source: &io::Error) -> String {
    match source.kind() {
        io::ErrorKind::NotFound => "there is no such file".to_owned(),
        io::ErrorKind::IsADirectory => "it is a directory".to_owned(),
        io::ErrorKind::PermissionDenied => "reading it is not permitted".to_owned(),
        _ => source.to_string(),
    }
}

fn hint(path: &Path, directory: Option<&Path>, source: &io::Error) -> String {
    let seen =
        directory.map(|directory| format!(" (looked up from {})", shown(directory))).unwrap_or_default();
    let near = if source.kind() == io::ErrorKind::NotFound { nearby::hint(path) } else { String::new() };
    let remedy = match source.kind() {
        io::ErrorKind::NotFound if path.to_string_lossy().starts_with("package://") => {
            "; give the file's own path, `package://` needs ROS"
        }
        io::ErrorKind::NotFound if !near.is_empty() => &near,
        io::ErrorKind::NotFound => "; check the spelling and the working directory",
        io::ErrorKind::IsADirectory => "; name the .urdf file inside it",
        _ => "",
    };
    format!("{seen}{remedy}")
}
