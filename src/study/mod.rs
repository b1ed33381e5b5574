//! Order studies: what order a run really shows, measured where it can be measured and withheld where it can not.
//!
//! Observed orders are easily measured badly: end points cancel, start-up transients hide schemes, round-off floors spoil
//! slopes, a shortened last step ruins them. An [`OrderStudy`] runs a [`Ladder`] of sampling gaps that all divide the
//! duration, takes the largest error along each run (and along its second half), names the rungs that are left
//! out and why, and ends in a [`Verdict`].

mod convergence;
mod ladder;
mod order;
mod problem;
mod round_off;
mod samples;
#[cfg(feature = "proptest")]
pub mod strategies;

pub use convergence::{Convergence, Criteria, Mark, Undecidable, Verdict};
pub use ladder::{Ladder, LadderError, Rung};
pub use order::{OrderReport, OrderStudy, Orders};
pub use problem::Problem;
pub use round_off::jitter;
pub use samples::{Errors, Samples};
