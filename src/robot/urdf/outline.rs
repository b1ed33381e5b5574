//! A first look at the markup: depth, sizes, DTD, xacro and where a torn text ends, before any tree is built.
//!
//! The XML parser reports neither where a DTD stands nor which tag is open at the end, and it would build a tree
//! of two million nested tags before anyone could object. This pass runs in time and memory bounded by the caps.

use std::borrow::Cow;
use std::collections::HashSet;
use std::ops::Range;

use super::MAX_DEPTH;

/// Most elements in a file.
const MAX_ELEMENTS: usize = 2_000_000;
/// Most attributes in a file.
const MAX_ATTRIBUTES: usize = 6_000_000;
/// Most attributes of one element (the parser compares them pairwise).
const MAX_ATTRIBUTES_OF_ONE: usize = 256;
/// Most namespace declarations in a file (the parser copies them down the tree).
const MAX_NAMESPACES: usize = 1_000;

/// The elements of a joint that kinematics reads.
const JOINT_PARTS: [&str; 6] = ["origin", "parent", "child", "axis", "limit", "mimic"];
/// What xacro never leaves in a robot that it expanded.
const UNEXPANDED: [&str; 5] =
    ["xacro:include", "xacro:macro", "xacro:if", "xacro:unless", "xacro:insert_block"];

/// A start tag: where it stands and its name.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tag<'a> {
    pub(super) offset: usize,
    pub(super) name: &'a str,
}

