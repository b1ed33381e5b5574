//! Why no robot could be made of a text.

use thiserror::Error;

use crate::robot::diagnostic::{first_error, summary};
use crate::robot::{Diagnostic, Severity};

/// Why no robot can be made of a text: every finding, with its place.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{}", summary(.diagnostics))]
pub struct UrdfError {
    diagnostics: Vec<Diagnostic>,
}

impl UrdfError {
    pub(super) fn new(diagnostics: Vec<Diagnostic>) -> UrdfError {
        UrdfError { diagnostics }
    }

    pub(super) fn at(line: usize, column: usize, message: String) -> UrdfError {
        UrdfError::new(vec![Diagnostic { severity: Severity::Error, line, column, message }])
    }

    pub(super) fn whole_file(message: String) -> UrdfError {
        UrdfError::at(1, 1, message)
    }

    /// Returns everything that was found in the text, by place; at least one finding has [`Severity::Error`].
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// Returns the first finding of severity error.
    pub fn first(&self) -> Option<&Diagnostic> {
        first_error(&self.diagnostics)
    }
}
