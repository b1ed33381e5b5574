use crate::math::{ExpressionError, evaluate, number_text};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// A finite number, written as a number or as an expression in pi (`"9*pi/10"`).
///
/// The expression is kept, so that a file that is written out reads as it was.
///
/// ```
/// use kinstep::kind::Real;
///
/// let turn: Real = "9*pi/10".parse()?;
/// assert_eq!(turn.value(), 9.0 * std::f64::consts::PI / 10.0);
/// assert_eq!(turn.to_string(), "9*pi/10");
/// # Ok::<(), kinstep::math::ExpressionError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Real {
    value: f64,
    expression: Option<String>,
}

impl Real {
    /// Returns the number.
    pub fn value(&self) -> f64 {
        self.value
    }
}

impl From<f64> for Real {
    fn from(value: f64) -> Self {
        Self { value, expression: None }
    }
}

impl std::str::FromStr for Real {
    type Err = ExpressionError;

    fn from_str(text: &str) -> Result<Self, ExpressionError> {
        Ok(Self { value: evaluate(text)?, expression: Some(text.to_owned()) })
    }
}

impl fmt::Display for Real {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.expression {
            Some(expression) => f.write_str(expression),
            None => f.write_str(&number_text(self.value)),
        }
    }
}

impl Serialize for Real {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.expression {
            Some(expression) => serializer.serialize_str(expression),
            None => serializer.serialize_f64(self.value),
        }
    }
}

impl<'de> Deserialize<'de> for Real {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(RealVisitor)
    }
}

struct RealVisitor;

impl serde::de::Visitor<'_> for RealVisitor {
    type Value = Real;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or an expression in pi such as \"9*pi/10\"")
    }

    fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Real, E> {
        if value.is_finite() {
            Ok(value.into())
        } else {
            Err(E::custom(format_args!("{value} is not a finite number")))
        }
    }

    fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Real, E> {
        Ok((value as f64).into())
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Real, E> {
        text.parse().map_err(E::custom)
    }
}

#[cfg(feature = "schema")]
impl schemars::JsonSchema for Real {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Real".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "description": "A finite number, or an expression of numbers, pi, + - * / and parentheses in quotes.",
            "anyOf": [{ "type": "number" }, { "type": "string", "pattern": r"^[-+*/().0-9eE\spiπ]+$" }]
        })
    }
}
