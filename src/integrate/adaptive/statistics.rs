use std::ops::AddAssign;

/// What a solution took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// Steps made.
    pub steps: usize,
    /// Steps attempted and not made.
    pub rejected: usize,
    /// Evaluations of the right-hand side, those for differences in place of a Jacobian among them.
    pub evaluations: usize,
    /// Jacobians.
    pub jacobians: usize,
    /// Factorisations of matrices.
    pub factorizations: usize,
    /// Steps made by formulas of each order; entry `k` is of order `k`.
    pub orders: [usize; 16],
}

impl AddAssign for Statistics {
    fn add_assign(&mut self, other: Self) {
        self.steps += other.steps;
        self.rejected += other.rejected;
        self.evaluations += other.evaluations;
        self.jacobians += other.jacobians;
        self.factorizations += other.factorizations;
        for (own, others) in self.orders.iter_mut().zip(other.orders) {
            *own += others;
        }
    }
}
