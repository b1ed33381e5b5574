//! Rows from TOML, with the place of everything that is wrong.

use std::collections::HashMap;

use num_traits::ToPrimitive;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::math::{Rational, parse_rational, rational_from_f64};

use super::error::{Defect, DefectKind, Place, TableError, nearest};
use super::row::{Coefficients, Declared, Places, Row};

/// The keys of a row.
const KEYS: [&str; 13] = [
    "id",
    "name",
    "family",
    "difference",
    "denominator",
    "alpha",
    "beta",
    "gamma",
    "order",
    "error_constant",
    "zero_stable",
    "source",
    "attribution",
];
const NOTE: &str = "note";

/// What a row may leave out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strictness {
    /// `source`, `order`, `error_constant` and `zero_stable` are required.
    Finished,
    /// `source`, `order`, `error_constant` and `zero_stable` may be missing: the row is a draft, to be finished by the
    /// code.
    Draft,
}

/// Returns the rows of a TOML text, in the order of the text.
///
/// # Errors
/// [`TableError`] with everything that makes the text or a row unreadable, ids used twice included.
pub fn read_rows(text: &str, strictness: Strictness) -> Result<Vec<Row>, TableError> {
    let mut defects = Vec::new();
    let mut rows = Vec::new();
    match DeTable::parse(text) {
        Ok(document) => {
            let mut reader = Reader { text, row: None, defects: &mut defects };
            for table in reader.row_tables(document.get_ref(), document.span().start) {
                rows.extend(reader.row(table, strictness));
            }
        }
        Err(error) => {
            let place = Place::of(text, error.span().map_or(0, |span| span.start));
            let message = error.message().trim().replace('\n', "; ");
            defects.push(Defect { place, row: None, kind: DefectKind::Syntax { message } });
        }
    }
    defects.extend(repeated_ids(&rows));
    TableError::unless_none(defects).map(|()| rows)
}

fn repeated_ids(rows: &[Row]) -> Vec<Defect> {
    let mut first_lines: HashMap<&str, usize> = HashMap::new();
    rows.iter()
        .filter_map(|row| {
            let first_line = *first_lines.entry(&row.id).or_insert(row.places.row.line);
            let kind = DefectKind::DuplicateId { id: row.id.clone(), first_line };
            (first_line != row.places.row.line).then_some(Defect { place: row.places.row, row: None, kind })
        })
        .collect()
}

/// A value and where it stands.
type Value<'a, 'i> = &'a Spanned<DeValue<'i>>;

struct Reader<'t> {
    text: &'t str,
    /// The id of the row being read.
    row: Option<String>,
    defects: &'t mut Vec<Defect>,
}

