use super::{ByJoint, Parameter, Value};
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde::{Serialize, Serializer};
use std::fmt;

/// The parameters that something of a kind was given, by their names.
///
/// ```
/// use kinstep::kind::Parameters;
///
/// let circle = Parameters::new().with("radius", 0.1);
/// assert_eq!(circle.number("radius"), Some(0.1));
/// assert_eq!(circle.number("petals"), None);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Parameters(Vec<(String, Value)>);

impl Parameters {
    /// No parameter.
    pub fn new() -> Self {
        Self::default()
    }

    /// The same with one more, in place of one of that name.
    #[must_use]
    pub fn with(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.set(name, value);
        self
    }

    /// Gives a parameter, in place of one of that name.
    pub fn set(&mut self, name: &str, value: impl Into<Value>) {
        let value = value.into();
        match self.0.iter_mut().find(|(own, _)| own == name) {
            Some((_, own)) => *own = value,
            None => self.0.push((name.to_owned(), value)),
        }
    }

    /// Takes a parameter away, if it was given.
    pub fn remove(&mut self, name: &str) {
        self.0.retain(|(own, _)| own != name);
    }

    /// The value of that name.
    pub fn get(&self, name: &str) -> Option<&Value> {
        self.0.iter().find(|(own, _)| own == name).map(|(_, value)| value)
    }

    /// The number of that name, in the unit of its parameter.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.get(name)?.number()
    }

    /// The numbers of that name, in the unit of their parameter.
    pub fn numbers(&self, name: &str) -> Option<Vec<f64>> {
        Some(self.get(name)?.list()?.iter().filter_map(Value::number).collect())
    }

    /// The vectors of that name, in the unit of their parameter.
    pub fn vectors(&self, name: &str) -> Option<Vec<[f64; 3]>> {
        let vector = |value: &Value| {
            let numbers: Vec<f64> = value.list()?.iter().filter_map(Value::number).collect();
            <[f64; 3]>::try_from(numbers).ok()
        };
        Some(self.get(name)?.list()?.iter().filter_map(vector).collect())
    }

    /// The number or numbers of joints of that name, in the unit of their parameter.
    pub fn by_joint(&self, name: &str) -> Option<ByJoint> {
        ByJoint::of(self.get(name)?)
    }

    /// The text of that name.
    pub fn text(&self, name: &str) -> Option<&str> {
        match self.get(name)? {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Whether that was given as true.
    pub fn flag(&self, name: &str) -> bool {
        self.get(name) == Some(&Value::Flag(true))
    }

    /// The names and values, in the order in which they stand.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Value)> {
        self.0.iter().map(|(name, value)| (name.as_str(), value))
    }

    /// How many were given.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether none was given.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Puts them into the order in which a kind has them; those that it does not have come last.
    pub fn sort_like(&mut self, known: &[Parameter]) {
        let place = |name: &str| known.iter().position(|own| own.name == name).unwrap_or(known.len());
        self.0.sort_by_key(|(name, _)| place(name));
    }
}

/// The order does not matter.
impl PartialEq for Parameters {
    fn eq(&self, other: &Self) -> bool {
        self.len() == other.len() && self.iter().all(|(name, value)| other.get(name) == Some(value))
    }
}

impl Serialize for Parameters {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter())
    }
}

impl<'de> Deserialize<'de> for Parameters {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(ParametersVisitor)
    }
}

struct ParametersVisitor;

impl<'de> Visitor<'de> for ParametersVisitor {
    type Value = Parameters;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table of parameters")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Parameters, A::Error> {
        let mut parameters = Parameters::new();
        while let Some((name, value)) = entries.next_entry::<String, Value>()? {
            parameters.set(&name, value);
        }
        Ok(parameters)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Form;
    use super::*;

    #[test]
    fn values_are_found_by_name_and_type() {
        let mut all =
            Parameters::new().with("a", [1.0, 2.0]).with("b", vec![[1.0, 2.0, 3.0]]).with("c", true);
        all.set("d", "word");
        assert_eq!(all.numbers("a").unwrap(), [1.0, 2.0]);
        assert_eq!(all.vectors("b").unwrap(), [[1.0, 2.0, 3.0]]);
        assert!(all.flag("c") && !all.flag("d") && all.number("a").is_none());
        assert_eq!((all.text("d"), all.text("c")), (Some("word"), None));
        all.remove("c");
        assert_eq!((all.len(), all.is_empty(), all.get("c")), (3, false, None));
    }

    #[test]
    fn they_are_the_same_in_any_order_and_are_written_in_that_of_their_kind() {
        let known = [
            Parameter::required("x", Form::Number, "m", "First."),
            Parameter::required("y", Form::Number, "m", "Second."),
        ];
        let mut given = Parameters::new().with("other", 3.0).with("y", 2.0).with("x", 1.0);
        let before = given.clone();
        given.sort_like(&known);
        assert_eq!(given, before);
        assert_eq!(given.iter().map(|(name, _)| name).collect::<Vec<_>>(), ["x", "y", "other"]);
        let written = serde_json::to_string(&given).unwrap();
        assert_eq!(written, r#"{"x":1.0,"y":2.0,"other":3.0}"#);
        assert_eq!(serde_json::from_str::<Parameters>(&written).unwrap(), given);
    }
}
