use super::differences::Differences;
use super::order_choice::Errors;
use crate::integrate::field::Field;
use crate::integrate::solve::ErrorNorm;
use crate::math::Scalar;

/// A step by the rows of Adams and Bashforth of order k and of Adams and Moulton of order k + 1, in the mode PECE.
///
/// With the differences `phi_i` of the derivatives and `g_i` the integral over the step of the Newton polynomials, divided by `h`,
///
/// ```text
/// p = x_n + h sum_{i<=k} g_i phi*_i        phi*_i = beta_i phi_i(n)
/// x_{n+1} = p + h g_{k+1} (f(t_{n+1}, p) - sum_{i<=k} phi*_i)
/// ```
///
/// The error of order m is `h (g_m - g_{m+1}) phi_{m+1}(n+1)`, the difference of the correctors of orders m and m + 1. (Shampine
/// and Gordon, Computer Solution of Ordinary Differential Equations, 1975, chapters 3 and 5.)
#[derive(Clone, Debug)]
pub(super) struct Adams<T> {
    /// `g_{i+1}`, and the memory for computing them.
    g: Vec<T>,
    integrals: Vec<T>,
    ones: Vec<T>,
    /// What the polynomial through the past has for a derivative at `t_{n+1}`.
    extrapolated: Vec<T>,
    /// What the derivative of the prediction is more than that.
    top: Vec<T>,
    derivative: Vec<T>,
    prediction: Vec<T>,
    lipschitz: f64,
}

impl<T: Scalar> Adams<T> {
    pub(super) fn new(highest: usize, dimension: usize) -> Self {
        let vector = || vec![T::zero(); dimension];
        let row = |entry: T| vec![entry; highest + 3];
        Self {
            g: row(T::zero()),
            integrals: row(T::zero()),
            ones: row(T::one()),
            extrapolated: vector(),
            top: vector(),
            derivative: vector(),
            prediction: vector(),
            lipschitz: 0.0,
        }
    }

    /// Attempts the step of order `order` and length `h` to the time `t`; returns its errors, or nothing where it is not finite.
    pub(super) fn attempt(
        &mut self,
        field: &mut impl Field<T>,
        past: &Differences<T>,
        norm: &ErrorNorm,
        step: Step<'_, T>,
        next: &mut [T],
    ) -> Option<Errors> {
        let Step { t, h, order, from } = step;
        let count = (order + 2).min(past.known() + 1);
        self.integrate_polynomials(&past.alpha, count);
        past.combine(order, &self.g, &mut self.prediction);
        past.combine(order, &self.ones, &mut self.extrapolated);
        for (entry, &from) in self.prediction.iter_mut().zip(from) {
            *entry = from + h * *entry;
        }
        field.evaluate(t, &self.prediction, &mut self.derivative, &mut []);
        let weight = h * self.g[order];
        for i in 0..next.len() {
            self.top[i] = self.derivative[i] - self.extrapolated[i];
            next[i] = self.prediction[i] + weight * self.top[i];
        }
        let errors = self.errors(past, norm, h, order);
        errors.own.is_finite().then_some(errors)
    }

    /// Evaluates the corrected state, and remembers that.
    pub(super) fn accept(
        &mut self,
        field: &mut impl Field<T>,
        past: &mut Differences<T>,
        norm: &ErrorNorm,
        (t, order): (T, usize),
        state: &[T],
    ) {
        field.evaluate(t, state, &mut self.derivative, &mut []);
        let moved = norm.of(|i| state[i] - self.prediction[i]);
        let changed = norm.of(|i| self.derivative[i] - self.extrapolated[i] - self.top[i]);
        self.lipschitz = if moved > 0.0 { changed / moved } else { 0.0 };
        for i in 0..state.len() {
            self.top[i] = self.derivative[i] - self.extrapolated[i];
        }
        past.commit(order, &mut self.top);
    }

    fn errors(&self, past: &Differences<T>, norm: &ErrorNorm, h: T, order: usize) -> Errors {
        let constant = |order: usize| h * (self.g[order - 1] - self.g[order]);
        let own = norm.of(|i| constant(order) * self.top[i]);
        let lower = (order > 1).then(|| {
            let (constant, beta, below) = (constant(order - 1), past.beta[order - 1], past.row(order - 1));
            norm.of(|i| constant * (self.top[i] + beta * below[i]))
        });
        let higher = (past.known() > order).then(|| {
            let (constant, beta, below) = (constant(order + 1), past.beta[order], past.row(order));
            norm.of(|i| constant * (self.top[i] - beta * below[i]))
        });
        Errors { own, lower, higher }
    }

    /// Computes the first `count` of the `g_i`, by integration by parts.
    fn integrate_polynomials(&mut self, alpha: &[T], count: usize) {
        for (q, entry) in self.integrals.iter_mut().enumerate().take(count) {
            *entry = T::one() / T::from_index((q + 1) * (q + 2));
        }
        self.g[0] = T::one();
        self.g[1] = self.integrals[0];
        for i in 2..count {
            for q in 0..count - i {
                self.integrals[q] = self.integrals[q] - alpha[i - 1] * self.integrals[q + 1];
            }
            self.g[i] = self.integrals[0];
        }
    }

    /// An estimate of the rate at which derivatives change with the state: what the last correction changed of the derivative, over
    /// what it changed of the state.
    pub(super) fn lipschitz(&self) -> f64 {
        self.lipschitz
    }
}

/// A step that is attempted.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step<'a, T> {
    /// The time at its end.
    pub(super) t: T,
    /// Its length.
    pub(super) h: T,
    /// The order of the row.
    pub(super) order: usize,
    /// The state at its beginning.
    pub(super) from: &'a [T],
}
