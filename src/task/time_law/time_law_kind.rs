use super::TimeLaw;
use crate::kind::Kind;

/// A time law that files can name; it takes no parameters.
pub type TimeLawKind = Kind<fn() -> Box<dyn TimeLaw>>;
