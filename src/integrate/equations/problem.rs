//! An initial value problem: equations, initial values and, where it is known, the solution.

use super::compiled::{Compiled, EquationField};
use super::parse::{Function, Meaning, Node, parse};
use crate::integrate::scalar::Elementary;
use std::collections::HashSet;
use thiserror::Error;

/// The most unknowns of a problem.
const MOST_UNKNOWNS: usize = 1000;

/// The parts of a problem as people write them, each a list of `name = expression`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EquationText {
    /// Names with a value.
    pub parameters: Vec<(String, f64)>,
    /// Short names for parts of equations, in an order in which each uses earlier ones only.
    pub definitions: Vec<String>,
    /// The derivative of every unknown: `x' = expression`.
    pub equations: Vec<String>,
    /// The value of every unknown at t = 0: `x = expression`.
    pub initial: Vec<String>,
    /// The solution as a function of t, or nothing: `x = expression`.
    pub exact: Vec<String>,
}

/// What is wrong with a line of a problem.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{message}")]
pub struct EquationError {
    /// Which list: `parameters`, `where`, `equations`, `initial` or `exact`.
    pub list: &'static str,
    /// Which line of it, from 0; nothing where the list as a whole is meant.
    pub line: Option<usize>,
    /// The sentence.
    pub message: String,
}

/// A system `x' = f(t, x)` from t = 0 that was written as text.
///
/// ```
/// use kinstep::integrate::{EquationText, Equations};
/// let lines = |lines: &[&str]| lines.iter().map(|&line| line.to_owned()).collect::<Vec<_>>();
/// let swing = Equations::parse(&EquationText {
///     equations: lines(&["x' = x*cos(t)"]),
///     initial: lines(&["x = 1"]),
///     exact: lines(&["x = exp(sin(t))"]),
///     ..EquationText::default()
/// })?;
/// assert_eq!(swing.unknowns(), ["x"]);
/// assert_eq!(swing.initial::<f64>(), [1.0]);
/// assert_eq!(swing.exact(0.5), Some(vec![0.5_f64.sin().exp()]));
/// # Ok::<(), kinstep::integrate::EquationError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Equations {
    unknowns: Vec<String>,
    definitions: Vec<Node>,
    derivatives: Vec<Node>,
    initial: Vec<Node>,
    exact: Option<Vec<Node>>,
}

impl Equations {
    /// Reads a problem.
    ///
    /// # Errors
    /// [`EquationError`]: a line that does not read, a name that means nothing or two things, an unknown without
    /// its initial value or its equation.
    pub fn parse(text: &EquationText) -> Result<Self, EquationError> {
        let mut names = Names::new(text)?;
        let equations = lines("equations", &text.equations, true)?;
        if equations.is_empty() || equations.len() > MOST_UNKNOWNS {
            let message = format!("a problem has 1 to {MOST_UNKNOWNS} equations such as \"x' = -x\"");
            return Err(EquationError { list: "equations", line: None, message });
        }
        for (line, (name, _)) in equations.iter().enumerate() {
            names.add("equations", line, name)?;
        }
        let unknowns: Vec<String> = equations.iter().map(|(name, _)| (*name).to_owned()).collect();
        let mut definitions = Vec::new();
        for (line, (name, expression)) in lines("where", &text.definitions, false)?.into_iter().enumerate() {
            definitions.push(names.read("where", line, expression, names.variables.len())?);
            names.add("where", line, name)?;
        }
        let all = names.variables.len();
        let derivatives = equations
            .iter()
            .enumerate()
            .map(|(line, (_, expression))| names.read("equations", line, expression, all))
            .collect::<Result<_, _>>()?;
        let initial = names.for_unknowns("initial", &text.initial, &unknowns, 0)?;
        let exact = if text.exact.is_empty() {
            None
        } else {
            Some(names.for_unknowns("exact", &text.exact, &unknowns, 1)?)
        };
        Ok(Self { unknowns, definitions, derivatives, initial, exact })
    }

    /// The unknowns, in the order of the entries of a state.
    pub fn unknowns(&self) -> &[String] {
        &self.unknowns
    }

    /// Whether the solution is known.
    pub fn has_exact(&self) -> bool {
        self.exact.is_some()
    }

    /// The right-hand side.
    pub fn field<T: Elementary>(&self) -> EquationField<T> {
        let dimension = self.unknowns.len();
        EquationField {
            dimension,
            definitions: self.definitions.iter().map(Compiled::of).collect(),
            derivatives: self.derivatives.iter().map(Compiled::of).collect(),
            values: vec![T::zero(); 1 + dimension + self.definitions.len()],
            stack: Vec::new(),
        }
    }

