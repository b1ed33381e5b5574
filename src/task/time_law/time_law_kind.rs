use super::TimeLaw;
use crate::kind::{Kind, Parameters};

/// Makes a time law of its parameters.
pub type MakeTimeLaw = fn(&Parameters) -> Box<dyn TimeLaw>;

/// A time law that files can name.
pub type TimeLawKind = Kind<MakeTimeLaw>;
