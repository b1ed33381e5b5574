//! Where a locked joint is held.

use std::fmt;

use serde::{Deserialize, Deserializer, Serialize};

use kinstep::kind::Real;

/// Where a locked joint is held: a position in rad or m or, of a joint with more than one degree of freedom, the pose
/// `[x, y, z, roll, pitch, yaw]` of its child after its origin (0 for none).
#[derive(Clone, Debug, PartialEq, Serialize)]
// The schema is a format of its own: the type keeps its first name there.
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(rename = "Held"))]
#[serde(untagged)]
pub enum LockPosition {
    /// A position in rad or m.
    Position(Real),
    /// Position in m, and roll, pitch and yaw in rad.
    Pose([Real; 6]),
}

impl LockPosition {
    /// Returns the one or six numbers.
    pub fn numbers(&self) -> &[Real] {
        match self {
            Self::Position(position) => std::slice::from_ref(position),
            Self::Pose(pose) => pose,
        }
    }
}

impl<'de> Deserialize<'de> for LockPosition {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(LockPositionVisitor)
    }
}

struct LockPositionVisitor;

impl<'de> serde::de::Visitor<'de> for LockPositionVisitor {
    type Value = LockPosition;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a position, or a pose such as [0, 0, 1, 0, 0, \"pi/2\"] of six numbers")
    }

    fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<LockPosition, E> {
        Real::deserialize(serde::de::value::F64Deserializer::new(value)).map(LockPosition::Position)
    }

    fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<LockPosition, E> {
        self.visit_f64(value as f64)
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<LockPosition, E> {
        Real::deserialize(serde::de::value::StrDeserializer::new(text)).map(LockPosition::Position)
    }

    fn visit_seq<A: serde::de::SeqAccess<'de>>(self, mut list: A) -> Result<LockPosition, A::Error> {
        let mut numbers: Vec<Real> = Vec::new();
        while let Some(number) = list.next_element()? {
            numbers.push(number);
        }
        let got = numbers.len();
        let wrong = |_| serde::de::Error::custom(format_args!("expected 6 numbers, got {got}"));
        numbers.try_into().map(LockPosition::Pose).map_err(wrong)
    }
}
