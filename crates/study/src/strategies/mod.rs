//! Strategies for property tests with proptest: whole order studies of random formulas on random arms and paths, and all that
//! they are made of ([`kinstep_strategies`]).
//!
//! Everything is made through the doors that people use (rows as TOML, robots as URDF), shrinks to few joints, small
//! numbers and round figures; a whole study prints a scenario file, robot and row inside, that does it again.
//!
//! ```
//! use kinstep_study::strategies::order_at_fixed_step;
//! use proptest::strategy::{Strategy, ValueTree};
//! use proptest::test_runner::TestRunner;
//!
//! let mut runner = TestRunner::deterministic();
//! let case = order_at_fixed_step().new_tree(&mut runner).unwrap().current();
//! println!("{case}"); // a scenario file for `kinstep order`
//! let report = case.study()?;
//! assert!(!report.task_transient.as_ref().is_some_and(|seen| seen.verdict.is_not_reached()), "{case}\n{report}");
//! # Ok::<(), kinstep::planner::PlannerError>(())
//! ```

mod case;
mod path_spec;

pub use case::{OrderCase, UnstableCase, diverging, order_at_fixed_gain, order_at_fixed_step};
pub use kinstep_strategies::*;
pub use path_spec::path_spec;