    /// The initial state.
    pub fn initial<T: Elementary>(&self) -> Vec<T> {
        values(&self.initial, T::zero())
    }

    /// The solution at `t`, where it is known.
    pub fn exact<T: Elementary>(&self, t: T) -> Option<Vec<T>> {
        self.exact.as_ref().map(|exact| values(exact, t))
    }

    /// The solution as a function, where it is known.
    pub fn solution<T: Elementary>(&self) -> Option<impl FnMut(T) -> Vec<T> + use<T>> {
        let compiled: Vec<Compiled<T>> = self.exact.as_ref()?.iter().map(Compiled::of).collect();
        let mut stack = Vec::new();
        Some(move |t| compiled.iter().map(|entry| entry.value(&[t], &mut stack)).collect())
    }
}

fn values<T: Elementary>(nodes: &[Node], t: T) -> Vec<T> {
    let mut stack = Vec::new();
    nodes.iter().map(|node| Compiled::of(node).value(&[t], &mut stack)).collect()
}

/// Splits `name = expression` (or `name' = expression`) lines.
fn lines<'t>(
    list: &'static str,
    lines: &'t [String],
    primed: bool,
) -> Result<Vec<(&'t str, &'t str)>, EquationError> {
    let split = |(line, text): (usize, &'t String)| {
        let form = if primed { "x' = expression" } else { "x = expression" };
        let refuse = || EquationError {
            list,
            line: Some(line),
            message: format!("\"{text}\" is not of the form `{form}`"),
        };
        let (name, expression) = text.split_once('=').ok_or_else(refuse)?;
        let name = name.trim();
        let name = if primed { name.strip_suffix('\'').map(str::trim_end) } else { Some(name) };
        let is_name = |name: &&str| {
            let mut characters = name.chars();
            characters.next().is_some_and(|c| c.is_alphabetic() || c == '_')
                && characters.all(|c| c.is_alphanumeric() || c == '_')
        };
        Ok((name.filter(is_name).ok_or_else(refuse)?, expression))
    };
    lines.iter().enumerate().map(split).collect()
}

/// The names that expressions may use.
struct Names {
    parameters: Vec<(String, f64)>,
    variables: Vec<String>,
}

impl Names {
    fn new(text: &EquationText) -> Result<Self, EquationError> {
        let mut names = Self { parameters: Vec::new(), variables: vec!["t".to_owned()] };
        for (name, value) in &text.parameters {
            names.check("parameters", None, name)?;
            names.parameters.push((name.clone(), *value));
        }
        Ok(names)
    }

    fn check(&self, list: &'static str, line: Option<usize>, name: &str) -> Result<(), EquationError> {
        let reserved = name == "pi" || Function::NAMES.iter().any(|(known, _)| *known == name);
        let taken =
            self.variables.iter().chain(self.parameters.iter().map(|(name, _)| name)).any(|n| n == name);
        if reserved || taken {
            let message = format!("\"{name}\" already means something else; choose another name");
            return Err(EquationError { list, line, message });
        }
        Ok(())
    }

    fn add(&mut self, list: &'static str, line: usize, name: &str) -> Result<(), EquationError> {
        self.check(list, Some(line), name)?;
        self.variables.push(name.to_owned());
        Ok(())
    }

    /// Reads an expression that may use the first `visible` variables.
    fn read(
        &self,
        list: &'static str,
        line: usize,
        expression: &str,
        visible: usize,
    ) -> Result<Node, EquationError> {
        let meaning = |name: &str| {
            if let Some(slot) = self.variables[..visible].iter().position(|known| known == name) {
                return Ok(Meaning::Slot(slot));
            }
            if let Some((_, value)) = self.parameters.iter().find(|(known, _)| known == name) {
                return Ok(Meaning::Constant(*value));
            }
            let known: Vec<&str> = self.variables[..visible]
                .iter()
                .chain(self.parameters.iter().map(|(name, _)| name))
                .map(String::as_str)
                .chain(Function::NAMES.map(|(name, _)| name))
                .chain(["pi"])
                .collect();
            Err(format!("\"{name}\" means nothing here; known are {}", known.join(", ")))
        };
        let message = |message| EquationError { list, line: Some(line), message };
        parse(expression, &meaning).map_err(message)
    }

