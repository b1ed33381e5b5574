use super::ring::{BLOCK, Ring};
use super::times::Times;
use crate::integrate::field::Field;
use crate::math::Scalar;

/// Where a component comes from: the index of a history among several, and its index there.
pub(crate) type Origin = (usize, usize);

/// How many samples of each kind are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::integrate) struct Depths {
    /// States.
    pub(in crate::integrate) states: usize,
    /// First parts `f` of evaluations.
    pub(in crate::integrate) first: usize,
    /// Second parts `g`; nothing where the field has none.
    pub(in crate::integrate) second: Option<usize>,
}

/// The last states of a run with their times, and the last evaluations of the field.
#[derive(Clone, Debug)]
pub(in crate::integrate) struct History<T> {
    pub(in crate::integrate) x: Ring<T>,
    pub(in crate::integrate) f: Ring<T>,
    pub(in crate::integrate) g: Option<Ring<T>>,
    pub(in crate::integrate) times: Times<T>,
}

impl<T: Scalar> History<T> {
    /// The history that begins with the state `x0`.
    pub(in crate::integrate) fn new(depths: Depths, times: Times<T>, x0: &[T]) -> Self {
        let ring = |depth| Ring::new(depth, x0.len(), T::zero());
        let mut history =
            Self { x: ring(depths.states), f: ring(depths.first), g: depths.second.map(ring), times };
        history.x.push().copy_from_slice(x0);
        history
    }

    /// Evaluates the field at the newest state.
    pub(in crate::integrate) fn evaluate(&mut self, field: &mut impl Field<T>) {
        let g = self.g.as_mut().map_or(&mut [] as &mut [T], Ring::push);
        field.evaluate(self.times.now(), self.x.get(0), self.f.push(), g);
    }

    /// Takes an evaluation for that of the newest state.
    pub(in crate::integrate) fn remember_evaluation(&mut self, f: &[T], g: &[T]) {
        self.f.push().copy_from_slice(f);
        if let Some(ring) = &mut self.g {
            ring.push().copy_from_slice(g);
        }
    }

    /// What is known at the newest state: itself, `f` and, where the field has one, `g`.
    pub(in crate::integrate) fn known(&self) -> (&[T], &[T], Option<&[T]>) {
        (self.x.get(0), self.f.get(0), self.g.as_ref().map(|g| g.get(0)))
    }

    /// Makes a candidate the newest state; it is filled up with zeros to whole blocks.
    #[inline]
    pub(in crate::integrate) fn commit(&mut self, candidate: &[[T; BLOCK]]) {
        self.x.push_blocks().copy_from_slice(candidate);
        self.times.commit();
    }

    /// Whether the other one is at the same instant and holds evaluations of the same parts.
    pub(in crate::integrate) fn is_in_step_with(&self, other: &Self) -> bool {
        self.times == other.times && self.g.is_some() == other.g.is_some()
    }

    /// The history of components that come from several that are [in step](Self::is_in_step_with), or are zero. `None` without
    /// a history to come from.
    pub(in crate::integrate) fn gathered(histories: &[&Self], origins: &[Option<Origin>]) -> Option<Self> {
        let first = *histories.first()?;
        let ring = |pick: fn(&Self) -> Option<&Ring<T>>| {
            let rings: Option<Vec<_>> = histories.iter().map(|history| pick(history)).collect();
            rings.map(|rings| Ring::gathered(&rings, origins, T::zero()))
        };
        Some(Self {
            x: ring(|history| Some(&history.x))?,
            f: ring(|history| Some(&history.f))?,
            g: ring(|history| history.g.as_ref()),
            times: first.times.clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::field::Ode;

    fn history(x: [f64; 2]) -> History<f64> {
        let depths = Depths { states: 2, first: 1, second: None };
        let mut history = History::new(depths, Times::uniform(0.0, 0.5), &x);
        history.evaluate(&mut Ode::new(2, |_t, x: &[f64], f: &mut [f64]| {
            f.copy_from_slice(&[10.0 * x[0], 10.0 * x[1]]);
        }));
        history
    }

    #[test]
    fn components_are_gathered_from_several_histories() {
        let (one, other) = (history([1.0, 2.0]), history([3.0, 4.0]));
        assert!(one.is_in_step_with(&other));
        let gathered = History::gathered(&[&one, &other], &[Some((1, 1)), None, Some((0, 0))]).unwrap();
        assert_eq!(gathered.known(), (&[4.0, 0.0, 1.0] as &[_], &[40.0, 0.0, 10.0] as &[_], None));
        assert!(History::<f64>::gathered(&[], &[]).is_none());
    }

    #[test]
    fn a_committed_candidate_is_the_newest_state_at_the_next_time() {
        let mut history = history([1.0, 2.0]);
        let mut candidate = [[0.0; BLOCK]];
        candidate[0][..2].copy_from_slice(&[5.0, 6.0]);
        history.commit(&candidate);
        assert_eq!((history.x.get(0), history.x.get(1)), (&[5.0, 6.0] as &[_], &[1.0, 2.0] as &[_]));
        assert_eq!((history.times.index(), history.times.now()), (1, 0.5));
    }
}
