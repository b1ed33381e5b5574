//! Solving for the next state, `x = known + first f(t, x) + second g(t, x)`, where the field does not do it itself.
//!
//! One file for each way of solving.

mod fixed_point;

pub use fixed_point::FixedPoint;
