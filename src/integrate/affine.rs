/// The next state as a function of itself, `x = known + first f(t, x) + second g(t, x)`, t being its time: what an implicit row leaves to be solved.
///
/// | row | `first` | `second` |
/// |---|---|---|
/// | implicit, `x' = f` | `sigma beta_0` | 0 |
/// | implicit, `x' = f + g` | `sigma beta_0` | `sigma gamma_0` |
/// | implicit-explicit | 0 | `sigma gamma_0` |
///
/// with `alpha_0 = 1`; `known` is everything that past states and evaluations contribute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine<'a, T> {
    /// What is known of the next state, as many entries as the state has.
    pub known: &'a [T],
    /// What multiplies `f(t, x)`, in units of time.
    pub first: T,
    /// What multiplies `g(t, x)`, in units of time; zero where the field has no `g`.
    pub second: T,
}

/// What became of the attempt to solve for a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solved {
    /// The state was found.
    Converged,
    /// It was not: the equation may have no solution, or the iteration did not get there.
    NotConverged,
    /// The field has no way of its own to solve; the stepper's built-in one is to be used.
    NotOffered,
}
