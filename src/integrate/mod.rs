//! The one stepper: every row of the formula table runs through [`Multistep`], on plain ODEs and on arms.
//!
//! ```text
//! sum_{j=0..s} alpha_j x_{n+1-j} = sigma sum_j beta_j f_{n+1-j} + sigma sum_j gamma_j g_{n+1-j}
//! ```
//!
//! with `x' = f(t, x) + g(t, x)`, newest sample first (index `j` is time `n + 1 - j`; not the ascending order of
//! Hairer, Norsett and Wanner).
//!
//! | seam | what is behind it |
//! |---|---|
//! | [`Field`] | a right-hand side, and how to solve for the state of an implicit step |
//! | [`Method`] | rows, and how they work together: explicit, implicit, implicit-explicit, predictor and corrector |
//! | [`Coefficients`] | the weights of a row: fixed, or following the ratios of the last steps |
//! | [`Starter`] | the states before the first step of the recursion |
//! | [`StepController`] | whether a step is accepted, and how long the next one is |
//!
//! [`Multistep::new`] takes an explicit formula; [`Multistep::of_method`] takes any method.
//!
//! [`Solver`] solves a problem from its start to its end: within tolerances, by formulas of varying steps and order
//! ([`VariableOrder`]), or by any method in equal steps; with output times, events and dense output.

mod adaptive;
mod affine;
mod coefficients;
mod controller;
mod equations;
mod error;
mod field;
mod history;
mod method;
mod solve;
mod solver;
mod starter;
mod status;
mod stepper;

pub use crate::math::{Elementary, Scalar};
pub use adaptive::{Family, SolveStatus, Statistics, VariableOrder};
pub use affine::{Affine, Solved};
pub use coefficients::{Coefficients, RatioCoefficients, RatioRow, RowKind};
pub use controller::{Attempt, Decision, FixedStep, StepController};
pub use equations::{EquationError, EquationField, EquationText, Equations};
pub use error::IntegrateError;
pub use field::{Field, Ode, Parts};
pub use method::{Method, Mode};
pub use solve::FixedPoint;
pub use solver::{Direction, Event, Happening, Sample, Solution, Solver, StepRecord};
pub use starter::{Starter, StarterKind, Tableau};
pub use status::Status;
pub use stepper::Multistep;
