//! Expressions of names, numbers, `+ - * / ^`, comparisons, parentheses and functions.

use super::token::{Kind, ParseError, Token, tokens};
use crate::math::{Function, Rational, parse_rational};
use num_traits::{ToPrimitive, Zero};

/// Deepest nesting of parentheses and signs that is read.
const MOST_NESTED: usize = 64;
/// Longest expression that is read \[characters\].
const MOST_CHARACTERS: usize = 4000;
/// Largest exponent that is multiplied out.
const MOST_POWER: i64 = 32;

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meaning {
    /// The place of a variable.
    Slot(usize),
    /// A parameter.
    Constant(f64),
}

/// A comparison of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Comparison {
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    Unequal,
}

impl Comparison {
    const SIGNS: [(&'static str, Self); 6] = [
        ("<", Self::Less),
        ("<=", Self::LessOrEqual),
        (">", Self::Greater),
        (">=", Self::GreaterOrEqual),
        ("==", Self::Equal),
        ("!=", Self::Unequal),
    ];
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
    RealPower(Box<Node>, Box<Node>),
    /// One where it holds, zero where it does not.
    Compared(Comparison, Box<Node>, Box<Node>),
    Call(Function, Vec<Node>),
}

/// A part of an expression that is not smooth where `quantity` changes its sign.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Switch {
    /// The part as it was written.
    pub(super) text: String,
    pub(super) quantity: Node,
}

/// Reads an expression, and what in it may switch; `meaning` says what names stand for, or in a sentence that they mean nothing.
pub(super) fn parse(
    text: &str,
    meaning: &dyn Fn(&str) -> Result<Meaning, String>,
) -> Result<(Node, Vec<Switch>), ParseError> {
    let characters: Vec<char> = text.chars().collect();
    if characters.len() > MOST_CHARACTERS {
        let message = format!("longer than {MOST_CHARACTERS} characters");
        return Err(ParseError { column: MOST_CHARACTERS, message });
    }
    let tokens = tokens(&characters)?;
    let mut reader = Reader { characters, tokens, next: 0, depth: 0, meaning, switches: Vec::new() };
    let node = reader.comparison()?;
    match reader.peek() {
        None => Ok((node, reader.switches)),
        Some(token) => {
            let hint = match token.kind {
                Kind::Number(_) | Kind::Name(_) | Kind::Sign("(") => {
                    "; an operator is missing before it, such as *"
                }
                Kind::Sign(")") => "; no parenthesis is open",
                Kind::Sign(_) => "",
            };
            Err(reader.error(reader.next, format!("`{}` can not stand here{hint}", token.text())))
        }
    }
}

struct Reader<'a> {
    characters: Vec<char>,
    tokens: Vec<Token>,
    next: usize,
    depth: usize,
    meaning: &'a dyn Fn(&str) -> Result<Meaning, String>,
    switches: Vec<Switch>,
}

