use super::Scalar;
use super::ring::{BLOCK, Ring};
use crate::formula::Formula;
use crate::math::{Kernel, Rational, with_instructions};
use fearless_simd::{Level, Simd};

/// A row as the stepper uses it: what multiplies the known states and evaluations, newest first.
///
/// `x_{n+1} = sum_j state_j x_{n-j} + sum_j first_j f_{n-j} + sum_j second_j g_{n-j}` with `sum_j state_j = 1`, trailing zeros
/// cut off.
#[derive(Clone, Debug, PartialEq)]
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

    /// Writes `x_{n+1}` and returns whether all of it is finite. The small terms are added first: they lose least that way.
    ///
    /// The weights of the states sum to one in every consistent row, but not once they are rounded; what is missing would
    /// push every step the same way. So older states enter by their differences from the newest.
    pub(super) fn combine(
        &self,
        level: Level,
        x: &Ring<T>,
        f: &Ring<T>,
        g: Option<&Ring<T>>,
        next: &mut [[T; BLOCK]],
    ) -> bool {
        with_instructions(level, Combination { weights: self, x, f, g, next })
    }
}

/// One combination of the history. Whole blocks are written at once, so that the compiler finds the vectors in them.
struct Combination<'a, T> {
    weights: &'a Weights<T>,
    x: &'a Ring<T>,
    f: &'a Ring<T>,
    g: Option<&'a Ring<T>>,
    next: &'a mut [[T; BLOCK]],
}

impl<T: Scalar> Kernel for Combination<'_, T> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> bool {
        let Self { weights, x, f, g, next } = self;
        next.fill([T::zero(); BLOCK]);
        if let Some(g) = g {
            add(&weights.second, g, next);
        }
        add(&weights.first, f, next);
        let newest = x.blocks(0);
        for (age, weight) in used(&weights.state).skip_while(|&(age, _)| age == 0) {
            for ((sum, sample), newest) in next.iter_mut().zip(x.blocks(age)).zip(newest) {
                *sum = std::array::from_fn(|i| sum[i] + weight * (sample[i] - newest[i]));
            }
        }
        let mut all_finite = true;
        for (sum, newest) in next.iter_mut().zip(newest) {
            let total: [T; BLOCK] = std::array::from_fn(|i| sum[i] + newest[i]);
            // Every entry is looked at, whatever the others are: that is quicker than to stop early.
            all_finite &= total.iter().fold(true, |all, entry| all & entry.is_finite());
            *sum = total;
        }
        all_finite
    }
}

/// The weights that are not zero, with the ages of their samples.
#[inline(always)]
fn used<T: Scalar>(weights: &[T]) -> impl Iterator<Item = (usize, T)> {
    weights.iter().copied().enumerate().filter(|&(_, weight)| weight != T::zero())
}

#[inline(always)]
fn add<T: Scalar>(weights: &[T], ring: &Ring<T>, sums: &mut [[T; BLOCK]]) {
    for (age, weight) in used(weights) {
        for (sum, sample) in sums.iter_mut().zip(ring.blocks(age)) {
            *sum = std::array::from_fn(|i| sum[i] + weight * sample[i]);
        }
    }
}
