use super::affine::{Affine, Solved};
use crate::math::Scalar;

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

    /// Solves `x = known + first f(t, x) + second g(t, x)` for the next state `x` at its time `t`, as implicit rows need it;
    /// see [`Affine`] for what `known`, `first` and `second` are. On entry `x` holds a first guess.
    ///
    /// Unless overridden it returns [`Solved::NotOffered`], and the stepper iterates the equation itself
    /// ([`FixedPoint`](super::FixedPoint)), which converges as long as `first` and `second` times the Lipschitz constants of
    /// `f` and `g` stay below one. Where it does not, and `second` is zero, Newton's method takes over. A field that can solve exactly, or by an iteration of its own, does
    /// so here. An override should not allocate, returns [`Solved::NotConverged`] where it finds nothing, and does not panic.
    ///
    /// ```
    /// use kinstep::formula::FormulaTable;
    /// use kinstep::integrate::{Affine, Field, Method, Multistep, Solved, Starter};
    ///
    /// /// `x' = -rate x`, of which every implicit step can be solved for `x`.
    /// struct Decay {
    ///     rate: f64,
    /// }
    ///
    /// impl Field<f64> for Decay {
    ///     fn dimension(&self) -> usize {
    ///         1
    ///     }
    ///     fn evaluate(&mut self, _t: f64, x: &[f64], f: &mut [f64], _g: &mut [f64]) {
    ///         f[0] = -self.rate * x[0];
    ///     }
    ///     fn solve(&mut self, _t: f64, next: Affine<'_, f64>, x: &mut [f64]) -> Solved {
    ///         x[0] = next.known[0] / (1.0 + next.first * self.rate);
    ///         Solved::Converged
    ///     }
    /// }
    ///
    /// let mut field = Decay { rate: 1e6 };
    /// let method = Method::of(FormulaTable::builtin().get("bdf1")?);
    /// let mut solution = Multistep::of_method(method, &Starter::Rk4, &field, 0.0, 0.1, &[1.0])?;
    /// for _ in 0..10 {
    ///     solution.step(&mut field);
    /// }
    /// assert!(solution.state()[0].abs() < 1e-40);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    fn solve(&mut self, _t: T, _next: Affine<'_, T>, _x: &mut [T]) -> Solved {
        Solved::NotOffered
    }

    /// Writes the derivatives `df_i/dx_j` at `(t, x)` to `jacobian[i * dimension + j]`, and returns whether it did.
    ///
    /// Unless overridden it does not, and differences of [`evaluate`](Field::evaluate) take its place where an implicit step is solved
    /// by Newton's method.
    fn jacobian(&mut self, _t: T, _x: &[T], _jacobian: &mut [T]) -> bool {
        false
    }
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
