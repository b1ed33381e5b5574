//! Who says whether a step is accepted, and how long the next one is.
//!
//! One file for each controller; a controller of your own implements [`StepController`].

mod fixed_step;
mod step_controller;

pub use fixed_step::FixedStep;
pub use step_controller::{Attempt, Decision, StepController};
