use super::Scalar;
use super::ring::{BLOCK, Ring};
use crate::formula::Formula;
use crate::math::{Kernel, Rational, with_instructions};
use fearless_simd::{Level, Simd};

/// A row as the stepper uses it: what multiplies the known states and evaluations, newest first.
///
/// `x_{n+1} = sum_j state_j x_{n-j} + sum_j first_j f_{n-j} + sum_j second_j g_{n-j}` with `sum_j state_j = 1`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Weights<T> {
    /// Without the newest state, whose weight is what the others leave of one.
    older: Terms<T>,
    pub(super) first: Terms<T>,
    pub(super) second: Terms<T>,
}

/// The weights that are not zero, with the ages of what they multiply.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Terms<T>(Vec<(usize, T)>);

impl<T: Scalar> Terms<T> {
    fn new(weights: impl Iterator<Item = T>) -> Self {
        Self(weights.enumerate().filter(|(_, weight)| *weight != T::zero()).collect())
    }

    /// How many samples have to be kept.
    pub(super) fn depth(&self) -> usize {
        self.0.last().map_or(0, |(age, _)| age + 1)
    }
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
        let only = |weight| Terms(vec![(0, weight)]);
        Self {
            older: Terms(Vec::new()),
            first: only(sigma),
            second: only(sigma * T::from_rational(gamma_sum)),
        }
    }

    fn scaled(alpha: &[Rational], beta: &[Rational], gamma: &[Rational], sigma: T, feedback: T) -> Self {
        let terms = |row: &[Rational], scale: T| {
            Terms::new(row[1..].iter().map(|weight| T::from_rational(weight) * scale))
        };
        let mut older = terms(alpha, -T::one());
        older.0.retain(|&(age, _)| age > 0);
        Self { older, first: terms(beta, sigma), second: terms(gamma, sigma * feedback) }
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
        with_instructions(level, Combination { history: History { weights: self, x, f, g }, next })
    }
}

/// What the next state is combined of.
struct History<'a, T> {
    weights: &'a Weights<T>,
    x: &'a Ring<T>,
    f: &'a Ring<T>,
    g: Option<&'a Ring<T>>,
}

/// One combination of the history.
struct Combination<'a, T> {
    history: History<'a, T>,
    next: &'a mut [[T; BLOCK]],
}

impl<T: Scalar> Kernel for Combination<'_, T> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> bool {
        let Self { history, next } = self;
        let mut nothing = [T::zero(); BLOCK];
        let (fours, rest) = next.as_chunks_mut::<4>();
        for (k, next) in fours.iter_mut().enumerate() {
            history.combine(4 * k, next, &mut nothing);
        }
        let from = 4 * fours.len();
        if let Some(next) = rest.first_chunk_mut::<3>() {
            history.combine(from, next, &mut nothing);
        } else if let Some(next) = rest.first_chunk_mut::<2>() {
            history.combine(from, next, &mut nothing);
        } else if let Some(next) = rest.first_chunk_mut::<1>() {
            history.combine(from, next, &mut nothing);
        }
        nothing.iter().all(|entry| entry.is_finite())
    }
}

impl<T: Scalar> History<'_, T> {
    /// Combines the `B` blocks that begin at the block `from`, whose sums stay in registers; `nothing` stays finite if they are.
    #[inline(always)]
    fn combine<const B: usize>(&self, from: usize, next: &mut [[T; BLOCK]; B], nothing: &mut [T; BLOCK]) {
        let mut sums = [[T::zero(); BLOCK]; B];
        if let Some(g) = self.g {
            add(&self.weights.second, g, from, &mut sums);
        }
        add(&self.weights.first, self.f, from, &mut sums);
        let newest = self.x.part::<B>(0, from);
        for &(age, weight) in &self.weights.older.0 {
            let sample = self.x.part::<B>(age, from);
            for b in 0..B {
                sums[b] = std::array::from_fn(|i| sums[b][i] + weight * (sample[b][i] - newest[b][i]));
            }
        }
        for b in 0..B {
            next[b] = std::array::from_fn(|i| sums[b][i] + newest[b][i]);
            *nothing = std::array::from_fn(|i| nothing[i] + next[b][i] * T::zero());
        }
    }
}

#[inline(always)]
fn add<T: Scalar, const B: usize>(terms: &Terms<T>, ring: &Ring<T>, from: usize, sums: &mut [[T; BLOCK]; B]) {
    for &(age, weight) in &terms.0 {
        let sample = ring.part::<B>(age, from);
        for b in 0..B {
            sums[b] = std::array::from_fn(|i| sums[b][i] + weight * sample[b][i]);
        }
    }
}
