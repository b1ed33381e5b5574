//! What a reader has to say about a file: severity, place and a sentence.

use std::fmt;

/// How much a [`Diagnostic`] matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Worth knowing; nothing is wrong.
    Note,
    /// Doubtful; the robot is usable and the message says how the file was understood.
    Warning,
    /// Wrong; the joint, link or file that the finding is about can not be used.
    Error,
}

impl Severity {
    /// The severity as one lower-case word: `error`, `warning` or `note`.
    pub fn as_str(self) -> &'static str {
        match self {
            Severity::Note => "note",
            Severity::Warning => "warning",
            Severity::Error => "error",
        }
    }
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// One finding in a file, with its place.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct Diagnostic {
    /// How much the finding matters.
    pub severity: Severity,
    /// Line of the finding, counted from 1.
    pub line: usize,
    /// Column of the finding in characters, counted from 1.
    pub column: usize,
    /// What is wrong, and what to do about it, as a sentence.
    pub message: String,
}

impl Diagnostic {
    /// Returns a finding of severity error at a line and a column, both counted from 1.
    pub fn error(line: usize, column: usize, message: impl Into<String>) -> Diagnostic {
        Self::new(Severity::Error, line, column, message)
    }

    /// Returns a finding of that severity at a line and a column, both counted from 1.
    pub fn new(severity: Severity, line: usize, column: usize, message: impl Into<String>) -> Diagnostic {
        Diagnostic { severity, line, column, message: message.into() }
    }
}

impl fmt::Display for Diagnostic {
    /// Writes `line:column: severity: message`, so that a file name and a colon can stand in front.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}: {}", self.line, self.column, self.severity, self.message)
    }
}

/// The first finding of severity error.
pub(super) fn first_error(diagnostics: &[Diagnostic]) -> Option<&Diagnostic> {
    diagnostics.iter().find(|found| found.severity == Severity::Error)
}

/// Returns the first error in a sentence, and how many more there are.
pub(crate) fn summary(diagnostics: &[Diagnostic]) -> String {
    match first_error(diagnostics) {
        Some(first) => {
            format!("line {}, column {}: {}{}", first.line, first.column, first.message, more(diagnostics))
        }
        None => "the file can not be read".to_owned(),
    }
}

/// Returns ` (and 2 more errors)`, or nothing when there is only one.
pub(super) fn more(diagnostics: &[Diagnostic]) -> String {
    match diagnostics.iter().filter(|found| found.severity == Severity::Error).count() {
        0 | 1 => String::new(),
        2 => " (and 1 more error)".to_owned(),
        n => format!(" (and {} more errors)", n - 1),
    }
}
