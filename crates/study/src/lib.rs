//! Order studies: what order a run really shows, measured where it can be measured and withheld where it can not.
//!
//! Observed orders are easily measured badly: end points cancel, start-up transients hide schemes, round-off floors spoil
//! slopes, a shortened last step ruins them. An [`OrderStudy`] runs a [`Ladder`] of sampling gaps that all divide the
//! duration, takes the largest error along each run (and along its second half), names the rungs that are left
//! out and why, and ends in a [`Verdict`].

mod assertions;
mod blame;
mod convergence;
mod equations;
mod fit;
mod ladder;
mod measure;
mod order;
mod problem;
mod reference;
mod round_off;
mod samples;
mod scenario;
mod soundness;
mod stability;
#[cfg(feature = "proptest")]
pub mod strategies;
pub mod sweep;

pub use convergence::{Convergence, Criteria, Mark, Undecidable, Verdict};
pub use fit::Fit;
pub use ladder::{Ladder, LadderError, Rung};
pub use measure::Measure;
pub use order::{OrderReport, OrderStudy, Orders};
pub use problem::Problem;
pub use reference::Reference;
pub use round_off::jitter;
pub use samples::{Errors, Samples};
pub use scenario::{RowStudy, ScenarioStudy, Studied};
