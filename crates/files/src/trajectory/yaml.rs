//! As much of YAML as messages need: documents as trees that know their places, and numbers that every reader takes for
//! numbers.

use std::borrow::Cow;

use granit_parser::{Event, Parser, ScanError, Span};

use super::digits::push_shortest;
use super::error::Problem;

/// A node of a document, and the byte at which it begins.
#[derive(Clone, Debug)]
pub(super) enum Node<'t> {
    Scalar(Cow<'t, str>, usize),
    List(Vec<Node<'t>>, usize),
    Map(Vec<(Cow<'t, str>, Node<'t>)>, usize),
}

/// Returns the documents of a text.
pub(super) fn documents(text: &str) -> Result<Vec<Node<'_>>, Problem> {
    let mut reader = Reader { text, parser: Parser::new_from_str(text) };
    let mut documents = Vec::new();
    while let Some((event, span)) = reader.next()? {
        match event {
            Event::StreamStart | Event::StreamEnd | Event::DocumentStart(..) | Event::DocumentEnd => {}
            event => documents.push(reader.node(event, &span)?),
        }
    }
    Ok(documents)
}

struct Reader<'t, P> {
    text: &'t str,
    parser: P,
}

impl<'t, P: Iterator<Item = Result<(Event<'t>, Span), ScanError>>> Reader<'t, P> {
    fn next(&mut self) -> Result<Option<(Event<'t>, Span)>, Problem> {
        self.parser.next().transpose().map_err(|e| {
            let at = byte_of(self.text, e.marker().line(), e.marker().col());
            Problem::at(at, format!("not YAML: {}", e.info()))
        })
    }

    fn need(&mut self) -> Result<(Event<'t>, Span), Problem> {
        self.next()?.ok_or_else(|| Problem::at(self.text.len(), "the document ends too early"))
    }

    /// The parser bounds how deep documents nest.
    fn node(&mut self, event: Event<'t>, span: &Span) -> Result<Node<'t>, Problem> {
        let at = start(self.text, span);
        match event {
            Event::Scalar(text, ..) => Ok(Node::Scalar(text, at)),
            Event::SequenceStart(..) => {
                let mut items = Vec::new();
                loop {
                    match self.need()? {
                        (Event::SequenceEnd, _) => return Ok(Node::List(items, at)),
                        (event, span) => items.push(self.node(event, &span)?),
                    }
                }
            }
            Event::MappingStart(..) => {
                let mut entries = Vec::new();
                loop {
                    let (event, key_span) = self.need()?;
                    if matches!(event, Event::MappingEnd) {
                        return Ok(Node::Map(entries, at));
                    }
                    let Node::Scalar(key, _) = self.node(event, &key_span)? else {
                        return Err(Problem::at(start(self.text, &key_span), "a key has to be a word"));
                    };
                    let (event, span) = self.need()?;
                    entries.push((key, self.node(event, &span)?));
                }
            }
            _ => Err(Problem::at(at, "aliases are not read here; write the value itself")),
        }
    }
}

fn start(text: &str, span: &Span) -> usize {
    match span.byte_range() {
        Some(range) => range.start,
        None => byte_of(text, span.start.line(), span.start.col()),
    }
}

/// The byte at a line from 1 and a column from 0.
fn byte_of(text: &str, line: usize, column: usize) -> usize {
    let lines = text.split_inclusive('\n').take(line.saturating_sub(1));
    let before: usize = lines.map(str::len).sum();
    let rest = &text[before..];
    before + rest.char_indices().nth(column).map_or(rest.len(), |(byte, _)| byte)
}

impl<'t> Node<'t> {
    pub(super) fn at(&self) -> usize {
        match self {
            Self::Scalar(_, at) | Self::List(_, at) | Self::Map(_, at) => *at,
        }
    }

    pub(super) fn get(&self, key: &str) -> Option<&Node<'t>> {
        let Self::Map(entries, _) = self else { return None };
        entries.iter().find(|(known, _)| known == key).map(|(_, node)| node)
    }

    pub(super) fn items(&self) -> Option<&[Node<'t>]> {
        if let Self::List(items, _) = self { Some(items) } else { None }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.items().is_some_and(<[_]>::is_empty)
    }

    pub(super) fn need(&self, key: &str) -> Result<&Node<'t>, Problem> {
        self.get(key).ok_or_else(|| Problem::at(self.at(), format!("`{key}` is missing here")))
    }

    pub(super) fn list(&self, what: &str) -> Result<&[Node<'t>], Problem> {
        self.items().ok_or_else(|| Problem::at(self.at(), format!("expected {what}")))
    }

    pub(super) fn text(&self) -> Result<&str, Problem> {
        if let Self::Scalar(text, _) = self {
            Ok(text)
        } else {
            Err(Problem::at(self.at(), "expected a name"))
        }
    }

    pub(super) fn number(&self) -> Result<f64, Problem> {
        let text = self.text()?;
        let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
        value.ok_or_else(|| {
            let shown: String = text.chars().take(40).collect();
            Problem::at(self.at(), format!("`{}` is not a finite number", shown.escape_debug()))
        })
    }

    /// Appends the numbers of a list that has so many.
    pub(super) fn numbers(&self, count: usize, into: &mut Vec<f64>) -> Result<(), Problem> {
        let items = self.list("a list of numbers")?;
        if items.len() != count {
            let got = items.len();
            return Err(Problem::at(
                self.at(),
                format!("expected {count} numbers, one per joint, got {got}"),
            ));
        }
        items.iter().try_for_each(|item| {
            into.push(item.number()?);
            Ok(())
        })
    }
}

/// Returns a text in double quotes; what JSON escapes, YAML reads.
pub(super) fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// Appends `[a, b, c]`.
pub(super) fn push_list(text: &mut String, items: impl Iterator<Item = String>) {
    text.push('[');
    for (index, item) in items.enumerate() {
        text.push_str(if index == 0 { "" } else { ", " });
        text.push_str(&item);
    }
    text.push(']');
}

/// Appends `[1.0, 2.5e-07]`: the shortest decimals that read back as the same doubles.
pub(super) fn push_numbers(text: &mut String, values: impl Iterator<Item = f64>) {
    text.push('[');
    for (index, value) in values.enumerate() {
        text.push_str(if index == 0 { "" } else { ", " });
        push_shortest(text, value);
    }
    text.push(']');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_a_point_and_a_signed_exponent() {
        let mut text = String::new();
        push_numbers(&mut text, [1.0, -0.0, 1e-7, 2.5e22, 0.1].into_iter());
        assert_eq!(text, "[1.0, -0.0, 1.0e-7, 2.5e+22, 0.1]");
    }

    #[test]
    fn places_are_bytes() {
        let text = "a: \u{e9}\nb: [1, x]\n";
        let documents = documents(text).unwrap();
        let list = documents[0].get("b").unwrap().items().unwrap();
        assert_eq!(list[1].at(), text.find('x').unwrap());
        assert!(list[1].number().is_err());
        assert!(super::documents("a: [1").is_err());
        assert!(super::documents("a: *b").is_err());
    }
}
