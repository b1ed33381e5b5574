//! Plans written down: one trait, one file per format.

use std::io::{self, Write};

use kinstep::planner::Plan;

/// A format that a plan can be written in. A new format is a file with one implementation.
pub trait PlanFormat {
    /// Writes the plan.
    ///
    /// # Errors
    /// What the writer says.
    fn write(&self, plan: &Plan, out: &mut dyn Write) -> io::Result<()>;
}
