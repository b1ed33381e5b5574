use super::Scalar;
use super::ring::{BLOCK, Ring};
use crate::formula::Formula;
use crate::math::Rational;

/// A row as the stepper uses it: what multiplies the known states and evaluations, newest first.
///
/// `x_{n+1} = sum_j state_j x_{n-j} + sum_j first_j f_{n-j} + sum_j second_j g_{n-j}` with `sum_j state_j = 1`, trailing zeros
/// cut off.
#[derive(Clone, Debug)]
pub(super) struct Weights<T> {
    pub(super) state: Vec<T>,
    pub(super) first: Vec<T>,
    pub(super) second: Vec<T>,
}

impl<T: Scalar> Weights<T> {
    /// The weights of an explicit row at gap `sigma`.
    pub(super) fn of(formula: &Formula, sigma: T) -> Self {
        Self::scaled(formula.alpha(), formula.beta(), formula.gamma(), sigma, T::one())
    }

    /// The same for a row that starts another one: its `gamma` is scaled to the other's `gamma_sum`, so that both
    /// run with the same feedback step `h`.
    pub(super) fn for_start(formula: &Formula, sigma: T, gamma_sum: &Rational) -> Self {
        let scale = T::from_rational(&(gamma_sum / formula.gamma_sum()));
        Self::scaled(formula.alpha(), formula.beta(), formula.gamma(), sigma, scale)
    }

    /// Euler's step with the feedback step of a row whose `gamma` sums to `gamma_sum`.
    pub(super) fn euler(sigma: T, gamma_sum: &Rational) -> Self {
        Self { state: vec![T::one()], first: vec![sigma], second: vec![sigma * T::from_rational(gamma_sum)] }
    }

    fn scaled(alpha: &[Rational], beta: &[Rational], gamma: &[Rational], sigma: T, feedback: T) -> Self {
        let cut = |row: &[Rational], scale: T| {
            let mut weights: Vec<T> = row[1..].iter().map(|r| T::from_rational(r) * scale).collect();
            while weights.last().is_some_and(|w| *w == T::zero()) {
                weights.pop();
            }
            weights
        };
        Self { state: cut(alpha, -T::one()), first: cut(beta, sigma), second: cut(gamma, sigma * feedback) }
    }

    /// Writes `x_{n+1}`. The small terms are added first: they lose least that way.
    ///
    /// The weights of the states sum to one in every consistent row, but not once they are rounded; what is missing would
    /// push every step the same way. So older states enter by their differences from the newest.
    pub(super) fn combine(&self, x: &Ring<T>, f: &Ring<T>, g: Option<&Ring<T>>, next: &mut [[T; BLOCK]]) {
        let newest = x.blocks(0);
        for (block, (next, newest)) in next.iter_mut().zip(newest).enumerate() {
            let mut sum = [T::zero(); BLOCK];
            if let Some(g) = g {
                add(&self.second, g, block, &mut sum);
            }
            add(&self.first, f, block, &mut sum);
            for (age, &weight) in self.state.iter().enumerate().skip(1) {
                if weight == T::zero() {
                    continue;
                }
                let sample = &x.blocks(age)[block];
                for i in 0..BLOCK {
                    sum[i] += weight * (sample[i] - newest[i]);
                }
            }
            for i in 0..BLOCK {
                next[i] = sum[i] + newest[i];
            }
        }
    }
}

#[inline(always)]
fn add<T: Scalar>(weights: &[T], ring: &Ring<T>, block: usize, sum: &mut [T; BLOCK]) {
    for (age, &weight) in weights.iter().enumerate() {
        if weight == T::zero() {
            continue;
        }
        let sample = &ring.blocks(age)[block];
        for i in 0..BLOCK {
            sum[i] += weight * sample[i];
        }
    }
}
