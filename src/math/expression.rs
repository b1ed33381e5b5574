//! Numbers as people write angles: `9*pi/10`, `-(pi/2 - 0.1)`, `atan2(1, 2)`.

use std::iter::Peekable;
use std::str::CharIndices;

use super::function::Function;

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

/// Returns the value of an expression of numbers, `pi`, `+ - * / ^`, comparisons (1 where they hold, else 0), parentheses and
/// the functions `sin cos tan asin acos atan atan2 sinh cosh tanh exp ln sqrt abs sign min max`.
///
/// # Errors
/// [`ExpressionError`] with the column of the first character that does not fit, or where the value is not finite.
///
/// ```
/// let angle = kinstep::math::evaluate("9*pi/10")?;
/// assert_eq!(angle, 9.0 * std::f64::consts::PI / 10.0);
/// assert_eq!(kinstep::math::evaluate("max(2^3, sqrt(49))")?, 8.0);
/// assert_eq!(kinstep::math::evaluate("2*(pi").unwrap_err().column, 6);
/// # Ok::<(), kinstep::math::ExpressionError>(())
/// ```
pub fn evaluate(text: &str) -> Result<f64, ExpressionError> {
    let mut reader = Reader { text, rest: text.char_indices().peekable(), depth: 0 };
    let value = reader.comparison()?;
    reader.skip_blanks();
    if let Some((at, c)) = reader.peek() {
        let problem = if c.is_alphabetic() || c == '(' || c == 'π' {
            format!("an operator is missing before '{c}' (write 2*pi, not 2pi)")
        } else {
            format!(
                "'{c}' does not belong here; an expression has numbers, pi, + - * / ^, functions and parentheses"
            )
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

    fn operator(&mut self, known: &[char]) -> Option<(usize, char)> {
        self.skip_blanks();
        self.rest.next_if(|(_, c)| known.contains(c))
    }

    fn comparison(&mut self) -> Result<f64, ExpressionError> {
        let left = self.sum()?;
        let Some((at, first)) = self.operator(&['<', '>', '=', '!']) else { return Ok(left) };
        let or_equal = self.rest.next_if(|(_, c)| *c == '=').is_some();
        let compare: fn(&f64, &f64) -> bool = match (first, or_equal) {
            ('<', false) => f64::lt,
            ('<', true) => f64::le,
            ('>', false) => f64::gt,
            ('>', true) => f64::ge,
            ('=', true) => f64::eq,
            ('!', true) => f64::ne,
            _ => return Err(self.error(at, format!("'{first}' compares nothing; use < <= > >= == !="))),
        };
        Ok(f64::from(u8::from(compare(&left, &self.sum()?))))
    }

    fn sum(&mut self) -> Result<f64, ExpressionError> {
        let mut value = self.product()?;
        while let Some((_, sign)) = self.operator(&['+', '-']) {
            let term = self.product()?;
            value = if sign == '+' { value + term } else { value - term };
        }
        Ok(value)
    }

    fn product(&mut self) -> Result<f64, ExpressionError> {
        let mut value = self.signed()?;
        while let Some((at, sign)) = self.operator(&['*', '/']) {
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
        while let Some((_, sign)) = self.operator(&['+', '-']) {
            negative ^= sign == '-';
        }
        let value = self.power()?;
        Ok(if negative { -value } else { value })
    }

    /// A sign binds less than a power, and a power of a power is taken from the right: -2^3^2 is -(2^9).
    fn power(&mut self) -> Result<f64, ExpressionError> {
        let base = self.atom()?;
        let Some((at, _)) = self.operator(&['^']) else { return Ok(base) };
        self.deeper(at)?;
        let exponent = self.signed()?;
        self.depth -= 1;
        let value = base.powf(exponent);
        if value.is_nan() {
            return Err(self.error(at, format!("{base}^{exponent} is not a number")));
        }
        Ok(value)
    }

    fn deeper(&mut self, at: usize) -> Result<(), ExpressionError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.error(at, format!("more than {MAX_DEPTH} parentheses inside each other")));
        }
        Ok(())
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
        self.deeper(at)?;
        self.rest.next();
        let value = self.comparison()?;
        self.close()?;
        Ok(value)
    }

    fn close(&mut self) -> Result<(), ExpressionError> {
        self.skip_blanks();
        if self.rest.next_if(|(_, c)| *c == ')').is_none() {
            let end = self.peek().map_or(self.text.len(), |(end, _)| end);
            return Err(self.error(end, "a ')' is missing".to_owned()));
        }
        self.depth -= 1;
        Ok(())
    }

    /// The value of a function whose name begins at `start`.
    fn call(&mut self, function: Function, name: &str, start: usize) -> Result<f64, ExpressionError> {
        if self.operator(&['(']).is_none() {
            return Err(self.error(start, format!("'{name}' needs its argument in parentheses")));
        }
        self.deeper(start)?;
        let mut arguments = vec![self.comparison()?];
        while self.operator(&[',']).is_some() {
            arguments.push(self.comparison()?);
        }
        self.close()?;
        if !function.arguments().contains(&arguments.len()) {
            let (wants, given) = (function.arguments_in_words(), arguments.len());
            return Err(self.error(start, format!("'{name}' takes {wants}; {given} given")));
        }
        let value = function.value(&arguments);
        if value.is_nan() {
            let list: Vec<String> = arguments.iter().map(f64::to_string).collect();
            return Err(self.error(start, format!("{name}({}) is not a number", list.join(", "))));
        }
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
        let name = &self.text[start..end];
        if name == "pi" || name == "π" {
            return Ok(std::f64::consts::PI);
        }
        if let Some(function) = Function::named(name) {
            return self.call(function, name, start);
        }
        let problem =
            format!("'{name}' is not known; known are pi and functions such as sin, atan2, sqrt, min");
        Err(self.error(start, problem))
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
            ("-2^2^3", -256.0),
            ("2^-1", 0.5),
            ("abs(-3)*sign(-2) + min(1, 2, -3) + max(1, 4)", -2.0),
            ("atan2(0, -1)", PI),
            ("(1 < 2) + (1 >= 2) + (2 == 2)*10 + (2 != 2)", 11.0),
            ("sqrt(16) + ln(exp(1))", 5.0),
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
        assert_eq!(refused("3 + tau").0, 5);
        assert!(
            refused("3 + tau").1.starts_with("'tau' is not known; known are pi and functions such as sin")
        );
        assert_eq!(refused("1 + sqrt(-1)"), (5, "sqrt(-1) is not a number".to_owned()));
        assert_eq!(refused("2*min(1)").0, 3);
        assert_eq!(refused("2*sin 1").0, 3);
        assert_eq!(refused("1 = 1").0, 3);
        assert_eq!(refused("(-8)^(1/3)").0, 5);
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
        assert!(refused(&"abs(".repeat(1_000_000)).1.contains("parentheses"));
        assert!(refused(&"2^".repeat(1_000_000)).1.contains("parentheses"));
    }

    proptest::proptest! {
        #[test]
        fn any_text_gives_a_value_or_an_error_with_a_column_inside_it(text in "[-+*/^<=() .0-9epi,absinπ]{0,24}") {
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
