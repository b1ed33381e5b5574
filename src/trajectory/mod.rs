//! Joint trajectories after a run: with the robots that move and with where they come from, as they are handed on.
//!
//! [`Trajectory`] holds the samples of all arms on one clock, [`About`] says what made it, [`Stage`] has the robots. A
//! [`TrajectoryFormat`] writes a [`Recording`] of the three; every format is a file with one implementation.

mod about;
mod csv;
mod format;
mod stage;
#[expect(clippy::module_inception, reason = "the file is named after the type that it holds")]
mod trajectory;

pub use about::About;
pub use csv::Csv;
pub use format::{Recording, TrajectoryFormat};
pub use stage::{Machine, Stage, StagedArm};
pub use trajectory::{ArmTrajectory, Trajectory};
