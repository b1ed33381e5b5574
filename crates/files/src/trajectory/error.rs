//! Why a trajectory can not be read.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// What kind of thing stands in the way of reading a trajectory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrajectoryErrorKind {
    /// The file is missing, or the system does not give it out.
    File,
    /// What the file holds is no trajectory.
    Content,
}

/// A place in a text file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TextPlace {
    /// The line, from 1.
    pub line: usize,
    /// The column in characters, from 1.
    pub column: usize,
    /// The text of that line.
    pub source_line: String,
}

impl TextPlace {
    /// Returns the place of a byte of `text`.
    pub(super) fn of_byte(text: &str, byte: usize) -> Self {
        let byte = text.floor_char_boundary(byte);
        let start = text[..byte].rfind('\n').map_or(0, |at| at + 1);
        let line = text[..start].matches('\n').count() + 1;
        let column = text[start..byte].chars().count() + 1;
        Self { line, column, source_line: text[start..].lines().next().unwrap_or_default().to_owned() }
    }
}

/// A trajectory that can not be read: which file, where in it, and why.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub struct TrajectoryError {
    /// The file.
    pub path: PathBuf,
    /// What kind of thing is wrong.
    pub kind: TrajectoryErrorKind,
    /// The sentence, without the place.
    pub message: String,
    /// Where the text is wrong, where it is text.
    pub place: Option<TextPlace>,
}

impl fmt::Display for TrajectoryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.path.display())?;
        if let Some(TextPlace { line, column, .. }) = self.place {
            write!(f, "{line}:{column}:")?;
        }
        write!(f, " {}", self.message)
    }
}

impl TrajectoryError {
    /// Returns the refusal of a file that the system does not give out.
    pub(super) fn of_file(path: &Path, error: &io::Error) -> Self {
        let message = match error.kind() {
            io::ErrorKind::NotFound => "there is no such file".to_owned(),
            io::ErrorKind::PermissionDenied => "permission to read it is denied".to_owned(),
            io::ErrorKind::IsADirectory => "this is a folder, not a file".to_owned(),
            _ => format!("it can not be read: {error}"),
        };
        Self { path: path.to_owned(), kind: TrajectoryErrorKind::File, message, place: None }
    }
}

/// What is wrong with the content of a file, and the byte of its text where it shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// The sentence.
    pub message: String,
    /// The byte, counted from 0 in the text without a byte order mark, where the format is text.
    pub at: Option<usize>,
}

impl Problem {
    /// A problem of the file as a whole.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), at: None }
    }

    /// A problem at a byte of the text.
    pub fn at(byte: usize, message: impl Into<String>) -> Self {
        Self { message: message.into(), at: Some(byte) }
    }

    /// Returns the error that this problem is in a file with that text.
    pub(super) fn within(self, path: &Path, text: &str) -> TrajectoryError {
        TrajectoryError {
            path: path.to_owned(),
            kind: TrajectoryErrorKind::Content,
            message: self.message,
            place: self.at.map(|byte| TextPlace::of_byte(text, byte)),
        }
    }
}

/// Returns the beginning of a text that is not what it should be, as it can be shown.
pub(super) fn excerpt(text: &str) -> String {
    let shown: String = text.chars().take(40).collect();
    shown.escape_debug().to_string()
}
