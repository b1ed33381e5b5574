//! Strategies for property tests with proptest: random formulas, serial arms, trees, configurations away from or near to
//! singularity, paths, and whole order studies of them.
//!
//! Everything is made through the doors that people use (rows as TOML, robots as URDF), shrinks to few joints, small
//! numbers and round figures; a whole study prints a scenario file, robot and row inside, that does it again.
//!
//! ```
//! use kinstep::study::strategies::order_at_fixed_step;
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

mod arm;
mod case;
mod configuration;
mod formula;
mod path;
mod rational;
mod tree;

pub use arm::{ArmCase, JointCase, arms};
pub use case::{OrderCase, UnstableCase, diverging, order_at_fixed_gain, order_at_fixed_step};
pub use configuration::{ConfigurationCase, away_from_singularity, towards_singularity};
pub use formula::{
    FormulaCase, adams_like, feedback_steps, formulas, from_table, look_ahead, overshooting_steps,
    unstable_formulas,
};
pub use path::{PathCase, Shape, TimeLawCase, open_paths, paths, time_laws};
pub use tree::{ChainCase, Follower, TreeCase, TreeJoint, chains, trees};
