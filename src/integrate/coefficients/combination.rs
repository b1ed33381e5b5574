use super::weights::{Terms, Weights};
use crate::integrate::history::{BLOCK, History, Ring};
use crate::math::Scalar;
use crate::math::{Kernel, with_instructions};
use fearless_simd::{Level, Simd};

/// Writes what a row makes of the history, all of `x_{n+1}` but the terms of the new state itself, and returns whether all of
/// it is finite. The small terms are added first: they lose least that way.
///
/// The weights of the states sum to one in every consistent row, but not once they are rounded; what is missing would
/// push every step the same way. So older states enter by their differences from the newest.
pub(in crate::integrate) fn combine<T: Scalar>(
    level: Level,
    weights: &Weights<T>,
    history: &History<T>,
    next: &mut [[T; BLOCK]],
) -> bool {
    let History { x, f, g, .. } = history;
    with_instructions(level, Combination { terms: Summands { weights, x, f, g: g.as_ref() }, next })
}

/// What the next state is combined of.
struct Summands<'a, T> {
    weights: &'a Weights<T>,
    x: &'a Ring<T>,
    f: &'a Ring<T>,
    g: Option<&'a Ring<T>>,
}

/// One combination of the history.
struct Combination<'a, T> {
    terms: Summands<'a, T>,
    next: &'a mut [[T; BLOCK]],
}

impl<T: Scalar> Kernel for Combination<'_, T> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, _: S) -> bool {
        let Self { terms, next } = self;
        let mut nothing = [T::zero(); BLOCK];
        let (fours, rest) = next.as_chunks_mut::<4>();
        for (k, next) in fours.iter_mut().enumerate() {
            terms.combine(4 * k, next, &mut nothing);
        }
        let from = 4 * fours.len();
        if let Some(next) = rest.first_chunk_mut::<3>() {
            terms.combine(from, next, &mut nothing);
        } else if let Some(next) = rest.first_chunk_mut::<2>() {
            terms.combine(from, next, &mut nothing);
        } else if let Some(next) = rest.first_chunk_mut::<1>() {
            terms.combine(from, next, &mut nothing);
        }
        nothing.iter().all(|entry| entry.is_finite())
    }
}

impl<T: Scalar> Summands<'_, T> {
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
