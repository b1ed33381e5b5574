//! Expressions of names, numbers, `+ - * / ^`, parentheses and a few functions.

use crate::math::{Rational, parse_rational};
use num_traits::{One, ToPrimitive};

/// Deepest nesting of parentheses and signs that is read.
const MOST_NESTED: usize = 64;
/// Longest expression that is read \[characters\].
const MOST_CHARACTERS: usize = 4000;
/// Largest exponent.
const MOST_POWER: i64 = 32;

/// A function of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Sin,
    Cos,
    Exp,
    Ln,
    Sqrt,
}

impl Function {
    pub(super) const NAMES: [(&'static str, Self); 5] =
        [("sin", Self::Sin), ("cos", Self::Cos), ("exp", Self::Exp), ("ln", Self::Ln), ("sqrt", Self::Sqrt)];
}

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meaning {
    /// The place of a variable.
    Slot(usize),
    /// A parameter.
    Constant(f64),
}

/// An expression as it was read.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    Number(Rational),
    Parameter(f64),
    Pi,
    Slot(usize),
    Negative(Box<Node>),
    Sum(Box<Node>, Box<Node>),
    Difference(Box<Node>, Box<Node>),
    Product(Box<Node>, Box<Node>),
    Quotient(Box<Node>, Box<Node>),
    /// To a power, counted in halves.
    Power(Box<Node>, i32),
    Call(Function, Box<Node>),
}

/// Reads an expression; `meaning` says what names stand for, the error is a sentence.
pub(super) fn parse(text: &str, meaning: &dyn Fn(&str) -> Result<Meaning, String>) -> Result<Node, String> {
    if text.chars().count() > MOST_CHARACTERS {
        return Err(format!("longer than {MOST_CHARACTERS} characters"));
    }
    let mut reader = Reader { tokens: tokens(text)?, next: 0, depth: 0, meaning };
    let node = reader.sum()?;
    match reader.peek() {
        None => Ok(node),
        Some(token) => Err(format!("`{}` can not stand here", token.text())),
    }
}

#[derive(Clone, Debug, PartialEq)]
enum Token {
    Number(String),
    Name(String),
    Sign(char),
}

impl Token {
    fn text(&self) -> String {
        match self {
            Self::Number(text) | Self::Name(text) => text.clone(),
            Self::Sign(sign) => sign.to_string(),
        }
    }
}

fn tokens(text: &str) -> Result<Vec<Token>, String> {
    let characters: Vec<char> = text.chars().collect();
    let mut found = Vec::new();
    let mut at = 0;
    while at < characters.len() {
        let c = characters[at];
        let run = |from: usize, keep: &dyn Fn(usize) -> bool| {
            (from..characters.len()).take_while(|&i| keep(i)).last().map_or(from, |last| last + 1)
        };
        if c.is_whitespace() {
            at += 1;
        } else if c.is_ascii_digit() || c == '.' {
            let sign_of_exponent = |i: usize| {
                matches!(characters[i], '+' | '-') && i > at && matches!(characters[i - 1], 'e' | 'E')
            };
            let end = run(at, &|i| {
                characters[i].is_ascii_digit()
                    || matches!(characters[i], '.' | 'e' | 'E')
                    || sign_of_exponent(i)
            });
            found.push(Token::Number(characters[at..end].iter().collect()));
            at = end;
        } else if c.is_alphabetic() || c == '_' {
            let end = run(at, &|i| characters[i].is_alphanumeric() || characters[i] == '_');
            found.push(Token::Name(characters[at..end].iter().collect()));
            at = end;
        } else if "+-*/^()".contains(c) {
            found.push(Token::Sign(c));
            at += 1;
        } else {
            return Err(format!("`{}` can not stand in an expression", c.escape_debug()));
        }
    }
    Ok(found)
}

struct Reader<'a> {
    tokens: Vec<Token>,
    next: usize,
    depth: usize,
    meaning: &'a dyn Fn(&str) -> Result<Meaning, String>,
}

