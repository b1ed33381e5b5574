//! Initial value problems written as text: `x' = y`, in doubles or with 32 digits.

mod compiled;
mod parse;
mod problem;
mod token;

pub use compiled::EquationField;
pub use problem::{EquationError, EquationText, Equations};
