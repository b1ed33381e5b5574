//! The findings of one reading, in one place.

use super::places::Places;
use super::{Defect, Diagnostic, Severity, names};

/// How many nearest-name searches one report pays for; a file with more misspellings than that is hopeless.
const SUGGESTIONS: usize = 20;

/// Collects findings by byte offset.
pub(crate) struct Report<'a> {
    text: &'a str,
    places: Places<'a>,
    found: Vec<(usize, Severity, String)>,
    suggestions_left: usize,
}

impl<'a> Report<'a> {
    pub(crate) fn new(text: &'a str) -> Report<'a> {
        Report { text, places: Places::new(text), found: Vec::new(), suggestions_left: SUGGESTIONS }
    }

    pub(crate) fn error(&mut self, offset: usize, message: impl Into<String>) {
        self.found.push((offset, Severity::Error, message.into()));
    }

    pub(crate) fn warning(&mut self, offset: usize, message: impl Into<String>) {
        self.found.push((offset, Severity::Warning, message.into()));
    }

    pub(crate) fn note(&mut self, offset: usize, message: impl Into<String>) {
        self.found.push((offset, Severity::Note, message.into()));
    }

    /// The line of an offset, to be named in a message.
    pub(crate) fn line(&self, offset: usize) -> usize {
        self.places.line(offset)
    }

    /// The name, with its prefix, that the file writes at an offset.
    pub(crate) fn written_name(&self, offset: usize) -> &'a str {
        let rest = self.text.get(offset..).unwrap_or_default();
        let ends = |c: char| c.is_ascii_whitespace() || matches!(c, '=' | '/' | '>');
        rest.split(ends).next().unwrap_or_default()
    }

    pub(crate) fn defect(&self, offset: usize, reason: String) -> Defect {
        let (line, column) = self.places.at(offset);
        Defect { reason, line, column }
    }

    /// Returns "; did you mean ...?" for a name that is not known.
    pub(crate) fn suggestion<'n>(&mut self, name: &str, known: impl IntoIterator<Item = &'n str>) -> String {
        if self.suggestions_left == 0 {
            return String::new();
        }
        self.suggestions_left -= 1;
        names::suggestion(&names::nearest(name, known))
    }

    /// Returns the findings by place.
    pub(crate) fn finish(mut self) -> Vec<Diagnostic> {
        self.found.sort_by_key(|&(offset, severity, _)| (offset, std::cmp::Reverse(severity)));
        let places = &self.places;
        self.found
            .into_iter()
            .map(|(offset, severity, message)| {
                let (line, column) = places.at(offset);
                Diagnostic { severity, line, column, message }
            })
            .collect()
    }
}
