use super::adams::Step;
use super::differences::Differences;
use super::order_choice::Errors;
use crate::integrate::affine::{Affine, Solved};
use crate::integrate::field::Field;
use crate::integrate::solve::{ErrorNorm, Newton};
use crate::math::Scalar;

/// A step of backward differentiation of order k with variable coefficients and fixed leading coefficient.
///
/// The polynomial through the past `k + 1` states predicts `p = sum_i phi*_i` and the derivative `p' = sum_i gamma_i phi*_i`; the
/// corrector's derivative at `t_{n+1}` is `p' + alpha_s / h (x - p)` with `alpha_s = 1 + 1/2 + ... + 1/k`, so that
///
/// ```text
/// x = p - h/alpha_s p' + h/alpha_s f(t_{n+1}, x)
/// ```
///
/// and `x - p` tells the errors. (Brenan, Campbell and Petzold, Numerical Solution of Initial-Value Problems in
/// Differential-Algebraic Equations, sections 5.2.1, 5.2.3 and 5.2.4.)
#[derive(Clone, Debug)]
pub(super) struct BackwardDifferentiation<T> {
    ones: Vec<T>,
    /// `gamma_{i+1}`, of the predicted derivative.
    gamma: Vec<T>,
    /// `sigma_{i+1}`: takes `phi_{i+1}` to the scaled derivative `h^i x^(i) / i` of the order below.
    sigma: Vec<T>,
    known: Vec<T>,
    prediction: Vec<T>,
    /// What the state is more than predicted.
    top: Vec<T>,
    pub(super) newton: Newton<T>,
}

impl<T: Scalar> BackwardDifferentiation<T> {
    pub(super) fn new(highest: usize, dimension: usize) -> Self {
        let vector = || vec![T::zero(); dimension];
        let row = |entry: T| vec![entry; highest + 4];
        Self {
            ones: row(T::one()),
            gamma: row(T::zero()),
            sigma: row(T::zero()),
            known: vector(),
            prediction: vector(),
            top: vector(),
            newton: Newton::new(dimension),
        }
    }

    /// Attempts the step; returns its errors, or what became of the equation where it was not solved.
    pub(super) fn attempt(
        &mut self,
        field: &mut impl Field<T>,
        past: &Differences<T>,
        norm: &ErrorNorm,
        step: Step<'_, T>,
        next: &mut [T],
    ) -> Option<Errors> {
        let Step { t, h, order, .. } = step;
        self.prepare(&past.alpha, h, order + 1);
        past.combine(order + 1, &self.ones, &mut self.prediction);
        past.combine(order + 1, &self.gamma, &mut self.known);
        let leading = (1..=order).fold(T::zero(), |sum, i| sum + T::one() / T::from_index(i));
        let first = h / leading;
        for (known, &prediction) in self.known.iter_mut().zip(&self.prediction) {
            *known = prediction - first * *known;
        }
        next.copy_from_slice(&self.prediction);
        let affine = Affine { known: &self.known, first, second: T::zero() };
        let solved = match field.solve(t, affine, next) {
            Solved::NotOffered => self.newton.solve(field, norm, t, affine, next),
            solved => solved,
        };
        if solved != Solved::Converged {
            return None;
        }
        for i in 0..next.len() {
            self.top[i] = next[i] - self.prediction[i];
        }
        let errors = self.errors(past, norm, order, leading);
        errors.own.is_finite().then_some(errors)
    }

    /// Remembers the state.
    pub(super) fn accept(&mut self, past: &mut Differences<T>, order: usize) {
        past.commit(order + 1, &mut self.top);
    }

    fn prepare(&mut self, alpha: &[T], h: T, count: usize) {
        self.gamma[0] = T::zero();
        self.sigma[0] = T::one();
        for i in 1..count {
            self.gamma[i] = self.gamma[i - 1] + alpha[i - 1] / h;
            self.sigma[i] = T::from_index(i) * self.sigma[i - 1] * alpha[i];
        }
    }

    fn errors(&self, past: &Differences<T>, norm: &ErrorNorm, order: usize, leading: T) -> Errors {
        let missed = norm.of(|i| self.top[i]);
        let sum = past.alpha[..order].iter().fold(T::zero(), |sum, &alpha| sum + alpha);
        let last = past.alpha[order].to_f64();
        let constant = (last + (sum - leading).to_f64()).abs().max(last);
        let own = missed * constant.max(self.sigma[order].to_f64());
        let lower = (order > 1).then(|| {
            let (beta, below) = (past.beta[order], past.row(order));
            self.sigma[order - 1].to_f64() * norm.of(|i| self.top[i] + beta * below[i])
        });
        let higher = (past.known() > order + 1).then(|| {
            let (beta, below) = (past.beta[order + 1], past.row(order + 1));
            norm.of(|i| self.top[i] - beta * below[i]) / (order + 2) as f64
        });
        Errors { own, lower, higher }
    }
}
