use super::Criterion;
use crate::kind::{Kind, Parameters};

/// A null-space criterion that files can name.
pub type CriterionKind = Kind<MakeCriterion>;

/// Makes a criterion of its parameters and of the positions [rad or m] at which the joints of its system start.
pub type MakeCriterion = fn(&Parameters, &[f64]) -> Box<dyn Criterion>;
