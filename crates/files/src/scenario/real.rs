//! One number of a scenario, with the expression it was written as.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use kinstep::math::evaluate;

/// A finite number, written as a number or as an expression in pi (`"9*pi/10"`).
///
/// The expression is kept, so that a scenario that is written out reads as it was.
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

impl fmt::Display for Real {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.expression {
            Some(expression) => f.write_str(expression),
            None => f.write_str(&kinstep::math::number_text(self.value)),
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
        let value = evaluate(text).map_err(E::custom)?;
        Ok(Real { value, expression: Some(text.to_owned()) })
    }
}

/// Reads exactly `N` numbers; serde's own arrays take the first `N` and drop the rest in silence.
pub(super) fn exactly<'de, D: Deserializer<'de>, const N: usize>(
    deserializer: D,
) -> Result<[Real; N], D::Error> {
    let numbers = Vec::<Real>::deserialize(deserializer)?;
    let got = numbers.len();
    numbers.try_into().map_err(|_| serde::de::Error::custom(format_args!("expected {N} numbers, got {got}")))
}

/// As [`exactly`], for a key that may be left out.
pub(super) fn some_exactly<'de, D: Deserializer<'de>, const N: usize>(
    deserializer: D,
) -> Result<Option<[Real; N]>, D::Error> {
    exactly(deserializer).map(Some)
}

/// Reads a list of vectors of three numbers each, for a key that may be left out.
pub(super) fn some_triples<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Vec<[Real; 3]>>, D::Error> {
    let vectors = Vec::<Vec<Real>>::deserialize(deserializer)?;
    let triple = |numbers: Vec<Real>| {
        let got = numbers.len();
        let refuse = |_| serde::de::Error::custom(format_args!("expected 3 numbers, got {got}"));
        numbers.try_into().map_err(refuse)
    };
    vectors.into_iter().map(triple).collect::<Result<_, _>>().map(Some)
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