impl Reader<'_> {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.next)
    }

    fn take(&mut self, sign: char) -> bool {
        let is_next = self.peek() == Some(&Token::Sign(sign));
        self.next += usize::from(is_next);
        is_next
    }

    fn sum(&mut self) -> Result<Node, String> {
        let mut left = self.product()?;
        loop {
            if self.take('+') {
                left = Node::Sum(left.into(), self.product()?.into());
            } else if self.take('-') {
                left = Node::Difference(left.into(), self.product()?.into());
            } else {
                return Ok(left);
            }
        }
    }

    fn product(&mut self) -> Result<Node, String> {
        let mut left = self.signed()?;
        loop {
            if self.take('*') {
                left = Node::Product(left.into(), self.signed()?.into());
            } else if self.take('/') {
                left = Node::Quotient(left.into(), self.signed()?.into());
            } else {
                return Ok(left);
            }
        }
    }

    /// A sign binds less than a power: -x^2 is -(x^2).
    fn signed(&mut self) -> Result<Node, String> {
        self.depth += 1;
        if self.depth > MOST_NESTED {
            return Err(format!("nested more than {MOST_NESTED} deep"));
        }
        let node = if self.take('-') {
            Node::Negative(self.signed()?.into())
        } else if self.take('+') {
            self.signed()?
        } else {
            self.power()?
        };
        self.depth -= 1;
        Ok(node)
    }

    fn power(&mut self) -> Result<Node, String> {
        let base = self.atom()?;
        if !self.take('^') {
            return Ok(base);
        }
        let exponent = self.signed()?;
        let halves = constant(&exponent).map(|value| value * Rational::from_integer(2.into()));
        let halves = halves.filter(Rational::is_integer).and_then(|value| value.to_i64());
        match halves.filter(|halves| halves.abs() <= 2 * MOST_POWER) {
            Some(halves) => Ok(Node::Power(base.into(), halves as i32)),
            None => Err(format!(
                "an exponent is a whole number or a half such as 1.5, at most {MOST_POWER}; other powers are exp(p*ln(x))"
            )),
        }
    }

    fn atom(&mut self) -> Result<Node, String> {
        let token = self.peek().cloned().ok_or("the expression ends where a number or a name should be")?;
        self.next += 1;
        match token {
            Token::Number(text) => parse_rational(&text).map(Node::Number).map_err(|e| e.to_string()),
            Token::Name(name) => self.name(&name),
            Token::Sign('(') => self.closed(),
            Token::Sign(sign) => Err(format!("`{sign}` stands where a number or a name should be")),
        }
    }

    fn closed(&mut self) -> Result<Node, String> {
        let inside = self.sum()?;
        if self.take(')') { Ok(inside) } else { Err("a parenthesis is not closed".to_owned()) }
    }

    fn name(&mut self, name: &str) -> Result<Node, String> {
        if let Some((_, function)) = Function::NAMES.iter().find(|(known, _)| *known == name) {
            if !self.take('(') {
                return Err(format!("{name} needs its argument in parentheses"));
            }
            return Ok(Node::Call(*function, self.closed()?.into()));
        }
        if name == "pi" {
            return Ok(Node::Pi);
        }
        Ok(match (self.meaning)(name)? {
            Meaning::Slot(slot) => Node::Slot(slot),
            Meaning::Constant(value) => Node::Parameter(value),
        })
    }
}

/// The exact value of an exponent.
fn constant(node: &Node) -> Option<Rational> {
    match node {
        Node::Number(value) => Some(value.clone()),
        Node::Negative(inside) => Some(-constant(inside)?),
        Node::Quotient(a, b) => {
            let divisor = constant(b)?;
            (divisor != Rational::one() - Rational::one()).then(|| constant(a).map(|a| a / divisor))?
        }
        _ => None,
    }
}
