//! The part of YAML that programs write messages in, read at the speed of their numbers.
//!
//! Whatever is not certain (anchors, tags, comments within values, text of several lines, escapes) is left to the parser of
//! all of YAML, which also finds the words for what is wrong.

use std::borrow::Cow;

use super::node::Node;
use super::points::{POINTS, Points};

/// How deep lists and maps may stand in each other here.
const DEEPEST: usize = 32;

/// Returns the document of a text that begins at a byte; nothing where the text has none, or something that is not certain.
pub(super) fn document(text: &str, base: usize) -> Option<Node<'_>> {
    let mut quick = Quick { text, base, at: 0, depth: 0 };
    let indent = quick.next_line()?;
    let node = match quick.byte()? {
        b'[' | b'{' => {
            let node = quick.inline()?;
            quick.end_of_line()?;
            node
        }
        _ => quick.block(indent)?,
    };
    quick.next_line().is_none().then_some(())?;
    (quick.at == text.len()).then_some(node)
}

/// Returns the points of a part of a text that begins with one of them, as those that go on behind others, and what stands behind
/// the last; nothing where something is not certain.
pub(super) fn points<'t>(text: &'t str, others: &Points) -> Option<(Box<Points>, &'t str)> {
    let mut quick = Quick { text, base: 0, at: 0, depth: 0 };
    let indent = quick.next_line()?;
    quick.is_item().then_some(())?;
    match quick.items(indent, Items::Points(others.following()))? {
        Node::Points(points, _) => Some((points, &text[quick.at..])),
        _ => None,
    }
}

struct Quick<'t> {
    text: &'t str,
    base: usize,
    at: usize,
    depth: usize,
}

/// A list while it is read: points take no more room than their numbers.
enum Items<'t> {
    Plain(Vec<Node<'t>>),
    Points(Points),
}

impl<'t> Items<'t> {
    fn of(key: Option<&str>, at: usize) -> Self {
        match key {
            Some(POINTS) => Self::Points(Points::new(at)),
            _ => Self::Plain(Vec::new()),
        }
    }

    fn push(&mut self, item: Node<'t>) -> Option<()> {
        match self {
            Self::Plain(items) => items.push(item),
            Self::Points(points) => points.push(&item).ok()?,
        }
        Some(())
    }

    fn finish(self, at: usize) -> Node<'t> {
        match self {
            Self::Plain(items) => Node::List(items, at),
            Self::Points(points) => Node::Points(Box::new(points), at),
        }
    }
}

impl<'t> Quick<'t> {
    fn byte(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn place(&self) -> usize {
        self.base + self.at
    }

    fn skip_blanks(&mut self) {
        while self.byte() == Some(b' ') {
            self.at += 1;
        }
    }

    /// Goes to the first character of the next line that has something in it, and returns how far it stands in; nothing at the
    /// end of the text, or where a line is not certain.
    fn next_line(&mut self) -> Option<usize> {
        loop {
            let start = self.at;
            self.skip_blanks();
            match self.byte()? {
                b'\n' => self.at += 1,
                b'\r' if self.text.as_bytes().get(self.at + 1) == Some(&b'\n') => self.at += 2,
                b'#' => self.at += self.text[self.at..].find('\n').unwrap_or(self.text.len() - self.at),
                b'\t' => return None,
                _ => {
                    let is_start = start == 0 || self.text.as_bytes()[start - 1] == b'\n';
                    return is_start.then_some(self.at - start);
                }
            }
        }
    }

    /// Looks at the next line without going there.
    fn ahead(&mut self) -> Option<usize> {
        let at = self.at;
        let indent = self.next_line();
        self.at = at;
        indent
    }

    /// Goes over the rest of a line, which has to be empty or a comment.
    fn end_of_line(&mut self) -> Option<()> {
        let before = self.at;
        self.skip_blanks();
        match self.byte() {
            None => Some(()),
            Some(b'\n') => {
                self.at += 1;
                Some(())
            }
            Some(b'\r') => {
                self.at += 1;
                (self.byte() == Some(b'\n')).then(|| self.at += 1)
            }
            Some(b'#') if self.at > before => {
                self.at += self.text[self.at..].find('\n').map_or(self.text.len() - self.at, |line| line + 1);
                Some(())
            }
            Some(_) => None,
        }
    }

    fn is_item(&self) -> bool {
        let rest = &self.text.as_bytes()[self.at..];
        rest.first() == Some(&b'-') && matches!(rest.get(1), None | Some(b' ' | b'\n' | b'\r'))
    }

    /// A list or a map whose first entry begins here, at a column.
    fn block(&mut self, column: usize) -> Option<Node<'t>> {
        if self.is_item() { self.list(column, None) } else { self.map(column) }
    }

