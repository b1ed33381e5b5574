use super::{Criterion, Law};
use crate::kind::{Kind, Parameters};

/// A law that files can name.
pub type LawKind = Kind<MakeLaw>;

/// The null-space criteria that a file names beside a law, in its order.
pub type Criteria = Vec<Box<dyn Criterion>>;

/// How a law is made of its parameters.
#[derive(Clone, Copy, Debug)]
pub enum MakeLaw {
    /// A law without null-space criteria.
    Plain(fn(&Parameters) -> Box<dyn Law>),
    /// A law to which the criteria are handed that the file names beside it, if any.
    WithCriteria(fn(&Parameters, Criteria) -> Box<dyn Law>),
}

impl MakeLaw {
    /// Whether null-space criteria may be named beside it.
    pub fn takes_criteria(&self) -> bool {
        matches!(self, Self::WithCriteria(_))
    }

    /// Returns the law; criteria that it does not take are left out.
    pub fn law(&self, given: &Parameters, criteria: Criteria) -> Box<dyn Law> {
        match self {
            Self::Plain(make) => make(given),
            Self::WithCriteria(make) => make(given, criteria),
        }
    }
}
