use super::{Criterion, Law};
use crate::kind::{Kind, Parameters};

/// A law that files can name.
pub type LawKind = Kind<MakeLaw>;

/// How a law is made of its parameters.
#[derive(Clone, Copy, Debug)]
pub enum MakeLaw {
    /// A law without null-space criteria.
    Plain(fn(&Parameters) -> Box<dyn Law>),
    /// A law to which the criteria are handed that the file names beside it, if any.
    WithCriteria(fn(&Parameters, Vec<Box<dyn Criterion>>) -> Box<dyn Law>),
}

impl MakeLaw {
    /// Whether null-space criteria may be named beside it.
    pub fn takes_criteria(&self) -> bool {
        matches!(self, Self::WithCriteria(_))
    }

    /// Returns the law; criteria that it does not take are left out.
    pub fn law(&self, given: &Parameters, criteria: Vec<Box<dyn Criterion>>) -> Box<dyn Law> {
        match self {
            Self::Plain(make) => make(given),
            Self::WithCriteria(make) => make(given, criteria),
        }
    }
}
