//! Strategies for property tests with proptest: random formulas, serial arms, trees, configurations away from or near to
//! singularity, and paths.
//!
//! Everything is made through the doors that people use (rows as TOML, robots as URDF), and shrinks to few joints, small
//! numbers and round figures. Whole order studies of them are strategies of the package `kinstep-study`.
//!
//! ```
//! use kinstep_strategies::arms;
//! use proptest::strategy::{Strategy, ValueTree};
//! use proptest::test_runner::TestRunner;
//!
//! let mut runner = TestRunner::deterministic();
//! let arm = arms().new_tree(&mut runner)?.current();
//! println!("{arm}"); // a robot file, and where its joints stand
//! assert!(arm.chain().is_some());
//! # Ok::<(), proptest::test_runner::Reason>(())
//! ```

mod arm;
mod configuration;
mod formula;
mod path;
mod rational;
mod tree;

pub use arm::{ArmCase, JointCase, arms};
pub use configuration::{ConfigurationCase, away_from_singularity, towards_singularity};
pub use formula::{
    FormulaCase, adams_like, feedback_steps, formulas, from_table, look_ahead, overshooting_steps,
    unstable_formulas,
};
pub use path::{PathCase, Shape, TimeLawCase, open_paths, paths, time_laws};
pub use tree::{ChainCase, Follower, TreeCase, TreeJoint, chains, trees};
