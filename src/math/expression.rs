//! Numbers as people write angles: `9*pi/10`, `-(pi/2 - 0.1)`.

use std::iter::Peekable;
use std::str::CharIndices;

/// Deepest nesting of parentheses that is read.
const MAX_DEPTH: usize = 64;

/// What is wrong with an expression, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{text}\", column {column}: {problem}")]
pub struct ExpressionError {
    /// The expression as it was written.
    pub text: String,
    /// Where the expression goes wrong, in characters from 1.
    pub column: usize,
    /// What is wrong at that column.
    pub problem: String,
}

/// Returns the value of an expression of numbers, `pi`, `+ - * /` and parentheses.
///
/// # Errors
/// [`ExpressionError`] with the column of the first character that does not fit, or where the value is not finite.
///
/// ```
/// let angle = kinstep::math::evaluate("9*pi/10")?;
/// assert_eq!(angle, 9.0 * std::f64::consts::PI / 10.0);
/// assert_eq!(kinstep::math::evaluate("2*(pi").unwrap_err().column, 6);
/// # Ok::<(), kinstep::math::ExpressionError>(())
/// ```
pub fn evaluate(text: &str) -> Result<f64, ExpressionError> {
    let mut reader = Reader { text, rest: text.char_indices().peekable(), depth: 0 };
    let value = reader.sum()?;
    reader.skip_blanks();
    if let Some((at, c)) = reader.peek() {
        let problem = if c.is_alphabetic() || c == '(' || c == 'π' {
            format!("an operator is missing before '{c}' (write 2*pi, not 2pi)")
        } else {
            format!("'{c}' does not belong here; an expression has numbers, pi, + - * / and parentheses")
        };
        return Err(reader.error(at, problem));
    }
    if value.is_finite() {
        Ok(value)
    } else {
        Err(reader.error(0, format!("the value is {value}, not a finite number")))
    }
}

struct Reader<'a> {
    text: &'a str,
    rest: Peekable<CharIndices<'a>>,
    depth: usize,
}

