//! Solving for the next state, `x = known + first f(t, x) + second g(t, x)`, where the field does not do it itself.
//!
//! One file for each way of solving.

mod error_norm;
mod fixed_point;
mod iteration;
mod newton;

pub(super) use error_norm::ErrorNorm;
pub use fixed_point::FixedPoint;
pub(super) use iteration::Iteration;
pub(super) use newton::Newton;
