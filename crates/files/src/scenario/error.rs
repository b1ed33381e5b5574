//! What is wrong with a scenario, and where.

use super::key_path::KeyPath;

/// What kind of thing a scenario was refused for; a program's exit status follows from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The scenario itself: unreadable, an unknown key or id, a value out of its range.
    Scenario,
    /// A robot that it names is defective, or has no such link.
    Robot,
    /// A formula that it names is defective, or can not run.
    Formula,
    /// A file that it names is missing or can not be read.
    File,
}

/// A place in a text file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file, where there is one.
    pub file: Option<String>,
    /// The line, from 1.
    pub line: usize,
    /// The column in characters, from 1.
    pub column: usize,
    /// The text of that line.
    pub source_line: String,
}

impl Place {
    /// Returns the place of a byte of `text`.
    pub fn of_byte(file: Option<String>, text: &str, byte: usize) -> Self {
        let mut byte = byte.min(text.len());
        while !text.is_char_boundary(byte) {
            byte -= 1;
        }
        let start = text[..byte].rfind('\n').map_or(0, |at| at + 1);
        let line = text[..start].matches('\n').count() + 1;
        let column = text[start..byte].chars().count() + 1;
        let source_line = text[start..].lines().next().unwrap_or_default().to_owned();
        Self { file, line, column, source_line }
    }

    /// Returns the place at a line and a column of `text`, both from 1.
    pub fn of_line(file: Option<String>, text: &str, line: usize, column: usize) -> Self {
        let source_line = text.lines().nth(line.saturating_sub(1)).unwrap_or_default().to_owned();
        Self { file, line, column, source_line }
    }
}

/// A scenario that can not be planned, in a sentence, with the key and its place where they are known.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct ScenarioError {
    /// What kind of thing is wrong.
    pub kind: ErrorKind,
    /// The sentence: the key, what is wrong with it, and what to do.
    pub message: String,
    /// The key that the sentence is about, where it is about one.
    pub path: Option<KeyPath>,
    /// Where that key, or the offending text, stands.
    pub place: Option<Box<Place>>,
    /// Which character of the text at that key is meant, from 1, where it is not the first.
    pub column: Option<std::num::NonZeroU32>,
    /// The file that the sentence is about as a whole, where it can not be read.
    pub file: Option<String>,
    /// What else is wrong, where more than one thing was found.
    pub also: Vec<ScenarioError>,
}

impl ScenarioError {
    /// Returns a refusal without a place.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self {
            kind,
            message: message.into(),
            path: None,
            place: None,
            column: None,
            file: None,
            also: Vec::new(),
        }
    }

    /// Returns a refusal of the value at `path`; the sentence begins with the path.
    pub fn at(kind: ErrorKind, path: &KeyPath, problem: impl std::fmt::Display) -> Self {
        Self { path: Some(path.clone()), ..Self::new(kind, format!("{path}: {problem}")) }
    }

    /// Returns the refusal of a file that can not be read.
    pub fn of_file(file: &std::path::Path, message: impl Into<String>) -> Self {
        Self { file: Some(file.display().to_string()), ..Self::new(ErrorKind::File, message) }
    }

    /// Returns several refusals as one: the first with the others beside it. Nothing where there are none.
    pub fn all<'a>(refusals: impl IntoIterator<Item = &'a ScenarioError>) -> Option<Self> {
        let mut refusals = refusals.into_iter().cloned();
        let mut first = refusals.next()?;
        first.also.extend(refusals);
        Some(first)
    }

    /// Returns the same refusal with a place, unless it has one.
    #[must_use]
    pub fn or_placed(mut self, place: Option<Place>) -> Self {
        self.place = self.place.or_else(|| place.map(Box::new));
        self
    }
}

/// Returns what a message offers in place of an unknown name: `did you mean NAME?` where one of `known` is near to it, else the
/// list of them.
pub fn suggestion<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    match nearest(name, &known) {
        Some(nearest) => format!("did you mean {nearest}?"),
        None if known.is_empty() => "there is none to choose from".to_owned(),
        None => format!("known are {}", known.join(", ")),
    }
}

/// Returns `not one of A, B, C`, and the one that is near to `name`, if there is one.
pub(crate) fn not_one_of(name: &str, known: &[&str]) -> String {
    let hint = nearest(name, known).map_or_else(String::new, |nearest| format!("; did you mean {nearest}?"));
    format!("not one of {}{hint}", known.join(", "))
}

fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let likeness = |k: &&'a str| (strsim::normalized_damerau_levenshtein(name, k), *k);
    let best = known.iter().map(likeness).max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(best.1).filter(|_| best.0 >= 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_has_its_line_and_its_column_in_characters() {
        let text = "a = 1\nπ = é\n";
        let place = Place::of_byte(None, text, text.find('é').unwrap());
        assert_eq!((place.line, place.column, place.source_line.as_str()), (2, 5, "π = é"));
        assert_eq!(Place::of_byte(None, text, 9999).line, 3);
        assert_eq!(Place::of_byte(None, "", 0).line, 1);
    }

    #[test]
    fn a_near_name_is_suggested_and_a_far_one_gets_the_list() {
        assert_eq!(suggestion("sigm", ["sigma", "formula"]), "did you mean sigma?");
        assert_eq!(suggestion("zebra", ["sigma", "formula"]), "known are sigma, formula");
    }
}
