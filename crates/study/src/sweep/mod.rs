//! Sweeps: one scenario many times, with values from lists and distributions, into one table.
//!
//! Cases are counted through, and what a case is follows from its number alone: so the table has the same bytes however many threads
//! made it, and a sweep that was interrupted goes on where it stopped.

mod axis;
mod case;
mod journal;
mod read;
mod run;

pub use axis::{Axis, AxisError};
pub use case::{Case, Figures, Record, Sweep};
pub use read::{SweepRow, SweepTable};
pub use run::{Progress, SweepError, Swept, Table, run};
