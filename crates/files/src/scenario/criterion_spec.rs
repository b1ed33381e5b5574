//! A null-space criterion beside a law.

use serde::{Deserialize, Serialize};

use kinstep::kind::Parameters;

/// What the joints do where the tasks leave them free.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(transform = super::kind_schema::criteria))]
#[serde(expecting = "a table such as { kind = \"posture\", rate = 1 }")]
pub struct CriterionSpec {
    /// The criterion.
    pub kind: String,
    /// The parameters of its kind.
    #[serde(flatten)]
    #[cfg_attr(feature = "schema", schemars(skip))]
    pub parameters: Parameters,
}

impl CriterionSpec {
    /// Returns a criterion of that kind without parameters.
    pub fn new(kind: &str) -> Self {
        Self { kind: kind.to_owned(), parameters: Parameters::new() }
    }
}
