//! How redundancy is resolved, and how strongly the task error is fed back.

use serde::{Deserialize, Serialize};

use super::criterion_spec::CriterionSpec;
use super::error::ScenarioError;
use super::key_path::KeyPath;
use super::kind_reader::{KindTable, Misread, named};
use super::kinds::Kinds;
use kinstep::kind::{Parameters, Real};
use kinstep::law::{LAWS, Law, MakeCriterion, MakeLaw};

/// How redundancy is resolved, and how strongly the task error is fed back. At most one of `h` and `gain`;
/// without either, h is the formula's optimum.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(transform = super::kind_schema::laws))]
#[serde(expecting = "a table such as { h = 0.4 }")]
pub struct LawSpec {
    /// The law.
    #[serde(default = "first_law")]
    pub kind: String,
    /// Feedback step h, dimensionless: held fixed, the task error falls like sigma^(p+1).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub h: Option<Real>,
    /// Feedback gain k in 1/s: h = sigma k gamma(1).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain: Option<Real>,
    /// The parameters of its kind.
    #[serde(flatten)]
    #[cfg_attr(feature = "schema", schemars(skip))]
    pub parameters: Parameters,
    /// What the joints do where the tasks leave them free; criteria add up.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub criterion: Vec<CriterionSpec>,
}

fn first_law() -> String {
    LAWS.first().map_or("", |law| law.name).to_owned()
}

impl Default for LawSpec {
    /// The first built-in law without parameters.
    fn default() -> Self {
        Self { kind: first_law(), h: None, gain: None, parameters: Parameters::new(), criterion: Vec::new() }
    }
}

impl LawSpec {
    /// Reads the parameters of the law and of its criteria by their kinds.
    pub(super) fn read(&mut self, kinds: &Kinds) -> Vec<Misread> {
        let law = KeyPath::dotted("law");
        let table = law_table(&law, kinds, &self.kind);
        let mut misread: Vec<Misread> = table.read(&mut self.parameters).err().into_iter().collect();
        for (index, criterion) in self.criterion.iter_mut().enumerate() {
            let at = law.key("criterion").index(index);
            let table = criterion_table(&at, kinds, &criterion.kind);
            misread.extend(table.read(&mut criterion.parameters).err());
        }
        misread
    }

    /// Checks the parameters of the law and of its criteria by their kinds.
    pub(super) fn check_kinds(&self, kinds: &Kinds) -> Result<(), ScenarioError> {
        let law = KeyPath::dotted("law");
        let table = law_table(&law, kinds, &self.kind);
        let takes_criteria = table.named()?.make.takes_criteria();
        let keys: &[&str] = if takes_criteria { &["criterion"] } else { &[] };
        let given: &[&str] = if self.criterion.is_empty() { &[] } else { &["criterion"] };
        table.check(&self.parameters, (&["h", "gain"], keys, given), false)?;
        for (index, criterion) in self.criterion.iter().enumerate() {
            let at = law.key("criterion").index(index);
            let table = criterion_table(&at, kinds, &criterion.kind);
            table.check(&criterion.parameters, (&[], &[], &[]), false)?;
        }
        Ok(())
    }

    /// Returns the law of a system whose joints start at `q0` [rad or m].
    pub(super) fn law(&self, kinds: &Kinds, q0: &[f64]) -> Result<Box<dyn Law>, ScenarioError> {
        let at = KeyPath::dotted("law");
        let law = named(&kinds.laws, &at.key("kind"), &self.kind)?;
        let criterion = |(index, spec): (usize, &CriterionSpec)| {
            let at = at.key("criterion").index(index).key("kind");
            Ok((named(&kinds.criteria, &at, &spec.kind)?.make)(&spec.parameters, q0))
        };
        let criteria =
            self.criterion.iter().enumerate().map(criterion).collect::<Result<_, ScenarioError>>()?;
        Ok(law.make.law(&self.parameters, criteria))
    }
}

fn law_table<'a>(at: &'a KeyPath, kinds: &'a Kinds, kind: &'a str) -> KindTable<'a, MakeLaw> {
    KindTable { at, kinds: &kinds.laws, kind, keys: [&["kind", "h", "gain"], &["criterion"]] }
}

fn criterion_table<'a>(at: &'a KeyPath, kinds: &'a Kinds, kind: &'a str) -> KindTable<'a, MakeCriterion> {
    KindTable { at, kinds: &kinds.criteria, kind, keys: [&["kind"], &[]] }
}
