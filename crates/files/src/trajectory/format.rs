//! What every format of trajectories offers.

use std::io::{self, Write};

use super::{Refusal, Stage, Trajectory};

/// A trajectory and the robots that move along it.
#[derive(Clone, Copy, Debug)]
pub struct Recording<'a> {
    /// The samples.
    pub trajectory: &'a Trajectory,
    /// The robots.
    pub stage: &'a Stage,
}

/// A format that trajectories are handed on in. A new format is a file with one implementation.
pub trait TrajectoryFormat {
    /// Says whether the trajectory can be written in this format, before anything is.
    ///
    /// # Errors
    /// [`Refusal`] where those who read the format would not take it.
    fn check(&self, recording: Recording<'_>) -> Result<(), Refusal> {
        let _ = recording;
        Ok(())
    }

    /// Writes the trajectory.
    ///
    /// # Errors
    /// What the writer says.
    fn write(&self, recording: Recording<'_>, out: &mut dyn Write) -> io::Result<()>;
}
