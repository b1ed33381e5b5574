//! Small strictly convex quadratic programs: the point nearest to a target that satisfies equalities, bounds and inequalities.

mod active_set;
mod factors;
mod problem;
mod solver;
#[cfg(test)]
mod tests;

pub(crate) use problem::dot;
pub use problem::{Constraint, LeastDistance, NoSolution};
pub use solver::{LeastDistanceSolver, Solved};
