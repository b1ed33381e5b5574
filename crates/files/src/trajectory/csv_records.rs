//! Comma-separated values as RFC 4180 has them, also with other separators: records of fields, with the places where they
//! stand.

use std::borrow::Cow;

use super::error::Problem;

/// A field of a record, and the byte at which it begins.
#[derive(Clone, Debug)]
pub struct Field<'t> {
    /// Its text, without the quotes around it.
    pub text: Cow<'t, str>,
    pub(super) at: usize,
}

/// Reads the records of a text of comma-separated values, one after another: fields may stand in quotes and hold line breaks
/// there (RFC 4180).
#[derive(Clone, Debug)]
pub struct Records<'t> {
    text: &'t str,
    at: usize,
    separator: Separator,
}

/// What stands between fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Separator {
    Comma,
    Semicolon,
    Tab,
    /// As many spaces as there are.
    Blanks,
}

impl Separator {
    pub(super) fn character(self) -> char {
        match self {
            Self::Comma => ',',
            Self::Semicolon => ';',
            Self::Tab => '\t',
            Self::Blanks => ' ',
        }
    }

    /// The word for several.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Comma => "commas",
            Self::Semicolon => "semicolons",
            Self::Tab => "tabs",
            Self::Blanks => "blanks",
        }
    }
}

impl Field<'_> {
    /// The byte of the text at which it begins.
    pub(crate) fn at(&self) -> usize {
        self.at
    }
}

impl<'t> Records<'t> {
    /// Begins at the first record of a text.
    pub fn new(text: &'t str) -> Self {
        Self::separated_by(text, Separator::Comma)
    }

    /// Begins at the first record of a text with another separator.
    pub(super) fn separated_by(text: &'t str, separator: Separator) -> Self {
        Self { text, at: 0, separator }
    }

    /// Reads the next record that has something in it into `fields`; returns false at the end of the text.
    ///
    /// # Errors
    /// [`Problem`] with the place of a quote that is not closed, or of what follows a closed one.
    pub fn read(&mut self, fields: &mut Vec<Field<'t>>) -> Result<bool, Problem> {
        fields.clear();
        loop {
            let rest = &self.text[self.at..];
            if rest.is_empty() {
                return Ok(false);
            }
            let end = rest.find('\n').unwrap_or(rest.len());
            if !rest[..end].trim().is_empty() {
                return self.record(end, fields).map(|()| true);
            }
            self.at = (self.at + end + 1).min(self.text.len());
        }
    }

    /// What stands between fields.
    pub(super) fn separator(&self) -> Separator {
        self.separator
    }

    /// Where the next record begins.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    /// Where the record that was read last ends.
    pub(super) fn end(&self) -> usize {
        self.text[..self.at].trim_end_matches(['\n', '\r']).len()
    }

    fn record(&mut self, end: usize, fields: &mut Vec<Field<'t>>) -> Result<(), Problem> {
        let line = &self.text[self.at..self.at + end];
        if line.contains('"') {
            return self.quoted_record(fields);
        }
        let mut at = self.at;
        for part in line.trim_end_matches('\r').split(self.separator.character()) {
            if self.separator != Separator::Blanks || !part.is_empty() {
                fields.push(Field { text: Cow::Borrowed(part), at });
            }
            at += part.len() + 1;
        }
        self.at = (self.at + end + 1).min(self.text.len());
        Ok(())
    }

    /// A record with quotes in it, which may hold commas and line breaks.
    fn quoted_record(&mut self, fields: &mut Vec<Field<'t>>) -> Result<(), Problem> {
        loop {
            let field = self.field()?;
            fields.push(field);
            let rest = &self.text[self.at..];
            if rest.starts_with(self.separator.character()) {
                self.at += if self.separator == Separator::Blanks {
                    rest.len() - rest.trim_start_matches(' ').len()
                } else {
                    1
                };
            } else {
                self.at += if rest.starts_with("\r\n") { 2 } else { rest.len().min(1) };
                return Ok(());
            }
        }
    }

    fn field(&mut self) -> Result<Field<'t>, Problem> {
        let (at, rest) = (self.at, &self.text[self.at..]);
        if !rest.starts_with('"') {
            let length = rest.find([self.separator.character(), '\n']).unwrap_or(rest.len());
            let text = rest[..length].trim_end_matches('\r');
            self.at += text.len();
            return Ok(Field { text: Cow::Borrowed(text), at });
        }
        let mut text = String::new();
        let mut inner = 1;
        loop {
            let Some(length) = rest[inner..].find('"') else {
                return Err(Problem::at(at, "this quote is not closed"));
            };
            text.push_str(&rest[inner..inner + length]);
            inner += length + 1;
            if !rest[inner..].starts_with('"') {
                break;
            }
            text.push('"');
            inner += 1;
        }
        self.at += inner;
        if !(rest.len() == inner || rest[inner..].starts_with([self.separator.character(), '\n', '\r'])) {
            let separators = self.separator.name();
            let message = format!(
                "the end of the line or one of the {separators} between fields has to follow a closing quote"
            );
            return Err(Problem::at(self.at, message));
        }
        Ok(Field { text: Cow::Owned(text), at })
    }
}

/// Returns a field as it stands in a record: one with a comma, a quote or a line break in it stands in quotes.
pub(super) fn quoted(text: &str) -> Cow<'_, str> {
    if text.contains([',', '"', '\n', '\r']) {
        Cow::Owned(format!("\"{}\"", text.replace('"', "\"\"")))
    } else {
        Cow::Borrowed(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn records_read_back_whatever_is_in_their_fields(
            rows in proptest::collection::vec(proptest::collection::vec("[a,\"\r\né]{0,5}x", 1..4), 1..5),
            end in prop_oneof![Just("\n"), Just("\r\n")],
        ) {
            let line = |row: &Vec<String>| row.iter().map(|f| quoted(f)).collect::<Vec<_>>().join(",") + end;
            let text: String = rows.iter().map(line).collect();
            let (mut records, mut fields) = (Records::new(&text), Vec::new());
            for row in &rows {
                prop_assert!(records.read(&mut fields).unwrap());
                let read: Vec<&str> = fields.iter().map(|field| field.text.as_ref()).collect();
                prop_assert_eq!(&read, row);
            }
            prop_assert!(!records.read(&mut fields).unwrap());
        }
    }
}