    fn deeper(&mut self) -> Option<()> {
        self.depth += 1;
        (self.depth < DEEPEST).then_some(())
    }

    fn list(&mut self, column: usize, key: Option<&str>) -> Option<Node<'t>> {
        let items = Items::of(key, self.place());
        self.items(column, items)
    }

    fn items(&mut self, column: usize, mut items: Items<'t>) -> Option<Node<'t>> {
        self.deeper()?;
        let at = self.place();
        loop {
            let start = self.at;
            self.at += 1;
            self.skip_blanks();
            let item = match self.byte() {
                None | Some(b'\n' | b'\r') => self.below(column)?,
                Some(b'-') if self.is_item() => return None,
                Some(_) if self.begins_entry() => self.map(column + self.at - start)?,
                Some(_) => {
                    let item = self.inline()?;
                    self.end_of_line()?;
                    item
                }
            };
            items.push(item)?;
            match self.ahead() {
                Some(indent) if indent == column => {
                    self.next_line()?;
                    if !self.is_item() {
                        break;
                    }
                }
                Some(indent) if indent > column => return None,
                _ => break,
            }
        }
        // A map goes on where a list stands as far in as its key: go back to the start of the line.
        self.back_to_line();
        self.depth -= 1;
        Some(items.finish(at))
    }

    fn back_to_line(&mut self) {
        while self.at > 0 && self.text.as_bytes()[self.at - 1] == b' ' {
            self.at -= 1;
        }
    }

    /// Whether a key stands here.
    fn begins_entry(&self) -> bool {
        let mut ahead = Quick { text: self.text, base: self.base, at: self.at, depth: 0 };
        ahead.key().is_some()
    }

    fn key(&mut self) -> Option<Cow<'t, str>> {
        let key = match self.byte()? {
            b'"' | b'\'' => self.quoted()?,
            _ => {
                let start = self.at;
                let is_word = |byte: u8| byte.is_ascii_alphanumeric() || b"_./-".contains(&byte);
                while self.byte().is_some_and(is_word) {
                    self.at += 1;
                }
                if self.at == start || self.text.as_bytes()[start] == b'-' {
                    return None;
                }
                &self.text[start..self.at]
            }
        };
        if self.byte() != Some(b':') {
            return None;
        }
        self.at += 1;
        matches!(self.byte(), None | Some(b' ' | b'\n' | b'\r')).then_some(Cow::Borrowed(key))
    }

    fn map(&mut self, column: usize) -> Option<Node<'t>> {
        self.deeper()?;
        let at = self.place();
        let mut entries = Vec::with_capacity(4);
        loop {
            let key = self.key()?;
            self.skip_blanks();
            let value = match self.byte() {
                None | Some(b'\n' | b'\r' | b'#') => {
                    self.end_of_line()?;
                    self.value_below(column, &key)?
                }
                Some(b'[') if key == POINTS => {
                    let value = self.flow_list(Some(POINTS))?;
                    self.end_of_line()?;
                    value
                }
                Some(_) => {
                    let value = self.inline()?;
                    self.end_of_line()?;
                    value
                }
            };
            entries.push((key, value));
            match self.ahead() {
                Some(indent) if indent == column => self.next_line()?,
                Some(indent) if indent > column => return None,
                _ => break,
            };
            if self.is_item() {
                return None;
            }
        }
        self.depth -= 1;
        Some(Node::Map(entries, at))
    }

    /// What stands below a key: a list as far in or farther, a map farther in, or nothing.
    fn value_below(&mut self, column: usize, key: &str) -> Option<Node<'t>> {
        let nothing = Node::Scalar(Cow::Borrowed(""), self.place());
        let Some(indent) = self.ahead() else { return Some(nothing) };
        if indent < column {
            return Some(nothing);
        }
        let at = self.at;
        self.next_line()?;
        if self.is_item() {
            return self.list(indent, Some(key));
        }
        if indent > column {
            return if self.begins_entry() { self.map(indent) } else { None };
        }
        self.at = at;
        Some(nothing)
    }

    /// What stands below the dash of an item.
    fn below(&mut self, column: usize) -> Option<Node<'t>> {
        self.end_of_line()?;
        let indent = self.ahead()?;
        if indent <= column {
            return None;
        }
        self.next_line()?;
        if self.is_item() || self.begins_entry() { self.block(indent) } else { None }
    }

    /// A value within a line, or within brackets.
    fn inline(&mut self) -> Option<Node<'t>> {
        let at = self.place();
        match self.byte()? {
            b'[' => self.flow_list(None),
            b'{' => self.flow_map(),
            b'"' | b'\'' => self.quoted().map(|text| Node::Scalar(Cow::Borrowed(text), at)),
            b'&' | b'*' | b'!' | b'|' | b'>' | b'%' | b'@' | b'`' | b'?' | b':' | b',' | b'#' => None,
            _ => {
                let rest = &self.text[self.at..];
                let line = &rest[..rest.find(['\n', '\r']).unwrap_or(rest.len())];
                let text = line[..line.find(" #").unwrap_or(line.len())].trim_end_matches(' ');
                if text.contains(": ") || text.ends_with(':') || text.contains('\t') {
                    return None;
                }
                self.at += text.len();
                Some(Node::Scalar(Cow::Borrowed(text), at))
            }
        }
    }

    /// Text in quotes on one line, without escapes.
    fn quoted(&mut self) -> Option<&'t str> {
        let quote = self.byte()? as char;
        let inner = &self.text[self.at + 1..];
        let length = inner.find([quote, '\n', '\\'])?;
        let text = &inner[..length];
        let rest = &inner[length..];
        if !rest.starts_with(quote) || rest[1..].starts_with(quote) {
            return None;
        }
        self.at += length + 2;
        Some(text)
    }

    fn skip_space(&mut self) {
        while matches!(self.byte(), Some(b' ' | b'\n' | b'\r' | b'\t')) {
            self.at += 1;
        }
    }

    fn flow_list(&mut self, key: Option<&str>) -> Option<Node<'t>> {
        self.deeper()?;
        let at = self.place();
        let mut items = Items::of(key, at);
        self.at += 1;
        loop {
            self.skip_space();
            if self.byte()? == b']' {
                break;
            }
            items.push(self.flow_value(None)?)?;
            self.skip_space();
            match self.byte()? {
                b',' => self.at += 1,
                b']' => break,
                _ => return None,
            }
        }
        self.at += 1;
        self.depth -= 1;
        Some(items.finish(at))
    }

    fn flow_map(&mut self) -> Option<Node<'t>> {
        self.deeper()?;
        let at = self.place();
        let mut entries = Vec::with_capacity(4);
        self.at += 1;
        loop {
            self.skip_space();
            if self.byte()? == b'}' {
                break;
            }
            let Node::Scalar(key, _) = self.flow_value(None)? else { return None };
            self.skip_space();
            if self.byte()? != b':' {
                return None;
            }
            // Without quotes around the key, a blank has to follow: `a:1` is a word.
            let is_quoted = matches!(self.text.as_bytes()[self.at - 1], b'"' | b'\'');
            self.at += 1;
            (is_quoted || matches!(self.byte()?, b' ' | b'\n')).then_some(())?;
            self.skip_space();
            let value = self.flow_value(Some(&key))?;
            entries.push((key, value));
            self.skip_space();
            match self.byte()? {
                b',' => self.at += 1,
                b'}' => break,
                _ => return None,
            }
        }
        self.at += 1;
        self.depth -= 1;
        Some(Node::Map(entries, at))
    }

    fn flow_value(&mut self, key: Option<&str>) -> Option<Node<'t>> {
        let at = self.place();
        match self.byte()? {
            b'[' => self.flow_list(key),
            b'{' => self.flow_map(),
            b'"' | b'\'' => self.quoted().map(|text| Node::Scalar(Cow::Borrowed(text), at)),
            _ => {
                let start = self.at;
                let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"_./+-".contains(&byte);
                while self.byte().is_some_and(is_plain) {
                    self.at += 1;
                }
                let text = &self.text[start..self.at];
                (!text.is_empty()).then_some(Node::Scalar(Cow::Borrowed(text), at))
            }
        }
    }
}