impl Reader<'_> {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.next)
    }

    fn take(&mut self, sign: &str) -> bool {
        let is_next =
            self.peek().is_some_and(|token| matches!(token.kind, Kind::Sign(found) if found == sign));
        self.next += usize::from(is_next);
        is_next
    }

    /// An error at a token; behind the last one, at the end of the text.
    fn error(&self, token: usize, message: impl Into<String>) -> ParseError {
        let end = self.tokens.last().map_or(0, |last| last.end);
        ParseError {
            column: self.tokens.get(token).map_or(end, |token| token.start),
            message: message.into(),
        }
    }

    /// Remembers that what stands from the token `from` to here switches where `quantity` changes its sign.
    fn switches(&mut self, from: usize, quantity: Node) {
        let text = self.characters[self.tokens[from].start..self.tokens[self.next - 1].end].iter().collect();
        self.switches.push(Switch { text, quantity });
    }

    fn comparison(&mut self) -> Result<Node, ParseError> {
        let from = self.next;
        let left = self.sum()?;
        let Some((_, comparison)) = Comparison::SIGNS.iter().find(|(sign, _)| self.take(sign)) else {
            return Ok(left);
        };
        let right = self.sum()?;
        if Comparison::SIGNS.iter().any(|(sign, _)| self.take(sign)) {
            let message = "two comparisons in a row mean nothing; multiply them, each in parentheses";
            return Err(self.error(self.next - 1, message));
        }
        self.switches(from, Node::Difference(left.clone().into(), right.clone().into()));
        Ok(Node::Compared(*comparison, left.into(), right.into()))
    }

    fn sum(&mut self) -> Result<Node, ParseError> {
        let mut left = self.product()?;
        loop {
            if self.take("+") {
                left = Node::Sum(left.into(), self.product()?.into());
            } else if self.take("-") {
                left = Node::Difference(left.into(), self.product()?.into());
            } else {
                return Ok(left);
            }
        }
    }

    fn product(&mut self) -> Result<Node, ParseError> {
        let mut left = self.signed()?;
        loop {
            if self.take("*") {
                left = Node::Product(left.into(), self.signed()?.into());
            } else if self.take("/") {
                let at = self.next - 1;
                let divisor = self.signed()?;
                if constant(&divisor).is_some_and(|value| value.is_zero()) {
                    return Err(self.error(at, "this divides by zero"));
                }
                left = Node::Quotient(left.into(), divisor.into());
            } else {
                return Ok(left);
            }
        }
    }

    /// A sign binds less than a power: -x^2 is -(x^2).
    fn signed(&mut self) -> Result<Node, ParseError> {
        self.depth += 1;
        if self.depth > MOST_NESTED {
            return Err(self.error(self.next, format!("nested more than {MOST_NESTED} deep")));
        }
        let node = if self.take("-") {
            Node::Negative(self.signed()?.into())
        } else if self.take("+") {
            self.signed()?
        } else {
            self.power()?
        };
        self.depth -= 1;
        Ok(node)
    }

    fn power(&mut self) -> Result<Node, ParseError> {
        let base = self.atom()?;
        if !self.take("^") {
            return Ok(base);
        }
        let exponent = self.signed()?;
        let halves = constant(&exponent).map(|value| value * Rational::from_integer(2.into()));
        let halves = halves.filter(Rational::is_integer).and_then(|value| value.to_i64());
        Ok(match halves.filter(|halves| halves.abs() <= 2 * MOST_POWER) {
            Some(halves) => Node::Power(base.into(), halves as i32),
            None => Node::RealPower(base.into(), exponent.into()),
        })
    }

    fn atom(&mut self) -> Result<Node, ParseError> {
        let at = self.next;
        let Some(token) = self.peek().cloned() else {
            return Err(self.error(at, "the expression ends where a number or a name should be"));
        };
        self.next += 1;
        match token.kind {
            Kind::Number(text) => {
                parse_rational(&text).map(Node::Number).map_err(|e| self.error(at, e.to_string()))
            }
            Kind::Name(name) => self.name(&name, at),
            Kind::Sign("(") => {
                let inside = self.comparison()?;
                self.close(at).map(|()| inside)
            }
            Kind::Sign(sign) => {
                Err(self.error(at, format!("`{sign}` stands where a number or a name should be")))
            }
        }
    }

    /// The end of the parenthesis that the token `opened` begins.
    fn close(&mut self, opened: usize) -> Result<(), ParseError> {
        if self.take(")") {
            return Ok(());
        }
        match self.peek() {
            Some(token) => {
                let message = format!("`{}` stands where the parenthesis should be closed", token.text());
                Err(self.error(self.next, message))
            }
            None => Err(self.error(opened, "a parenthesis is not closed")),
        }
    }

    fn name(&mut self, name: &str, at: usize) -> Result<Node, ParseError> {
        if let Some(function) = Function::named(name) {
            return self.call(function, name, at);
        }
        if name == "pi" {
            return Ok(Node::Pi);
        }
        match (self.meaning)(name) {
            Ok(Meaning::Slot(slot)) => Ok(Node::Slot(slot)),
            Ok(Meaning::Constant(value)) => Ok(Node::Parameter(value)),
            Err(message) => Err(self.error(at, message)),
        }
    }

    fn call(&mut self, function: Function, name: &str, at: usize) -> Result<Node, ParseError> {
        if !self.take("(") {
            return Err(self.error(at, format!("{name} needs its argument in parentheses")));
        }
        let mut arguments = vec![self.comparison()?];
        while self.take(",") {
            arguments.push(self.comparison()?);
        }
        self.close(at + 1)?;
        if !function.arguments().contains(&arguments.len()) {
            let (wants, given) = (function.arguments_in_words(), arguments.len());
            return Err(self.error(at, format!("{name} takes {wants}; {given} given")));
        }
        match function {
            Function::Abs | Function::Sign => self.switches(at, arguments[0].clone()),
            Function::Min | Function::Max => {
                for (k, later) in arguments.iter().enumerate().skip(1) {
                    for earlier in &arguments[..k] {
                        self.switches(at, Node::Difference(earlier.clone().into(), later.clone().into()));
                    }
                }
            }
            _ => {}
        }
        Ok(Node::Call(function, arguments))
    }
}

/// The exact value of an exponent or a divisor that is written in numbers.
fn constant(node: &Node) -> Option<Rational> {
    match node {
        Node::Number(value) => Some(value.clone()),
        Node::Negative(inside) => Some(-constant(inside)?),
        Node::Quotient(a, b) => Some(constant(a)? / constant(b)?),
        _ => None,
    }
}
