//! How the first states come about, before a row of several steps can run: one file for each starter.
//!
//! [`StarterKind::ALL`] lists those that have a name; everything that offers starters by name walks it.

mod given;
mod kind;
mod paper;
mod ramp;
mod runge_kutta;
mod running;
#[expect(clippy::module_inception, reason = "the file is named after the one type it holds")]
mod starter;
mod tableau;

pub use kind::StarterKind;
pub use starter::Starter;
pub use tableau::Tableau;

pub(super) use running::RunningStarter;
