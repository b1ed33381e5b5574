//! Small TOML files about robots: values with their places, and everything that is wrong in one report.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::Diagnostic;
use super::names::{list, quote};
use super::report::Report;
use super::size::unbelievable;
use crate::math::evaluate;

/// A value and where it stands.
pub(crate) type Value<'a, 'i> = &'a Spanned<DeValue<'i>>;

/// Reads a text as TOML through `read`; `None` when anything was an error.
pub(crate) fn read_toml<T>(
    text: &str,
    read: impl FnOnce(&Entries<'_, '_>, &mut Report<'_>) -> Option<T>,
) -> (Option<T>, Vec<Diagnostic>) {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut report = Report::new(text);
    let value = match DeTable::parse(text) {
        Ok(document) => read(&Entries { table: document.get_ref(), offset: 0 }, &mut report),
        Err(error) => {
            let message = error.message().trim().replace('\n', "; ");
            report.error(error.span().map_or(0, |span| span.start), format!("not TOML: {message}"));
            None
        }
    };
    let found = report.finish();
    let is_sound = found.iter().all(|found| found.severity < super::Severity::Error);
    (value.filter(|_| is_sound), found)
}

/// A table and where it stands.
pub(crate) struct Entries<'a, 'i> {
    pub(crate) table: &'a DeTable<'i>,
    pub(crate) offset: usize,
}

impl<'a, 'i> Entries<'a, 'i> {
    /// Reports the keys that are not `known`.
    pub(crate) fn check_keys(&self, what: &str, known: &[&str], report: &mut Report<'_>) {
        for key in self.table.keys().filter(|key| !known.contains(&key.get_ref().as_ref())) {
            let suggestion = report.suggestion(key.get_ref(), known.iter().copied());
            let hint =
                if suggestion.is_empty() { format!("; it has {}", list(known, "and")) } else { suggestion };
            report.error(key.span().start, format!("{what} has no key {}{hint}", quote(key.get_ref())));
        }
    }

    pub(crate) fn value(&self, key: &str) -> Option<Value<'a, 'i>> {
        self.table.get(key)
    }

    /// Where a key's value stands, or else the table.
    pub(crate) fn place(&self, key: &str) -> usize {
        self.value(key).map_or(self.offset, |value| value.span().start)
    }

    pub(crate) fn text(&self, key: &str, report: &mut Report<'_>) -> Option<&'a str> {
        let value = self.value(key)?;
        let text = value.get_ref().as_str();
        if text.is_none() {
            wrong_type(key, "a text in quotes", value, report);
        }
        text
    }

    pub(crate) fn flag(&self, key: &str, report: &mut Report<'_>) -> Option<bool> {
        let value = self.value(key)?;
        let flag = value.get_ref().as_bool();
        if flag.is_none() {
            wrong_type(key, "true or false", value, report);
        }
        flag
    }

    /// The finite number of believable size under a key; 0 where there is none, or none that reads.
    pub(crate) fn number(&self, key: &str, report: &mut Report<'_>) -> f64 {
        self.value(key).and_then(|value| number(key, value, report)).unwrap_or(0.0)
    }

    /// The numbers of a list of any length.
    pub(crate) fn numbers(&self, key: &str, report: &mut Report<'_>) -> Option<Vec<f64>> {
        let value = self.value(key)?;
        let Some(entries) = value.get_ref().as_array() else {
            wrong_type(key, "a list of numbers", value, report);
            return None;
        };
        let numbers = entries.iter().enumerate();
        let numbers: Vec<_> =
            numbers.map(|(i, entry)| number(&format!("{key}[{i}]"), entry, report)).collect();
        numbers.into_iter().collect()
    }

    /// The three numbers of a vector; zeros where there is none, or none that reads.
    pub(crate) fn vector(&self, key: &str, report: &mut Report<'_>) -> [f64; 3] {
        let Some(numbers) = self.numbers(key, report) else { return [0.0; 3] };
        let count = numbers.len();
        numbers.try_into().unwrap_or_else(|_| {
            report.error(self.place(key), format!("`{key}`: expected 3 numbers, found {count}"));
            [0.0; 3]
        })
    }
}

/// Returns a finite number of believable size, given as a number or as an expression in pi.
fn number(key: &str, value: Value<'_, '_>, report: &mut Report<'_>) -> Option<f64> {
    let number = real(key, value, report)?;
    let Some(cause) = unbelievable(number) else { return Some(number) };
    report.error(value.span().start, format!("`{key}`: {cause}"));
    None
}

/// Returns a number, or an infinity; never NaN.
pub(crate) fn real(key: &str, value: Value<'_, '_>, report: &mut Report<'_>) -> Option<f64> {
    let parsed = match value.get_ref() {
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().replace('_', "").parse().ok(),
        DeValue::Integer(integer) => {
            i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|i| i as f64)
        }
        DeValue::Float(float) => float.as_str().replace('_', "").parse().ok(),
        DeValue::String(text) => match evaluate(text) {
            Ok(number) => Some(number),
            Err(error) => {
                report.error(value.span().start, format!("`{key}`: {error}"));
                return None;
            }
        },
        _ => {
            wrong_type(key, "a number, or an expression in pi such as \"pi/2\"", value, report);
            return None;
        }
    };
    let number = parsed.filter(|number: &f64| !number.is_nan());
    if number.is_none() {
        report.error(value.span().start, format!("`{key}`: this is not a number"));
    }
    number
}

pub(crate) fn wrong_type(key: &str, expected: &str, value: Value<'_, '_>, report: &mut Report<'_>) {
    let found = match value.get_ref() {
        DeValue::String(text) => format!("the text {}", quote(text)),
        DeValue::Integer(number) => format!("the integer {}", quote(number.as_str())),
        DeValue::Float(number) => format!("the number {}", quote(number.as_str())),
        DeValue::Boolean(value) => format!("{value}"),
        DeValue::Datetime(_) => "a date".to_owned(),
        DeValue::Array(_) => "a list".to_owned(),
        DeValue::Table(_) => "a table".to_owned(),
    };
    report.error(value.span().start, format!("`{key}`: expected {expected}, found {found}"));
}
