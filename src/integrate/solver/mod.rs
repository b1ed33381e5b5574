//! A problem solved from its start to its end: closures in, a [`Solution`] out.

mod choice;
mod counted;
mod crossing;
mod engine;
mod event;
mod fixed_steps;
mod run;
mod solution;
#[expect(clippy::module_inception, reason = "the file is named after the one type it holds")]
mod solver;

pub use event::{Direction, Event};
pub use solution::{Happening, Sample, Solution, StepRecord};
pub use solver::Solver;
