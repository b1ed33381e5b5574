//! One file of a crate: what it declares, imports and names.

use std::collections::BTreeSet;

use super::tokens::{Token, tokens};

/// A name that a `use` brings into a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Import {
    /// The path as it is written.
    pub(super) path: Vec<String>,
    /// What the file calls it; `*` for everything below the path.
    pub(super) name: String,
    /// Whether others get it from here: `pub use`, with or without a restriction.
    pub(super) is_passed_on: bool,
}

/// What the layering needs to know of a file. Nothing of it comes from comments, strings or tests.
#[derive(Debug, Default)]
pub(super) struct Module {
    /// The modules that it declares, each with a file of its own.
    pub(super) children: BTreeSet<String>,
    /// The modules that it declares for tests alone.
    pub(super) tests: BTreeSet<String>,
    /// Everything that `use` brings in.
    pub(super) imports: Vec<Import>,
    /// The items that are defined at its top.
    pub(super) definitions: BTreeSet<String>,
    /// The macros that it gives to the root of its crate.
    pub(super) exported_macros: BTreeSet<String>,
    /// The paths of two or more words in its code.
    pub(super) paths: BTreeSet<Vec<String>>,
    /// The words in its code.
    pub(super) words: BTreeSet<String>,
    /// Modules that are written inside the file, which this reader can not follow.
    pub(super) inline: Vec<String>,
}

impl Module {
    /// Reads the text of a file.
    pub(super) fn read(text: &str) -> Self {
        let mut module = Self::default();
        let tokens = tokens(text);
        let mut reader = Reader { tokens: &tokens, at: 0 };
        let mut depth = 0_usize;
        let mut is_exported = false;
        while let Some(token) = reader.next() {
            match token {
                Token::Mark('{') => depth += 1,
                Token::Mark('}') => depth = depth.saturating_sub(1),
                Token::Mark('#') => match reader.attribute() {
                    Attribute::Test => module.tests.extend(reader.skip_item()),
                    Attribute::MacroExport => is_exported = true,
                    // What it names counts: an error's message may call a function.
                    Attribute::Other => {}
                },
                Token::Mark(_) | Token::Colons => {}
                Token::Word(word) => {
                    module.word(word, depth, &mut reader);
                    if word == "macro_rules" {
                        let name = reader.tokens.get(reader.at + 1).and_then(Token::word);
                        let names = name.into_iter().map(str::to_owned);
                        module.definitions.extend(names.clone());
                        module.exported_macros.extend(names.filter(|_| is_exported));
                        is_exported = false;
                    }
                }
            }
        }
        module
    }

    /// Whether the file only declares modules and passes names on.
    pub(super) fn is_index(&self) -> bool {
        self.definitions.is_empty() && !self.words.contains("impl")
    }

    fn word(&mut self, word: &str, depth: usize, reader: &mut Reader<'_>) {
        match word {
            "pub" => reader.skip_restriction(),
            "use" if reader.peek() != Some(&Token::Mark('<')) => {
                let is_passed_on = reader.is_public();
                self.imports.extend(reader.imports(is_passed_on));
            }
            "mod" => {
                let name = reader.next().and_then(Token::word).unwrap_or_default().to_owned();
                if reader.peek() == Some(&Token::Mark(';')) {
                    self.children.insert(name);
                } else {
                    self.inline.push(name);
                }
            }
            "fn" | "struct" | "enum" | "trait" | "type" | "const" | "static" | "union" if depth == 0 => {
                self.definitions.extend(reader.peek().and_then(Token::word).map(str::to_owned));
            }
            _ => {
                let path = reader.path(word);
                self.words.insert(word.to_owned());
                if path.len() > 1 {
                    self.paths.insert(path);
                }
            }
        }
    }
}

/// What an attribute says of the item after it.
enum Attribute {
    /// `#[cfg(test)]`, also together with other conditions.
    Test,
    /// `#[macro_export]`
    MacroExport,
    Other,
}

/// A place among tokens.
struct Reader<'a> {
    tokens: &'a [Token],
    at: usize,
}

