//! Rust text as the few tokens that an import is made of. Comments, strings, numbers and lifetimes are gone.

use std::iter::Peekable;
use std::str::Chars;

/// What is left of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Token {
    /// A name or a keyword.
    Word(String),
    /// `::`
    Colons,
    /// Any other sign.
    Mark(char),
}

impl Token {
    /// The name or keyword, where it is one.
    pub(super) fn word(&self) -> Option<&str> {
        if let Token::Word(word) = self { Some(word) } else { None }
    }
}

/// Returns the tokens of a text.
pub(super) fn tokens(text: &str) -> Vec<Token> {
    let mut found = Vec::new();
    let mut rest = text.chars().peekable();
    while let Some(sign) = rest.next() {
        match sign {
            '/' if rest.peek() == Some(&'/') => skip_line(&mut rest),
            '/' if rest.peek() == Some(&'*') => skip_block(&mut rest),
            '"' => skip_string(&mut rest),
            '\'' => skip_character(&mut rest),
            ':' if rest.peek() == Some(&':') => {
                rest.next();
                found.push(Token::Colons);
            }
            _ if sign.is_alphanumeric() || sign == '_' => found.extend(word(sign, &mut rest)),
            _ if sign.is_whitespace() => {}
            _ => found.push(Token::Mark(sign)),
        }
    }
    found
}

type Rest<'a> = Peekable<Chars<'a>>;

fn skip_line(rest: &mut Rest<'_>) {
    rest.find(|&sign| sign == '\n');
}

/// Block comments hold others.
fn skip_block(rest: &mut Rest<'_>) {
    let (mut depth, mut before) = (0, '/');
    for sign in rest {
        match (before, sign) {
            ('/', '*') => depth += 1,
            ('*', '/') => depth -= 1,
            _ => {
                before = sign;
                continue;
            }
        }
        if depth == 0 {
            return;
        }
        // Neither sign is part of the next pair.
        before = ' ';
    }
}

fn skip_string(rest: &mut Rest<'_>) {
    while let Some(sign) = rest.next() {
        match sign {
            '\\' => drop(rest.next()),
            '"' => return,
            _ => {}
        }
    }
}

/// Skips a string that ends with a quote and as many `#` as it began with.
fn skip_raw_string(hashes: usize, rest: &mut Rest<'_>) {
    rest.find(|&sign| sign == '"');
    let mut seen = None;
    for sign in rest {
        seen = match (sign, seen) {
            ('"', _) => Some(0),
            ('#', Some(count)) => Some(count + 1),
            _ => None,
        };
        if seen == Some(hashes) {
            return;
        }
    }
}

/// Skips a character such as `'a'` or `'\''`, or the sign of a lifetime.
fn skip_character(rest: &mut Rest<'_>) {
    let mut ahead = rest.clone();
    match ahead.next() {
        Some('\\') => {
            ahead.next();
            ahead.find(|&sign| sign == '\'');
            *rest = ahead;
        }
        Some(_) if ahead.next() == Some('\'') => *rest = ahead,
        _ => while rest.next_if(|sign| sign.is_alphanumeric() || *sign == '_').is_some() {},
    }
}

/// A word; nothing where it is a number, or the beginning of a string such as `br#"..."#`.
fn word(first: char, rest: &mut Rest<'_>) -> Option<Token> {
    let mut word = String::from(first);
    while let Some(sign) = rest.next_if(|sign| sign.is_alphanumeric() || *sign == '_') {
        word.push(sign);
    }
    if matches!(word.as_str(), "r" | "br" | "cr") {
        let mut ahead = rest.clone();
        let mut hashes = 0;
        while ahead.next_if_eq(&'#').is_some() {
            hashes += 1;
        }
        match ahead.peek() {
            Some('"') => {
                skip_raw_string(hashes, rest);
                return None;
            }
            // A keyword as a name: `r#type`.
            Some(_) if hashes == 1 => {
                rest.next();
                return None;
            }
            _ => {}
        }
    }
    // Of `b"..."` and `b'.'` the rest is like any other string or character.
    let is_prefix = matches!(word.as_str(), "b" | "c") && matches!(rest.peek(), Some('"' | '\''));
    (!is_prefix && !first.is_numeric()).then_some(Token::Word(word))
}