impl Reader<'_> {
    fn report(&mut self, byte: usize, kind: DefectKind) {
        self.defects.push(Defect { place: Place::of(self.text, byte), row: self.row.clone(), kind });
    }

    /// The tables under `formula`; anything else at the top is reported.
    fn row_tables<'a, 'i>(&mut self, document: &'a DeTable<'i>, start: usize) -> Vec<Value<'a, 'i>> {
        let mut tables = Vec::new();
        for (key, value) in document {
            if key.get_ref() != "formula" {
                self.unknown_key(key.get_ref(), key.span().start, "the file", &["formula"]);
                continue;
            }
            match value.get_ref() {
                DeValue::Array(list) if list.iter().all(|entry| entry.get_ref().is_table()) => {
                    tables.extend(list.iter());
                }
                _ => self.wrong_type("formula", "a list of rows, each begun by a line [[formula]]", value),
            }
        }
        if tables.is_empty() && self.defects.is_empty() {
            self.report(start, DefectKind::NoRows);
        }
        tables
    }

    fn unknown_key(&mut self, key: &str, byte: usize, place: &'static str, known: &[&str]) {
        let kind = DefectKind::UnknownKey {
            key: key.to_owned(),
            nearest: nearest(key, known.iter().copied()).map(str::to_owned),
            place,
            known: known.join(", "),
        };
        self.report(byte, kind);
    }

    fn wrong_type(&mut self, key: &str, expected: &'static str, value: Value<'_, '_>) {
        let found = match value.get_ref() {
            DeValue::String(text) => format!("the text \"{}\"", crate::math::shortened(text)),
            DeValue::Integer(number) => format!("the integer {}", crate::math::shortened(number.as_str())),
            DeValue::Float(number) => format!("the number {}", crate::math::shortened(number.as_str())),
            DeValue::Boolean(value) => format!("{value}"),
            DeValue::Datetime(_) => "a date".to_owned(),
            DeValue::Array(_) => "a list".to_owned(),
            DeValue::Table(_) => "a table".to_owned(),
        };
        self.report(value.span().start, DefectKind::WrongType { key: key.to_owned(), expected, found });
    }

    /// Reads one row; `None` when something in it was reported.
    fn row(&mut self, spanned: Value<'_, '_>, strictness: Strictness) -> Option<Row> {
        let table = spanned.get_ref().as_table()?;
        let before = self.defects.len();
        let start = spanned.span().start;
        self.row = None;
        let id = self.id(table, start);
        self.row.clone_from(&id);
        let known: Vec<&str> = KEYS.into_iter().chain([NOTE]).collect();
        for key in table.keys().filter(|key| !known.contains(&key.get_ref().as_ref())) {
            self.unknown_key(key.get_ref(), key.span().start, "a row", &known);
        }
        let declared = self.declared(table);
        let source = self.text_at(table, "source");
        if strictness == Strictness::Finished {
            self.require_claims(table, start);
        }
        let [name, family, attribution, note] =
            ["name", "family", "attribution", NOTE].map(|key| self.text_at(table, key));
        let coefficients = self.coefficients(table, start)?;
        let row = Row::new(&id.clone().unwrap_or_default(), coefficients);
        let row = row.map_err(|kind| self.report(coefficient_place(table, &kind, start), kind)).ok()?;
        self.row = None;
        let places = self.places(table, start);
        (self.defects.len() == before).then_some(Row {
            name,
            family,
            declared,
            source,
            attribution,
            note,
            places,
            ..row
        })
    }

    fn places(&self, table: &DeTable<'_>, start: usize) -> Places {
        let of = |keys: &[&str]| {
            let value = keys.iter().find_map(|key| table.get(*key));
            Place::of(self.text, value.map_or(start, |value| value.span().start))
        };
        Places {
            row: Place::of(self.text, start),
            coefficients: of(&["difference", "alpha"]),
            gamma: of(&["gamma"]),
            order: of(&["order"]),
            error_constant: of(&["error_constant"]),
            zero_stable: of(&["zero_stable"]),
        }
    }

    fn id(&mut self, table: &DeTable<'_>, start: usize) -> Option<String> {
        let Some(value) = table.get("id") else {
            self.missing("id", "give the row a short name of its own, such as id = \"mine-1\"", start);
            return None;
        };
        let id = self.text_at(table, "id")?;
        let usable = |c: char| c.is_ascii_alphanumeric() || "-_.+".contains(c);
        if id.is_empty() || id.len() > 100 || !id.chars().all(usable) {
            let id = crate::math::shortened(&id);
            self.report(value.span().start, DefectKind::UnusableId { id });
            return None;
        }
        Some(id)
    }

    fn missing(&mut self, key: &'static str, remedy: &'static str, byte: usize) {
        self.report(byte, DefectKind::MissingKey { key, remedy });
    }

    fn require_claims(&mut self, table: &DeTable<'_>, start: usize) {
        let claims = [
            ("order", "a row declares its order, to be checked; `formula check --draft` computes it"),
            (
                "error_constant",
                "a row declares its error constant, to be checked; `formula check --draft` computes it",
            ),
            (
                "zero_stable",
                "a row declares whether it is zero-stable, to be checked; `formula check --draft` computes it",
            ),
            ("source", "say where the coefficients are from, such as a key of the bibliography"),
        ];
        for (key, remedy) in claims {
            if !table.contains_key(key) {
                self.missing(key, remedy, start);
            }
        }
    }

    fn text_at(&mut self, table: &DeTable<'_>, key: &'static str) -> Option<String> {
        let value = table.get(key)?;
        let text = value.get_ref().as_str().map(str::to_owned);
        if text.is_none() {
            self.wrong_type(key, "a text in quotes", value);
        }
        text
    }

    fn declared(&mut self, table: &DeTable<'_>) -> Declared {
        let order = table.get("order").and_then(|value| self.order(value));
        let error_constant =
            table.get("error_constant").and_then(|value| self.number("error_constant".to_owned(), value));
        let zero_stable = table.get("zero_stable").and_then(|value| {
            let flag = value.get_ref().as_bool();
            if flag.is_none() {
                self.wrong_type("zero_stable", "true or false", value);
            }
            flag
        });
        Declared { order, error_constant, zero_stable }
    }

    fn order(&mut self, value: Value<'_, '_>) -> Option<usize> {
        if !value.get_ref().is_integer() {
            self.wrong_type("order", "a whole number", value);
            return None;
        }
        let number = self.number("order".to_owned(), value)?;
        let order = number.to_integer().to_usize().filter(|order| (1..=1_000_000).contains(order));
        if order.is_none() {
            let text = crate::math::shortened(&number.to_string());
            self.report(value.span().start, DefectKind::ImpossibleOrder { text });
        }
        order
    }

    /// Reads an integer or a number in quotes, exactly.
    fn number(&mut self, key: String, value: Value<'_, '_>) -> Option<Rational> {
        let parsed = match value.get_ref() {
            DeValue::Integer(integer) if integer.radix() == 10 => {
                parse_rational(&integer.as_str().replace('_', ""))
            }
            DeValue::Integer(integer) => Ok(Rational::from_integer(num_bigint::BigInt::parse_bytes(
                integer.as_str().as_bytes(),
                integer.radix(),
            )?)),
            DeValue::String(text) => parse_rational(text),
            DeValue::Float(float) => {
                let text = crate::math::shortened(float.as_str());
                match parse_rational(&float.as_str().replace('_', "")) {
                    // Halves and their like are the same in binary: nothing was rounded.
                    Ok(exact) if is_exact(float.as_str(), &exact) => Ok(exact),
                    Ok(_) => {
                        self.report(value.span().start, DefectKind::BareFloat { key, text });
                        return None;
                    }
                    // nan and inf are no numbers in quotes either.
                    Err(error) => Err(error),
                }
            }
            _ => {
                self.wrong_type(&key, "an integer or a number in quotes", value);
                return None;
            }
        };
        parsed.map_err(|error| self.report(value.span().start, DefectKind::Number { key, error })).ok()
    }

    fn list(&mut self, table: &DeTable<'_>, key: &'static str) -> Option<Vec<Rational>> {
        let value = table.get(key)?;
        let Some(entries) = value.get_ref().as_array() else {
            self.wrong_type(key, "a list of numbers, newest sample first", value);
            return None;
        };
        let numbers: Vec<Option<Rational>> =
            entries.iter().enumerate().map(|(j, entry)| self.number(format!("{key}[{j}]"), entry)).collect();
        numbers.into_iter().collect()
    }

    fn coefficients(&mut self, table: &DeTable<'_>, start: usize) -> Option<Coefficients> {
        let first_of = |keys: [&'static str; 3]| keys.into_iter().find(|key| table.contains_key(*key));
        let difference = first_of(["difference", "denominator", "difference"]);
        match (difference, first_of(["alpha", "beta", "gamma"])) {
            (Some(first), Some(second)) => {
                let byte = table.get(second).map_or(start, |value| value.span().start);
                self.report(byte, DefectKind::TwoSpellings { first, second });
                None
            }
            (Some(_), None) => self.difference(table, start),
            (None, Some(_)) => self.general(table, start),
            (None, None) => {
                self.missing(
                    "difference",
                    "write the coefficients as \"difference\" with \"denominator\", or as \"alpha\" with \"beta\"",
                    start,
                );
                None
            }
        }
    }

    fn difference(&mut self, table: &DeTable<'_>, start: usize) -> Option<Coefficients> {
        if !table.contains_key("difference") {
            self.missing("difference", "\"denominator\" is what its entries are divided by", start);
        }
        let numerators = self.list(table, "difference");
        if !table.contains_key("denominator") {
            self.missing(
                "denominator",
                "it is what all entries of \"difference\" are divided by, 1 for none",
                start,
            );
        }
        let denominator =
            table.get("denominator").and_then(|value| self.number("denominator".to_owned(), value));
        Some(Coefficients::Difference { numerators: numerators?, denominator: denominator? })
    }

    fn general(&mut self, table: &DeTable<'_>, start: usize) -> Option<Coefficients> {
        for (key, remedy) in [
            ("alpha", "it holds the weights of the states, newest sample first"),
            ("beta", "it holds the weights of f, newest sample first, as many as \"alpha\" has"),
        ] {
            if !table.contains_key(key) {
                self.missing(key, remedy, start);
            }
        }
        let [alpha, beta, gamma] = ["alpha", "beta", "gamma"].map(|key| self.list(table, key));
        if table.contains_key("gamma") && gamma.is_none() {
            return None;
        }
        Some(Coefficients::General { alpha: alpha?, beta: beta?, gamma })
    }
}

/// The value that a defect of the coefficients is about.
fn coefficient_place(table: &DeTable<'_>, kind: &DefectKind, start: usize) -> usize {
    let key = match kind {
        DefectKind::UnequalLengths { key, .. }
        | DefectKind::TooFewCoefficients { key, .. }
        | DefectKind::TooLong { key, .. }
        | DefectKind::ZeroLeadingCoefficient { key } => key.as_str(),
        DefectKind::ZeroDenominator => "denominator",
        _ => "difference",
    };
    table.get(key).or_else(|| table.get("alpha")).map_or(start, |value| value.span().start)
}

/// Whether a double holds a decimal without rounding it.
fn is_exact(text: &str, exact: &Rational) -> bool {
    let double = text.replace('_', "").parse::<f64>().ok().and_then(rational_from_f64);
    double.as_ref() == Some(exact)
}