impl<'a> Reader<'a> {
    fn next(&mut self) -> Option<&'a Token> {
        self.at += 1;
        self.tokens.get(self.at - 1)
    }

    fn peek(&self) -> Option<&'a Token> {
        self.tokens.get(self.at)
    }

    /// Takes the next token where it is that one.
    fn take(&mut self, token: &Token) -> bool {
        let is_next = self.peek() == Some(token);
        self.at += usize::from(is_next);
        is_next
    }

    /// Says what the attribute after a `#` is; goes past it only where its words matter no more.
    fn attribute(&mut self) -> Attribute {
        let words: Vec<&str> = self.tokens[self.at..]
            .iter()
            .take_while(|token| **token != Token::Mark(']'))
            .filter_map(Token::word)
            .collect();
        match *words {
            ["cfg", "test"] | ["cfg", "all", "test", ..] => {
                self.skip_attribute();
                Attribute::Test
            }
            ["macro_export"] => {
                self.skip_attribute();
                Attribute::MacroExport
            }
            _ => Attribute::Other,
        }
    }

    fn skip_attribute(&mut self) {
        while self.next().is_some_and(|token| *token != Token::Mark(']')) {}
    }

    /// Skips an item to its `;` or the end of its braces; returns its name where it is a module with its own file.
    fn skip_item(&mut self) -> Option<String> {
        let mut depth = 0_usize;
        let mut name = None;
        while let Some(token) = self.next() {
            match token {
                Token::Mark('(' | '[' | '{') => depth += 1,
                Token::Mark('}') if depth == 1 => return None,
                Token::Mark(')' | ']' | '}') => depth = depth.saturating_sub(1),
                Token::Mark(';') if depth == 0 => return name,
                Token::Word(word) if word == "mod" => name = self.peek()?.word().map(str::to_owned),
                _ => {}
            }
        }
        None
    }

    /// Skips the restriction of a `pub(...)`, which is no import.
    fn skip_restriction(&mut self) {
        let inside = self.tokens.get(self.at + 1).and_then(Token::word);
        if self.peek() == Some(&Token::Mark('(')) && matches!(inside, Some("crate" | "super" | "self" | "in"))
        {
            while self.next().is_some_and(|token| *token != Token::Mark(')')) {}
        }
    }

    /// Whether the word just read stands after `pub` or `pub(...)`.
    fn is_public(&self) -> bool {
        let before = &self.tokens[..self.at - 1];
        let before = match before {
            [rest @ .., Token::Mark(')')] => {
                let open = rest.iter().rposition(|token| *token == Token::Mark('('));
                &before[..open.unwrap_or(0)]
            }
            _ => before,
        };
        before.last().and_then(Token::word) == Some("pub")
    }

    /// The rest of a path that begins with a word.
    fn path(&mut self, first: &str) -> Vec<String> {
        let is_start = self.at < 2 || self.tokens[self.at - 2] != Token::Colons;
        let mut path = vec![first.to_owned()];
        while is_start && self.peek() == Some(&Token::Colons) {
            let Some(word) = self.tokens.get(self.at + 1).and_then(Token::word) else { break };
            path.push(word.to_owned());
            self.at += 2;
        }
        path
    }

    /// The names that a `use` brings in, to its `;`.
    fn imports(&mut self, is_passed_on: bool) -> Vec<Import> {
        let mut found = Vec::new();
        self.branch(&[], is_passed_on, &mut found);
        self.take(&Token::Mark(';'));
        found
    }

    /// One branch of what stands after `use`: `a::b`, `a::b as c`, `a::*` or `a::{...}`.
    fn branch(&mut self, before: &[String], is_passed_on: bool, found: &mut Vec<Import>) {
        let mut path = before.to_vec();
        let mut name = None;
        while let Some(token) = self.peek() {
            match token {
                Token::Colons => {}
                Token::Mark('{') => {
                    self.at += 1;
                    while !self.take(&Token::Mark('}')) && self.peek().is_some() {
                        self.branch(&path, is_passed_on, found);
                        self.take(&Token::Mark(','));
                    }
                    return;
                }
                Token::Mark('*') => name = Some("*".to_owned()),
                Token::Word(word) if word == "as" => {
                    self.at += 1;
                    name = self.peek().and_then(Token::word).map(str::to_owned);
                }
                Token::Word(word) if word == "self" && !path.is_empty() => {}
                Token::Word(word) => path.push(word.clone()),
                Token::Mark(_) => break,
            }
            self.at += 1;
        }
        if let Some(last) = path.last().cloned() {
            found.push(Import { path, name: name.unwrap_or(last), is_passed_on });
        }
    }
}