/// Why the look ended before the end of the text.
#[derive(Debug, Clone, Copy)]
pub(super) enum Stop<'a> {
    /// A `<!DOCTYPE`.
    Dtd(usize),
    /// Deeper than the cap.
    TooDeep(Tag<'a>),
    /// More of something than the cap.
    TooMany { offset: usize, what: &'static str, most: usize },
    /// The text ends inside this piece of markup.
    Torn { offset: usize, inside: &'static str },
    /// An end tag that does not fit the open one.
    Mismatch { open: Tag<'a>, close: Tag<'a> },
    /// An end tag where none is open.
    NothingOpen(Tag<'a>),
    /// Text or a second element after the root element.
    AfterRoot(usize),
}

/// What the look found.
#[derive(Debug, Default)]
pub(super) struct Outline<'a> {
    /// Tags still open at the end.
    pub(super) open: Vec<Tag<'a>>,
    pub(super) stop: Option<Stop<'a>>,
    /// Where `${`, `$(arg ` or a `xacro:` element first stands in a part that kinematics reads.
    pub(super) xacro: Option<usize>,
    /// Where such things stand in parts that kinematics does not read.
    pub(super) leftovers: Vec<usize>,
    /// Bodies of comments that hold `--`, which XML forbids and URDF files have.
    pub(super) dashed_comments: Vec<Range<usize>>,
    prefixes: Vec<(usize, &'a str)>,
    declared: HashSet<&'a str>,
    elements: usize,
    attributes: usize,
    namespaces: usize,
    root_closed: bool,
}

/// Looks over the text.
pub(super) fn outline(text: &str) -> Outline<'_> {
    let mut outline = Outline::default();
    outline.stop = outline.scan(text).err();
    outline
}

impl<'a> Outline<'a> {
    fn scan(&mut self, text: &'a str) -> Result<(), Stop<'a>> {
        let mut at = 0;
        while let Some(found) = text[at..].find('<') {
            let start = at + found;
            self.characters(&text[at..start], at)?;
            at = self.markup(text, start)?;
        }
        self.characters(&text[at..], at)
    }

    fn characters(&mut self, characters: &str, offset: usize) -> Result<(), Stop<'a>> {
        if self.root_closed
            && let Some(found) = characters.find(|c: char| !c.is_ascii_whitespace())
        {
            return Err(Stop::AfterRoot(offset + found));
        }
        // No part of URDF is written as characters.
        self.look_for_xacro(characters, offset, None);
        Ok(())
    }

    /// Looks for xacro in characters, or in an attribute of an element of that name.
    fn look_for_xacro(&mut self, characters: &str, offset: usize, element: Option<&str>) {
        if let Some(found) = ["${", "$(arg "].iter().filter_map(|mark| characters.find(mark)).min() {
            let is_read = element.is_some_and(|name| self.is_read(name));
            self.note_xacro(offset + found, is_read);
        }
    }

    fn note_xacro(&mut self, offset: usize, is_read: bool) {
        if is_read {
            self.xacro.get_or_insert(offset);
        } else {
            self.leftovers.push(offset);
        }
    }

    /// Whether kinematics reads the attributes of an element of that name that stands in those which are open, or would
    /// read what xacro makes of it: a `xacro:` element in a joint may stand for its origin; includes, macros and conditions
    /// in a robot say that nothing of it was expanded.
    fn is_read(&self, name: &str) -> bool {
        let path: Vec<&str> = self.open.iter().skip(1).map(|tag| tag.name).chain([name]).collect();
        match path[..] {
            _ if self.open.is_empty() => true,
            [] | ["link" | "joint"] => true,
            ["joint", part] => JOINT_PARTS.contains(&part) || part.starts_with("xacro:"),
            [first, ..] => UNEXPANDED.contains(&first),
        }
    }

    /// Reads one piece of markup that begins at `start` and returns where it ends.
    fn markup(&mut self, text: &'a str, start: usize) -> Result<usize, Stop<'a>> {
        let rest = &text[start..];
        if rest.starts_with("<!--") {
            let end = end_of(text, start, 4, "-->", "a comment")?;
            let body = start + 4..(end - 3).max(start + 4);
            if text[body.clone()].contains("--") || text[body.clone()].ends_with('-') {
                self.dashed_comments.push(body);
            }
            Ok(end)
        } else if rest.starts_with("<![CDATA[") {
            let end = end_of(text, start, 9, "]]>", "a CDATA section")?;
            self.characters(&text[start + 9..end - 3], start + 9)?;
            Ok(end)
        } else if rest.starts_with("<?") {
            end_of(text, start, 2, "?>", "a processing instruction")
        } else if rest.starts_with("<!") {
            Err(Stop::Dtd(start))
        } else if rest.starts_with("</") {
            self.end_tag(text, start)
        } else {
            self.start_tag(text, start)
        }
    }

    fn end_tag(&mut self, text: &'a str, start: usize) -> Result<usize, Stop<'a>> {
        let end = end_of(text, start, 2, ">", "an end tag")?;
        let close = Tag { offset: start, name: text[start + 2..end - 1].trim_ascii_end() };
        self.prefix_of(close.name, start + 2);
        match self.open.pop() {
            None => return Err(Stop::NothingOpen(close)),
            Some(open) if open.name != close.name => return Err(Stop::Mismatch { open, close }),
            Some(_) => {}
        }
        self.root_closed = self.open.is_empty();
        Ok(end)
    }

    fn start_tag(&mut self, text: &'a str, start: usize) -> Result<usize, Stop<'a>> {
        if self.root_closed {
            return Err(Stop::AfterRoot(start));
        }
        let name = text[start + 1..].split(|c: char| c.is_ascii_whitespace() || c == '/' || c == '>').next();
        let tag = Tag { offset: start, name: name.unwrap_or_default() };
        if tag.name.starts_with("xacro:") {
            self.note_xacro(start, self.is_read(tag.name));
        }
        self.prefix_of(tag.name, start + 1);
        self.elements += 1;
        within(self.elements, MAX_ELEMENTS, "elements", start)?;
        let end = self.attributes_of(text, tag)?;
        if !text[..end].ends_with("/>") {
            if self.open.len() == MAX_DEPTH {
                return Err(Stop::TooDeep(tag));
            }
            self.open.push(tag);
        } else if self.open.is_empty() {
            self.root_closed = true;
        }
        Ok(end)
    }

    /// Walks from quote to quote and returns where the tag ends.
    fn attributes_of(&mut self, text: &'a str, tag: Tag<'a>) -> Result<usize, Stop<'a>> {
        let (start, from) = (tag.offset, tag.offset + 1 + tag.name.len());
        let torn = Stop::Torn { offset: start, inside: "a tag" };
        let mut at = from;
        for count in 1.. {
            let found = at + text[at..].find(['"', '\'', '>']).ok_or(torn)?;
            if text.as_bytes()[found] == b'>' {
                return Ok(found + 1);
            }
            within(count, MAX_ATTRIBUTES_OF_ONE, "attributes in one element", start)?;
            self.attributes += 1;
            within(self.attributes, MAX_ATTRIBUTES, "attributes", start)?;
            let quote = char::from(text.as_bytes()[found]);
            let value = found + 1;
            let close = value + text[value..].find(quote).ok_or(torn)?;
            self.look_for_xacro(&text[value..close], value, Some(tag.name));
            self.attribute_name(text, at..found, start)?;
            at = close + 1;
        }
        Ok(at)
    }

    fn attribute_name(&mut self, text: &'a str, range: Range<usize>, tag: usize) -> Result<(), Stop<'a>> {
        let raw = &text[range.clone()];
        let offset = range.start + (raw.len() - raw.trim_ascii_start().len());
        let name = raw.trim_ascii().trim_end_matches('=').trim_ascii_end();
        if name == "xmlns" || name.starts_with("xmlns:") {
            self.namespaces += 1;
            within(self.namespaces, MAX_NAMESPACES, "namespace declarations", tag)?;
            self.declared.insert(name.strip_prefix("xmlns:").unwrap_or_default());
        } else {
            self.prefix_of(name, offset);
        }
        Ok(())
    }

    fn prefix_of(&mut self, name: &'a str, offset: usize) {
        if let Some((prefix, _)) = name.split_once(':')
            && prefix != "xml"
        {
            self.prefixes.push((offset + prefix.len(), prefix));
        }
    }

    /// Prefixes that are used and nowhere declared, each with the place of its first colon.
    pub(super) fn undeclared(&self) -> Vec<(usize, &'a str)> {
        let mut seen = HashSet::new();
        let missing = self.prefixes.iter().filter(|(_, prefix)| !self.declared.contains(prefix));
        missing.filter(|(_, prefix)| seen.insert(*prefix)).copied().collect()
    }

    /// Returns the text with two habits of real files mended that an XML parser refuses and URDF's own reader
    /// does not: `--` in comments, and prefixes that nobody declares (`a:b` becomes `a_b`). Every byte keeps
    /// its place.
    pub(super) fn mended(&self, text: &'a str) -> Cow<'a, str> {
        let undeclared = self.prefixes.iter().filter(|(_, prefix)| !self.declared.contains(prefix));
        let colons: Vec<usize> = undeclared.map(|&(colon, _)| colon).collect();
        if self.dashed_comments.is_empty() && colons.is_empty() {
            return Cow::Borrowed(text);
        }
        let mut bytes = text.as_bytes().to_vec();
        for body in &self.dashed_comments {
            bytes[body.clone()].iter_mut().filter(|byte| **byte != b'\n').for_each(|byte| *byte = b' ');
        }
        for colon in colons {
            bytes[colon] = b'_';
        }
        String::from_utf8(bytes).map_or(Cow::Borrowed(text), Cow::Owned)
    }
}

fn end_of<'a>(
    text: &'a str,
    start: usize,
    skip: usize,
    end: &str,
    inside: &'static str,
) -> Result<usize, Stop<'a>> {
    let found = text[start + skip..].find(end).ok_or(Stop::Torn { offset: start, inside })?;
    Ok(start + skip + found + end.len())
}

fn within<'a>(count: usize, most: usize, what: &'static str, offset: usize) -> Result<(), Stop<'a>> {
    if count > most { Err(Stop::TooMany { offset, what, most }) } else { Ok(()) }
}