impl Reader<'_> {
    fn error(&self, at: usize, problem: String) -> ExpressionError {
        let column = self.text[..at].chars().count() + 1;
        ExpressionError { text: self.text.to_owned(), column, problem }
    }

    fn peek(&mut self) -> Option<(usize, char)> {
        self.rest.peek().copied()
    }

    fn skip_blanks(&mut self) {
        while self.rest.next_if(|(_, c)| c.is_whitespace()).is_some() {}
    }

    fn operator(&mut self, known: [char; 2]) -> Option<(usize, char)> {
        self.skip_blanks();
        self.rest.next_if(|(_, c)| known.contains(c))
    }

    fn sum(&mut self) -> Result<f64, ExpressionError> {
        let mut value = self.product()?;
        while let Some((_, sign)) = self.operator(['+', '-']) {
            let term = self.product()?;
            value = if sign == '+' { value + term } else { value - term };
        }
        Ok(value)
    }

    fn product(&mut self) -> Result<f64, ExpressionError> {
        let mut value = self.signed()?;
        while let Some((at, sign)) = self.operator(['*', '/']) {
            let factor = self.signed()?;
            if sign == '/' && factor == 0.0 {
                return Err(self.error(at, "this divides by zero".to_owned()));
            }
            value = if sign == '*' { value * factor } else { value / factor };
        }
        Ok(value)
    }

    fn signed(&mut self) -> Result<f64, ExpressionError> {
        let mut negative = false;
        while let Some((_, sign)) = self.operator(['+', '-']) {
            negative ^= sign == '-';
        }
        let value = self.atom()?;
        Ok(if negative { -value } else { value })
    }

    fn atom(&mut self) -> Result<f64, ExpressionError> {
        match self.peek() {
            Some((at, '(')) => self.parentheses(at),
            Some((_, c)) if c.is_ascii_digit() || c == '.' => self.number(),
            Some((at, c)) if c.is_alphabetic() => self.name(at),
            Some((at, c)) => Err(self.error(at, format!("a number, pi or '(' should stand here, not '{c}'"))),
            None => Err(self
                .error(self.text.len(), "the expression ends where a number or pi should stand".to_owned())),
        }
    }

    fn parentheses(&mut self, at: usize) -> Result<f64, ExpressionError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.error(at, format!("more than {MAX_DEPTH} parentheses inside each other")));
        }
        self.rest.next();
        let value = self.sum()?;
        self.skip_blanks();
        if self.rest.next_if(|(_, c)| *c == ')').is_none() {
            let end = self.peek().map_or(self.text.len(), |(end, _)| end);
            return Err(self.error(end, "a ')' is missing".to_owned()));
        }
        self.depth -= 1;
        Ok(value)
    }

    fn number(&mut self) -> Result<f64, ExpressionError> {
        let start = self.peek().map_or(self.text.len(), |(at, _)| at);
        let mut previous = ' ';
        while let Some((_, c)) = self.rest.next_if(|(_, c)| {
            c.is_ascii_digit()
                || matches!(c, '.' | 'e' | 'E')
                || (matches!(c, '+' | '-') && matches!(previous, 'e' | 'E'))
        }) {
            previous = c;
        }
        let end = self.peek().map_or(self.text.len(), |(at, _)| at);
        let digits = &self.text[start..end];
        digits.parse().map_err(|_| self.error(start, format!("'{digits}' is not a number")))
    }

    fn name(&mut self, start: usize) -> Result<f64, ExpressionError> {
        while self.rest.next_if(|(_, c)| c.is_alphanumeric() || *c == '_').is_some() {}
        let end = self.peek().map_or(self.text.len(), |(at, _)| at);
        match &self.text[start..end] {
            "pi" | "π" => Ok(std::f64::consts::PI),
            other => Err(self.error(start, format!("'{other}' is not known; the only name is pi"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn refused(text: &str) -> (usize, String) {
        let error = evaluate(text).unwrap_err();
        (error.column, error.problem)
    }

    #[test]
    fn reads_numbers_pi_and_the_four_operations() {
        for (text, value) in [
            ("9*pi/10", 9.0 * PI / 10.0),
            ("-pi/10", -PI / 10.0),
            (" 2 - -3 ", 5.0),
            ("1e-3*(2+4)/-3", -0.002),
            (".5", 0.5),
            ("2/4/2", 0.25),
            ("8-4-2", 2.0),
            ("1E+2", 100.0),
            ("--+-(π)", -PI),
        ] {
            assert_eq!(evaluate(text).unwrap(), value, "{text}");
        }
    }

    #[test]
    fn names_the_column_of_what_does_not_fit() {
        assert_eq!(refused("").0, 1);
        assert_eq!(refused("2*").0, 3);
        assert_eq!(refused("2*(pi").0, 6);
        assert!(refused("2pi").1.contains("2*pi"));
        assert_eq!(refused("pi/0").0, 3);
        assert_eq!(refused("3 + tau"), (5, "'tau' is not known; the only name is pi".to_owned()));
        assert_eq!(refused("π*x").0, 3);
        assert_eq!(refused("1.2.3").0, 1);
        assert_eq!(refused("1e400").0, 1);
        assert_eq!(refused("nan").0, 1);
        assert_eq!(refused("1,5").0, 2);
    }

    #[test]
    fn a_tower_of_parentheses_or_signs_is_refused_or_read_without_overflow() {
        assert!(refused(&"(".repeat(1_000_000)).1.contains("parentheses"));
        assert_eq!(evaluate(&("-".repeat(1_000_000) + "1")).unwrap(), 1.0);
    }

    proptest::proptest! {
        #[test]
        fn any_text_gives_a_value_or_an_error_with_a_column_inside_it(text in "[-+*/() .0-9epi,aπ]{0,24}") {
            match evaluate(&text) {
                Ok(value) => proptest::prop_assert!(value.is_finite()),
                Err(error) => proptest::prop_assert!(error.column <= text.chars().count() + 1),
            }
        }

        #[test]
        fn a_number_reads_as_itself(value in proptest::num::f64::NORMAL) {
            proptest::prop_assert_eq!(evaluate(&format!("{value:e}")).unwrap(), value);
        }
    }
}
