//! As much of YAML as messages need: documents, and numbers that every reader takes for numbers.

use granit_parser::{Event, Parser, ScanError, Span};

use super::digits::push_shortest;
use super::error::Problem;
use super::node::Node;
use super::points::{POINTS, Points};
use super::quick_yaml;

/// What takes documents, one after another.
pub(super) type Sink<'s, 't> = dyn FnMut(Node<'t>) -> Result<(), Problem> + 's;

/// Hands the documents of a text on, each as soon as it is read.
pub(super) fn documents<'t>(text: &'t str, sink: &mut Sink<'_, 't>) -> Result<(), Problem> {
    // Directives and anchors belong to documents beside them or to parts that are far apart: then the text is read as a whole.
    if text.starts_with('%') || text.contains("\n%") {
        return parsed(text, 0, sink);
    }
    let mut start = 0;
    while start < text.len() {
        let (end, next) = document_end(text, start);
        document(&text[start..end], start, sink)?;
        start = next;
    }
    Ok(())
}

/// Hands the document of a part of a text on, if there is one; the part begins at a byte.
pub(super) fn document<'t>(part: &'t str, base: usize, sink: &mut Sink<'_, 't>) -> Result<(), Problem> {
    match quick_yaml::document(part, base) {
        Some(node) => sink(node),
        None => parsed(part, base, sink),
    }
}

/// Where the document that begins there ends, and where the next one begins: documents are separated by lines of `---`, and
/// nothing else may begin a line so.
fn document_end(text: &str, start: usize) -> (usize, usize) {
    let mut line = start;
    loop {
        let rest = &text[line..];
        if rest.starts_with("---") || rest.starts_with("...") {
            return (line, line + 3);
        }
        match rest.find("\n---").into_iter().chain(rest.find("\n...")).min() {
            Some(offset) => line += offset + 1,
            None => return (text.len(), text.len()),
        }
    }
}

/// As [`documents`], by a parser of all of YAML, of a part of a text that begins at a byte.
fn parsed<'t>(text: &'t str, base: usize, sink: &mut Sink<'_, 't>) -> Result<(), Problem> {
    let mut reader = Reader { text, base, parser: Parser::new_from_str(text) };
    while let Some((event, span)) = reader.next()? {
        match event {
            Event::StreamStart | Event::StreamEnd | Event::DocumentStart(..) | Event::DocumentEnd => {}
            event => sink(reader.node(event, &span)?)?,
        }
    }
    Ok(())
}

struct Reader<'t, P> {
    text: &'t str,
    base: usize,
    parser: P,
}

impl<'t, P: Iterator<Item = Result<(Event<'t>, Span), ScanError>>> Reader<'t, P> {
    fn next(&mut self) -> Result<Option<(Event<'t>, Span)>, Problem> {
        self.parser.next().transpose().map_err(|e| {
            let at = self.base + byte_of(self.text, e.marker().line(), e.marker().col());
            Problem::at(at, format!("not YAML: {}", e.info()))
        })
    }

    fn need(&mut self) -> Result<(Event<'t>, Span), Problem> {
        self.next()?.ok_or_else(|| Problem::at(self.base + self.text.len(), "the document ends too early"))
    }

    /// The parser bounds how deep documents nest.
    fn node(&mut self, event: Event<'t>, span: &Span) -> Result<Node<'t>, Problem> {
        let at = self.start(span);
        match event {
            Event::Scalar(text, ..) => Ok(Node::Scalar(text, at)),
            Event::SequenceStart(..) => self.list(at, None),
            Event::MappingStart(..) => {
                let mut entries = Vec::new();
                loop {
                    let (event, key_span) = self.need()?;
                    if matches!(event, Event::MappingEnd) {
                        return Ok(Node::Map(entries, at));
                    }
                    let Node::Scalar(key, _) = self.node(event, &key_span)? else {
                        return Err(Problem::at(self.start(&key_span), "a key has to be a word"));
                    };
                    let value = match self.need()? {
                        (Event::SequenceStart(..), span) if key == POINTS => {
                            self.list(self.start(&span), Some(Points::new(self.start(&span))))?
                        }
                        (event, span) => self.node(event, &span)?,
                    };
                    entries.push((key, value));
                }
            }
            _ => Err(Problem::at(at, "aliases are not read here; write the value itself")),
        }
    }

    /// A list, or points where all items are maps.
    fn list(&mut self, at: usize, mut points: Option<Points>) -> Result<Node<'t>, Problem> {
        let mut items = Vec::new();
        loop {
            let (event, span) = self.need()?;
            if matches!(event, Event::SequenceEnd) {
                break;
            }
            let item = self.node(event, &span)?;
            match &mut points {
                Some(points) if items.is_empty() && matches!(item, Node::Map(..)) => points.push(&item)?,
                _ => items.push(item),
            }
        }
        Ok(match points {
            Some(points) if items.is_empty() => Node::Points(Box::new(points), at),
            _ => Node::List(items, at),
        })
    }

    fn start(&self, span: &Span) -> usize {
        self.base
            + match span.byte_range() {
                Some(range) => range.start,
                None => byte_of(self.text, span.start.line(), span.start.col()),
            }
    }
}

/// The byte at a line from 1 and a column from 0.
fn byte_of(text: &str, line: usize, column: usize) -> usize {
    let lines = text.split_inclusive('\n').take(line.saturating_sub(1));
    let before: usize = lines.map(str::len).sum();
    let rest = &text[before..];
    before + rest.char_indices().nth(column).map_or(rest.len(), |(byte, _)| byte)
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

    fn all(text: &str) -> Result<Vec<Node<'_>>, Problem> {
        let mut all = Vec::new();
        documents(text, &mut |node| {
            all.push(node);
            Ok(())
        })?;
        Ok(all)
    }

    #[test]
    fn numbers_have_a_point_and_a_signed_exponent() {
        let mut text = String::new();
        push_numbers(&mut text, [1.0, -0.0, 1e-7, 2.5e22, 0.1].into_iter());
        assert_eq!(text, "[1.0, -0.0, 1.0e-7, 2.5e+22, 0.1]");
    }

    #[test]
    fn places_are_bytes() {
        for text in ["a: \u{e9}\nb: [1, x]\n", "a: &m \u{e9}\nb: [1, x]\n", "c: 1\n---\na: 1\nb: [1, x]\n"] {
            let documents = all(text).unwrap();
            let list = documents[documents.len() - 1].get("b").unwrap().items().unwrap();
            assert_eq!(list[1].at(), text.find('x').unwrap());
            assert!(list[1].number().is_err());
        }
        assert!(all("a: [1").is_err());
        assert!(all("a: *b").is_err());
        assert_eq!(all("a: 1\n---\na: 2\n...\n---\n").unwrap().len(), 2);
    }
}
