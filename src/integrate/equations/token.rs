//! The tokens of an expression, each with its place.

/// What is wrong, and where it stands in the expression, in characters from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ParseError {
    pub(super) column: usize,
    pub(super) message: String,
}

/// What a token is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    Number(String),
    Name(String),
    /// `+ - * / ^ ( ) , < > <= >= == !=`
    Sign(&'static str),
}

/// A token and where it begins and ends, in characters from 0.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Token {
    pub(super) kind: Kind,
    pub(super) start: usize,
    pub(super) end: usize,
}

impl Token {
    pub(super) fn text(&self) -> &str {
        match &self.kind {
            Kind::Number(text) | Kind::Name(text) => text,
            Kind::Sign(sign) => sign,
        }
    }
}

/// Longer signs first: `<=` is not `<`.
const SIGNS: [&str; 14] = ["<=", ">=", "==", "!=", "+", "-", "*", "/", "^", "(", ")", ",", "<", ">"];

/// Cuts an expression into tokens.
pub(super) fn tokens(characters: &[char]) -> Result<Vec<Token>, ParseError> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < characters.len() {
        if characters[at].is_whitespace() {
            at += 1;
            continue;
        }
        let (kind, end) = token(characters, at)?;
        found.push(Token { kind, start: at, end });
        at = end;
    }
    Ok(found)
}

fn token(characters: &[char], at: usize) -> Result<(Kind, usize), ParseError> {
    let c = characters[at];
    let text = |end: usize| characters[at..end].iter().collect::<String>();
    if c.is_ascii_digit() || c == '.' {
        let end = at
            + characters[at..]
                .iter()
                .enumerate()
                .take_while(|&(i, _)| is_digit(characters, at + i, at))
                .count();
        return Ok((Kind::Number(text(end)), end));
    }
    if c.is_alphabetic() || c == '_' {
        let end = at + characters[at..].iter().take_while(|c| c.is_alphanumeric() || **c == '_').count();
        return Ok((Kind::Name(text(end)), end));
    }
    let is_here = |sign: &&&str| sign.chars().enumerate().all(|(i, c)| characters.get(at + i) == Some(&c));
    if let Some(sign) = SIGNS.iter().find(is_here) {
        return Ok((Kind::Sign(sign), at + sign.len()));
    }
    let hint = match c {
        '=' => "; two numbers are compared with ==",
        '[' | '{' => "; there are round parentheses only",
        _ => "",
    };
    let message = format!("`{}` can not stand in an expression{hint}", c.escape_debug());
    Err(ParseError { column: at, message })
}

/// Whether a character goes on with the number that begins at `start`.
fn is_digit(characters: &[char], i: usize, start: usize) -> bool {
    let c = characters[i];
    let is_sign_of_exponent = matches!(c, '+' | '-') && i > start && matches!(characters[i - 1], 'e' | 'E');
    c.is_ascii_digit() || matches!(c, '.' | 'e' | 'E') || is_sign_of_exponent
}
