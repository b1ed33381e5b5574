//! Where a locked joint is held.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize};

use super::real::Real;

/// Where a locked joint is held: a position in rad or m or, of a joint with more than one degree of freedom, the pose
/// `[x, y, z, roll, pitch, yaw]` of its child after its origin (0 for none).
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum Held {
    /// A position in rad or m.
    Position(Real),
    /// Position in m, and roll, pitch and yaw in rad.
    Pose([Real; 6]),
}

impl Held {
    /// Returns the one or six numbers.
    pub fn numbers(&self) -> &[Real] {
        match self {
            Self::Position(position) => std::slice::from_ref(position),
            Self::Pose(pose) => pose,
        }
    }
}

impl<'de> Deserialize<'de> for Held {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(HeldVisitor)
    }
}

struct HeldVisitor;

impl<'de> serde::de::Visitor<'de> for HeldVisitor {
    type Value = Held;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a position, or a pose such as [0, 0, 1, 0, 0, \"pi/2\"] of six numbers")
    }

    fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Held, E> {
        Real::deserialize(serde::de::value::F64Deserializer::new(value)).map(Held::Position)
    }

    fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Held, E> {
        self.visit_f64(value as f64)
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Held, E> {
        Real::deserialize(serde::de::value::StrDeserializer::new(text)).map(Held::Position)
    }

    fn visit_seq<A: serde::de::SeqAccess<'de>>(self, mut list: A) -> Result<Held, A::Error> {
        let mut numbers: Vec<Real> = Vec::new();
        while let Some(number) = list.next_element()? {
            numbers.push(number);
        }
        let got = numbers.len();
        let wrong = |_| serde::de::Error::custom(format_args!("expected 6 numbers, got {got}"));
        numbers.try_into().map(Held::Pose).map_err(wrong)
    }
}
