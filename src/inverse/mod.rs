//! Inverse kinematics: joint positions that bring a tip where it is asked to be, within limits.
//!
//! [`Search::solve`] takes a chain and a [`Target`] (a pose, a position, or a position and the direction of the tip's
//! axis) and tries many starting places, always the same ones. An answer is checked by forward kinematics; where there
//! is none, the [`Solution`] tells how near the tip came, and where.

mod descent;
mod nearest;
mod search;
mod starts;
mod target;

pub use search::{Search, SearchError, Solution};
pub use target::Target;
