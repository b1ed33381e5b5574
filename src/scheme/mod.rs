//! Schemes with a name: a row, a law and a start put together, with no algorithm of their own.

use crate::formula::{Formula, FormulaTable};
use crate::integrate::Starter;
use crate::planner::{Arm, Planner, PlannerBuilder};

/// The DTSMP scheme, eq. (9) of T. Wang and D. Guo, IEEE Access 8 (2020): five steps, `O(sigma^4)` at fixed `h`,
/// stable for `h` in (0, 2/3), started by four Euler steps as in the paper.
///
/// Set the duration and build. A `start` set afterwards replaces the paper's.
pub fn dtsmp(arms: impl IntoIterator<Item = Arm>, sigma: f64, h: f64) -> PlannerBuilder {
    scheme("la6-wang-guo", arms, sigma, h).start(Starter::Paper)
}

/// The Euler scheme, eq. (13) of the same paper: `O(sigma^2)` at fixed `h`, stable for `h` in (0, 2).
pub fn euler(arms: impl IntoIterator<Item = Arm>, sigma: f64, h: f64) -> PlannerBuilder {
    scheme("la2-euler", arms, sigma, h)
}

/// The split scheme of order `p` from 1 to 8: Adams-Bashforth on the feedforward velocity, feedback on the newest state
/// only, so that `h = 1` is deadbeat and `h` may lie in (0, 2). `None` for other orders.
pub fn split(p: usize, arms: impl IntoIterator<Item = Arm>, sigma: f64, h: f64) -> Option<PlannerBuilder> {
    let row = FormulaTable::builtin().get(&format!("split-ab{p}")).ok()?;
    Some(with_row(row, arms, sigma, h))
}

fn scheme(id: &str, arms: impl IntoIterator<Item = Arm>, sigma: f64, h: f64) -> PlannerBuilder {
    let row = FormulaTable::builtin()
        .get(id)
        .expect("the built-in table holds the rows that schemes are named after");
    with_row(row, arms, sigma, h)
}

fn with_row(row: &Formula, arms: impl IntoIterator<Item = Arm>, sigma: f64, h: f64) -> PlannerBuilder {
    Planner::builder().formula(row).sigma(sigma).h(h).arms(arms)
}