    /// Reads one expression for every unknown, in their order, whatever order the lines have.
    fn for_unknowns(
        &self,
        list: &'static str,
        text: &[String],
        unknowns: &[String],
        visible: usize,
    ) -> Result<Vec<Node>, EquationError> {
        let found = lines(list, text, false)?;
        let mut seen = HashSet::new();
        for (line, (name, _)) in found.iter().enumerate() {
            if !unknowns.iter().any(|unknown| unknown == name) || !seen.insert(*name) {
                let message = format!(
                    "\"{name}\" is not an unknown, or stands here twice; the unknowns are {}",
                    unknowns.join(", ")
                );
                return Err(EquationError { list, line: Some(line), message });
            }
        }
        unknowns
            .iter()
            .map(|unknown| {
                let line =
                    found.iter().position(|(name, _)| name == unknown).ok_or_else(|| EquationError {
                        list,
                        line: None,
                        message: format!("there is no line for the unknown \"{unknown}\""),
                    })?;
                self.read(list, line, found[line].1, visible)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::field::Field;
    use crate::math::DoubleDouble;
    use proptest::prelude::*;

    fn lines(lines: &[&str]) -> Vec<String> {
        lines.iter().map(|&line| line.to_owned()).collect()
    }

    fn of(equation: &str) -> Result<Equations, EquationError> {
        Equations::parse(&EquationText {
            parameters: vec![("a".to_owned(), 0.5)],
            definitions: lines(&["s = x*x", "s2 = s + 1"]),
            equations: lines(&[equation]),
            initial: lines(&["x = sqrt(2)"]),
            exact: Vec::new(),
        })
    }

    fn value(expression: &str, t: f64, x: f64) -> f64 {
        let mut f = [0.0];
        of(&format!("x' = {expression}")).unwrap().field().evaluate(t, &[x], &mut f, &mut []);
        f[0]
    }

    #[test]
    fn expressions_mean_what_they_mean_on_paper() {
        for (text, expected) in [
            ("1 - 2 - 3", -4.0),
            ("2*3^2", 18.0),
            ("-2^2", -4.0),
            ("2^-1", 0.5),
            ("12/3/2", 2.0),
            ("4^1.5", 8.0),
            ("4^(-3/2)", 0.125),
            ("1e-2 + .5", 0.51),
            ("a*x", 1.5),
            ("s2 + t", 12.0),
            ("-(x - t)", -1.0),
            ("ln(exp(x))", 3.0),
            ("sin(pi/2) + cos(0*x)", 2.0),
        ] {
            assert!((value(text, 2.0, 3.0) - expected).abs() < 1e-14, "{text}: {}", value(text, 2.0, 3.0));
        }
    }

    #[test]
    fn numbers_are_exact_in_extended_precision() {
        let equations = of("x' = 0.1").unwrap();
        let mut f = [DoubleDouble::from(0.0)];
        equations.field().evaluate(f[0], &equations.initial::<DoubleDouble>(), &mut f, &mut []);
        assert!((f[0] * DoubleDouble::from(10.0) - DoubleDouble::from(1.0)).to_f64().abs() < 1e-31);
    }

    #[test]
    fn what_does_not_read_is_refused_with_a_reason() {
        for (text, reason) in [
            ("x' = y", "\"y\" means nothing here; known are t, x, s, s2, a, sin"),
            ("x' = 2 +", "ends where"),
            ("x' = (2", "not closed"),
            ("x' = 2 3", "`3` can not stand here"),
            ("x' = 2^x", "exponent is a whole number"),
            ("x' = 2^(1/0)", "exponent is a whole number"),
            ("x' = sin x", "needs its argument"),
            ("x' = 1.2.3", "second decimal point"),
            ("x = 2", "not of the form `x' = expression`"),
            ("t' = 2", "already means something else"),
            ("a' = 2", "already means something else"),
            ("x' = x!", "`!` can not stand"),
        ] {
            let error = of(text).unwrap_err();
            assert!(error.message.contains(reason), "{text}: {error}");
            assert_eq!(error.list, "equations");
        }
        assert!(of(&format!("x' = {}x{}", "(".repeat(99), ")".repeat(99))).is_err());
        assert!(of(&format!("x' = {}x", "-".repeat(3000))).is_err());
        let two = EquationText { equations: lines(&["x' = 1"]), ..EquationText::default() };
        assert!(Equations::parse(&two).unwrap_err().message.contains("no line for the unknown \"x\""));
        assert!(Equations::parse(&EquationText::default()).is_err());
    }

    proptest! {
        #[test]
        fn no_text_makes_the_reader_panic(text in "[xta0-9.+*/^()' =sincoe-]{0,30}") {
            let _ = of(&text);
            let _ = of(&format!("x' = {text}"));
        }
    }
}
