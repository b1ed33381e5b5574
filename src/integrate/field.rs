use super::Scalar;

/// What the second part `g` of a right-hand side means to a starter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parts {
    /// `x' = f(t, x)`: there is no `g`, and rows use `beta` alone.
    One,
    /// `g` is a feedback that vanishes on the exact solution. Its gain grows as the step shrinks, so one-step
    /// starters leave it out until the recursion begins: with it in their stages the start would drop to order two.
    Feedback,
    /// `g` is part of the dynamics (additive and implicit-explicit splittings); starters integrate `f + g`.
    Additive,
}

/// A right-hand side in two parts, `x' = f(t, x) + g(t, x)`.
pub trait Field<T> {
    /// Number of components of the state.
    fn dimension(&self) -> usize;

    /// What `g` is; [`Parts::One`] unless overridden.
    fn parts(&self) -> Parts {
        Parts::One
    }

    /// Writes `f(t, x)` and, unless [`parts`](Field::parts) is [`Parts::One`], `g(t, x)`.
    ///
    /// All slices have [`dimension`](Field::dimension) entries, except that `g` is empty for [`Parts::One`].
    fn evaluate(&mut self, t: T, x: &[T], f: &mut [T], g: &mut [T]);
}

/// A plain ODE `x' = f(t, x)` given by a closure `|t, x, derivative|`.
///
/// ```
/// use kinstep::formula::FormulaTable;
/// use kinstep::integrate::{Multistep, Ode, Starter};
///
/// let formula = FormulaTable::builtin().get("la6-wang-guo")?;
/// let mut decay = Ode::new(1, |_t, x: &[f64], derivative: &mut [f64]| derivative[0] = -x[0]);
/// let mut solution = Multistep::new(formula, &Starter::Rk4, &decay, 0.0, 0.01, &[1.0])?;
/// for _ in 0..100 {
///     solution.step(&mut decay);
/// }
/// assert!((solution.state()[0] - (-1.0_f64).exp()).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Ode<F> {
    dimension: usize,
    right_hand_side: F,
}

impl<F> Ode<F> {
    /// The field of `dimension` components whose derivative the closure writes.
    pub fn new(dimension: usize, right_hand_side: F) -> Self {
        Self { dimension, right_hand_side }
    }
}

impl<T: Scalar, F: FnMut(T, &[T], &mut [T])> Field<T> for Ode<F> {
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn evaluate(&mut self, t: T, x: &[T], f: &mut [T], _g: &mut [T]) {
        (self.right_hand_side)(t, x, f);
    }
}
