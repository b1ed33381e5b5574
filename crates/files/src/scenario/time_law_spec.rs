//! How a path is travelled in time.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::error::ScenarioError;
use super::key_path::KeyPath;
use super::kind_reader::{KindTable, Misread, named};
use super::kinds::Kinds;
use kinstep::kind::{Parameters, Value};
use kinstep::task::{MakeTimeLaw, TimeLaw};

/// A time law, by its name alone or with its parameters: `"quintic"`, `{ kind = "trapezoid", ramp = 0.2 }`.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeLawSpec {
    /// Kind of time law.
    pub kind: String,
    /// The parameters of its kind.
    pub parameters: Parameters,
}

/// The same as a table.
#[derive(Serialize, Deserialize)]
struct Table {
    kind: String,
    #[serde(flatten)]
    parameters: Parameters,
}

impl TimeLawSpec {
    /// Returns the time law of that name with no parameter yet.
    pub fn new(kind: &str) -> Self {
        Self { kind: kind.to_owned(), parameters: Parameters::new() }
    }

    /// Returns the same with a parameter of its kind.
    #[must_use]
    pub fn with(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.parameters.set(name, value);
        self
    }

    /// Makes the law, if there is one of that name.
    pub(super) fn law(&self, kinds: &Kinds) -> Option<Box<dyn TimeLaw>> {
        kinds.time_laws.get(&self.kind).map(|kind| (kind.make)(&self.parameters))
    }

    /// Reads the parameters by their kind.
    pub(super) fn read(&mut self, at: &KeyPath, kinds: &Kinds) -> Result<(), Misread> {
        // A name that stands alone has no key of its own.
        let known = named(&kinds.time_laws, at, &self.kind).map(|_| ());
        known.map_err(|error| Misread { error, is_of_key: false })?;
        let mut parameters = std::mem::take(&mut self.parameters);
        let read = self.table(at, kinds).read(&mut parameters);
        self.parameters = parameters;
        read
    }

    fn table<'a>(&'a self, at: &'a KeyPath, kinds: &'a Kinds) -> KindTable<'a, MakeTimeLaw> {
        KindTable { at, kinds: &kinds.time_laws, kind: &self.kind, keys: [&["kind"], &[]] }
    }

    /// Checks that the law has the parameters of its kind and no others.
    pub(super) fn check(&self, at: &KeyPath, kinds: &Kinds) -> Result<(), ScenarioError> {
        named(&kinds.time_laws, at, &self.kind)?;
        self.table(at, kinds).check(&self.parameters, (&[], &[], &[]), false)
    }
}

impl Serialize for TimeLawSpec {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.parameters.is_empty() {
            return serializer.serialize_str(&self.kind);
        }
        let Self { kind, parameters } = self.clone();
        Table { kind, parameters }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for TimeLawSpec {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(TimeLawVisitor)
    }
}

struct TimeLawVisitor;

impl<'de> serde::de::Visitor<'de> for TimeLawVisitor {
    type Value = TimeLawSpec;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the name of a time law, or a table such as { kind = \"trapezoid\", ramp = 0.2 }")
    }

    fn visit_str<E>(self, name: &str) -> Result<TimeLawSpec, E> {
        Ok(TimeLawSpec::new(name))
    }

    fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<TimeLawSpec, A::Error> {
        let Table { kind, parameters } = Table::deserialize(MapAccessDeserializer::new(map))?;
        Ok(TimeLawSpec { kind, parameters })
    }
}

#[cfg(feature = "schema")]
impl schemars::JsonSchema for TimeLawSpec {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "TimeLawSpec".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        super::kind_schema::time_laws()
    }
}
